"""The frame of mrcal's rectified systems, and their resolution."""

from typing import NamedTuple

import numpy as np

import rectbench as rb

RADIANS = rb.Radial("equidistant", 1.0, 0.0)
LEAST_FORWARD = 1e-6
"""Sine of the angle between the baseline and where the cameras look; below it there is no forward."""


class MrcalFrame(NamedTuple):
    """x from the first camera to the second, z the mean of both optical axes without its part along x."""

    R_rect_left: np.ndarray
    R_rect_right: np.ndarray
    azimuth: float
    """Where the mean of both optical axes looks along the baseline, γ in radians."""

    @classmethod
    def of(cls, rig: rb.Rig) -> "MrcalFrame":
        """Raises Unsupported where both cameras look along the baseline."""
        right = rig.centre_right_in_left / rig.baseline_m
        forward = rig.R_right_left.T[:, 2] + [0, 0, 1]
        forward /= np.linalg.norm(forward)
        along = float(forward @ right)
        across = forward - along * right
        if not np.linalg.norm(across) > LEAST_FORWARD:
            raise rb.Unsupported(
                "the cameras look along the baseline, and mrcal's frame has no forward there"
            )
        z = across / np.linalg.norm(across)
        R_rect_left = np.stack([right, np.cross(z, right), z])
        return cls(R_rect_left, R_rect_left @ rig.R_right_left.T, float(np.arcsin(along)))

    def px_per_rad(self, camera: rb.Camera) -> tuple[float, float]:
        """Pixels a radian of γ and of β in the first camera's image, in the middle of the rectified view."""
        sin, cos = np.sin(self.azimuth), np.cos(self.azimuth)
        by_ray = camera.whole.project_jacobian(self.R_rect_left.T @ [sin, 0, cos]) @ self.R_rect_left.T
        along, across = np.linalg.norm(by_ray @ np.array([[cos, 0, -sin], [0, cos, 0]]).T, axis=0)
        return float(along), float(across)

    def reach(self, rig: rb.Rig, angles: rb.Target) -> np.ndarray:
        """How far both views reach from the middle, along the baseline and across it, radians [2]."""
        warps = rb.Warp(rig.left, self.R_rect_left, angles), rb.Warp(rig.right, self.R_rect_right, angles)
        seen = np.concatenate([warp.forward(rb.outline_pixels(warp.source)[0]) for warp in warps])
        reach: np.ndarray = np.nanmax(np.abs(seen - [self.azimuth, 0.0]), axis=0)
        return reach
