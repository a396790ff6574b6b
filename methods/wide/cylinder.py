"""Images on a cylinder, as D2SLAM's and VINS-Fisheye's front ends look at fisheye lenses."""

from typing import Literal

import numpy as np

import rectbench as rb

from ._frames import in_epipolar_frame


class Options(rb.Options):
    axis: Literal["baseline", "vertical"] = rb.option(
        "baseline",
        "baseline: the cylinder lies about the baseline, as it does where one camera looks up and one down; "
        "vertical: it stands upright beside a horizontal baseline, and rows are no epipolar planes",
    )
    along_deg: float = rb.option(
        120.0, "the most that is shown along the axis, where a cylinder has no end", gt=0, lt=180
    )
    focal_px: float | None = rb.option(
        None, "radius of the cylinder in px; the sources' centre resolution where left out", gt=0
    )


class Cylinder(rb.Rectifier[Options]):
    """û = f tan γ along the baseline and v̂ = f β around it: the map of Abraham and Förstner with r = tan.

    With axis=vertical û = f atan2(x, z), v̂ = f y / hypot(x, z), as a cylinder serves cameras side by side for
    tracking; its rows are no scan lines. Nothing is shown near the ends of the axis.
    """

    name = "cylinder"
    references = (
        "Gao, Wang, Ding, Gao, Qin and Shen, Autonomous aerial robot using dual-fisheye cameras, "
        "Journal of Field Robotics 37(4), 2020",
        "Xu, Liu, Chen and Shen, D2SLAM: decentralized and distributed collaborative visual-inertial SLAM "
        "system for aerial swarm, IEEE Transactions on Robotics 40, 2024",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        rig = problem.rig
        focal = options.focal_px or rb.centre_resolution_px(rig)
        reach_px = focal * float(np.tan(np.radians(options.along_deg) / 2))
        along, around = rb.Radial("cylindrical", focal, 0.0), rb.Radial("equidistant", focal, 0.0)
        notes: dict[str, float | str] = {"focal_px": focal}
        if options.axis == "baseline":
            return in_epipolar_frame(rig, rb.Epipolar(along, around), notes, (reach_px, np.inf))
        return in_epipolar_frame(rig, rb.Upright(around, along), notes, (np.inf, reach_px))
