from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

from rectbench.plugins.figure import FigureData
from rectbench.reporting.charts.survey import Survey
from rectbench.reporting.style import looks
from rectbench.reporting.survey import lens_classes, surveyed
from rectbench.reporting.tables.part_tables import all_tables
from rectbench.runs.run import Run, read_run
from tests.reporting.runs import fake_sources, make_row

WriteRun = Callable[..., Path]
VIEWS_DEG = {"tele": 40.0, "car": 80.0, "camera": 100.0, "fisheye": 150.0, "dome": 200.0}
METHODS = {"conventional": 0.4, "hartley": 0.5, "abraham": 0.2}


def row(rig: str, method: str, pose: str = "exact") -> dict[str, Any]:
    """The conventional method and Hartley's keep all of a view of up to 120°, half of a wider one."""
    view_deg = VIEWS_DEG[rig]
    keeps = method == "abraham" or view_deg < 120
    value = METHODS[method] * view_deg / 100 if keeps else math.nan
    measured = {"view_kept": 1.0 if keeps else 0.5, "log_distortion_95": value, "view_100_deg": view_deg}
    return make_row("none", rig, pose, method) | measured | {"row_error_source_median_px": 0.25}


@pytest.fixture
def run(write_run: WriteRun) -> Run:
    rows = [row(r, m, pose) for r in VIEWS_DEG for m in METHODS for pose in ("exact", "perturbed")]
    return read_run(write_run(rows, figures=("survey",)))


def drawn(run: Run) -> Figure:
    drawing, _ = Survey().drawings(FigureData(run, run, fake_sources(), looks(run.methods)))
    return drawing.draw()


def test_lenses_are_of_a_class_by_the_field_of_view_that_both_images_show(run: Run) -> None:
    assert {c.title: c.rigs for c in lens_classes(run)} == {
        "up to 60°": ("tele",),
        "60–110°": ("car", "camera"),
        "110–165°": ("fisheye",),
        "beyond 165°": ("dome",),
    }


def test_the_average_of_a_class_is_the_geometric_mean_over_its_rigs(run: Run) -> None:
    found = {one.method: one for one in surveyed(run, lens_classes(run), run.catalogue.ranking)}
    reached = found["abraham"].reached[1]
    assert reached is not None
    assert reached.average == pytest.approx(0.2 * math.sqrt(0.8 * 1.0))
    assert dict(reached.by_rig) == pytest.approx({"car": 0.16, "camera": 0.2})


def test_what_keeps_too_little_of_a_class_has_no_average_there_and_says_why(run: Run) -> None:
    found = {one.method: one for one in surveyed(run, lens_classes(run), run.catalogue.ranking)}
    reached = found["conventional"].reached[3]
    assert reached is not None
    assert (reached.average, reached.why) == (None, "keeps\u00a050\u00a0%")


def test_the_chart_has_a_panel_a_class_and_a_row_a_method_best_first(run: Run) -> None:
    figure = drawn(run)
    assert [ax.get_title() for ax in figure.axes] == [
        "up to 60°, 1 rig",
        "60–110°, 2 rigs",
        "110–165°, 1 rig",
        "beyond 165°, 1 rig",
    ]
    names = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert names[0] == "abraham"
    assert set(names) == set(METHODS)


def test_methods_that_work_from_matches_have_another_colour(run: Run) -> None:
    colours = {label.get_text(): label.get_color() for label in drawn(run).axes[0].get_yticklabels()}
    assert colours["abraham"] == colours["conventional"] != colours["hartley"]


def test_the_table_has_a_column_a_class_and_marks_the_best_of_each(run: Run) -> None:
    table = next(table for table in all_tables(run) if table.name == "survey")
    assert [heading.text for heading in table.headings[2:6]] == [
        "up to 60° (1)",
        "60–110° (2)",
        "110–165° (1)",
        "beyond 165° (1)",
    ]
    ranked, _ = table.sections
    best = {row[0].text: [entry.best for entry in row[2:6]] for row in ranked.rows}
    assert best["abraham"] == [True, True, False, False]  # alone on the widest: nobody was beaten
    assert best["conventional"] == [False] * 4


def test_the_table_shows_row_errors_under_the_noisy_pose(run: Run) -> None:
    table = next(table for table in all_tables(run) if table.name == "survey")
    place = [heading.key for heading in table.headings].index("row_error_source_median_px")
    assert {row[place].value for row in table.rows} == {0.25}


def test_what_crops_the_rim_is_compared_in_the_middle_of_the_view(run: Run) -> None:
    table = next(table for table in all_tables(run) if table.name == "survey")
    whole, middle = table.sections
    assert whole.title == "log distortion, 95 % of the view"
    assert middle.title == "log distortion, 50 % of the view"
    dome = {row[0].text: row[5].value for row in middle.rows}
    assert all(isinstance(value, float) for value in dome.values())


def test_the_excess_over_the_floor_comes_first_and_leaves_out_what_has_no_floor(write_run: WriteRun) -> None:
    floors = {"tele": 0.0, "car": 0.1, "camera": 0.1, "fisheye": 0.1, "dome": 0.1}
    rows = [
        row(rig, "abraham")
        | {"floor_log_distortion": floor}
        | ({"excess_over_floor": VIEWS_DEG[rig] / 100} if floor else {})
        for rig, floor in floors.items()
    ]
    run = read_run(write_run(rows, figures=("survey",)))
    excess = next(table for table in all_tables(run) if table.name == "survey").sections[0]
    assert excess.title == "excess over floor [%], 95 % of the view"
    assert [entry.best for entry in excess.rows[0][2:6]] == [False] * 4  # alone, nobody was beaten
    assert [entry.text for entry in excess.rows[0][2:6]] == ["–", "90.0", "150.0", "200.0"]


def test_a_part_that_does_not_ask_for_a_survey_has_none(write_run: WriteRun) -> None:
    run = read_run(write_run([row("tele", method) for method in METHODS], figures=("bars",)))
    assert "survey" not in {table.name for table in all_tables(run)}
