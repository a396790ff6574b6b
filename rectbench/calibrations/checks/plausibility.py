"""What a rig's numbers make improbable, told in one line each; nothing is changed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np

from rectbench.calibrations.documents import tell
from rectbench.cameras import Camera
from rectbench.cameras.lens import lens_named
from rectbench.errors import argument
from rectbench.formulas.namespaces import NUMPY
from rectbench.rigs.rig import Rig

SHORTEST_BASELINE_M, LONGEST_BASELINE_M = 0.004, 100.0
"""Of rigs that people build; what lies beyond is rather in another unit."""

ASPECT = 0.05
"""By how much fx and fy, relative, may differ; pixels are square but for a per mille or so."""

LEAST_SHARE = 1e-3
"""Of an image's pixels, beyond which the lens's polynomial turns; fewer are not told."""

GRID, DIRECTIONS = 48, 90
"""Columns and rows of the pixels that the share is counted on, and directions in which the edge is sought."""

FOLDING = frozenset(("kannala-brandt", "pinhole", "tilted-pinhole", "radial-tangential"))
"""Models whose domain ends, where not at 90° or 180°, where their distortion turns."""


@np.errstate(all="ignore")
def tell_implausible(rig: Rig) -> None:
    """Tell what is improbable about the rig."""
    for side, camera in (("left", rig.left), ("right", rig.right)):
        for line in _implausible(camera):
            tell(f"{rig.name}: the {side} camera's {line}")
    if not SHORTEST_BASELINE_M <= rig.baseline_m <= LONGEST_BASELINE_M:
        tell(
            f"{rig.name}: the baseline is {rig.baseline_m:.3g} m, which few rigs have; if the calibration's "
            f"translations are in another unit, `{argument('unit')}` states it"
        )


def _implausible(camera: Camera) -> Iterator[str]:
    p = camera.params
    if "fx" in p and abs(p["fx"] / p["fy"] - 1.0) > ASPECT:
        yield f"focal lengths are {p['fx']:.6g} and {p['fy']:.6g} px; expected nearly the same"
    if not (0 <= p["cx"] <= camera.width and 0 <= p["cy"] <= camera.height):
        size = f"{camera.width}x{camera.height}"
        yield f"principal point ({p['cx']:.6g}, {p['cy']:.6g}) is not on its image, {size}"
    share = _share_beyond_fold(camera)
    if share > LEAST_SHARE:
        yield (
            f"distortion turns at {_edge_deg(camera):.1f}° from the axis, inside the image; the {share:.1%} "
            "of the pixels that lie beyond count as not seen"
        )


def _share_beyond_fold(camera: Camera) -> float:
    """The share of the image's pixels that lie beyond where the distortion turns.

    That is a curve about the centre, which the lens makes of the circle at its edge; no pixel is undistorted.
    """
    if camera.model not in FOLDING or camera.max_angle_deg is not None:
        return 0.0
    lens, c = lens_named(camera.model), SimpleNamespace(**camera.constants)
    if not math.isfinite(c.max_radius):
        return 0.0
    phi, edge = np.linspace(-math.pi, math.pi, DIRECTIONS), math.radians(_edge_deg(camera))
    x, y, z = math.sin(edge) * np.cos(phi), math.sin(edge) * np.sin(phi), np.full(DIRECTIONS, math.cos(edge))
    mx, my, _ = lens.to_plane(c, x, y, z, NUMPY)
    u, v = np.array([[0, 0, 1, 1], [0, 1, 0, 1]]) * np.array(camera.size)[:, None]
    if np.hypot(*lens.from_pixel(c, u, v)).max() <= np.hypot(mx, my).min():
        return 0.0
    u, v = (np.linspace(0.0, side - 1.0, GRID) for side in camera.size)
    a, b = lens.from_pixel(c, *np.meshgrid(u, v))
    order = np.argsort(directions := np.arctan2(my, mx))
    reach = np.interp(np.arctan2(b, a), directions[order], np.hypot(mx, my)[order], period=2 * math.pi)
    return float((np.hypot(a, b) > reach).mean())


def _edge_deg(camera: Camera) -> float:
    """The angle from the axis at which the distortion turns, degrees."""
    constants = camera.constants
    return math.degrees(constants.get("max_theta", math.atan(constants["max_radius"])))
