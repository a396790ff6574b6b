"""A reason that several cells share is told once: in the table of failures, and on the terminal."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from rectbench.cli.printing import running
from rectbench.reporting.failures import failures_of, told_failures
from rectbench.reporting.tables.run_tables import failures_table
from rectbench.runs.run import Run, read_run
from tests.reporting.runs import METHODS, failed_row, quick_rows, save_run

EPIPOLE = "an epipole lies in the left view"


def run_of(folder: Path, *failures: dict[str, Any]) -> Run:
    """A run in which these rows stand in the place of those that have their names."""
    keys = ("scene", "rig", "motion", "pose", "method", "seed")
    failing = {tuple(row[key] for key in keys): row for row in failures}
    rows = [failing.get(tuple(row[key] for key in keys), row) for row in quick_rows()]
    return read_run(save_run(folder, rows))


def test_a_reason_of_all_methods_is_said_once(tmp_path: Path) -> None:
    failures = [
        failed_row("street", "t265", pose, method, reason=EPIPOLE)
        for method in METHODS
        for pose in ("exact", "perturbed")
    ]
    run = run_of(tmp_path, *failures)
    assert list(told_failures(run)) == [
        "unsupported: every method on street/t265/as-calibrated/exact, street/t265/as-calibrated/perturbed: "
        + EPIPOLE
    ]
    table = failures_table(run)
    assert table.caption.startswith(f"{len(failures)} of ")
    shown = [[entry.text for entry in row] for row in table.sections[0].rows]
    assert [row[-5:] for row in shown] == [
        [pose, "every method", "0", "unsupported", EPIPOLE] for pose in ("exact", "perturbed")
    ]


def test_other_reasons_name_their_methods(tmp_path: Path) -> None:
    run = run_of(
        tmp_path,
        failed_row("street", "t265", "exact", "hartley", "error", "no matches"),
        failed_row("street", "t265", "exact", "fusiello", "error", "no matches"),
        failed_row("street", "t265", "exact", "abraham", reason=EPIPOLE),
        failed_row("street", "t265", "perturbed", "abraham", "timeout", EPIPOLE),
    )
    told = set(told_failures(run))
    assert told == {
        "error: hartley, fusiello on street/t265/as-calibrated/exact: no matches",
        f"unsupported: abraham on street/t265/as-calibrated/exact: {EPIPOLE}",
        f"timeout: abraham on street/t265/as-calibrated/perturbed: {EPIPOLE}",
    }
    assert {failure.method for failure in failures_of(run)} == {"hartley, fusiello", "abraham"}


def test_of_many_places_the_first_are_named(tmp_path: Path) -> None:
    scenes = ("street", "corridor", "room", "forest")
    failures = [failed_row(scene, "t265", "exact", "hartley", reason=EPIPOLE) for scene in scenes]
    (line,) = told_failures(run_of(tmp_path, *failures))
    assert line == (
        "unsupported: hartley on street/t265/as-calibrated/exact, corridor/t265/as-calibrated/exact, "
        f"room/t265/as-calibrated/exact and 1 more place: {EPIPOLE}"
    )


def test_a_run_of_one_method_names_it(tmp_path: Path) -> None:
    rows = [failed_row("street", "t265", "exact", "abraham", reason=EPIPOLE)]
    run = read_run(save_run(tmp_path, [*rows, *quick_rows(scenes=("room",), methods=("abraham",))]))
    assert list(told_failures(run)) == [f"unsupported: abraham on street/t265/as-calibrated/exact: {EPIPOLE}"]


def test_seeds_of_one_reason_stand_together(tmp_path: Path) -> None:
    rows = [failed_row("street", "t265", "exact", method, reason=EPIPOLE) for method in METHODS]
    again = [{**row, "seed": 1} for row in rows]
    run = read_run(save_run(tmp_path, [*rows, *again, *quick_rows(scenes=("room",))]))
    assert [(failure.method, failure.seed) for failure in failures_of(run)] == [("every method", "0, 1")]


def test_the_terminal_says_it_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    failures = [failed_row("street", "t265", "exact", method, reason=EPIPOLE) for method in METHODS]
    run = run_of(tmp_path, *failures)
    out = io.StringIO()
    monkeypatch.setattr(running, "console", lambda: Console(file=out, width=300, highlight=False))
    running.show_summary(run.folder)
    assert out.getvalue().count(EPIPOLE) == 1
