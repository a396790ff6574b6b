"""Synthetic benches: numbers that spread over units, over scenes within a unit, over seeds within a scene."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rectbench.types import FloatArray

BENCHES = 2000


@dataclass(frozen=True)
class Bench:
    """Standard deviations of each level, and how many there are of it; `seeds` for each unit and scene."""

    unit: float
    scene: float
    seed: float
    seeds: NDArray[np.int64]
    """[units, scenes]"""

    @classmethod
    def balanced(
        cls, units: int, unit: float, scene: float, seed: float, scenes: int = 2, seeds: int = 3
    ) -> Bench:
        return cls(unit, scene, seed, np.full((units, scenes), seeds))

    def leaves(self, rng: np.random.Generator, benches: int = BENCHES, methods: int = 1) -> FloatArray:
        """[benches, methods, units, scenes, most seeds] about zero; NaN where a scene has fewer seeds."""
        units, scenes = self.seeds.shape
        most, lead = int(self.seeds.max()), (benches, methods)
        values = (
            rng.normal(0, self.unit, (*lead, units, 1, 1))
            + rng.normal(0, self.scene, (*lead, units, scenes, 1))
            + rng.normal(0, self.seed, (*lead, units, scenes, most))
        )
        values[..., np.arange(most) >= self.seeds[..., None]] = np.nan
        return values


def unit_values(leaves: FloatArray) -> FloatArray:
    """[..., units] of [..., units, scenes, seeds]: the mean over scenes of the mean over seeds."""
    means: FloatArray = np.nanmean(leaves, axis=-1).mean(axis=-1)
    return means


def labelled(leaves: FloatArray) -> dict[tuple[int, ...], float]:
    """The same numbers [units, scenes, seeds] as rows would give them: by (unit, scene, seed)."""
    return {place: float(value) for place, value in np.ndenumerate(leaves) if not np.isnan(value)}
