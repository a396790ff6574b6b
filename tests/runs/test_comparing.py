from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import rectbench as rb
from rectbench.experiments.execution.outcomes import Outcome
from rectbench.experiments.planning import make_plan
from rectbench.runs.comparing import compare
from rectbench.runs.record import facts_of, table_of, write_run
from tests.experiments.fakes import small_report

SEEDS = tuple(range(12))


def write(folder: Path, shift: float, spread: float = 0.0, failed: tuple[int, ...] = ()) -> Path:
    """A run whose log distortion is 1 to 12 by seed, plus `shift`, plus noise of `spread`."""
    plan = make_plan(small_report(methods=("abraham",), seeds=SEEDS))
    noise = np.random.default_rng(3).normal(0, spread, len(SEEDS)) if spread else np.zeros(len(SEEDS))
    outcomes = [
        Outcome("crash", "x")
        if seed in failed
        else Outcome(metrics={"log_distortion": 1.0 + seed + shift + noise[seed]})
        for seed in SEEDS
    ]
    write_run(folder, table_of(plan, outcomes), facts_of(plan))
    return folder


def row(a: Path, b: Path) -> pd.Series:
    table = compare(a, b).table
    assert list(table["metric"]) == ["log_distortion"]
    return table.iloc[0]


def test_the_difference_is_paired_by_cell(tmp_path: Path) -> None:
    found = row(write(tmp_path / "a", 0.0), write(tmp_path / "b", 0.01))
    assert found["pairs"] == 12
    assert found["median_a"] == pytest.approx(6.5)
    # Cells spread over 11 units; only pairing shows a change of a hundredth so sharply.
    assert found["difference"] == pytest.approx(0.01)
    assert (found["low"], found["high"]) == (pytest.approx(0.01), pytest.approx(0.01))


def test_the_interval_covers_noise_and_is_repeatable(tmp_path: Path) -> None:
    a, b = write(tmp_path / "a", 0.0), write(tmp_path / "b", 0.0, spread=0.1)
    found = row(a, b)
    assert found["low"] < 0 < found["high"]
    pd.testing.assert_series_equal(found, row(a, b))
    far = row(a, write(tmp_path / "c", 1.0, spread=0.1))
    assert far["low"] > 0.5


def test_cells_that_failed_in_one_are_told_and_left_out(tmp_path: Path) -> None:
    comparison = compare(write(tmp_path / "a", 0.0, failed=(2, 3)), write(tmp_path / "b", 0.0, failed=(3, 4)))
    assert comparison.table["pairs"][0] == 9
    assert len(comparison.unpaired) == 2
    assert "seed 2: crash in A, ok in B" in comparison.unpaired[0]


def test_runs_without_a_common_cell_compare_to_nothing(tmp_path: Path) -> None:
    everything = tuple(SEEDS)
    comparison = compare(write(tmp_path / "a", 0.0), write(tmp_path / "b", 0.0, failed=everything))
    assert comparison.table.empty
    with pytest.raises(rb.InvalidInput, match="is no run's folder"):
        compare(tmp_path / "a", tmp_path)
