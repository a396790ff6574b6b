"""Uncertainty of every pixel at 1920x1080, beside the lookup table of the same rectification.

    pytest tests/benchmarks/test_uncertainty_speed.py

One distance a map. `pose` has 6 uncertain parameters, `pose and lenses` 22.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import rectbench as rb

SIZES = {
    "pose": {"rotation_deg": 0.05, "direction_deg": 0.3},
    "pose and lenses": {
        "rotation_deg": 0.05,
        "direction_deg": 0.3,
        "focal_px": 0.5,
        "centre_px": 0.3,
        "parameters": {f"{side}.k{i}": 1e-4 for side in ("left", "right") for i in range(1, 5)},
    },
}


@pytest.fixture(scope="module")
def rig() -> rb.Rig:
    return rb.load_rig("sony-as200v")


@pytest.mark.benchmark(group="uncertainty of every pixel, 1920x1080")
@pytest.mark.parametrize("sizes", SIZES)
def test_uncertainty(benchmark: Callable[..., Any], rig: rb.Rig, sizes: str) -> None:
    rect, covariance = rb.rectify(rig), rb.RigCovariance.from_sigmas(rig, **SIZES[sizes])
    pixels = rig.left.pixel_grid()
    assert pixels.shape == (1080, 1920, 2)
    benchmark(rb.metrics.uncertainty, rect, rig, covariance, depth_m=5.0, pixels=pixels)


@pytest.mark.benchmark(group="uncertainty of every pixel, 1920x1080")
def test_lookup_table(benchmark: Callable[..., Any], rig: rb.Rig) -> None:
    rect = rb.rectify(rig)
    benchmark(rect.maps, "left")
