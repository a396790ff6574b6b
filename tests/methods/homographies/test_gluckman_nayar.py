"""Areas change the least, as measured on the rectification itself."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

import rectbench as rb
from tests.methods.homographies.pinholes import (
    fundamental,
    homographies,
    pinholes,
    pixel_grid,
    random_pinholes,
)

GRID = pixel_grid()[::37]


def area_change(H_left: np.ndarray, H_right: np.ndarray) -> float:
    """The mean of (det J - 1)² over both images."""
    areas = [np.linalg.det(H) / (GRID @ H[2]) ** 3 for H in (H_left, H_right)]
    return float(np.mean([(area - 1) ** 2 for area in areas]))


def test_the_change_told_is_that_of_the_delivered_maps() -> None:
    pair = pinholes()
    rect = rb.rectify(pair, method="gluckman-nayar")
    pixels = pixel_grid()[::37, :2]
    areas = [np.linalg.det(warp.jacobian(pixels)) for warp in (rect.left, rect.right)]
    assert rect.notes["area_change"] == pytest.approx(np.mean([(a - 1) ** 2 for a in areas]), rel=1e-2)
    assert rect.notes["area_change"] == pytest.approx(area_change(*homographies(rect)), rel=1e-2)


@pytest.mark.parametrize("seed", range(3))
def test_no_pair_of_lines_and_areas_changes_less(seed: int) -> None:
    pair = random_pinholes(seed)
    F = fundamental(pair)
    epipole = np.linalg.svd(F)[2][-1]

    def change(p: np.ndarray) -> float:
        z = np.array([np.cos(p[0]), np.sin(p[0]), 0])
        means = []
        for w, log_area in ((np.cross(epipole, z), p[1]), (F @ z, p[2])):
            w = w / (w @ [319.5, 239.5, 1])
            means.append(np.mean((np.exp(log_area) / (GRID @ w) ** 3 - 1) ** 2))
        return float(np.mean(means))

    starts = [np.array([angle, 0, 0]) for angle in np.linspace(0, np.pi, 24, endpoint=False)]
    start = min(starts, key=change)
    brute = minimize(change, start, method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-14})
    H_left, H_right = homographies(rb.rectify(pair, method="gluckman-nayar"))
    assert area_change(H_left, H_right) == pytest.approx(brute.fun, rel=2e-3)


def test_it_changes_areas_less_than_the_other_projective_methods() -> None:
    pair = pinholes((2.0, 8.0, 3.0))
    change = {
        method: area_change(*homographies(rb.rectify(pair, method=method)))
        for method in ("gluckman-nayar", "loop-zhang", "hartley", "fusiello-trucco-verri")
    }
    assert min(change, key=lambda method: change[method]) == "gluckman-nayar"
