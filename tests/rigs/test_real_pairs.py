"""Features of real image pairs lie on the epipolar curves of their rigs: the poses point the right way."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import cv2
import numpy as np
import pytest

from rectbench import Rig, load_rig

PAIRS = [
    ("t265", "pairs/t265/fs1.png", "pairs/t265/fs2.png", 0.4),
    ("t265", "pairs/t265/robot1.png", "pairs/t265/robot2.png", 0.4),
    ("mynteye", "pairs/mynteye/left_fisheye_img_0.png", "pairs/mynteye/right_fisheye_img_0.png", 0.25),
    ("bumblebee2", "pairs/bumblebee2/garden01_left.jpg", "pairs/bumblebee2/garden01_right.jpg", 0.4),
    ("bumblebee2", "pairs/bumblebee2/sundial01_left.jpg", "pairs/bumblebee2/sundial01_right.jpg", 0.4),
]


def sift_matches(left: np.ndarray, right: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pixels [N, 2] of SIFT features that pass the ratio test; no outlier is rejected otherwise."""
    sift = cv2.SIFT_create(2000)
    (points, a), (others, b) = sift.detectAndCompute(left, None), sift.detectAndCompute(right, None)
    good = [
        first
        for first, second in cv2.BFMatcher().knnMatch(a, b, k=2)
        if first.distance < 0.75 * second.distance
    ]
    return (
        np.array([points[match.queryIdx].pt for match in good]),
        np.array([others[match.trainIdx].pt for match in good]),
    )


def epipolar_distance_px(rig: Rig, px_left: np.ndarray, px_right: np.ndarray) -> np.ndarray:
    """Distance of right pixels from the epipolar curves of the left ones, to first order."""
    rays_left, rays_right = rig.left.unproject(px_left)[0], rig.right.unproject(px_right)[0]
    normals = rays_left @ rig.essential_matrix.T
    residual = np.sum(rays_right * normals, axis=-1)
    slope = np.einsum("nij,ni->nj", rig.right.unproject_jacobian(px_right), normals)
    distance = np.abs(residual) / np.linalg.norm(slope, axis=-1)
    return distance[np.isfinite(distance)]


def share_in_front(rig: Rig, px_left: np.ndarray, px_right: np.ndarray) -> float:
    """Share of the matches whose rays meet ahead of both cameras."""
    a = rig.left.unproject(px_left)[0] @ rig.R_right_left.T
    b = rig.right.unproject(px_right)[0]
    seen = np.isfinite(a).all(axis=-1) & np.isfinite(b).all(axis=-1)
    ranges = np.linalg.pinv(np.stack([a[seen], -b[seen]], axis=-1)) @ -rig.t_right_left
    return float((ranges > 0).all(axis=-1).mean())


@pytest.mark.parametrize(
    ("name", "left", "right", "limit_px"), PAIRS, ids=[Path(pair[1]).stem for pair in PAIRS]
)
def test_matches_lie_on_the_epipolar_curves(
    real_data: Path, name: str, left: str, right: str, limit_px: float
) -> None:
    matches = sift_matches(
        *(cv2.imread(str(real_data / path), cv2.IMREAD_GRAYSCALE) for path in (left, right))
    )
    rig = load_rig(name)
    assert len(matches[0]) > 200
    assert 0.1 < np.median(epipolar_distance_px(rig, *matches)) < limit_px
    assert share_in_front(rig, *matches) > 0.95

    R, t = rig.R_right_left, rig.t_right_left
    inverse = dataclasses.replace(rig, R_right_left=R.T, t_right_left=-R.T @ t)
    assert np.median(epipolar_distance_px(inverse, *matches)) > 4 * limit_px
    assert share_in_front(dataclasses.replace(rig, t_right_left=-t), *matches) < 0.05
