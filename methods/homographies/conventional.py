"""Conventional rectification: undistort to a perspective image and turn it into the epipolar frame."""

from collections.abc import Callable
from typing import Literal

import numpy as np

import rectbench as rb

LEAST_FOCAL_SHARE = 0.01
"""A focal length below this share of the source's resolution shows the world as a dot: refused."""


class Options(rb.Options):
    focal: Literal["centre-resolution", "min-distortion", "fov", "balance"] = rb.option(
        "centre-resolution",
        "how f is chosen: the source's pixels per radian at its centre, the least distortion L "
        "(the paper's; tends to a tiny image on wide lenses), a field of view, or a balance",
    )
    fov_deg: float = rb.option(
        100.0, "horizontal field of view of the rectified image, for focal=fov", gt=0, lt=179
    )
    balance: float = rb.option(
        0.0, "for focal=balance: 0 shows source pixels only, 1 all of the source's rim", ge=0, le=1
    )


class Conventional(rb.Rectifier[Options]):
    """û = c_x + f x/z, v̂ = c_y + f y/z after Bouguet's rotations; rays behind the image are masked.

    Where a camera looks along the baseline the image plane is turned about it to where it shows most.
    """

    name = "conventional"
    references = (
        "Bouguet, Camera Calibration Toolbox for Matlab, 2004",
        "Fusiello, Trucco and Verri, A compact algorithm for rectification of stereo pairs, 2000",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        rig, size = problem.rig, rb.perspective_size(problem.rig)
        ways: dict[str, Callable[[], float]] = {
            "centre-resolution": lambda: rb.centre_resolution_px(rig),
            "min-distortion": lambda: self.least_distorted(problem, size),
            "fov": lambda: size[0] / 2 / np.tan(np.radians(options.fov_deg) / 2),
            "balance": lambda: self.balanced(rig, size, options.balance),
        }
        focal = ways[options.focal]()
        if not focal >= LEAST_FOCAL_SHARE * rb.centre_resolution_px(rig):
            raise rb.Unsupported(
                f"focal={options.focal} gives f = {focal:.3g} px where the source has "
                f"{rb.centre_resolution_px(rig):.0f}: the lens is too wide for it"
            )
        found = self.at_focal(rig, focal, size)
        for warp in (found.left, found.right):
            if not shows_any(warp, size):
                raise rb.Unsupported(
                    f"of one of the views nothing lies on a perspective image of {size[0]}x{size[1]} px at "
                    f"f = {focal:.0f} px: the cameras look apart"
                )
        return found

    def at_focal(self, rig: rb.Rig, focal: float, size: tuple[int, int]) -> rb.Rectification:
        """The perspective rectification of one focal length, what is in front in the middle."""
        frame = rb.PerspectiveFrame.of(rig)
        cx, cy = (np.array(size) - 1) / 2 - focal * frame.middle
        target = rb.Perspective.from_focal(focal, cx, cy)
        left, right = (
            rb.Warp(rig.left, frame.R_rect_left, target),
            rb.Warp(rig.right, frame.R_rect_right, target),
        )
        return rb.Rectification(rig, left, right, size, {"focal_px": focal})

    def least_distorted(self, problem: rb.Problem, size: tuple[int, int]) -> float:
        """The focal length of least L: a factor on f scales the whole image, so one look is enough."""
        focal = rb.centre_resolution_px(problem.rig)
        score = rb.metrics.distortion(
            self.at_focal(problem.rig, focal, size), problem.rig, problem.pixels_left, protocol="rescaled"
        )
        return focal * score.scales[0]

    def balanced(self, rig: rb.Rig, size: tuple[int, int], balance: float) -> float:
        """Between the f whose image just holds both sources' rims (1) and that just filled by them (0)."""
        at_unit = self.at_focal(rig, 1.0, size)
        half = (np.array(size) - 1) / 2
        holding, filling = [], []
        for warp in (at_unit.left, at_unit.right):
            pixels, _ = rb.outline_pixels(warp.source)
            rim = warp.forward(pixels) - half
            if np.isnan(rim).any():
                return 0.0  # the rim reaches behind the plane: only a dot would hold it
            reach = np.abs(rim / half).max(axis=1)
            holding.append(1 / reach.max())
            on_rim = (np.abs(pixels + 0.5) % np.array(warp.source.size) == 0).any(axis=1)
            filling.append(1 / reach[on_rim].min())
        return balance * min(holding) + (1 - balance) * max(filling)


def shows_any(warp: rb.Warp, size: tuple[int, int]) -> bool:
    """Whether any pixel of the source lies on the rectified image."""
    pixels = warp.forward(rb.evaluation_pixels(warp.source))
    return bool(((pixels >= -0.5) & (pixels <= np.array(size) - 0.5)).all(axis=1).any())
