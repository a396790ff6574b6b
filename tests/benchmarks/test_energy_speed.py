"""The convex share of the energy about a fit, a metric of every cell: below a second.

pytest tests/benchmarks/test_energy_speed.py
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import rectbench as rb
from rectbench.metrics.energy import energy_convex_share


@pytest.mark.benchmark(group="convex share of the energy")
def test_convex_share(benchmark: Callable[..., Any]) -> None:
    benchmark(energy_convex_share, rb.rectify(rb.load_rig("sony-as200v"), "local-homography"))
