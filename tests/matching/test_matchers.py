"""Dense matchers by name and by file: what is one, what is refused, and that reports take them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

import rectbench as rb
from rectbench.experiments.execution.cells import cell_inputs
from rectbench.experiments.planning import make_plan
from rectbench.matching import USUAL_MATCHER, matcher_named
from rectbench.metrics.reconstruction import DenseReconstruction
from rectbench.pairs.opening import open_pair
from rectbench.store.store import Store
from tests.matching.sphere_room import sphere_pair, sphere_truth
from tests.rigs_for_tests import rig

OWN = '''
import numpy as np
import rectbench as rb


@rb.matcher("constant")
def constant(left, right, lowest, highest):
    """Finds one disparity everywhere."""
    return np.full(left.shape[:2], {disparity})
'''
ROOM = rig("equidistant", size=(120, 80))


def own_matcher(folder: Path, disparity: float) -> str:
    path = folder / "constant.py"
    path.write_text(OWN.format(disparity=disparity))
    return str(path)


@dataclass
class Pair:
    """Images and truth of a room, for a metric."""

    rig: rb.Rig = ROOM
    images: rb.StereoPair = field(default_factory=lambda: sphere_pair(ROOM))
    truth: rb.Truth = field(default_factory=lambda: sphere_truth(ROOM))


def scores(matcher: str) -> dict[str, float]:
    case = rb.Case(rb.rectify(ROOM, "abraham"), Pair(), matcher=matcher)  # type: ignore[arg-type]
    return DenseReconstruction().compute(case)


def small_report(matcher: str = USUAL_MATCHER) -> rb.Report:
    return rb.Report(
        name="small",
        title="",
        scenes=("room",),
        rigs=("t265",),
        methods=("abraham",),
        metrics=("reconstruction",),
        image_width=64,
        matcher=matcher,
    )


def test_a_file_with_a_matcher_is_one_and_finds_what_it_finds(tmp_path: Path) -> None:
    path = own_matcher(tmp_path, 7.0)
    assert matcher_named(path).name == "constant"
    image = np.random.default_rng(0).integers(0, 255, (80, 120, 3), np.uint8)
    found = rb.reconstruct(rb.rectify(ROOM, "abraham"), image, image, path)
    np.testing.assert_allclose(found.disparity.px[np.isfinite(found.disparity.px)], 7.0, atol=1e-3)


def test_scores_are_those_of_the_matcher_that_the_case_names(tmp_path: Path) -> None:
    usual = scores(USUAL_MATCHER)
    assert usual["reconstruction_completeness"] > 0.8
    assert scores("bm") != usual
    assert scores(own_matcher(tmp_path, 3.0))["reconstruction_completeness"] < 0.4


def test_a_reports_matcher_is_in_the_key_of_its_cells_by_name_and_by_source(tmp_path: Path) -> None:
    store = Store(tmp_path / "store")

    def key(matcher: str) -> object:
        (task,) = make_plan(small_report(matcher)).tasks
        assert task.matcher == matcher
        return cell_inputs(task, open_pair(task.pair, store)).get("matcher")

    assert key(USUAL_MATCHER) is None  # keys from before there was a choice stay
    assert key("sgbm-5way") != key("sgbm-8way")  # which lie in one file
    first = key(own_matcher(tmp_path, 3.0))
    assert first == key(own_matcher(tmp_path, 3.0)) != key(own_matcher(tmp_path, 4.0))


def test_the_usual_matcher_is_a_reports_own() -> None:
    assert rb.Report(name="r", title="", rigs=("t265",), methods=("abraham",)).matcher == USUAL_MATCHER


def test_a_report_with_an_unknown_matcher_is_told_before_anything_runs() -> None:
    with pytest.raises(rb.UnknownName, match=r"unknown matcher 'sgmb'; did you mean .*sgbm"):
        make_plan(small_report("sgmb"))


@pytest.mark.parametrize(
    ("name", "doc", "fault"), [("", "Words.", "matcher name"), ("m", "", "no docstring")]
)
def test_a_matcher_without_name_or_words_is_refused(name: str, doc: str, fault: str) -> None:
    def match(*_: object) -> np.ndarray:
        return np.zeros(1)

    match.__doc__ = doc
    with pytest.raises(rb.InvalidInput, match=fault):
        rb.matcher(name)(match)
