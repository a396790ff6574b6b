"""Equirectangular images of a stereo pair, as VR180 tools make them: a control without scan lines."""

import numpy as np

import rectbench as rb


class Options(rb.Options):
    fov_deg: float = rb.option(180.0, "longitudes and latitudes that are shown, each way", gt=0, le=180)
    focal_px: float | None = rb.option(
        None, "pixels a radian, both ways; the sources' centre resolution where left out", gt=0
    )


class Equirectangular(rb.Rectifier[Options]):
    """û = f atan2(x, z), v̂ = f asin(y) of unit rays: longitude and latitude about the vertical.

    Players show one to each eye, for which rows need not agree: but for the equator a circle of latitude is
    no epipolar plane of a horizontal baseline, since y/z = tan(v̂/f) / cos(û/f). The cameras are turned to be
    parallel and upright first. What lies beyond the field of view is left out.
    """

    name = "equirectangular"
    is_control = True
    references = (
        "Google, VR180 Video Format and Spherical Video V2 RFC, https://github.com/google/spatial-media",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        focal = options.focal_px or rb.centre_resolution_px(problem.rig)
        side = round(focal * np.radians(options.fov_deg))
        even = rb.Radial("equidistant", focal, (side - 1) / 2)
        target = rb.Upright(even, even)
        return rb.Rectification.from_targets(problem.rig, target, target, (side, side), {"focal_px": focal})
