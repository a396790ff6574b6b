"""Perspective lenses: Brown and Conrady's distortion as in OpenCV, a tilted sensor, a longer polynomial."""

from __future__ import annotations

import math
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import Polynomial

from rectbench.cameras.brown import COEFFICIENTS, distorted, edge, undistorted
from rectbench.cameras.lens import FOCAL_PARAMETERS, Interval, Lens, register
from rectbench.formulas.domain import FARTHEST, LEAST_SLOPE, PIXEL_SLACK, first_root
from rectbench.formulas.inversion import invert_in_disk
from rectbench.formulas.monotone import edge_of_disk, monotone_radius
from rectbench.formulas.protocol import Formulas

LONGER = ("k1", "k2", "k3", "k4", "p1", "p2")
"""Coefficients of `radial-tangential`; `pinhole` has its k4 in the denominator of the radial term."""

LEAST_DEPTH, MOST_DEPTH = 0.05, 1e4
"""Of a point of the lens plane, turned with the sensor: at 0 its image lies at infinity, and towards infinity
all images lie on one line."""

RIGHT_ANGLE = Interval(-0.5 * math.pi, 0.5 * math.pi, low_open=True, high_open=True)


@register
class Pinhole(Lens):
    """(x, y)/z, distorted: OpenCV's `calib3d` with twelve coefficients.

    Valid in front of the camera, while the distortion is monotone.
    """

    name = "pinhole"
    parameters = (*FOCAL_PARAMETERS, *COEFFICIENTS)

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        return dict(edge(p))

    def to_plane(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        a, b = x / z, y / z
        return *distorted(c, a, b, xp), (z > 0.0) & (xp.hypot(a, b) <= c.max_radius)

    def from_plane(self, c: Any, mx: Any, my: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        a, b, ok = undistorted(c, mx, my, xp)
        scale = 1.0 / xp.hypot(xp.hypot(a, b), 1.0)
        return scale * a, scale * b, scale, ok


@register
class TiltedPinhole(Lens):
    """`pinhole`, then the homography of a sensor turned by tau_x and tau_y, radians: all 14 coefficients.

    The distorted point is turned by R = R_y(tau_y) R_x(tau_x) and projected onto the tilted sensor, whose
    normal keeps its place: (mx, my, 1) ~ [r33 0 -r13; 0 r33 -r23; 0 0 1] R (a, b, 1) (OpenCV's calib3d,
    "tilted sensor"; Scheimpflug's condition).
    """

    name = "tilted-pinhole"
    parameters = (*FOCAL_PARAMETERS, *COEFFICIENTS, "tau_x", "tau_y")
    ranges: ClassVar = {**Lens.ranges, "tau_x": RIGHT_ANGLE, "tau_y": RIGHT_ANGLE}

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        cos_x, sin_x, cos_y, sin_y = (f(t) for t in (p.tau_x, p.tau_y) for f in (math.cos, math.sin))
        turn = np.array([[cos_y, 0, -sin_y], [0, 1, 0], [sin_y, 0, cos_y]]) @ np.array(
            [[1, 0, 0], [0, cos_x, sin_x], [0, -sin_x, cos_x]]
        )
        onto = np.array([[turn[2, 2], 0, -turn[0, 2]], [0, turn[2, 2], -turn[1, 2]], [0, 0, 1]])
        tilt, untilt = onto @ turn, turn.T @ np.linalg.inv(onto)
        return {**edge(p), "tilt": tuple(tilt.ravel().tolist()), "untilt": tuple(untilt.ravel().tolist())}

    def to_plane(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        a, b = x / z, y / z
        within = (z > 0.0) & (xp.hypot(a, b) <= c.max_radius)
        mx, my, depth = _mapped(c.tilt, *distorted(c, a, b, xp))
        return mx / depth, my / depth, within & (depth >= LEAST_DEPTH) & (depth <= MOST_DEPTH)

    def from_plane(self, c: Any, mx: Any, my: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        p, q, nearness = _mapped(c.untilt, mx, my)
        inside = (nearness >= (1.0 - PIXEL_SLACK) / MOST_DEPTH) & (
            nearness <= (1.0 + PIXEL_SLACK) / LEAST_DEPTH
        )
        a, b, ok = undistorted(c, p / nearness, q / nearness, xp)
        scale = 1.0 / xp.hypot(xp.hypot(a, b), 1.0)
        return scale * a, scale * b, scale, ok & inside


def _mapped(homography: Any, a: Any, b: Any) -> tuple[Any, Any, Any]:
    """The homography, nine numbers by rows, times (a, b, 1)."""
    h = homography
    return h[0] * a + h[1] * b + h[2], h[3] * a + h[4] * b + h[5], h[6] * a + h[7] * b + h[8]


@register
class RadialTangential(Lens):
    """(x, y)/z, moved by k1 r² + k2 r⁴ + k3 r⁶ + k4 r⁸ and by OpenCV's p1 and p2: BoofCV's, photogrammetry's.

    `pinhole` has k4 in the denominator of its radial term. Valid in front of the camera, while the
    distortion is monotone.
    """

    name = "radial-tangential"
    parameters = (*FOCAL_PARAMETERS, *LONGER, "skew")

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        radius = _monotone_radius(*(getattr(p, name) for name in LONGER))
        if math.isinf(radius):
            return {"max_radius": radius, "reach": radius}
        return dict(edge_of_disk(longer_distorted, p, radius))

    def to_plane(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        a, b = x / z, y / z
        return *longer_distorted(c, a, b, xp), (z > 0.0) & (xp.hypot(a, b) <= c.max_radius)

    def from_plane(self, c: Any, mx: Any, my: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        a, b, ok = invert_in_disk(longer_distorted, c, mx, my, c.max_radius, c.reach, xp)
        scale = 1.0 / xp.hypot(xp.hypot(a, b), 1.0)
        return scale * a, scale * b, scale, ok


def longer_distorted(c: Any, a: Any, b: Any, xp: Formulas) -> tuple[Any, Any]:
    """Where the lens puts the point (a, b) of the ideal plane."""
    q = a * a + b * b
    radial = 1.0 + q * (c.k1 + q * (c.k2 + q * (c.k3 + q * c.k4)))
    ab = 2.0 * a * b
    return (
        a * radial + c.p1 * ab + c.p2 * (q + 2.0 * a * a),
        b * radial + c.p1 * (q + 2.0 * b * b) + c.p2 * ab,
    )


@lru_cache
def _monotone_radius(*coefficients: float) -> float:
    if not any(coefficients):
        return math.inf
    c = SimpleNamespace(**dict(zip(LONGER, coefficients, strict=True)))
    stretch = Polynomial([1.0, c.k1, c.k2, c.k3, c.k4])  # of the radius, a polynomial in its square
    slope = stretch + 2.0 * Polynomial([0.0, 1.0]) * stretch.deriv()
    radius = min(FARTHEST, math.sqrt(first_root(slope - LEAST_SLOPE)))
    return monotone_radius(longer_distorted, c, radius) if c.p1 or c.p2 else radius
