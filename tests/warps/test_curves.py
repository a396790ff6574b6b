"""Epipolar curves: rows, unless a target states others, and then how far apart these are."""

import numpy as np
import pytest

import rectbench as rb
from tests.rigs_for_tests import points_before, rig


@pytest.mark.parametrize("method", ["abraham", "conventional"])
def test_rows_are_as_far_apart_as_before(method: str) -> None:
    pair = rig()
    rect = rb.rectify(pair, method)
    _, px_left, px_right = points_before(pair)
    left, right = rect.left.forward(px_left), rect.right.forward(px_right + 0.4)
    np.testing.assert_array_equal(rect.curves_apart(left, right), left[:, 1] - right[:, 1])


def test_across_the_seam_rows_are_neighbours() -> None:
    rect = rb.rectify(rig(centre_m=(0.0, 0.0, 0.3)), "polar", form="spherical")
    assert rect.turn_px is not None
    top, low = np.array([[10.0, 0.25]]), np.array([[10.0, rect.turn_px - 0.5]])
    assert rect.curves_apart(top, low)[0] == pytest.approx(0.75)


def test_normals_of_a_window_are_those_of_its_curves() -> None:
    circles = rb.EpipolarCircles(100.0, 0.0, 0.0, (1.0, 0.0, 0.0))
    framed = circles.framed(-50.0, 20.0, 2.0, 0.5)
    beta = 0.6
    gamma = np.linspace(-0.7, 0.7, 200)
    rays = np.stack([np.sin(gamma), np.cos(gamma) * np.sin(beta), np.cos(gamma) * np.cos(beta)], axis=-1)
    curve = framed.project(rays)[0]
    along = np.gradient(curve, axis=0)
    normals = framed.curve_normals(curve)
    sines = (along * normals).sum(axis=1) / np.linalg.norm(along, axis=1) / np.linalg.norm(normals, axis=1)
    np.testing.assert_allclose(sines[1:-1], 0, atol=1e-4)
