"""Usenko, Demmel & Cremers 2018, the double sphere model (Basalt's and Kalibr's `ds`)."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, ClassVar

from rectbench.cameras.lens import FOCAL_PARAMETERS, Interval, Lens, register
from rectbench.cameras.sphere import distance, edge, from_sphere_plane, to_sphere_plane
from rectbench.formulas.protocol import Formulas


@register
class DoubleSphere(Lens):
    """The unit sphere, moved forward by ξ, onto a second one: (x, y) / (α d₂ + (1-α) (ξ d₁ + z)).

    The edge is where the second sphere ends, exactly. The paper's inequality (43) differs: for most
    lenses it stops early (by 1.2° for ξ = -0.2, α = 0.6); for ξ < 0 with α near 0 or 1 it lets rays
    through that have already folded.
    """

    name = "double-sphere"
    parameters = (*FOCAL_PARAMETERS, "xi", "alpha")
    ranges: ClassVar = {**Lens.ranges, "xi": Interval(-1.0, 1.0, low_open=True), "alpha": Interval(0.0, 1.0)}

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        return edge(p.alpha)

    def to_plane(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        q = x * x + y * y
        _, beyond = distance(z, q, xp)
        return to_sphere_plane(c, x, y, c.xi * beyond + (1.0 - c.xi) * z, q, xp)

    def from_plane(self, c: Any, mx: Any, my: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        q = mx * mx + my * my
        mz, ok = from_sphere_plane(c, q, xp)
        scale = (c.xi * mz + xp.sqrt(mz * mz + (1.0 - c.xi * c.xi) * q)) / (mz * mz + q)
        # With ξ = 1 no ray passes behind the second sphere's centre, where mz < 0 and scale is 0.
        return scale * mx, scale * my, scale * mz - c.xi, ok & (scale > 0.0)
