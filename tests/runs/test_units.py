from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from rectbench.plugins.metric import Column
from rectbench.runs.run import Run, read_run
from rectbench.runs.units import by_place, by_rig, floor_of
from tests.reporting.runs import failed_row, make_row, save_run

COLUMN = Column("log_distortion", "log distortion")


def run_of(tmp_path: Path, numbers: dict[tuple[str, str, int, str], float]) -> Run:
    """A run with these numbers by (rig, scene, seed, method)."""
    rows: list[dict[str, Any]] = [
        make_row(scene, rig, "exact", method, seed, log_distortion=value)
        for (rig, scene, seed, method), value in numbers.items()
    ]
    return read_run(save_run(tmp_path / "run", rows))


def test_the_value_of_a_rig_is_the_mean_over_scenes_of_means_over_seeds(tmp_path: Path) -> None:
    seeds = {("t265", "street", seed, "abraham"): value for seed, value in enumerate((1.0, 2.0, 9.0))}
    run = run_of(
        tmp_path, {**seeds, ("t265", "room", 0, "abraham"): 2.0, ("tumvi", "room", 0, "abraham"): 5.0}
    )
    assert by_rig(run.results, COLUMN) == {"abraham": {"t265": 3.0, "tumvi": 5.0}}


def test_the_mean_is_geometric_where_the_column_says_so(tmp_path: Path) -> None:
    run = run_of(tmp_path, {("t265", "street", s, "abraham"): v for s, v in enumerate((1.0, 10.0, 1e5))})
    geometric = replace(COLUMN, average="geometric")  # type: ignore[arg-type]
    assert by_rig(run.results, geometric)["abraham"]["t265"] == pytest.approx(100.0)
    zero = run_of(tmp_path, {("t265", "street", 0, "abraham"): 0.0})
    assert by_rig(zero.results, geometric)["abraham"]["t265"] == pytest.approx(1e-9)


def test_a_method_has_no_value_on_a_rig_where_it_lacks_a_pair_that_another_has(tmp_path: Path) -> None:
    numbers = {("t265", scene, 0, m): 1.0 for scene in ("street", "room") for m in ("abraham", "mine")}
    del numbers["t265", "room", 0, "mine"]
    run = run_of(tmp_path, {**numbers, ("tumvi", "room", 0, "mine"): 2.0})
    assert by_rig(run.results, COLUMN) == {"abraham": {"t265": 1.0}, "mine": {"tumvi": 2.0}}


def test_a_method_that_failed_everywhere_has_no_rig(tmp_path: Path) -> None:
    rows = [failed_row("street", "t265", "exact", "hartley"), make_row("street", "t265", "exact", "abraham")]
    run = read_run(save_run(tmp_path / "run", rows))
    assert by_place(run.results, COLUMN)["hartley"] == {}
    assert by_rig(run.results, COLUMN)["hartley"] == {}


def test_the_floor_is_in_the_stored_unit() -> None:
    assert floor_of(COLUMN) == 1e-9
    assert floor_of(Column("a_px", "a", "px", floor=1e-6)) == 1e-6
    assert floor_of(Column("share", "share", "%", scale=100.0, floor=1e-3)) == 1e-5
