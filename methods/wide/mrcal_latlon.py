"""mrcal's rectified system with LENSMODEL_LATLON, a transverse equirectangular image."""

import rectbench as rb

from ._mrcal import RADIANS, MrcalFrame

MOST_DEG = 360.0


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
        asked_deg = options.az_fov_deg, options.el_fov_deg
        fovs = frame.fields_of_view(rig, asked_deg, rb.Epipolar(RADIANS, RADIANS), MOST_DEG)
        size, profiles = [], []
        middles = frame.azimuth, 0.0
        for fov, resolution, middle in zip(fovs, frame.px_per_rad(rig.left), middles, strict=True):
            side = max(1, round(fov * options.pixels_per_deg * resolution))
            focal = side / fov
            size.append(side)
            profiles.append(rb.Radial("equidistant", focal, (side - 1) / 2 - focal * middle))
        return frame.rectification(rig, rb.Epipolar(*profiles), size)
