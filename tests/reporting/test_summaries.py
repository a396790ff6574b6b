"""Averages by each column's own rule, over rigs first and last."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest

from rectbench.plugins.metric import Average, Column
from rectbench.plugins.result import Result
from rectbench.reporting.tables.captions import averages_text, units_text
from rectbench.reporting.tables.summaries import averaged
from rectbench.runs.run import read_run
from tests.reporting.runs import make_row

WriteRun = Callable[..., Path]


@pytest.fixture
def results(write_run: WriteRun) -> tuple[Result, ...]:
    """One rig with three scenes, one with one: 1, 2 and 4, and 16."""
    values = {("street", "a"): 1.0, ("room", "a"): 2.0, ("forest", "a"): 4.0, ("street", "b"): 16.0}
    rows = [make_row(*place, "exact", "abraham", fit_s=value) for place, value in values.items()]
    return read_run(write_run(rows)).results


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        ("mean", (7 / 3 + 16) / 2),
        ("geometric", math.sqrt(2 * 16)),
        ("rms", math.sqrt((7 + 256) / 2)),
        ("max", 16.0),
        ("min", 1.0),
    ],
)
def test_a_rig_weighs_as_much_as_another_whatever_it_holds(
    results: tuple[Result, ...], rule: Average, expected: float
) -> None:
    found = averaged(Column("fit_s", "fit", average=rule), results)
    assert found.value == pytest.approx(expected)
    assert found.count == 4
    assert list(found.by_rig) == ["a", "b"]


@pytest.mark.parametrize("rule", ["mean", "geometric", "rms", "max", "min"])
@pytest.mark.parametrize("odd", [math.inf, 0.0, 1e300])
def test_odd_values_raise_no_warning(write_run: WriteRun, rule: Average, odd: float) -> None:
    rows = [make_row("street", rig, "exact", "abraham", fit_s=odd if rig == "a" else 1.0) for rig in "abc"]
    results = read_run(write_run(rows)).results
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = averaged(Column("fit_s", "fit", average=rule), results)
    assert found.value is not None
    assert not math.isnan(found.value)


def test_one_pixel_s_doing_does_not_make_the_average(write_run: WriteRun) -> None:
    values = {"a": 1.4e5, "b": 1.0, "c": 1.0}
    rows = [make_row("street", rig, "exact", "abraham", distortion_native=v) for rig, v in values.items()]
    found = averaged(Column("distortion_native", "L", average="geometric"), read_run(write_run(rows)).results)
    assert found.value == pytest.approx(1.4e5 ** (1 / 3))


def test_the_caption_names_units_and_rules(results: tuple[Result, ...]) -> None:
    columns = [
        Column("a", "log distortion, 50 %", average="geometric"),
        Column("b", "log distortion, 95 %", average="geometric"),
        Column("c", "row error"),
        Column("d", "row error, max", average="max"),
    ]
    assert averages_text(results, columns) == (
        "Geometric means of log distortion, the largest of row error, max, arithmetic means of the rest, "
        "over 2 rigs (4 pairs in all)."
    )


def test_the_units_are_rigs_and_what_each_holds(write_run: WriteRun) -> None:
    rows = [make_row(s, r, "exact", "abraham") for s in ("street", "room") for r in "abc"]
    assert units_text(read_run(write_run(rows)).results) == "3 rigs (2 scenes each)"
    lenses = [make_row("none", r, "exact", "abraham", motion=m) for r in "abc" for m in ("still", "wide")]
    assert units_text(read_run(write_run(lenses, "lenses")).results) == "3 rigs (2 motions each)"
    seeds = [make_row("street", "a", "exact", "abraham", seed) for seed in (0, 1)]
    assert units_text(read_run(write_run(seeds, "seeds")).results) == "1 rig (1 scene × 2 seeds)"
