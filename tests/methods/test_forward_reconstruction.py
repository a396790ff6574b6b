"""A camera before the other in a corridor: matches right to a sixteenth of a pixel give its shape."""

from functools import cache

import numpy as np
import pytest

import rectbench as rb
from rectbench.matching.dense.disparity import Disparity
from rectbench.metrics.reconstruction import counted_pixels, depth_errors

SGBM_STEPS = 16
"""Of a pixel: disparities of semi-global matching come in these."""
SIZE = 256
MARGIN_DEG = 10.0


@cache
def forward_truth() -> rb.Truth:
    centre = {"cx": (SIZE - 1) / 2, "cy": (SIZE - 1) / 2}
    focal = SIZE / np.radians(120)
    lens = rb.Camera("equidistant", (SIZE, SIZE), {"fx": focal, "fy": focal, **centre})
    pair = rb.Rig(lens, lens, np.eye(3), np.array([0.0, 0.0, -0.3]), name="forward")
    return rb.render("corridor", pair, seed=0, spp=1)[1]


def matched(rect: rb.Rectification, truth: rb.Truth) -> rb.Reconstruction:
    """From the true disparity of each rectified pixel's nearest source pixel, rounded as a matcher's is."""
    width, height = rect.size
    source = rect.left.inverse(np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1))
    shown = np.isfinite(source).all(axis=-1) & rect.left.source.contains(source)
    u, v = np.clip(np.rint(source[shown]), 0, SIZE - 1).astype(int).T
    left = rect.left.forward(np.stack([u, v], axis=-1).astype(float))
    right = rect.right.forward(truth.right_pixels(u, v))
    disparity = np.full((height, width), np.nan, dtype=np.float32)
    disparity[shown] = np.round((left - right)[:, 0] * SGBM_STEPS) / SGBM_STEPS
    return rb.Reconstruction(Disparity(rect, disparity, np.zeros((height, width, 3), np.uint8)))


@pytest.mark.parametrize("method", ["polar", "log-polar", "polar-optimal"])
def test_nine_tenths_of_the_corridor_are_within_five_per_cent(method: str) -> None:
    truth = forward_truth()
    pixels = counted_pixels(truth)
    ahead = truth.rig.left.unproject(pixels)[0][:, 2]
    pixels = pixels[ahead < np.cos(np.radians(MARGIN_DEG))]
    assert len(pixels) > 40_000
    errors = depth_errors(matched(rb.rectify(truth.rig, method), truth), truth, pixels)
    assert (errors <= 0.05).mean() > 0.97
