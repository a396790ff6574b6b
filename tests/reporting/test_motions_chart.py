from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from rectbench.plugins.figure import FigureData
from rectbench.reporting.charts.motions import Motions
from rectbench.reporting.style import LOST, looks
from rectbench.runs.run import read_run
from tests.reporting.runs import failed_row, fake_sources, make_row

WriteRun = Callable[..., Path]
MOTIONS = ("sideways", "vertical", "forward")
METHODS = ("conventional", "abraham")


def row(rig: str, motion: str, method: str, kept: float, distortion: float, **more: Any) -> dict[str, Any]:
    measured = {"coverage_pixels": kept, "log_distortion_95": distortion}
    return make_row("none", rig, "exact", method, motion=motion, **measured, **more)


def rows() -> list[dict[str, Any]]:
    kept = {"conventional": (0.5, math.nan), "abraham": (0.98, 0.3)}
    return [row(rig, m, method, *kept[method]) for rig in ("a", "b") for m in MOTIONS for method in METHODS]


def drawn(folder: Path) -> Figure:
    run = read_run(folder)
    (drawing,) = Motions().drawings(FigureData(run, run, fake_sources(), looks(run.methods)))
    return drawing.draw()


def discs(figure: Figure, panel: int) -> dict[tuple[float, float], Circle]:
    """Those within the rings, which are drawn first."""
    circles = [patch for patch in figure.axes[panel].patches if isinstance(patch, Circle)]
    return {circle.center: circle for circle in circles}


def test_each_lens_is_a_panel_of_methods_and_motions(write_run: WriteRun) -> None:
    figure = drawn(write_run(rows()))
    assert [ax.get_title() for ax in figure.axes[:2]] == ["a", "b"]
    assert [label.get_text() for label in figure.axes[0].get_xticklabels()] == list(MOTIONS)
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == list(METHODS)
    assert len(discs(figure, 0)) == len(MOTIONS) * len(METHODS)


def test_the_area_of_a_disc_is_the_share_of_the_lens_that_is_kept(write_run: WriteRun) -> None:
    found = discs(drawn(write_run(rows())), 0)
    assert (found[0, 0].radius / found[0, 1].radius) ** 2 == pytest.approx(0.5 / 0.98)


def test_a_disc_is_grey_where_its_method_does_not_keep_the_view(write_run: WriteRun) -> None:
    found = discs(drawn(write_run(rows())), 0)
    assert found[0, 0].get_facecolor() == to_rgba(LOST)
    assert found[0, 1].get_facecolor() != to_rgba(LOST)


def test_the_least_distortion_of_a_column_is_framed(write_run: WriteRun) -> None:
    more = [*rows(), *(row("a", motion, "better", 1.0, 0.2) for motion in MOTIONS)]
    figure = drawn(write_run(more))
    frames = [patch.xy for patch in figure.axes[0].patches if isinstance(patch, Rectangle)]
    assert frames == [(column - 0.5, 1.5) for column in range(len(MOTIONS))]


def test_what_is_not_served_is_a_cross_and_no_disc(write_run: WriteRun) -> None:
    given = rows()
    failed = failed_row("none", "a", "exact", "conventional", status="unsupported")
    given[0] = failed | {"motion": "sideways"}
    figure = drawn(write_run(given))
    assert (0, 0) not in discs(figure, 0)
    (cross,) = figure.axes[0].lines
    assert (cross.get_xdata()[0], cross.get_ydata()[0]) == (0, 0)


def test_there_is_no_chart_of_two_motions(write_run: WriteRun) -> None:
    run = read_run(write_run([one for one in rows() if one["motion"] != "forward"]))
    assert not list(Motions().drawings(FigureData(run, run, fake_sources(), looks(run.methods))))
