"""What a row is scored by: names, bundles and files; what a broken metric says; what is promised."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

import rectbench as rb
from rectbench.experiments.execution import cells
from rectbench.metrics.scoring import BUNDLES, digests_of, metrics_of, needs_of, score
from rectbench.plugins.catalogue import known
from rectbench.plugins.metric import METRICS
from rectbench.registry import registry
from rectbench.scored import SeenView
from rectbench.store.closure import PACKAGE, source_closure
from tests.rigs_for_tests import points_before, rig

METRIC = '''
import rectbench as rb


class Own(rb.Metric):
    """A metric for tests."""

    name, topic = "own", "Own things"
    columns = (rb.Column("{key}", "own", "", "lower", "What is its own."),)

    def compute(self, case):
        return {answer}
'''


@dataclass
class Exact:
    """A pair of which all matches are exact."""

    rig: rb.Rig
    true_matches: rb.Matches
    knows_truth: bool = True
    board: None = None

    @property
    def scored_view(self) -> rb.ScoredView:
        return rb.ScoredView.of(self.rig, count=500)

    @property
    def seen_view(self) -> SeenView:
        return SeenView.of(self.rig)

    def features(self, *, by_estimate: bool) -> rb.Matches:
        return self.true_matches


@pytest.fixture(scope="module")
def case() -> rb.Case:
    pair = rig()
    _, px_left, px_right = points_before(pair, 100)
    known_pair: Any = Exact(pair, rb.Matches(px_left, px_right))
    return rb.Case(rb.rectify(pair), known_pair, first_fit_s=2.0, fit=lambda: rb.rectify(pair))


def own_metric(folder: Path, answer: str, key: str = "own") -> str:
    path = folder / "own.py"
    path.write_text(METRIC.format(answer=answer, key=key))
    return str(path)


def test_a_row_has_every_column_that_is_promised(case: rb.Case) -> None:
    asked = ("geometry", "row_error", "row_error_features", "row_error_board", "energy", "timing")
    row = score(case, asked)
    assert set(known().promised) <= set(row)
    assert all(math.isfinite(value) for value in row.values())
    assert row["fit_s"] == 2.0
    assert "row_error_board_mean_px" not in row


def test_a_bundle_is_its_members(case: rb.Case) -> None:
    assert score(case, ["geometry"]) == score(case, BUNDLES["geometry"])
    assert list(metrics_of(["geometry", "order"])) == list(BUNDLES["geometry"])


def test_what_is_needed_is_known_before_anything_is_rendered() -> None:
    assert needs_of(["geometry", "timing", "energy"]) == frozenset()
    assert needs_of(["row_error"]) == {"true_matches"}
    assert needs_of(["row_error_features", "row_error_board"]) == {"images"}


def test_a_wrong_name_is_told_with_the_nearest_ones() -> None:
    with pytest.raises(rb.UnknownName, match="unknown metric 'geometri'; did you mean geometry"):
        metrics_of(["geometri"])


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        ("{'owen': 1.0}", "metric own returned 'owen', which is none of its columns"),
        ("{'own': 'much'}", "metric own returned 'much' for own; expected a number"),
        ("{'own': True}", "metric own returned True for own; expected a number"),
        ("1.0", "metric own returned a float; expected numbers by their columns"),
    ],
)
def test_a_metric_with_a_wrong_answer_is_named(tmp_path: Path, case: rb.Case, answer: str, said: str) -> None:
    with pytest.raises(rb.InvalidResult, match=said):
        score(case, [own_metric(tmp_path, answer)])


def test_any_number_counts_and_what_is_left_out_is_empty(tmp_path: Path, case: rb.Case) -> None:
    whole = own_metric(tmp_path, "{'own': __import__('numpy').float32(2)}")
    assert score(case, [whole]) == {"own": 2.0}
    (tmp_path / "none").mkdir()
    assert score(case, [own_metric(tmp_path / "none", "{}")]) == {}


def test_no_metric_takes_another_ones_column(tmp_path: Path) -> None:
    with pytest.raises(rb.InvalidInput, match=r"two metrics have a column 'fit_s': .*timing.py and .*own.py"):
        metrics_of([own_metric(tmp_path, "{}", key="fit_s")])


def test_one_column_ranks_and_each_has_one_metric() -> None:
    columns = known().columns
    assert [column.key for column in columns if column.ranks] == ["log_distortion_95"]
    assert len({column.key for column in columns}) == len(columns)


def test_every_built_in_metric_shapes_the_key_of_a_cell() -> None:
    closure = source_closure(cells.__name__)
    paths = {plugin.path for plugin in registry(METRICS).plugins() if PACKAGE in plugin.path.parents}
    assert len(paths) >= 12
    assert paths <= set(closure)


def test_an_edited_metric_of_one_s_own_changes_the_key(tmp_path: Path) -> None:
    path = own_metric(tmp_path, "{}")
    before = digests_of([path])
    own_metric(tmp_path, "{'own': 1.0}")
    assert digests_of([path]).keys() == before.keys() == {"own"}
    assert digests_of([path]) != before
