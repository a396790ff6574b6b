from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

import rectbench as rb
from rectbench.experiments.execution.outcomes import Outcome
from rectbench.experiments.planning import make_plan
from rectbench.runs.gating import Tolerance, accept, accepted_path, gate
from rectbench.runs.record import facts_of, table_of, write_run
from tests.experiments.fakes import small_report, write_report_file

METRICS = {"row_error_mean_px": 0.1, "log_distortion": 0.25, "coverage_pixels": 0.9, "fit_s": 0.01}
Change = Callable[[pd.DataFrame], pd.DataFrame]


def write(folder: Path, change: Change = lambda table: table, is_whole: bool = True) -> Path:
    """A run of two methods on two seeds, changed."""
    plan = make_plan(small_report(methods=("abraham", "conventional"), seeds=(0, 1)))
    table = table_of(plan, [Outcome(metrics=METRICS) for _ in plan.tasks])
    write_run(folder, change(table), {**facts_of(plan), "is_whole": is_whole})
    return folder


@pytest.fixture
def accepted(tmp_path: Path) -> Path:
    accept(write(tmp_path / "accepted"), tmp_path / "small.accepted.csv")
    return tmp_path / "small.accepted.csv"


def setting(column: str, value: object, row: int = 0) -> Change:
    def change(table: pd.DataFrame) -> pd.DataFrame:
        table.loc[row, column] = value  # type: ignore[call-overload]
        return table

    return change


def test_the_same_numbers_pass(tmp_path: Path, accepted: Path) -> None:
    verdict = gate(write(tmp_path / "run"), accepted)
    assert (verdict.exit_code, verdict.compared) == (0, 4)
    assert verdict.regressions + verdict.improvements + verdict.new + verdict.incomplete == []


@pytest.mark.parametrize(
    ("column", "value", "code", "kind"),
    [
        ("row_error_mean_px", 0.1015, 0, None),
        ("row_error_mean_px", 0.11, 1, "regressions"),
        ("row_error_mean_px", 0.05, 0, "improvements"),
        ("row_error_mean_px", math.nan, 1, "regressions"),
        ("row_error_mean_px", math.inf, 1, "regressions"),
        ("log_distortion", 0.26, 1, "regressions"),
        ("coverage_pixels", 0.89, 1, "regressions"),
        ("coverage_pixels", 0.95, 0, "improvements"),
        ("fit_s", 100.0, 0, None),
        ("distortion_native", 3.0, 0, None),
        ("status", "crash", 1, "regressions"),
        ("status", "unsupported", 1, "regressions"),
    ],
)
def test_what_got_worse_fails_and_what_got_better_is_told(
    tmp_path: Path, accepted: Path, column: str, value: object, code: int, kind: str | None
) -> None:
    verdict = gate(write(tmp_path / "run", setting(column, value)), accepted)
    assert verdict.exit_code == code
    for name in ("regressions", "improvements"):
        lines = getattr(verdict, name)
        assert len(lines) == (name == kind), lines
        assert all("abraham on street/t265/as-calibrated/exact/seed 0" in line for line in lines)
        assert all(column in line for line in lines)


def test_a_missing_cell_fails_a_whole_run_and_leaves_a_part_incomplete(
    tmp_path: Path, accepted: Path
) -> None:
    run = write(tmp_path / "run", lambda table: table.iloc[1:])
    verdict = gate(run, accepted)
    assert (verdict.exit_code, len(verdict.regressions)) == (1, 1)
    part = write(tmp_path / "part", lambda table: table.iloc[1:], is_whole=False)
    verdict = gate(part, accepted)
    assert (verdict.exit_code, len(verdict.incomplete)) == (3, 1)


