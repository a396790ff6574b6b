"""The best method is the one that the stated rule says, among all that apply."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rectbench as rb
from rectbench.applications.choose_method import ROWS_AS_GOOD_PX, best_method
from rectbench.plugins.defaults import CONTENDERS
from rectbench.plugins.rectifier import METHODS
from rectbench.registry import forget_plugins, registry
from rectbench.types import Matches
from rectbench.warps import Framing
from tests.experiments.fakes import write_method
from tests.rigs_for_tests import points_before, rig

RIG = rig("kannala-brandt")


def test_the_best_has_the_least_log_distortion_at_equal_coverage() -> None:
    choice = best_method(RIG, framing=Framing(coverage=0.9))
    table = choice.table
    assert set(table["method"]) == set(CONTENDERS)
    assert (table["status"] == "ok").all()
    np.testing.assert_allclose(table["coverage_pixels"], 0.9, atol=0.005)
    assert table["log_distortion_on_view"].is_monotonic_increasing
    assert choice.best.method == table["method"][0] == "optimal"
    assert choice.best.method in choice.why
    assert "90% of the source pixels" in choice.why
    assert table["method"][1] in choice.why


def test_no_other_built_in_method_is_better_than_the_contenders() -> None:
    built_in = [plugin.name for plugin in registry(METHODS).plugins()]
    assert best_method(RIG, methods=built_in).best.method in CONTENDERS


def test_a_map_that_bends_its_rows_is_never_the_best() -> None:
    table = best_method(RIG, methods=["abraham", "equirectangular", "opencv-omnidir"]).table
    assert table["method"][0] == "abraham"
    assert table["status"].tolist() == ["ok", "ok", "unsupported"]  # cv2.omnidir knows another kind of lens
    assert np.isnan(table["log_distortion_on_view"][1])


def test_what_free_curves_gain_over_the_best_closed_form_is_told() -> None:
    choice = best_method(RIG, methods=["abraham", "local-homography", "polar-optimal", "optimal"])
    values = choice.table.set_index("method")["log_distortion_on_view"]
    closed = min(("abraham", "local-homography"), key=lambda method: values[method])
    gain = 1 - values["optimal"] / values[closed]
    assert f"its free curves gain {gain:.0%} over {closed}, the best closed form" in choice.why
    assert gain > 0.05
    assert "free curves" not in best_method(RIG, methods=["abraham", "local-homography"]).why


def test_a_share_of_the_view_is_asked_where_nobody_asks() -> None:
    choice = best_method(RIG, methods=["abraham", "local-homography"])
    assert rb.metrics.coverage(choice.rectification, RIG)["coverage_pixels"] == pytest.approx(0.95, abs=0.005)


def skewed_by(turned_rad: float, tmp_path: Path) -> str:
    """A method whose distortion is the least, but whose right image is turned."""
    return write_method(
        tmp_path,
        "skewed",
        "rect = rb.rectify(problem.rig, 'local-homography')\n"
        f"c, s = np.cos({turned_rad}), np.sin({turned_rad})\n"
        "turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])\n"
        "right = rb.Warp(rect.right.source, turn @ rect.R_rect_right, rect.right.target)\n"
        "return rb.Rectification(problem.rig, rect.left, right, rect.size)",
    )


def test_a_method_whose_rows_are_far_off_is_not_chosen(tmp_path: Path) -> None:
    choice = best_method(RIG, methods=[skewed_by(0.05, tmp_path), "abraham"])
    assert choice.best.method == "abraham"
    assert choice.candidates[1].reason.startswith("does not rectify: rows of near points are ")
    forget_plugins()


def test_methods_whose_rows_trusted_matches_find_off_are_not_chosen() -> None:
    """All calibrated methods believe a pose that is off; one works from matches that are right."""
    _, left, right = points_before(RIG, 200)
    turn = Rotation.from_euler("x", 0.5, degrees=True).as_matrix()
    wrong, trusted = replace(RIG, R_right_left=turn @ RIG.R_right_left), Matches(left, right)
    asked = {"methods": ["abraham", "fusiello"], "matches": trusted, "framing": rb.Framing(fov_deg=(60, 60))}
    choice = best_method(wrong, trusted=trusted, **asked)
    assert choice.best.method == "fusiello"
    assert f"not counting abraham, whose rows are over {ROWS_AS_GOOD_PX:g} px worse" in choice.why


def test_methods_that_do_not_apply_are_listed_with_their_reason(tmp_path: Path) -> None:
    refuses = write_method(tmp_path, "refuses", "raise rb.Unsupported('an epipole')")
    breaks = write_method(tmp_path, "breaks", "raise ValueError('no')")
    choice = best_method(RIG, methods=[refuses, breaks, "abraham"])
    table = choice.table.set_index("method")
    assert choice.best.method == "abraham"
    assert table.loc["refuses", "status"] == "unsupported"
    assert table.loc["refuses", "reason"] == "an epipole"
    assert table.loc["breaks", "status"] == "error"
    with pytest.raises(rb.Unsupported, match=r"no method applies.*refuses: an epipole"):
        best_method(RIG, methods=[refuses])
    also = write_method(tmp_path, "also", "raise rb.Unsupported('an epipole')")
    with pytest.raises(rb.Unsupported, match=f"^no method applies to rig {RIG.name}: an epipole$"):
        best_method(RIG, methods=[refuses, also])  # a reason that all share is said once
    with pytest.raises(rb.Unsupported, match=r"refuses, also: an epipole; breaks: ValueError: no"):
        best_method(RIG, methods=[refuses, also, breaks])
    forget_plugins()


def test_frames_in_which_methods_show_different_things_are_refused() -> None:
    with pytest.raises(rb.InvalidInput, match="expected coverage or fov_deg"):
        best_method(RIG, framing=Framing(crop="valid"))
