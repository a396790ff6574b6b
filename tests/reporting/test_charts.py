from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from matplotlib import rc_context
from matplotlib.figure import Figure

from rectbench.plugins.figure import FigureData
from rectbench.reporting.charts.bars import Bars, bar_chart
from rectbench.reporting.charts.coverage_curve import DistortionCoverage, alike
from rectbench.reporting.charts.grouped_bars import BarChart, draw_bars
from rectbench.reporting.curves import rig_curves
from rectbench.reporting.style import STYLE, looks
from rectbench.runs.run import read_run
from tests.reporting.runs import METHODS, failed_row, fake_sources, make_row, quick_rows

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


def drawn_curves(folder: Path) -> Figure:
    run = read_run(folder)
    given = FigureData(run, run, fake_sources(), looks(run.methods))
    (drawing,) = DistortionCoverage().drawings(given)
    return drawing.draw()


def test_each_rig_has_a_panel_on_common_axes(write_run: WriteRun) -> None:
    rigs = tuple(f"rig-{i}" for i in range(10))
    figure = drawn_curves(write_run([make_row("none", rig, "exact", m) for rig in rigs for m in METHODS]))
    panels = [ax for ax in figure.axes if ax.axison]
    assert [ax.get_title() for ax in panels] == list(rigs)
    assert len({ax.get_ylim() for ax in panels}) == len({ax.get_xlim() for ax in panels}) == 1


def test_a_curve_shows_the_numbers_and_ends_where_its_method_keeps_no_more(write_run: WriteRun) -> None:
    row = make_row("none", "t265", "exact", "conventional", view_kept=0.61)
    (ax,) = drawn_curves(write_run([row, make_row("none", "t265", "exact", "abraham")])).axes
    conventional, abraham = (line for line in ax.lines if len(line.get_xdata()) > 2)
    assert list(conventional.get_xdata()) == [10, 20, 30, 40, 50, 60]
    assert list(abraham.get_xdata())[-1] == 100
    assert conventional.get_ydata()[-1] == pytest.approx(row["log_distortion_60"])


def test_curves_that_lie_on_one_another_take_turns_in_dashes(write_run: WriteRun) -> None:
    rows = [make_row("none", "t265", "exact", m) for m in ("conventional", "abraham")]
    twin = rows[0] | {"method": "fusiello"} | {k: 1.03 * v for k, v in rows[0].items() if "log_dist" in k}
    run = read_run(write_run([*rows, twin]))
    assert alike(rig_curves(run)[0]) == [["conventional", "fusiello"], ["abraham"]]
    (ax,) = drawn_curves(write_run([*rows, twin])).axes
    styles = {line.get_color(): line.get_linestyle() for line in ax.lines if len(line.get_xdata()) > 2}
    assert styles == {
        run_looks.colour: "--" if method != "abraham" else "-"
        for method, run_looks in looks(run.methods).items()
    }


def test_row_errors_are_compared_on_the_same_matches_and_a_gap_is_no_failure(write_run: WriteRun) -> None:
    run = read_run(write_run([r | {"group": "pairs"} for r in quick_rows(poses=("perturbed",))], spec=PAIRS))
    part = run.part("pairs")
    drawings = list(Bars().drawings(FigureData(part, run, fake_sources(), looks(run.methods))))
    (drawing,) = (one for one in drawings if one.stem == "row-error")
    chart = drawing.made_from
    assert isinstance(chart, BarChart)
    assert list(chart.panels) == [f"of true correspondences in {share} % of the view" for share in (50, 95)]
    bar = chart.panels["of true correspondences in 95 % of the view"]["street\nt265"]["conventional"]
    assert (bar.mean, bar.failure) == (None, "")
    assert "no bar" in drawing.caption


PAIRS = {"groups": [{"name": "pairs", "title": "Pairs", "figures": []}]}


def test_the_view_of_a_share_stands_below_it_in_degrees(write_run: WriteRun) -> None:
    row = make_row("none", "t265", "exact", "abraham", view_50_deg=81.6, view_95_deg=151.0)
    (ax,) = drawn_curves(write_run([row])).axes
    assert [label.get_text() for label in ax.get_xticklabels()][1:] == ["50\n82°", "95\n151°"]


def test_a_method_without_a_curve_says_so_in_the_legend(write_run: WriteRun) -> None:
    rows = [make_row("none", "t265", "exact", "abraham"), failed_row("none", "t265", "exact", "hartley")]
    (legend,) = drawn_curves(write_run(rows)).legends
    assert [text.get_text() for text in legend.get_texts()] == ["abraham", "hartley (no curve)"]


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


def test_long_names_stay_within_the_page(write_run: WriteRun) -> None:
    options = [f'{{"law":"{law}"}}' for law in ("equidistant", "stereographic", "equisolid", "orthographic")]
    rows = [
        make_row("none", rig, "exact", "abraham", options=given) for rig in ("a", "b") for given in options
    ]
    with rc_context(fname=STYLE):
        figure = drawn_curves(write_run(rows))
        figure.draw_without_rendering()
    box = figure.legends[0].get_window_extent()
    assert box.x0 >= 0
    assert box.x1 <= figure.bbox.width


def test_what_a_chart_is_made_from_reads_the_same_in_every_process(write_run: WriteRun) -> None:
    run = read_run(write_run([r | {"group": "pairs"} for r in quick_rows()], spec=PAIRS))
    part = run.part("pairs")
    for drawing in Bars().drawings(FigureData(part, run, fake_sources(), looks(run.methods))):
        assert "set(" not in repr(drawing.made_from)
