"""multi-pinhole: each piece is a pinhole image with epipolar rows, and one hangs on the next."""

import numpy as np
import pytest

import rectbench as rb
from tests.rigs_for_tests import aligned_rig, rig


@pytest.mark.parametrize("pieces", [1, 2, 3, 5])
def test_each_piece_is_a_pinhole_image(pieces: int) -> None:
    rect = rb.rectify(aligned_rig(480, 320, 120), "multi-pinhole", pieces=pieces, focal_px=110.0)
    beta = rb.view_angles(rect.rig).beta
    span = (beta.high - beta.low) / pieces
    height = 220 * np.tan(span / 2)
    gamma, within = np.meshgrid(np.linspace(-0.8, 0.8, 9), np.linspace(-0.49, 0.49, 7))
    first = None
    for piece in range(pieces):
        middle = beta.low + (piece + 0.5) * span
        angle = middle + within * span
        rays = np.stack(
            [np.sin(gamma), np.cos(gamma) * np.sin(angle), np.cos(gamma) * np.cos(angle)], axis=-1
        )
        c, s = np.cos(middle), np.sin(middle)
        turned = rays @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T
        plain, _ = rb.Perspective.from_focal(110.0, 0.0, piece * height).project(turned)
        offset = rect.left.target.project(rays)[0] - plain
        first = offset[0, 0] if first is None else first
        np.testing.assert_allclose(offset, np.broadcast_to(first, offset.shape), atol=1e-9)


def test_one_piece_hangs_on_the_next() -> None:
    rect = rb.rectify(rig(), "multi-pinhole", pieces=2)
    beta = rb.view_angles(rect.rig).beta
    seam = (beta.low + beta.high) / 2
    above, below = (
        rect.left.target.project([0.4, np.sin(seam + step), np.cos(seam + step)])[0] for step in (-1e-9, 1e-9)
    )
    np.testing.assert_allclose(above, below, atol=1e-5)


def test_pieces_that_are_too_wide_are_refused() -> None:
    with pytest.raises(rb.Unsupported, match="expected enough of them to stay below 150°"):
        rb.rectify(aligned_rig(400, 400, 179, max_angle_deg=89.5), "multi-pinhole", pieces=1)
