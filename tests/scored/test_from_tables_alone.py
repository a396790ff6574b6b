"""The score is a property of the lookup tables: computed from these alone, by other code, it is the same."""

from __future__ import annotations

import numpy as np
import pytest

import rectbench as rb
from rectbench.metrics import log_distortion_on_view


def part_of_view(pair: rb.Rig, share: float) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """By side: the pixel in the middle of what both see, and how far along columns and rows A_s reaches."""
    cameras = {"left": pair.left, "right": pair.right}
    seen = {}
    for side, camera in cameras.items():
        pixels = camera.pixel_grid().reshape(-1, 2)
        rays, ok = camera.unproject(pixels)
        seen[side] = pixels[ok], rays[ok]
    R = pair.R_right_left
    shared_left = seen["left"][1][pair.right.sees(seen["left"][1] @ R.T)]
    back = seen["right"][1] @ R
    shared_right = back[pair.left.sees(back)]
    ray = np.concatenate([shared_left, shared_right]).sum(axis=0)
    found = {}
    for side, direction in (("left", ray), ("right", R @ ray)):
        middle, _ = cameras[side].project(direction / np.linalg.norm(direction))
        pixels, _ = seen[side]
        reach = np.abs(pixels - middle).max(axis=0)
        off = (np.abs(pixels - middle) / reach).max(axis=1)
        found[side] = middle, reach * np.quantile(off, share)
    return found


def from_tables_alone(rect: rb.Rectification, share: float) -> float:
    """Log distortion on A_s by every entry of the tables, each counted by the source area that it covers."""
    parts = part_of_view(rect.rig, share)
    size, squeeze, weights = [], [], []
    for side in ("left", "right"):
        table = np.stack(rect.maps(side), axis=-1).astype(float)
        middle, half = parts[side]
        across, down = (table[1:-1, 2:] - table[1:-1, :-2]) / 2, (table[2:, 1:-1] - table[:-2, 1:-1]) / 2
        inside = (np.abs(table[1:-1, 1:-1] - middle) <= half).all(axis=-1)
        for entries in (table[1:-1, 2:], table[1:-1, :-2], table[2:, 1:-1], table[:-2, 1:-1]):
            inside &= entries[..., 0] > -16
        K = np.stack([across, down], axis=-1)[inside]
        stretches = -np.log(np.linalg.svd(K, compute_uv=False))  # of the image: the inverse of the table's
        size.append(stretches.mean(axis=-1))
        squeeze.append(np.ptp(stretches, axis=-1) / 2)
        area = np.abs(np.linalg.det(K))
        weights.append(area / area.sum())
    s, q, w = (np.concatenate(values) for values in (size, squeeze, weights))
    mean = np.average(s, weights=w)
    return float(np.sqrt(np.average((s - mean) ** 2 + q**2, weights=w)))


@pytest.mark.parametrize("method", ["abraham", "local-homography"])
@pytest.mark.parametrize("name", ["t265", "sony-as200v", "tumvi", "bumblebee2"])
def test_what_ranks_is_what_the_tables_hold(method: str, name: str) -> None:
    pair = rb.load_rig(name)
    pair = pair.scaled(480 / pair.left.width)
    rect = rb.rectify(pair, method=method)
    for share in (0.5, 0.95):
        score = log_distortion_on_view(rect, pair, share)
        assert score == pytest.approx(from_tables_alone(rect, share), rel=0.01)


@pytest.mark.parametrize("name", ["t265", "bumblebee2"])
def test_it_is_so_of_a_perspective_image_as_far_as_it_goes(name: str) -> None:
    pair = rb.load_rig(name)
    rect = rb.rectify(pair, method="conventional")
    assert log_distortion_on_view(rect, pair, 0.3) == pytest.approx(from_tables_alone(rect, 0.3), rel=0.01)
