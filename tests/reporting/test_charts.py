from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from rectbench.reporting.charts.scatter import scatter

from rectbench.reporting.charts.bars import bar_chart
from rectbench.reporting.charts.grouped_bars import draw_bars
from rectbench.reporting.style import looks
from rectbench.runs.run import read_run
from tests.reporting.runs import METHODS, failed_row, make_row, quick_rows

WriteRun = Callable[..., Path]
LOOKS = looks(tuple(METHODS))


def test_a_failed_cell_is_a_marked_gap_and_no_bar(write_run: WriteRun) -> None:
    rows = quick_rows(scenes=("street", "room"), rigs=("t265",), poses=("perturbed",))
    rows[2] = failed_row("street", "t265", "perturbed", "hartley", status="timeout")
    figure = draw_bars(bar_chart(read_run(write_run(rows)), "row_error_mean_px", "perturbed"), LOOKS)
    ax = figure.axes[0]
    assert len(ax.patches) == 9
    assert [text.get_text() for text in ax.texts] == ["timeout"]
    assert [label.get_text() for label in ax.get_xticklabels()] == ["street", "room"]


def test_bars_are_as_high_as_the_numbers(write_run: WriteRun) -> None:
    rows = quick_rows(scenes=("street",), rigs=("t265",), poses=("exact",))
    ax = draw_bars(bar_chart(read_run(write_run(rows)), "distortion_native", "exact"), LOOKS).axes[0]
    assert ax.get_yscale() == "log"
    tops = [bar.get_y() + bar.get_height() for bar in ax.patches]
    assert tops == pytest.approx([row["distortion_native"] for row in rows])


def test_seeds_become_one_bar_with_their_range(write_run: WriteRun) -> None:
    values = {0: 0.2, 1: 0.3, 2: 0.7}
    rows = [make_row("street", "t265", "exact", "abraham", s, log_distortion=v) for s, v in values.items()]
    bar = bar_chart(read_run(write_run(rows)), "log_distortion", "exact").panels["t265"]["street"]["abraham"]
    assert (bar.mean, bar.least, bar.largest) == (pytest.approx(0.4), 0.2, 0.7)


def test_scatter_counts_what_it_cannot_show(write_run: WriteRun) -> None:
    rows = quick_rows(scenes=("street", "room"), rigs=("t265",), poses=("exact",))
    rows[2] = failed_row("street", "t265", "exact", "hartley")
    data = scatter(read_run(write_run(rows)), "coverage_solid_angle", ("log_distortion",))
    assert data.missing == {m: int(m == "hartley") for m in data.methods}
    assert len(data.panels[0]["hartley"]) == 1


def test_a_built_in_method_looks_the_same_whatever_runs_beside_it() -> None:
    alone = looks(["local-homography"])["local-homography"]
    assert looks(["mine", *METHODS, "yours"])["local-homography"] == alone


def test_a_method_that_joins_a_run_changes_the_look_of_no_other() -> None:
    before = looks([*METHODS, "mine", "yours"])
    assert looks([*METHODS, "mine", "yours", "a-third"]).items() >= before.items()


def test_more_methods_than_colours_are_still_told_apart() -> None:
    many = looks([f"method-{i}" for i in range(40)]).values()
    assert len({(look.colour, look.hatch) for look in many}) == 40
    assert len({(look.colour, look.marker) for look in many}) == 40
    assert len({look.colour for look in list(many)[:13]}) == 13
