"""Sampling: the shares of the source in which pixels are lost and in which they are invented."""

from __future__ import annotations

import math

import numpy as np

from rectbench.plugins.metric import Case, Column, Metric
from rectbench.warps.jacobians import Jacobians, entries, singular_values

UNIT_TOLERANCE = 1e-4
"""A singular value this near to 1 is an unchanged length, not a lost or invented pixel: lookup tables are
float32, and hold no length more exactly."""


def sampling(jacobians: Jacobians) -> dict[str, float]:
    """Shares of the pixels at which some direction shrinks, and at which some direction grows.

    Where σ2 < 1 pixels are lost, where σ1 > 1 they are invented; most maps do a little of both nearly
    everywhere.

    >>> import numpy as np
    >>> halved = np.full((1, 2, 2), 0.5) * np.eye(2)
    >>> sampling(Jacobians(halved, halved))
    {'sampling_lost': 1.0, 'sampling_invented': 0.0}
    """
    both = jacobians.both
    if not len(both):
        return {"sampling_lost": math.nan, "sampling_invented": math.nan}
    large, small = singular_values(*entries(both), np)
    weights = jacobians.weights
    return {
        "sampling_lost": float(np.average(small < 1 - UNIT_TOLERANCE, weights=weights)),
        "sampling_invented": float(np.average(large > 1 + UNIT_TOLERANCE, weights=weights)),
    }


class Sampling(Metric):
    """Shares of what is shown of the source in which pixels are lost, and in which they are invented."""

    name, topic = "sampling", "Sampling"
    columns = (
        Column.share(
            "sampling_lost",
            "pixels lost",
            "lower",
            "Share of source area squeezed (σ2 < 1): detail is lost.",
            shown="page",
        ),
        Column.share(
            "sampling_invented",
            "pixels invented",
            "lower",
            "Share of source area enlarged (σ1 > 1): interpolated.",
            shown="pairs",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Of both images together."""
        return sampling(case.delivered.shown)