def test_a_run_that_measured_nothing_does_not_pass(tmp_path: Path) -> None:
    def all_failed(table: pd.DataFrame) -> pd.DataFrame:
        return table.assign(status="unsupported")

    path = tmp_path / "small.accepted.csv"
    write(tmp_path / "run", all_failed)
    with pytest.raises(rb.InvalidInput, match="measured nothing"):
        accept(tmp_path / "run", path)
    accept(write(tmp_path / "accepted", setting("status", "ok")), path)
    text = path.read_text().replace(",ok,", ",unsupported,")
    path.write_text(text)
    verdict = gate(tmp_path / "run", path)
    assert (verdict.exit_code, verdict.compared, verdict.regressions) == (3, 0, [])


def test_cells_without_accepted_numbers_are_told_and_are_no_pass_alone(
    tmp_path: Path, accepted: Path
) -> None:
    lines = accepted.read_text().splitlines()
    accepted.write_text("\n".join(lines[:3]) + "\n")
    verdict = gate(write(tmp_path / "run"), accepted)
    assert (verdict.exit_code, verdict.compared, len(verdict.new)) == (0, 2, 2)
    accepted.write_text(lines[0] + "\n")
    assert gate(write(tmp_path / "run"), accepted).exit_code == 3


def test_a_cell_that_failed_when_accepted_may_recover(tmp_path: Path) -> None:
    path = tmp_path / "small.accepted.csv"
    accept(write(tmp_path / "accepted", setting("status", "unsupported")), path)
    verdict = gate(write(tmp_path / "run"), path)
    assert (verdict.exit_code, len(verdict.improvements)) == (0, 1)
    assert gate(write(tmp_path / "same", setting("status", "unsupported")), path).exit_code == 0
    assert gate(write(tmp_path / "worse", setting("status", "crash")), path).exit_code == 1


def test_a_part_of_a_report_is_not_accepted(tmp_path: Path) -> None:
    with pytest.raises(rb.InvalidInput, match="part of its report"):
        accept(write(tmp_path / "run", is_whole=False), tmp_path / "small.accepted.csv")
    assert not (tmp_path / "small.accepted.csv").exists()


def test_accepted_numbers_lie_beside_the_report(tmp_path: Path) -> None:
    report = write_report_file(tmp_path / "reports")
    run = write(tmp_path / "run")
    with pytest.raises(rb.UnknownName, match="unknown report 'small'"):
        accepted_path(run)
    facts = json.loads((run / "run.json").read_text())
    (run / "run.json").write_text(json.dumps({**facts, "report_file": report}))
    assert accepted_path(run) == tmp_path / "reports" / "small.accepted.csv"
    (run / "run.json").write_text(json.dumps({**facts, "report": "quick"}))
    assert accepted_path(run).name == "quick.accepted.csv"
    assert accepted_path(run).with_name("quick.py").exists()


def test_no_run_or_no_accepted_numbers_is_wrong_usage(tmp_path: Path, accepted: Path) -> None:
    with pytest.raises(rb.InvalidInput, match="is no run's folder"):
        gate(tmp_path, accepted)
    with pytest.raises(rb.InvalidInput, match="no accepted numbers"):
        gate(write(tmp_path / "run"), tmp_path / "absent.csv")
    accepted.write_text("scene,rig\n1,2\n")
    with pytest.raises(rb.InvalidInput, match=r"small\.accepted\.csv"):
        gate(tmp_path / "run", accepted)


def test_tolerances_have_a_direction() -> None:
    lower, higher = Tolerance("lower", 0.1, 0.0), Tolerance("higher", 0.1, 0.0)
    assert [lower.change(1.0, now) for now in (0.8, 0.95, 1.05, 1.2)] == ["better", "same", "same", "worse"]
    assert [higher.change(1.0, now) for now in (0.8, 1.2)] == ["worse", "better"]
    assert lower.change(math.inf, math.inf) == lower.change(math.nan, math.nan) == "same"
    assert lower.change(math.inf, 1.0) == "better"
    assert lower.change(0.0, 1e-9) == "worse"
    assert Tolerance("lower", 0.0, 1e-6).change(0.0, 1e-9) == "same"
