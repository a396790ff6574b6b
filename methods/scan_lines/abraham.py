"""Epipolar rectification of fisheye images that stay fisheye images (Abraham and Förstner 2005)."""

from typing import Literal

import rectbench as rb


class Options(rb.Options):
    law: Literal["equidistant", "stereographic", "equisolid", "orthographic", "cylindrical"] = rb.option(
        "equidistant", "the lens law r(γ) along the rows"
    )
    focal_px: float | None = rb.option(
        None, "focal length f in px; the sources' centre resolution where left out", gt=0
    )


class Abraham(rb.Rectifier[Options]):
    """û = c_x + f r(γ), v̂ = c_y + f β with a classical lens law r; nothing is optimised."""

    name = "abraham"
    references = (
        "Abraham and Förstner, Fish-eye-stereo calibration and epipolar rectification, "
        "ISPRS Journal of Photogrammetry and Remote Sensing 59(5), 2005",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        focal = options.focal_px or rb.centre_resolution_px(problem.rig)
        u, v = rb.Radial(options.law, focal, 0.0), rb.Radial("equidistant", focal, 0.0)
        return rb.Rectification.from_profiles(problem.rig, u, u, v, {"focal_px": focal})
