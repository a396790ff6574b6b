"""The pose from two images at 1920x1280, stage by stage, and its consensus beside OpenCV's.

    pytest tests/benchmarks/test_pose_speed.py

Each group holds what is compared; pytest-benchmark prints the ratio beside each time. OpenCV's work on
pinhole coordinates, so its share of a wide view ends before 90 degrees; ours has the same matches.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench.matching import match_features, relative_pose
from rectbench.matching.pose.estimate import MOST_FEATURES, POSE_PER_CELL, POSE_PIXELS
from rectbench.matching.pose.five_point import essential_matrices
from tests.matching.box_room import pair_of
from tests.rigs_for_tests import points_before, rig

WIDE = rig(size=(1920, 1280), fov_deg=135.0)
PINHOLE_PIXELS = 500.0


@pytest.fixture(scope="module")
def images() -> tuple[np.ndarray, np.ndarray]:
    return pair_of(WIDE)


@pytest.fixture(scope="module")
def matches() -> rb.Matches:
    """1000 matches with 0.3 px of noise, and 430 that are wrong."""
    rng = np.random.default_rng(0)
    exact = np.stack(points_before(WIDE, 1600)[1:])[:, :1000]
    wrong = rng.uniform(0, [1920, 1280], (2, 430, 2))
    return rb.Matches(*np.concatenate([exact + rng.normal(0, 0.3, exact.shape), wrong], axis=1))


@pytest.mark.benchmark(group="pose from two images, 1920x1280")
@pytest.mark.parametrize("detector", ["sift", "akaze", "orb"])
def test_pose(benchmark: Callable[..., Any], images: tuple[np.ndarray, np.ndarray], detector: str) -> None:
    benchmark(rb.estimate_pose, images, WIDE, detector=detector)


@pytest.mark.benchmark(group="features of two images, 1920x1280")
@pytest.mark.parametrize("working_pixels", [300_000, POSE_PIXELS, 1_200_000, None])
def test_features(
    benchmark: Callable[..., Any], images: tuple[np.ndarray, np.ndarray], working_pixels: float | None
) -> None:
    options = {"most": MOST_FEATURES, "per_cell": POSE_PER_CELL}
    benchmark(match_features, *images, working_pixels=working_pixels, **options)


@pytest.mark.benchmark(group="consensus and refinement, 30 % wrong of 1430 matches")
def test_relative_pose(benchmark: Callable[..., Any], matches: rb.Matches) -> None:
    found = benchmark(relative_pose, WIDE.left, WIDE.right, matches)
    benchmark.extra_info["rotation_error_deg"] = found.difference_deg(WIDE)[0]  # type: ignore[attr-defined]


@pytest.mark.benchmark(group="consensus and refinement, 30 % wrong of 1430 matches")
@pytest.mark.parametrize("method", ["RANSAC", "USAC_MAGSAC", "USAC_ACCURATE"])
def test_opencv(benchmark: Callable[..., Any], matches: rb.Matches, method: str) -> None:
    rays = [camera.unproject(px)[0] for camera, px in zip((WIDE.left, WIDE.right), matches, strict=True)]
    ahead = (rays[0][:, 2] > 0.2) & (rays[1][:, 2] > 0.2)
    left, right = (PINHOLE_PIXELS * ray[ahead, :2] / ray[ahead, 2:] for ray in rays)
    K = np.diag([PINHOLE_PIXELS, PINHOLE_PIXELS, 1.0])

    def pose() -> np.ndarray:
        E, mask = cv2.findEssentialMat(left, right, K, getattr(cv2, method), 0.9999, 1.0)
        return cv2.recoverPose(E[:3], left, right, K, mask=mask)[1]

    R = benchmark(pose)
    error = np.degrees(np.linalg.norm(R - WIDE.R_right_left) / np.sqrt(2))
    benchmark.extra_info["rotation_error_deg"] = error  # type: ignore[attr-defined]


@pytest.mark.benchmark(group="five points, a batch of 64 samples")
def test_five_points(benchmark: Callable[..., Any], matches: rb.Matches) -> None:
    rays = [camera.unproject(px)[0] for camera, px in zip((WIDE.left, WIDE.right), matches, strict=True)]
    left, right = (ray[:320].reshape(64, 5, 3) for ray in rays)
    benchmark(essential_matrices, left, right)
