"""The frame of mrcal's rectified systems, and their resolution."""

from typing import NamedTuple

import numpy as np

import rectbench as rb

RADIANS = rb.Radial("equidistant", 1.0, 0.0)
LEAST_FORWARD_DEG = 10.0
"""Between the baseline and where the cameras look; nearer to it rows or columns are of no size."""


class MrcalFrame(NamedTuple):
    """x from the first camera to the second, z the mean of both optical axes without its part along x."""

    R_rect_left: np.ndarray
    R_rect_right: np.ndarray
    azimuth: float
    """Where the mean of both optical axes looks along the baseline, γ in radians."""

    @classmethod
    def of(cls, rig: rb.Rig) -> "MrcalFrame":
        """Raises Unsupported where the cameras look along the baseline."""
        right = rig.centre_right_in_left / rig.baseline_m
        forward = rig.R_right_left.T[:, 2] + [0, 0, 1]
        forward /= np.linalg.norm(forward)
        azimuth = float(np.arcsin(np.clip(forward @ right, -1.0, 1.0)))
        off_deg = 90 - abs(np.degrees(azimuth))
        if off_deg < LEAST_FORWARD_DEG:
            raise rb.Unsupported(
                f"the cameras look {off_deg:.1f}° off the baseline; expected {LEAST_FORWARD_DEG:.0f}° or "
                "more, for mrcal's frame looks across it"
            )
        across = forward - (forward @ right) * right
        z = across / np.linalg.norm(across)
        R_rect_left = np.stack([right, np.cross(z, right), z])
        return cls(R_rect_left, R_rect_left @ rig.R_right_left.T, azimuth)

    def px_per_rad(self, camera: rb.Camera) -> tuple[float, float]:
        """Pixels a radian of γ and of β in the first camera's image, in the middle of the rectified view.

        Raises Unsupported where that camera does not see it.
        """
        sin, cos = np.sin(self.azimuth), np.cos(self.azimuth)
        by_ray = camera.whole.project_jacobian(self.R_rect_left.T @ [sin, 0, cos]) @ self.R_rect_left.T
        along, across = np.linalg.norm(by_ray @ np.array([[cos, 0, -sin], [0, cos, 0]]).T, axis=0)
        if not np.isfinite([along, across]).all():
            raise rb.Unsupported(
                "the first camera does not see the middle of both views, where mrcal takes its resolution"
            )
        return float(along), float(across)

    def fields_of_view(
        self, rig: rb.Rig, asked_deg: tuple[float | None, float | None], angles: rb.Target, most_deg: float
    ) -> list[float]:
        """Along the baseline and across it, radians: as asked, or what holds both views, at most so much.

        `angles` are those along columns and rows by which a view is held.
        """
        reached = []
        for camera, R_rect_cam in ((rig.left, self.R_rect_left), (rig.right, self.R_rect_right)):
            pixels, spacing_px = rb.outline_pixels(camera)
            off = np.abs(rb.Warp(camera, R_rect_cam, angles).forward(pixels) - [self.azimuth, 0.0])
            # Between two pixels of a grid the image circle may reach further.
            reached.append(np.nanmax(off, axis=0) * (1 + 2 * spacing_px / max(camera.size)))
        held_deg = np.degrees(2 * np.max(reached, axis=0))
        return [
            float(np.radians(min(held, most_deg) if asked is None else asked))
            for asked, held in zip(asked_deg, held_deg, strict=True)
        ]

    def rectification(self, rig: rb.Rig, target: rb.Target, size: list[int]) -> rb.Rectification:
        """One image for both cameras, in this frame."""
        left = rb.Warp(rig.left, self.R_rect_left, target)
        right = rb.Warp(rig.right, self.R_rect_right, target)
        notes = {"az0_deg": float(np.degrees(self.azimuth))}
        return rb.Rectification(rig, left, right, (size[0], size[1]), notes)
