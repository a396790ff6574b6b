"""mrcal's rectified system with LENSMODEL_LATLON, a transverse equirectangular image."""

import numpy as np

import rectbench as rb

from ._mrcal import RADIANS, MrcalFrame


class Options(rb.Options):
    az_fov_deg: float | None = rb.option(
        None, "field of view along the baseline; what holds both views where left out", gt=0, le=360
    )
    el_fov_deg: float | None = rb.option(None, "the same across the baseline", gt=0, le=360)
    pixels_per_deg: float = rb.option(
        1.0, "resolution, as a multiple of the first image's in the middle of the view", gt=0
    )


class MrcalLatlon(rb.Rectifier[Options]):
    """û = c_x + f_x γ, v̂ = c_y + f_y β about the mean of both optical axes, at the first image's resolution.

    mrcal asks for the field of view; here it is what holds both views unless it is stated. It is a whole
    number of pixels, and the resolution follows. The second camera comes to the right, wherever it stands.
    """

    name = "mrcal-latlon"
    references = ("Kogan, mrcal, https://mrcal.secretsauce.net: mrcal.rectified_system(), LENSMODEL_LATLON",)

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        rig, frame = problem.rig, MrcalFrame.of(problem.rig)
        reaches = frame.reach(rig, rb.Epipolar(RADIANS, RADIANS))
        fovs = [
            2 * reach if fov_deg is None else np.radians(fov_deg)
            for fov_deg, reach in zip((options.az_fov_deg, options.el_fov_deg), reaches, strict=True)
        ]
        middles, size, profiles = (frame.azimuth, 0.0), [], []
        for fov, resolution, middle in zip(fovs, frame.px_per_rad(rig.left), middles, strict=True):
            side = max(1, round(fov * options.pixels_per_deg * resolution))
            focal = float(side / fov)
            size.append(side)
            profiles.append(rb.Radial("equidistant", focal, (side - 1) / 2 - focal * middle))
        target = rb.Epipolar(*profiles)
        left = rb.Warp(rig.left, frame.R_rect_left, target)
        right = rb.Warp(rig.right, frame.R_rect_right, target)
        return rb.Rectification(rig, left, right, (size[0], size[1]), {"az0_deg": np.degrees(frame.azimuth)})
