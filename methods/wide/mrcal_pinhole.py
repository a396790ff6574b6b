"""mrcal's rectified system with LENSMODEL_PINHOLE, a perspective image."""

import numpy as np

import rectbench as rb

from ._mrcal import RADIANS, MrcalFrame

MOST_DEG = 90.0
"""Field of view where none is stated and the lenses see more."""


class Options(rb.Options):
    az_fov_deg: float | None = rb.option(
        None,
        "field of view along the baseline; that of both views, at most 90°, where left out",
        gt=0,
        lt=180,
    )
    el_fov_deg: float | None = rb.option(None, "the same across the baseline", gt=0, lt=180)
    pixels_per_deg: float = rb.option(
        1.0, "resolution, as a multiple of the first image's in the middle of the view", gt=0
    )


class MrcalPinhole(rb.Rectifier[Options]):
    """û = c_x + f_x x/z, v̂ = c_y + f_y y/z, in its middle at the first image's resolution.

    mrcal asks for the field of view, which is that between the rays of the outer pixels of a middle row and
    column. Unless it is stated it is here what both views take, and at most 90°. What lies behind is masked.
    """

    name = "mrcal-pinhole"
    references = ("Kogan, mrcal, https://mrcal.secretsauce.net: mrcal.rectified_system(), LENSMODEL_PINHOLE",)

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        rig, frame = problem.rig, MrcalFrame.of(problem.rig)
        asked_deg = options.az_fov_deg, options.el_fov_deg
        fovs = frame.fields_of_view(rig, asked_deg, rb.Planospheric(RADIANS, RADIANS), MOST_DEG)
        focals, centres, size = [], [], []
        middles = frame.azimuth, 0.0
        for fov, resolution, middle in zip(fovs, frame.px_per_rad(rig.left), middles, strict=True):
            focal = options.pixels_per_deg * resolution * np.cos(middle) ** 2
            half = half_width(fov, np.tan(middle))
            focals.append(focal)
            centres.append(focal * (half - np.tan(middle)))
            size.append(round(2 * focal * half) + 1)
        (fx, fy), (cx, cy) = focals, centres
        target = rb.Perspective(np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]]))
        return frame.rectification(rig, target, size)


def half_width(fov: float, middle: float) -> float:
    """w with atan(middle + w) - atan(middle - w) = fov: half of an image at distance 1 of that field of view.

    tan fov = 2 w / (1 + middle² - w²), a quadratic of one root above 0.
    """
    cotangent = 1 / np.tan(fov)
    return float(np.sqrt(cotangent**2 + 1 + middle**2) - cotangent)
