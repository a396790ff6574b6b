from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from rectbench.plugins.figure import Drawing, FigureData, Sources
from rectbench.reporting.charts.critical_difference import (
    CriticalDifference,
    Decided,
    decided,
    draw_beliefs,
    draw_ranks,
    mean_ranks,
    shown_beliefs,
    why_not_drawn,
)
from rectbench.reporting.style import looks
from rectbench.runs.run import read_run
from tests.reporting.runs import METHODS, failed_row, make_row

WriteRun = Callable[..., Path]
RIGS = tuple(f"rig-{i}" for i in range(14))


def rows(rigs: tuple[str, ...], methods: tuple[str, ...] = tuple(METHODS)) -> list[dict[str, Any]]:
    """Every method keeps the whole view."""
    found = [
        make_row(scene, rig, "exact", m) for scene in ("street", "room") for rig in rigs for m in methods
    ]
    return [row | {"log_distortion_95": row["log_distortion"]} for row in found]


def drawings(folder: Path, sources: Sources) -> list[Drawing]:
    run = read_run(folder)
    return list(CriticalDifference().drawings(FigureData(run, run, sources, looks(run.methods))))


def placed(*orders: str) -> Decided:
    """Methods a, b, ... on a rig an order: "bac" has b best."""
    values: Mapping[str, Mapping[str, float]] = {
        method: {f"rig-{i}": 1.0 + order.index(method) for i, order in enumerate(orders)}
        for method in sorted(orders[0])
    }
    return Decided("log distortion", 1e-9, values)


def test_why_there_is_no_figure_is_told_in_a_line(write_run: WriteRun) -> None:
    few = read_run(write_run(rows(RIGS[:9], tuple(METHODS)[:2])))
    assert why_not_drawn(few) == (
        "No figure of critical differences: it takes 3 methods with a log distortion at 95 % of "
        "the view on 10 rigs; here are 2 methods on 9 rigs."
    )
    assert why_not_drawn(read_run(write_run(rows(RIGS), "many"))) == ""


@pytest.mark.parametrize(("rigs", "methods", "count"), [(9, 5, 0), (10, 5, 2), (10, 2, 0), (10, 3, 2)])
def test_it_is_drawn_from_ten_rigs_and_three_methods_on(
    write_run: WriteRun, sources: Sources, rigs: int, methods: int, count: int
) -> None:
    found = drawings(write_run(rows(RIGS[:rigs], tuple(METHODS)[:methods])), sources)
    assert len(found) == count
    for drawing in found:
        assert f"over {rigs} rigs" in drawing.caption
        assert drawing.draw().axes


def test_a_method_without_a_number_on_some_rig_shares_the_last_place_there(
    write_run: WriteRun, sources: Sources
) -> None:
    absent = {("local-homography", RIGS[3]), ("abraham", RIGS[3])}
    folder = write_run([r for r in rows(RIGS) if (r["method"], r["rig"]) not in absent])
    data = decided(read_run(folder))
    assert (len(data.values), data.rigs) == (5, 14)
    one = Decided("x", 1e-9, {m: dict.fromkeys(RIGS, own[RIGS[3]]) for m, own in data.values.items()})
    assert [mean_ranks(one)[0][method] for method in ("local-homography", "abraham")] == [4.5, 4.5]
    words = "(local-homography, abraham)"
    assert all(words in drawing.caption for drawing in drawings(folder, sources))


def test_a_method_without_any_number_is_not_drawn(write_run: WriteRun) -> None:
    given = [r for r in rows(RIGS, ("abraham", "conventional")) if r["method"] != "hartley"]
    given += [failed_row("street", rig, "exact", "hartley") for rig in RIGS]
    assert set(decided(read_run(write_run(given))).values) == {"abraham", "conventional"}


def test_the_critical_difference_is_demsars() -> None:
    # The worked example of his paper: four classifiers on 14 data sets, CD = 2.569 sqrt(20 / 84) = 1.25.
    ranks, p, difference = mean_ranks(placed(*["abcd"] * 14))
    assert difference == pytest.approx(1.25, abs=0.005)
    assert ranks == {"a": 1.0, "b": 2.0, "c": 3.0, "d": 4.0}
    for a, b in ("ab", "bc", "ac", "bd"):
        assert (p.loc[a, b] < 0.05) == (ranks[b] - ranks[a] > difference)


def test_methods_that_are_alike_to_rounding_share_a_rank() -> None:
    values = {
        m: {rig: 0.3 + factor * i for i, rig in enumerate(RIGS)}
        for m, factor in zip("abc", (1, 1, 2), strict=True)
    }
    values["b"] = {rig: value * (1 + 1e-12) for rig, value in values["b"].items()}
    assert mean_ranks(Decided("x", 1e-9, values))[0]["a"] == mean_ranks(Decided("x", 1e-9, values))[0]["b"]


def test_nothing_is_told_apart_where_the_methods_together_are_not() -> None:
    _, p, _ = mean_ranks(placed(*["abcd", "dcba"] * 6))
    assert (p == 1).all(axis=None)
    same = {method: dict.fromkeys(RIGS, 1.0) for method in "abc"}
    assert (mean_ranks(Decided("x", 1e-9, same))[1] == 1).all(axis=None)


def test_each_method_has_its_colour_and_its_rank_beside_its_name() -> None:
    data = placed(*["abcd"] * 10, *["bacd"] * 2)
    own = looks(tuple(data.values))
    ax = draw_ranks(data, own).axes[0]
    coloured = {line.get_color() for line in ax.lines}
    assert {look.colour for look in own.values()} <= coloured
    words = {text.get_text().replace("\u00a0", "").strip() for text in ax.texts}
    assert {"a  1.17", "b  1.83", "3.00  c", "4.00  d"} <= words


def test_bars_are_as_long_as_the_probabilities() -> None:
    data = placed(*["abc"] * 9, *["acb"] * 4)
    beliefs = shown_beliefs(data)
    assert [(one.a, one.b) for one in beliefs] == [("a", "b"), ("a", "c"), ("b", "c")]
    shares = [share for one in beliefs for share in (one.a_better, one.equivalent, one.b_better)]
    ax = draw_beliefs(data, looks(tuple(data.values))).axes[0]
    assert [bar.get_width() for bar in ax.patches] == pytest.approx(shares)


def test_of_many_methods_neighbours_are_shown() -> None:
    data = placed(*["abcdefghi"] * 10)
    assert [one.a + one.b for one in shown_beliefs(data)] == ["ab", "bc", "cd", "de", "ef", "fg", "gh", "hi"]
