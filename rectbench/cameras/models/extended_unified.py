"""Khomutenko, Garcia & Martinet 2016, the extended unified model, as Usenko et al. 2018 write it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, ClassVar

from rectbench.cameras.lens import FOCAL_PARAMETERS, POSITIVE, Interval, Lens, register
from rectbench.cameras.sphere import edge, from_sphere_plane, to_sphere_plane
from rectbench.formulas.protocol import Formulas


@register
class ExtendedUnified(Lens):
    """(x, y) / (α d + (1-α) z) with d² = β (x² + y²) + z²."""

    name = "extended-unified"
    parameters = (*FOCAL_PARAMETERS, "alpha", "beta")
    ranges: ClassVar = {**Lens.ranges, "alpha": Interval(0.0, 1.0), "beta": POSITIVE}

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        return edge(p.alpha)

    def to_plane(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        return to_sphere_plane(c, x, y, z, c.beta * (x * x + y * y), xp)

    def from_plane(self, c: Any, mx: Any, my: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        mz, ok = from_sphere_plane(c, c.beta * (mx * mx + my * my), xp)
        scale = 1.0 / xp.sqrt(mx * mx + my * my + mz * mz)
        return scale * mx, scale * my, scale * mz, ok
