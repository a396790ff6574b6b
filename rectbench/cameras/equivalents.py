"""One lens under several names: the cameras of other projection models that are exactly the same.

| a camera | is also |
|---|---|
| equidistant | kannala-brandt without coefficients |
| thin-prism-fisheye, fisheye624 with radial terms of four coefficients alone | kannala-brandt |
| stereographic, both ways | division with k = -1/4, unified with ξ = 1 and twice the focal length |
| division with k = 0 or -1/4 | pinhole, stereographic |
| unified without distortion and skew, ξ ≥ 0 | extended-unified with α = ξ/(1+ξ), β = 1 |
| unified with ξ = 0, without skew | pinhole |
| extended-unified with β = 1 | double-sphere with ξ = 0, unified with ξ = α/(1-α) |
| double-sphere with ξ = 0 or α = 0 | extended-unified, unified |
| tilted-pinhole without tilt, radial-tangential without k4 and skew | pinhole |

Same: every ray lands on the same pixel, to rounding. Where a domain ends may differ by some 1e-4 rad.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from rectbench.cameras.brown import COEFFICIENTS
from rectbench.cameras.camera import Camera
from rectbench.cameras.lens import FOCAL_PARAMETERS

Params = Mapping[str, Any]
Lens = tuple[str, dict[str, Any]]
"""A projection model and its parameters."""

RADIAL_624 = {"k0": "k1", "k1": "k2", "k2": "k3", "k3": "k4"}
"""The coefficients of fisheye624 by their names in kannala-brandt."""


def equal_cameras(camera: Camera) -> list[Camera]:
    """The camera, and every camera of another model that is exactly it; the most closely related first."""
    found = {camera.model: camera}
    waiting = [camera]
    while waiting:
        equal = waiting.pop(0)
        for model, params in RULES[equal.model](equal.params) if equal.model in RULES else ():
            if model not in found:
                found[model] = Camera(model, camera.size, params, camera.max_angle_deg)
                waiting.append(found[model])
    return list(found.values())


def _equidistant(p: Params) -> Iterator[Lens]:
    yield "kannala-brandt", dict(p)


def _thin_prism_fisheye(p: Params) -> Iterator[Lens]:
    if not any(p[name] for name in ("p1", "p2", "sx1", "sy1")):
        yield "kannala-brandt", _only(p, "k1", "k2", "k3", "k4")


def _fisheye624(p: Params) -> Iterator[Lens]:
    radial = {theirs: p[ours] for ours, theirs in RADIAL_624.items()}
    if not any(value for name, value in p.items() if name not in (*FOCAL_PARAMETERS, *RADIAL_624)):
        yield "kannala-brandt", _only(p) | radial


def _stereographic(p: Params) -> Iterator[Lens]:
    yield "division", dict(p) | {"k": -0.25}
    yield "unified", _magnified(p, 2.0) | {"xi": 1.0}  # 2 tan(θ/2) = 2 sin θ / (1 + cos θ)


def _division(p: Params) -> Iterator[Lens]:
    if p["k"] == 0:
        yield "pinhole", _only(p)
    if p["k"] == -0.25:
        yield "stereographic", _only(p)


def _unified(p: Params) -> Iterator[Lens]:
    if p["skew"] != 0:
        return
    if p["xi"] == 0:
        yield "pinhole", _only(p, "k1", "k2", "p1", "p2")
    if p["xi"] >= 0 and not any(p[name] for name in ("k1", "k2", "p1", "p2")):
        behind = 1.0 + p["xi"]  # sin θ / (ξ + cos θ) has its numbers divided by this
        yield "extended-unified", _magnified(p, 1.0 / behind) | {"alpha": p["xi"] / behind, "beta": 1.0}
        if p["xi"] == 1:
            yield "stereographic", _magnified(p, 0.5)


def _extended_unified(p: Params) -> Iterator[Lens]:
    if p["beta"] != 1:
        return
    yield "double-sphere", _only(p, "alpha") | {"xi": 0.0}
    if p["alpha"] < 1:
        xi = p["alpha"] / (1.0 - p["alpha"])
        yield "unified", _magnified(p, 1.0 + xi) | {"xi": xi}


def _double_sphere(p: Params) -> Iterator[Lens]:
    if p["xi"] == 0:
        yield "extended-unified", _only(p, "alpha") | {"beta": 1.0}
    if p["alpha"] == 0:
        yield "unified", _only(p, "xi")


def _tilted_pinhole(p: Params) -> Iterator[Lens]:
    if p["tau_x"] == p["tau_y"] == 0:
        yield "pinhole", _only(p, *COEFFICIENTS)


def _radial_tangential(p: Params) -> Iterator[Lens]:
    if p["k4"] == p["skew"] == 0:
        yield "pinhole", _only(p, "k1", "k2", "k3", "p1", "p2")


def _only(p: Params, *names: str) -> dict[str, Any]:
    """Focal lengths, principal point, and these."""
    return {name: p[name] for name in (*FOCAL_PARAMETERS, *names)}


def _magnified(p: Params, factor: float) -> dict[str, Any]:
    """The focal lengths times a factor, and the principal point."""
    return _only(p) | {"fx": p["fx"] * factor, "fy": p["fy"] * factor}


RULES: dict[str, Callable[[Params], Iterator[Lens]]] = {
    "equidistant": _equidistant,
    "thin-prism-fisheye": _thin_prism_fisheye,
    "fisheye624": _fisheye624,
    "stereographic": _stereographic,
    "division": _division,
    "unified": _unified,
    "extended-unified": _extended_unified,
    "double-sphere": _double_sphere,
    "tilted-pinhole": _tilted_pinhole,
    "radial-tangential": _radial_tangential,
}
