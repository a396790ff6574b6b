"""Averaging where the warp shrinks, against plain `cv2.remap`, as ratios taken in one run.

    pytest tests/benchmarks/test_resampling_speed.py

Each group resamples one colour image of 1920x1080 with tables made before; "point" is OpenCV alone.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
import pytest

import rectbench as rb

METHODS = ("conventional", "abraham", "local-homography")
CASES = [(method, factor) for method in METHODS for factor in (1.0, 0.5)]


@pytest.fixture(scope="module")
def image() -> np.ndarray:
    return np.random.default_rng(0).integers(0, 256, (1080, 1920, 3), dtype=np.uint8)


@pytest.mark.parametrize(("method", "factor"), CASES)
@pytest.mark.parametrize("filter", ["point", "area"])
def test_resampling(
    benchmark: Callable[..., Any], image: np.ndarray, method: str, factor: float, filter: str
) -> None:
    benchmark.group = f"resampling, {method}, {factor:g} of its size"  # type: ignore[attr-defined]
    rect = rb.rectify(rb.load_rig("sony-as200v"), method=method).scaled(factor)
    resampler = rb.Resampler.of(rect, "left", filter)  # type: ignore[arg-type]
    if resampler.footprints is not None:
        benchmark.extra_info["shrunk_share"] = resampler.footprints.shrunk_share  # type: ignore[attr-defined]
    benchmark(resampler, image)


@pytest.mark.benchmark(group="making the tables of one side")
@pytest.mark.parametrize("filter", ["point", "area"])
def test_tables(benchmark: Callable[..., Any], filter: str) -> None:
    rect = rb.rectify(rb.load_rig("sony-as200v"), method="local-homography")
    benchmark(rb.Resampler.of, rect, "left", filter)


@pytest.mark.benchmark(group="one image at half its size")
def test_remap_at_full_size_then_area(benchmark: Callable[..., Any], image: np.ndarray) -> None:
    """What one would do without footprints; it aliases where the full size does."""
    rect = rb.rectify(rb.load_rig("sony-as200v"), method="abraham")
    half, full = rect.scaled(0.5).size, rb.Resampler.of(rect, "left")
    benchmark(lambda: cv2.resize(full(image), half, interpolation=cv2.INTER_AREA))


@pytest.mark.benchmark(group="one image at half its size")
def test_area_at_half_size(benchmark: Callable[..., Any], image: np.ndarray) -> None:
    rect = rb.rectify(rb.load_rig("sony-as200v"), method="abraham")
    benchmark(rb.Resampler.of(rect.scaled(0.5), "left", "area"), image)
