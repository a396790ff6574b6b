"""What the papers on rectifying homographies measure, of homographies whose measures are known."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import rectbench as rb
from rectbench.metrics.homography.gluckman_nayar import GluckmanNayar
from rectbench.metrics.homography.loop_zhang import LoopZhang
from rectbench.metrics.homography.mallon_whelan import MallonWhelan, aspect_ratio, orthogonality_deg
from rectbench.metrics.homography.outline import Outline
from rectbench.metrics.homography.usr_cgd import UsrCgd
from rectbench.metrics.scoring import metrics_of
from tests.rigs_for_tests import aligned_rig

SIZE = WIDTH, HEIGHT = 64, 48
K = np.array([[60.0, 0, 31.5], [0, 60, 23.5], [0, 0, 1]])
LENS = rb.Camera("pinhole", SIZE, {"fx": 60, "fy": 60, "cx": 31.5, "cy": 23.5})
RIG = rb.Rig(LENS, LENS, np.eye(3), np.array([-0.1, 0, 0]))
ABOUT_CENTRE = np.array([[1, 0, 31.5], [0, 1, 23.5], [0, 0, 1]])
EVERY = (LoopZhang, MallonWhelan, UsrCgd, GluckmanNayar)


def centred(H: Any) -> np.ndarray:
    """The homography of pixels whose origin is the middle of the image."""
    matrix: np.ndarray = ABOUT_CENTRE @ np.array(H, dtype=float) @ np.linalg.inv(ABOUT_CENTRE)
    return matrix


def by_homographies(left: np.ndarray, right: np.ndarray) -> rb.Rectification:
    warps = [rb.Warp(LENS, np.eye(3), rb.Perspective(H @ K)) for H in (left, right)]
    return rb.Rectification(RIG, warps[0], warps[1], SIZE)


def measures(metric: Any, *homographies: Any) -> dict[str, float]:
    """The columns of both images, of which the same homography is taken where one is given."""
    left, right = (*homographies, *homographies)[:2]
    row: dict[str, float] = metric().compute(rb.Case(by_homographies(left, right), pair=None))  # type: ignore[arg-type]
    return row


def test_images_left_as_they_are_have_the_ideal_of_every_measure() -> None:
    row = {key: value for metric in EVERY for key, value in measures(metric, np.eye(3)).items()}
    ones = {"usr_cgd_size_ratio", "gluckman_nayar_aspect"}
    for key, value in row.items():
        assert value == pytest.approx(float(key in ones), abs=1e-9), key


def test_the_projective_criterion_is_loop_and_zhangs_quotient_of_quadratic_forms() -> None:
    left, right = np.eye(3), np.eye(3)
    left[2], right[2] = (2e-3, -1e-3, 1), (-4e-4, 3e-3, 1)
    # w PPᵀ w / w p_c p_cᵀ w over as many pixels, in their words.
    PPt = np.diag([WIDTH**2 - 1, HEIGHT**2 - 1, 0]) / 12
    middle = np.array([(WIDTH - 1) / 2, (HEIGHT - 1) / 2, 1])
    expected = sum(w @ PPt @ w / (w @ middle) ** 2 for w in (left[2], right[2]))
    assert measures(LoopZhang, left, right)["loop_zhang_projective"] == pytest.approx(expected, rel=1e-6)


def test_neither_scale_nor_shear_nor_factor_changes_the_projective_criterion() -> None:
    H = np.array([[1, 0, 0], [0, 1, 0], [2e-3, -1e-3, 1]])
    affine = np.array([[0.7, 0.2, 30], [-0.1, 1.4, -9], [0, 0, 1]])
    plain, changed = (measures(LoopZhang, G)["loop_zhang_projective"] for G in (H, 3.0 * affine @ H))
    assert changed == pytest.approx(plain, rel=1e-6)
    assert measures(LoopZhang, affine)["loop_zhang_projective"] < 1e-12


def test_a_shear_is_measured_by_its_angle_and_by_what_it_lengthens() -> None:
    shear = centred([[1, 0.3, 0], [0, 1, 0], [0, 0, 1]])
    row = measures(LoopZhang, shear)
    assert row["loop_zhang_perpendicularity"] == pytest.approx(0.3 / math.hypot(1, 0.3))
    assert row["loop_zhang_proportion_off"] == pytest.approx(1 - 1 / (1 + 0.3**2))
    angle_deg = math.degrees(math.atan(0.3))
    assert measures(MallonWhelan, shear)["orthogonality_off_deg"] == pytest.approx(angle_deg)
    assert measures(UsrCgd, shear)["usr_cgd_skewness_deg"] == pytest.approx(angle_deg)
    diagonals = math.hypot(WIDTH - 0.3 * HEIGHT, HEIGHT) / math.hypot(WIDTH + 0.3 * HEIGHT, HEIGHT)
    assert measures(MallonWhelan, shear)["aspect_ratio_off"] == pytest.approx(1 - diagonals)


def test_orthogonality_and_aspect_ratio_are_given_as_mallon_and_whelan_print_them() -> None:
    shear = by_homographies(centred([[1, 0.3, 0], [0, 1, 0], [0, 0, 1]]), np.eye(3))
    outline = Outline.rectified(shear.left)
    assert orthogonality_deg(outline) == pytest.approx(90 - math.degrees(math.atan(0.3)))
    assert aspect_ratio(outline) < 1


def test_a_turned_and_enlarged_image_turns_and_grows_without_skew() -> None:
    angle, grown = math.radians(20), 1.5
    c, s = grown * math.cos(angle), grown * math.sin(angle)
    row = measures(UsrCgd, centred([[c, -s, 0], [s, c, 0], [0, 0, 1]]))
    assert row["usr_cgd_rotation_deg"] == pytest.approx(20)
    assert row["usr_cgd_size_ratio"] == pytest.approx(grown**2)
    assert row["usr_cgd_skewness_deg"] == pytest.approx(0, abs=1e-9)
    assert row["usr_cgd_aspect_off"] == pytest.approx(0, abs=1e-9)
    # A corner at p goes to g R p, |g R p - p|² = (1 + g² - 2 g cos) |p|², |p| being half of the diagonal.
    moved = math.sqrt(1 + grown**2 - 2 * grown * math.cos(angle)) / 2
    assert row["usr_cgd_vertex_distance"] == pytest.approx(moved)


def test_perspective_makes_the_half_diagonals_unequal() -> None:
    p = 5e-3
    row = measures(UsrCgd, centred([[1, 0, 0], [0, 1, 0], [p, 0, 1]]))
    ratio = (1 + p * WIDTH / 2) / (1 - p * WIDTH / 2)
    assert row["usr_cgd_aspect_off"] == pytest.approx((ratio + 1 / ratio) / 2 - 1)


def test_the_local_area_of_a_homography_is_its_determinant_over_the_cube_of_the_weight() -> None:
    H = np.array([[1.1, 0.1, 3], [-0.05, 0.9, 2], [2e-3, -1e-3, 1]])
    u, v = LENS.pixel_grid().reshape(-1, 2).T
    det_J = np.linalg.det(H) / (H[2] @ [u, v, np.ones_like(u)]) ** 3
    expected = np.mean((det_J - 1) ** 2)
    assert measures(GluckmanNayar, H)["gluckman_nayar_area"] == pytest.approx(expected)
    stretched = measures(GluckmanNayar, np.diag([1.5, 1.0, 1.0]), np.eye(3))
    assert stretched["gluckman_nayar_aspect"] == pytest.approx((1.5 + 1) / 2)


def test_a_map_that_is_no_homography_has_the_measures_of_its_outline_and_no_projective_one() -> None:
    rect = rb.rectify(RIG, method="abraham")
    row = {
        key: value
        for metric in EVERY
        for key, value in metric().compute(rb.Case(rect, pair=None)).items()  # type: ignore[arg-type]
    }
    assert math.isnan(row.pop("loop_zhang_projective"))
    assert np.isfinite(list(row.values())).all()
    # The rig looks straight ahead: its bent image is symmetric, so that nine points of it show no skew.
    assert row["orthogonality_off_deg"] == pytest.approx(0, abs=1e-9)
    assert row["usr_cgd_skewness_deg"] == pytest.approx(0, abs=1e-9)
    assert row["gluckman_nayar_area"] > 0.01


def test_a_lens_that_shows_nothing_in_the_corners_has_no_measures_of_them() -> None:
    rig = aligned_rig(96, 96, 150, max_angle_deg=75)
    case = rb.Case(rb.rectify(rig, method="abraham"), pair=None)  # type: ignore[arg-type]
    assert math.isnan(UsrCgd().compute(case)["usr_cgd_skewness_deg"])
    assert math.isnan(MallonWhelan().compute(case)["aspect_ratio_off"])


def test_what_a_fisheyes_undistorted_image_would_show_has_a_projective_criterion() -> None:
    rig = aligned_rig(96, 64, 100)
    rect = rb.rectify(rig, method="conventional")
    turned = np.array([[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]])
    tilted = rb.Warp(rig.left, turned, rect.left.target)
    row = LoopZhang().compute(rb.Case(rb.Rectification(rig, tilted, tilted, rect.size), pair=None))  # type: ignore[arg-type]
    x, _, z = rig.left.unproject(rig.left.pixel_grid().reshape(-1, 2))[0].T
    w = 0.8 - 0.6 * x / z
    assert row["loop_zhang_projective"] == pytest.approx(2 * np.var(w) / np.mean(w) ** 2, rel=1e-4)


def test_a_report_asks_for_them_by_one_name() -> None:
    assert set(metrics_of(["homography"])) == {metric.name for metric in EVERY}
