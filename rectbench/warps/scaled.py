"""A rectified image at another size."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rectbench.cameras.arrays import Constants, FloatArray
from rectbench.warps.targets import Target


@dataclass(frozen=True, eq=False)
class Scaled(Target):
    """Any target on an image `across` times as wide and `down` times as high.

    The image's corners stay where they are: with pixel centres at whole numbers, a coordinate û
    becomes (û + 0.5) s - 0.5, as in `Camera.scaled`.
    """

    target: Target
    across: float
    down: float

    @property
    def constants(self) -> Constants:
        return {"across": self.across, "down": self.down, "target": self.target.constants}

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Any) -> tuple[Any, Any, Any]:
        u, v, ok = self.target.project_formula(c.target, x, y, z, xp)
        return (u + 0.5) * c.across - 0.5, (v + 0.5) * c.down - 0.5, ok

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Any) -> tuple[Any, Any, Any, Any]:
        u, v = (u + 0.5) / c.across - 0.5, (v + 0.5) / c.down - 0.5
        return self.target.unproject_formula(c.target, u, v, xp)

    def axis_tables(
        self, columns: FloatArray, rows: FloatArray
    ) -> tuple[tuple[FloatArray, ...], tuple[FloatArray, ...]]:
        return self.target.axis_tables((columns + 0.5) / self.across - 0.5, (rows + 0.5) / self.down - 0.5)

    def ray_formula(
        self, c: Any, column: tuple[Any, ...], row: tuple[Any, ...], xp: Any
    ) -> tuple[Any, Any, Any, Any]:
        return self.target.ray_formula(c.target, column, row, xp)
