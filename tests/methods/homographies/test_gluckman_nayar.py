"""Areas change the least, as measured on the rectification itself."""

from __future__ import annotations

import numpy as np
import pytest
from rectbench_methods.homographies.gluckman_nayar import area_means
from scipy.optimize import minimize

from rectbench.metrics.homography.gluckman_nayar import local_changes
from tests.methods.homographies.pinholes import (
    SIZE,
    fundamental,
    homographies,
    pinholes,
    pixel_grid,
    random_pinholes,
    rectified,
)

GRID = pixel_grid()[::37]


def area_change(H_left: np.ndarray, H_right: np.ndarray) -> float:
    """The mean of (det J - 1)² over both images."""
    areas = [np.linalg.det(H) / (GRID @ H[2]) ** 3 for H in (H_left, H_right)]
    return float(np.mean([(area - 1) ** 2 for area in areas]))


def test_the_change_told_is_that_of_the_delivered_maps() -> None:
    pair = pinholes()
    rect = rectified(pair, "gluckman-nayar")
    pixels = pixel_grid()[::37, :2]
    areas = [np.linalg.det(warp.jacobian(pixels)) for warp in (rect.left, rect.right)]
    assert rect.notes["area_change"] == pytest.approx(np.mean([(a - 1) ** 2 for a in areas]), rel=1e-2)
    assert rect.notes["area_change"] == pytest.approx(area_change(*homographies(rect)), rel=1e-2)
    assert rect.notes["area_change"] == pytest.approx(local_changes(rect)[0], rel=1e-2)


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
    H_left, H_right = homographies(rectified(pair, "gluckman-nayar"))
    assert area_change(H_left, H_right) == pytest.approx(brute.fun, rel=2e-3)


@pytest.mark.parametrize("w", [(1e-3, 5e-4, 1.0), (-1.8e-3, 7e-4, 1.0)])
def test_areas_are_integrals_over_the_image(w: tuple[float, float, float]) -> None:
    a, b, _ = w
    x, y = SIZE[0] / 2, SIZE[1] / 2
    corners = [
        (sign_x * sign_y, 1 + sign_x * a * x + sign_y * b * y) for sign_x in (1, -1) for sign_y in (1, -1)
    ]
    # The double antiderivative of (1 + a x + b y)^-n is that to the power 2 - n over (n - 1)(n - 2) a b.
    exact = [
        sum(sign * at ** (2 - n) for sign, at in corners) / ((n - 1) * (n - 2) * a * b * 4 * x * y)
        for n in (3, 6)
    ]
    np.testing.assert_allclose(area_means(np.array(w), SIZE), exact, rtol=1e-6)


def test_it_changes_areas_less_than_the_other_projective_methods() -> None:
    pair = pinholes((2.0, 8.0, 3.0))
    change = {
        method: area_change(*homographies(rectified(pair, method)))
        for method in ("gluckman-nayar", "loop-zhang", "hartley", "fusiello-trucco-verri")
    }
    assert min(change, key=lambda method: change[method]) == "gluckman-nayar"
