"""JPL's planospheric model (PSPH), made for searching pairs of fisheye images along rows."""

import numpy as np

import rectbench as rb

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
        spans = longitudes(rig, 1 / focal), rb.view_angles(rig).beta
        (left, right), (top, bottom) = (np.clip(span, -LIMIT_RAD, LIMIT_RAD) for span in spans)
        if not (left < right and top < bottom):
            raise rb.Unsupported("all that the lenses show lies 85° and more aside")
        columns, rows = (rb.Cubic(0.0, focal, 0.0, 0.0, *ends) for ends in ((left, right), (top, bottom)))
        target = rb.Planospheric(columns, rows).framed(focal * left, focal * top, 1.0, 1.0)
        size = int(np.ceil(focal * (right - left))), int(np.ceil(focal * (bottom - top)))
        return rb.Rectification.from_targets(rig, target, target, size, {"focal_px": focal})


def longitudes(rig: rb.Rig, rad_per_px: float) -> tuple[float, float]:
    """The least and the greatest atan2(x, z) of both views, radians, a pixel of the outline's grid wider."""
    even = rb.Radial("equidistant", 1.0, 0.0)
    least, greatest = [], []
    for camera, R_rect_cam in zip((rig.left, rig.right), rb.rectifying_rotations(rig), strict=True):
        pixels, spacing_px = rb.outline_pixels(camera)
        found = rb.Warp(camera, R_rect_cam, rb.Upright(even, even)).forward(pixels)[:, 0]
        least.append(np.nanmin(found) - spacing_px * rad_per_px)
        greatest.append(np.nanmax(found) + spacing_px * rad_per_px)
    return float(min(least)), float(max(greatest))
