"""Fitting and lookup tables at 1920x1080, as ratios taken in one run.

    pytest tests/benchmarks/test_rectifying_speed.py

Each group holds what is compared; pytest-benchmark prints the ratio beside each time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
import pytest

import rectbench as rb

SIZE = (1920, 1080)


@pytest.fixture(scope="module")
def rig() -> rb.Rig:
    """The paper's Sony lens with a motion as the paper's."""
    return rb.load_rig("sony-as200v")


@pytest.mark.benchmark(group="lookup table, 1920x1080")
def test_opencv_fisheye_table(benchmark: Callable[..., Any], rig: rb.Rig) -> None:
    p = rig.left.params
    K = np.array([[p["fx"], 0, p["cx"]], [0, p["fy"], p["cy"]], [0, 0, 1]])
    D = np.array([p[f"k{i}"] for i in range(1, 5)])
    benchmark(cv2.fisheye.initUndistortRectifyMap, K, D, np.eye(3), K, SIZE, cv2.CV_32FC1)


@pytest.mark.benchmark(group="lookup table, 1920x1080")
@pytest.mark.parametrize("method", ["conventional", "abraham", "local-homography", "optimal"])
def test_table(benchmark: Callable[..., Any], rig: rb.Rig, method: str) -> None:
    rect = rb.rectify(rig, method=method)
    same_size = rb.Rectification(rect.rig, rect.left, rect.right, SIZE)
    benchmark(same_size.maps, "left")


@pytest.mark.benchmark(group="fit, 1920x1080, 500 pixels")
@pytest.mark.parametrize(
    "method", ["conventional", "abraham", "local-homography", "hartley", "fusiello", "optimal"]
)
def test_fit(benchmark: Callable[..., Any], rig: rb.Rig, method: str) -> None:
    benchmark(rb.rectify, rig, method=method)


@pytest.mark.benchmark(group="warp of one image, 1920x1080")
def test_opencv_remap(benchmark: Callable[..., Any], rig: rb.Rig) -> None:
    rect = rb.rectify(rig)
    map_x, map_y = rect.maps("left")
    image = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    benchmark(cv2.remap, image, map_x, map_y, cv2.INTER_LINEAR)


@pytest.mark.benchmark(group="warp of one image, 1920x1080")
def test_tables_and_remap_of_both(benchmark: Callable[..., Any], rig: rb.Rig) -> None:
    rect = rb.rectify(rig)
    image = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    benchmark(rect.remap, image, image)
