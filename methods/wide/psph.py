"""JPL's planospheric model (PSPH), which its rovers' fisheye stereo is searched in."""

import numpy as np

import rectbench as rb

from ._frames import in_epipolar_frame

LIMIT_RAD = np.radians(85.0)
"""Towards 90° planes about the vertical and about the baseline become one, and pixels infinitely long."""


class Options(rb.Options):
    focal_px: float | None = rb.option(
        None, "pixels a radian, both ways; the sources' centre resolution where left out", gt=0
    )


class Psph(rb.Rectifier[Options]):
    """û = f atan2(x, z), v̂ = f β: a pixel is where a plane about the vertical meets one about the baseline.

    Both families of planes turn evenly. They become one at ±90°, for which its author restricts it to fields
    of view below 180°; here what lies beyond 85° is masked.
    """

    name = "psph"
    references = (
        "Litwin, PSPH, the planospheric model of the camera-model software (cmod) of the Jet Propulsion "
        "Laboratory, 2002",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        rig = problem.rig
        focal = options.focal_px or rb.centre_resolution_px(rig)
        even = rb.Cubic(0.0, focal, 0.0, 0.0, -LIMIT_RAD, LIMIT_RAD)
        return in_epipolar_frame(rig, rb.Planospheric(even, even), {"focal_px": focal})
