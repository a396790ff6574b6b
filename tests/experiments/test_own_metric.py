"""A metric in one file: from it alone come its numbers, its gate, its table and its place on the page."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest

import rectbench as rb
from rectbench.experiments.planning import make_plan
from rectbench.reporting.report import write_report
from rectbench.runs.gating import accept, gate
from rectbench.runs.making import run
from rectbench.runs.run import read_run
from rectbench.store.store import STORE_VARIABLE
from tests.conftest import Shell
from tests.experiments.fakes import small_report

TALLNESS = '''
import rectbench as rb


class Tallness(rb.Metric):
    """How tall the rectified images are."""

    name, topic = "tallness", "Shape"
    columns = (
        rb.Column(
            "tallness_px",
            "tallness",
            "px",
            "lower",
            "Height of the rectified images, of which less is more.",
            tolerance=rb.Tolerance(0.0, 0.5),
        ),
    )

    def compute(self, case):
        case.remarks["shape"] = f"{case.rect.size[0]} wide"
        return {"tallness_px": case.rect.size[1]}
'''


@pytest.fixture(scope="module")
def metric(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("metric") / "tallness.py"
    path.write_text(TALLNESS, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def folder(metric: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of a small report that asks for it; the metric's file is gone when the run is read."""
    place = tmp_path_factory.mktemp("runs")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(STORE_VARIABLE, str(place / "store"))
        run(small_report(metrics=("distortion", str(metric)), figures=()), place / "run", jobs=1)
        metric.rename(metric.with_suffix(".gone"))
        write_report(place / "run")
    metric.with_suffix(".gone").rename(metric)
    return place / "run"


def test_its_number_and_its_remark_are_in_the_results(folder: Path) -> None:
    row = read_run(folder).table.iloc[0]
    assert row["tallness_px"] > 10
    assert json.loads(row["notes"])["shape"].endswith("wide")


def test_a_worse_value_closes_the_gate(folder: Path, tmp_path: Path) -> None:
    accepted = tmp_path / "small.accepted.csv"
    accept(folder, accepted)
    assert gate(folder, accepted).exit_code == 0
    numbers = pd.read_csv(accepted)
    numbers.assign(tallness_px=numbers["tallness_px"] - 1).to_csv(accepted, index=False)
    verdict = gate(folder, accepted)
    assert verdict.exit_code == 1
    assert "tallness_px" in verdict.regressions[0]


def test_a_gated_column_that_no_metric_of_the_run_has_leaves_it_incomplete(
    folder: Path, tmp_path: Path
) -> None:
    accepted = tmp_path / "small.accepted.csv"
    accept(folder, accepted)
    pd.read_csv(accepted).assign(slimness_px=3.0).to_csv(accepted, index=False)
    verdict = gate(folder, accepted)
    assert (verdict.exit_code, verdict.incomplete) == (
        3,
        ["slimness_px: no metric of the run has this column"],
    )


def test_its_topic_has_a_table(folder: Path) -> None:
    table = (folder / "tables" / "shape.md").read_text(encoding="utf-8")
    assert "tallness \\[px\\]" in table
    assert "tallness" in (folder / "tables" / "pair-street-t265.md").read_text(encoding="utf-8")


def test_the_page_shows_and_explains_it(folder: Path) -> None:
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert "Height of the rectified images, of which less is more." in page
    assert 'id="shape"' in page


def test_what_it_needs_is_rendered(metric: Path, tmp_path: Path) -> None:
    path = tmp_path / "looking.py"
    needing = TALLNESS.replace(
        'name, topic = "tallness"', 'needs = frozenset({"images"})\n    name, topic = "looking"'
    )
    path.write_text(needing.replace("tallness_px", "looking_px"), encoding="utf-8")
    plans = [make_plan(small_report(metrics=(str(file),), figures=())) for file in (metric, path)]
    assert [plan.tasks[0].pair.images for plan in plans] == [False, True]  # type: ignore[union-attr]


def test_a_wrong_name_is_told_before_anything_runs(tmp_path: Path) -> None:
    with pytest.raises(rb.UnknownName, match="unknown metric 'row_eror'; did you mean row_error"):
        make_plan(small_report(metrics=("row_eror",)))
    with pytest.raises(rb.InvalidInput, match=r"there is no file .*gone\.py"):
        make_plan(small_report(metrics=(str(tmp_path / "gone.py"),)))


def test_the_metrics_are_listed(shell: Shell) -> None:
    code, listed, _ = shell("list", "metrics")
    assert code == 0
    assert "row_error_board" in listed
    assert "Together: log_distortion, distortion" in listed


BAD = {
    "a key that every row has": ('rb.Column("status", "s")', "'status', which every row has"),
    "a key twice": ('rb.Column("a", "a"), rb.Column("a", "b")', "'a' twice"),
    "no such average": ('rb.Column("a", "a", average="median")', "average is 'median'"),
    "an endless scale": ('rb.Column("a", "a", scale=float("inf"))', "scale is inf"),
    "no columns": ("", "columns is"),
    "no such need": ('rb.Column("a", "a")', r"needs is .*'depth'.*expected a set of truth or images"),
}


@pytest.mark.parametrize("fault", BAD)
def test_what_a_run_could_not_hold_is_refused_before_it(tmp_path: Path, fault: str) -> None:
    columns, reason = BAD[fault]
    needs = 'frozenset({"depth"})' if fault == "no such need" else "frozenset()"
    (tmp_path / "bad.py").write_text(
        "import rectbench as rb\n\n\nclass Bad(rb.Metric):\n    name, topic = 'bad', 'Shape'\n"
        f"    needs = {needs}\n    columns = ({columns + ',' if columns else ''})\n\n"
        "    def compute(self, case):\n        return {}\n"
    )
    with pytest.raises(rb.InvalidInput, match=reason) as caught:
        make_plan(small_report(metrics=(str(tmp_path / "bad.py"),)))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("thing", ["images", "estimate", "board", "truth", "true_matches"])
def test_a_metric_is_handed_what_it_declared_and_no_more(tmp_path: Path, thing: str) -> None:
    (tmp_path / "nosy.py").write_text(
        "import rectbench as rb\n\n\nclass Nosy(rb.Metric):\n    name, topic = 'nosy', 'Shape'\n"
        "    columns = (rb.Column('nosy', 'nosy'),)\n\n    def compute(self, case):\n"
        f"        return {{'nosy': float(bool(case.pair.{thing}))}}\n"
    )
    table = run(small_report(metrics=(str(tmp_path / "nosy.py"),), figures=()), tmp_path / "run", jobs=1)
    assert table["status"].tolist() == ["invalid"]
    assert f"asks for {thing} of the pair; expected" in table["reason"][0]
