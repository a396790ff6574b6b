"""A map that does not rectify has a misfit, and no distortion at equal view."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from scipy.spatial.transform import Rotation

import rectbench as rb
from rectbench.applications.choose_method import best_method
from rectbench.metrics import log_distortion, log_distortion_on_view, row_misfit
from rectbench.metrics.scoring import score
from rectbench.scored import Delivered, ScoredView
from tests.rigs_for_tests import points_before, rig, rigs

RIG = rb.load_rig("t265").scaled(0.5)


@dataclass(frozen=True, eq=False)
class AsItIs(rb.Target):
    """The source image itself."""

    camera: rb.Camera

    @property
    def constants(self) -> Any:
        return {"camera": self.camera.constants}

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Any) -> Any:
        return self.camera.project_formula(c.camera, x, y, z, xp)

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Any) -> Any:
        return self.camera.unproject_formula(c.camera, u, v, xp)


def not_rectified(pair: rb.Rig = RIG) -> rb.Rectification:
    warps = (rb.Warp(camera, np.eye(3), AsItIs(camera)) for camera in (pair.left, pair.right))
    return rb.Rectification(pair, *warps, pair.left.size)


@dataclass(frozen=True, eq=False)
class Bent(rb.Target):
    """Rows bent down by up to `amount_px` at the ends of the image, in a parabola."""

    target: rb.Target
    width: float
    amount_px: float

    @property
    def constants(self) -> Any:
        return {"target": self.target.constants, "width": self.width, "amount": self.amount_px}

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Any) -> Any:
        u, v, ok = self.target.project_formula(c.target, x, y, z, xp)
        return u, v + self._bend(c, u), ok

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Any) -> Any:
        return self.target.unproject_formula(c.target, u, v - self._bend(c, u), xp)

    @staticmethod
    def _bend(c: Any, u: Any) -> Any:
        off = 2 * u / c.width - 1
        return c.amount * off * off


def bent(amount_px: float) -> rb.Rectification:
    rect = rb.rectify(RIG, method="abraham")
    left, right = (
        replace(warp, target=Bent(warp.target, rect.size[0], amount_px)) for warp in (rect.left, rect.right)
    )
    return replace(rect, left=left, right=right)


def misfit(
    rect: rb.Rectification, *pairs: rb.Rig, works_from: frozenset[str] = frozenset({"pose"})
) -> rb.metrics.RowMisfit:
    delivered = Delivered.of(rect, ScoredView.of(rect.rig))
    return row_misfit(rect, delivered, *(pairs or (rect.rig,)), works_from=works_from)


@settings(max_examples=10, deadline=None)
@given(pair=rigs)
@pytest.mark.parametrize("method", ["abraham", "local-homography", "conventional"])
def test_rows_of_calibrated_methods_are_epipolar_planes(method: str, pair: rb.Rig) -> None:
    found = misfit(rb.rectify(pair, method=method))
    assert found.rectifies
    assert found.bend_px < 1e-3
    assert found.misfit < 1e-4


@pytest.mark.parametrize("method", ["hartley", "fusiello"])
def test_rows_of_methods_that_know_matches_alone_are_planes_too(method: str) -> None:
    pair = rig()
    rng = np.random.default_rng(0)
    _, px_left, px_right = points_before(pair)
    noisy = rb.Matches(*(px + rng.normal(0, 0.2, px.shape) for px in (px_left, px_right)))
    found = misfit(rb.rectify(pair, method=method, matches=noisy), works_from=frozenset({"matches"}))
    assert found.rectifies
    assert found.bend_px < 1e-3
    assert found.misfit > 2e-4


@pytest.mark.parametrize("name", rb.fisheye_rigs())
def test_the_images_as_they_are_have_no_distortion_and_are_not_compared(name: str) -> None:
    pair = rb.load_rig(name)
    pair = pair.scaled(320 / pair.left.width)
    rect = not_rectified(pair)
    assert log_distortion(Delivered.of(rect, ScoredView.of(pair)).shown)["log_distortion"] < 1e-5
    assert math.isnan(log_distortion_on_view(rect, pair))
    assert misfit(rect).reason.startswith("does not rectify: rows are bent by ")


@pytest.mark.parametrize("amount_px", [0.5, 1.0, 10.0])
def test_bent_rows_are_found_by_as_much_as_they_are_bent(amount_px: float) -> None:
    found = misfit(bent(amount_px))
    # Planes take up some of a parabola, and what is left is seen where the lens shows it.
    assert 0.2 * amount_px < found.bend_px < amount_px
    assert not found.rectifies


def test_rows_of_the_two_images_that_do_not_meet_are_found_by_their_distance() -> None:
    rect = rb.rectify(RIG, method="abraham")
    lower = replace(rect, right=replace(rect.right, target=rect.right.target.framed(-0.5, 9.5, 1.0, 1.0)))
    found = misfit(lower)
    assert found.bend_px < 1e-3
    assert 6 < found.misfit * RIG.left.width < 12  # 10 rectified pixels, in those of the source
    assert found.reason.startswith("does not rectify: rows of near points are ")


def test_a_method_that_was_told_a_wrong_pose_is_not_blamed_for_it() -> None:
    told = replace(RIG, R_right_left=Rotation.from_euler("x", 5, degrees=True).as_matrix() @ RIG.R_right_left)
    rect = rb.rectify(told, method="abraham")
    assert misfit(rect, RIG).misfit > 0.01
    assert misfit(rect, RIG, told).misfit < 1e-4


class UprightRows(rb.Warp):
    """Rows that are planes of another baseline, and a `forward` that puts what is asked into one row."""

    def forward(self, px: Any) -> Any:
        there = super().forward(px)
        return np.full_like(there, 50.0) if there.size < 5_000 else there


def upright(denied: bool) -> rb.Rectification:
    """Abraham's rectification of cameras that stand above each other, handed out for those side by side."""
    other = replace(RIG, t_right_left=RIG.t_right_left[[1, 0, 2]])
    rect = replace(rb.rectify(other, method="abraham"), rig=RIG)
    if not denied:
        return rect
    left, right = (UprightRows(w.source, w.R_rect_cam, w.target) for w in (rect.left, rect.right))
    return replace(rect, left=left, right=right)


