from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import rectbench as rb
from rectbench.experiments.execution.outcomes import Outcome
from rectbench.experiments.execution.running import Execution
from rectbench.experiments.planning import make_plan
from rectbench.runs.comparing import compare
from rectbench.runs.record import RunRecord, table_of, write_run
from rectbench.statistics.intervals import mean_interval
from tests.conftest import Shell
from tests.experiments.fakes import small_report

RIGS, SEEDS = ("t265", "tumvi", "sony-as200v", "canon-8mm"), (0, 1, 2)
CELLS = tuple(product(RIGS, SEEDS))


def write(
    folder: Path,
    shift: float,
    spread: float = 0.0,
    failed: tuple[int, ...] = (),
    rigs: tuple[str, ...] = RIGS,
    metric: str = "row_error_mean_px",
) -> Path:
    """A run whose metric is 1 to 12 by cell, plus `shift`, plus noise of `spread` a rig."""
    plan = make_plan(small_report(methods=("abraham",), rigs=rigs, seeds=SEEDS))
    noise = dict(zip(RIGS, np.random.default_rng(3).normal(0, spread, len(RIGS)), strict=True))
    outcomes = []
    for number, task in enumerate(plan.tasks):
        value = 1.0 + number + shift + noise[task.cell.rig]
        outcomes.append(Outcome("crash", "x") if number in failed else Outcome(metrics={metric: value}))
    write_run(folder, table_of(plan, outcomes), RunRecord.of(Execution(plan, outcomes, 1, 1, None), 1.0))
    return folder


def row(a: Path, b: Path) -> pd.Series:
    table = compare(a, b).table
    assert len(table) == 1
    return table.iloc[0]


def test_the_difference_is_paired_by_cell(tmp_path: Path) -> None:
    found = row(write(tmp_path / "a", 0.0), write(tmp_path / "b", 0.01))
    assert (found["pairs"], found["rigs"]) == (12, 4)
    assert found["median_a"] == pytest.approx(6.5)
    # Cells spread over 11 units; only pairing shows a change of a hundredth so sharply.
    assert found["difference"] == pytest.approx(0.01)
    assert (found["low"], found["high"]) == (pytest.approx(0.01), pytest.approx(0.01))


def test_the_interval_is_over_rigs_and_not_over_their_seeds(tmp_path: Path) -> None:
    found = row(write(tmp_path / "a", 0.0), write(tmp_path / "b", 1.0, spread=0.1))
    expected = mean_interval(1.0 + np.random.default_rng(3).normal(0, 0.1, len(RIGS)))
    assert (found["difference"], found["low"], found["high"]) == pytest.approx(
        (expected.estimate, expected.low, expected.high)
    )


def test_a_metric_of_geometric_average_changes_by_a_ratio(tmp_path: Path) -> None:
    runs = [write(tmp_path / name, 0.0, metric="log_distortion") for name in "ab"]
    table = pd.read_parquet(runs[1] / "results.parquet")
    table["log_distortion"] *= 1.02
    table.to_parquet(runs[1] / "results.parquet", index=False)
    found = row(*runs)
    assert found["moved"] == 12
    assert [found[name] for name in ("difference", "low", "high")] == pytest.approx([0.02] * 3)


def test_a_run_compared_with_itself_says_so(tmp_path: Path, shell: Shell) -> None:
    run = write(tmp_path / "a", 0.0)
    assert shell("compare", run, run)[:2] == (0, "no cell differs\n")


def test_parts_and_poses_are_compared_apart(tmp_path: Path, shell: Shell) -> None:
    a, b = (write(tmp_path / name, shift) for name, shift in (("a", 0.0), ("b", 1.0)))
    for run in (a, b):
        table = pd.read_parquet(run / "results.parquet")
        table["group"] = ["lenses" if rig == RIGS[0] else "pairs" for rig in table["rig"]]
        table.to_parquet(run / "results.parquet", index=False)
    found = compare(a, b).table
    assert dict(zip(found["part"], found["pairs"], strict=True)) == {"lenses": 3, "pairs": 9}
    code, out, _ = shell("compare", a, b)
    assert code == 0
    assert "lenses: " in out
    assert "+1.00 to +1.00" in out


def test_two_rigs_have_no_interval(tmp_path: Path) -> None:
    two = [write(tmp_path / name, 0.0, rigs=RIGS[:2]) for name in "ab"]
    found = row(*two)
    assert (found["pairs"], found["rigs"], found["difference"]) == (6, 2, 0.0)
    assert np.isnan(found["low"])
    assert np.isnan(found["high"])


def test_a_number_that_is_infinite_in_both_has_not_changed(tmp_path: Path) -> None:
    runs = [write(tmp_path / name, np.inf) for name in "ab"]
    assert row(*runs)["difference"] == 0.0


def test_cells_that_failed_in_one_are_told_and_left_out(tmp_path: Path) -> None:
    comparison = compare(write(tmp_path / "a", 0.0, failed=(2, 3)), write(tmp_path / "b", 0.0, failed=(3, 4)))
    assert comparison.table["pairs"][0] == 9
    assert len(comparison.unpaired) == 2
    assert "seed 2: crash in A, ok in B" in comparison.unpaired[0]


def test_runs_without_a_common_cell_compare_to_nothing(tmp_path: Path) -> None:
    everything = tuple(range(len(CELLS)))
    comparison = compare(write(tmp_path / "a", 0.0), write(tmp_path / "b", 0.0, failed=everything))
    assert comparison.table.empty
    with pytest.raises(rb.InvalidInput, match="is no run's folder"):
        compare(tmp_path / "a", tmp_path)