@pytest.mark.parametrize("denied", [False, True])
def test_rows_of_another_baseline_are_found_whatever_forward_says_of_matches(denied: bool) -> None:
    found = misfit(upright(denied), works_from=frozenset({"matches"}))
    assert found.bend_px < 1e-3
    assert found.misfit > 0.05
    assert not found.rectifies


class KnowsNoMatches(rb.Warp):
    """Says of few pixels that they go nowhere."""

    def forward(self, px: Any) -> Any:
        there = super().forward(px)
        return np.full_like(there, np.nan) if there.size < 5_000 else there


def test_what_shows_no_match_is_no_rectification() -> None:
    rect = rb.rectify(RIG, method="abraham")
    left = KnowsNoMatches(rect.left.source, rect.left.R_rect_cam, rect.left.target)
    assert not misfit(replace(rect, left=left)).rectifies


def test_what_cannot_be_told_is_no_rectification() -> None:
    nan, limits = math.nan, {"allowed": 0.01}
    assert rb.metrics.RowMisfit(bend_px=0, misfit=0, **limits).rectifies
    assert not rb.metrics.RowMisfit(bend_px=nan, misfit=0, **limits).rectifies
    assert not rb.metrics.RowMisfit(bend_px=0, misfit=nan, **limits).rectifies


@dataclass
class Lenses:
    """A pair that has no scene."""

    rig: rb.Rig
    scored_view: rb.ScoredView = field(init=False)

    def __post_init__(self) -> None:
        self.scored_view = ScoredView.of(self.rig)


def test_a_row_of_a_map_that_does_not_rectify_shows_its_distortion_and_takes_no_rank() -> None:
    row = score(rb.Case(not_rectified(), Lenses(RIG)), ["log_distortion", "row_misfit"])  # type: ignore[arg-type]
    assert row["log_distortion"] < 1e-5
    assert "log_distortion_95" not in row
    assert row["row_bend_px"] > 1


NOTHING = '''
import rectbench as rb
from tests.metrics.test_row_misfit import not_rectified


class Nothing(rb.Rectifier):
    """Leaves the images as they are."""

    name = "nothing"

    def fit(self, problem, options):
        return not_rectified(problem.rig)
'''


def test_the_best_method_is_one_that_rectifies(tmp_path: Any) -> None:
    (tmp_path / "nothing.py").write_text(NOTHING, encoding="utf-8")
    choice = best_method(RIG, methods=[str(tmp_path / "nothing.py"), "abraham"])
    assert [c.method for c in choice.candidates] == ["abraham", "nothing"]
    assert choice.candidates[1].reason.startswith("does not rectify")
