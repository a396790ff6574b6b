"""A report in parts: each has its own pairs and methods, and a selection reaches the parts it names."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

import rectbench as rb
from rectbench.experiments.planning import Plan, make_plan
from rectbench.experiments.selecting import Selection
from rectbench.metrics.scoring import metrics_of
from rectbench.runs.making import run
from tests.experiments.fakes import write_method, write_scene

FISHEYE = rb.Group(
    name="fisheye",
    pairs=(("street", "t265", "sideways"), ("room", "sony-as200v", "sideways")),
    methods=("conventional", "abraham"),
)
PERSPECTIVE = rb.Group(
    name="perspective",
    pairs=(("room", "perspective-shifted", "as-calibrated"),),
    methods=("hartley", "abraham"),
    seeds=(0,),
    metrics=("distortion",),
)
STARTS = rb.Group(
    name="starts",
    pairs=(("street", "t265", "sideways"),),
    methods=("local-homography",),
    options={"local-homography": [{"start": "random", "draw": draw} for draw in (0, 1)]},
    is_open=False,
)


def report(*groups: rb.Group, **fields: Any) -> rb.Report:
    given: dict[str, Any] = {"name": "parts", "title": "Parts", "seeds": (0, 1), "figures": ("bars",)}
    return rb.Report(groups=groups or (FISHEYE, PERSPECTIVE, STARTS), **{**given, **fields})


def cells(plan: Plan) -> list[tuple[str, ...]]:
    return [(t.group, t.cell.scene, t.cell.rig, t.cell.method, str(t.cell.seed)) for t in plan.tasks]


def test_each_part_runs_its_own_methods_on_its_own_pairs() -> None:
    plan = make_plan(report())
    assert len(plan.tasks) == 2 * 2 * 2 + 1 * 2 * 1 + 1 * 2 * 2
    assert ("fisheye", "street", "t265", "conventional", "1") in cells(plan)
    assert ("perspective", "room", "perspective-shifted", "hartley", "0") in cells(plan)
    assert not any(c[0] == "fisheye" and c[3] == "hartley" for c in cells(plan))
    assert plan.is_whole
    metrics = {task.group: task.metrics for task in plan.tasks}
    assert metrics["perspective"] == ("distortion",)
    assert metrics["fisheye"] == tuple(metrics_of(report().metrics))


def test_parts_on_one_pair_share_one_task_for_it() -> None:
    plan = make_plan(report())
    assert len(plan.pairs) == 2 * 2 + 1
    shared = {t.pair for t in plan.tasks if (t.cell.scene, t.cell.seed) == ("street", 0)}
    assert len(shared) == 1
    assert next(iter(shared)).truth  # the fisheye part asks for it, the starts do not


def test_a_selected_name_runs_in_the_parts_it_belongs_to() -> None:
    only = make_plan(report(), Selection(methods=["hartley"]))
    assert {c[0] for c in cells(only)} == {"perspective"}
    only = make_plan(report(), Selection(rigs=["t265"]))
    assert {c[0] for c in cells(only)} == {"fisheye", "starts"}
    only = make_plan(report(), Selection(seeds=[1]))
    assert {c[0] for c in cells(only)} == {"fisheye", "starts"}
    with pytest.raises(rb.InvalidInput, match="no cell of report parts is selected"):
        make_plan(report(), Selection(methods=["hartley"], rigs=["t265"]))


def test_a_method_of_ones_own_joins_every_open_part(tmp_path: Path) -> None:
    mine = write_method(tmp_path, "mine")
    plan = make_plan(report(), Selection(methods=[f"+{mine}"]))
    assert {c[0] for c in cells(plan) if c[3] == "mine"} == {"fisheye", "perspective"}
    assert plan.is_whole


def test_one_cell_stands_in_one_part() -> None:
    twin = FISHEYE.model_copy(update={"name": "twin"})
    with pytest.raises(rb.InvalidInput, match=r"conventional on street, t265 stands in two groups, fisheye"):
        make_plan(report(FISHEYE, twin))


def test_pairs_that_are_stated_are_a_grid_with_holes() -> None:
    given: dict[str, Any] = {"name": "pairs", "title": "Pairs", "methods": ("abraham",), "figures": ("bars",)}
    stated = make_plan(rb.Report(**given, pairs=FISHEYE.pairs))
    assert [pair.rig for pair in stated.pairs] == ["t265", "sony-as200v"]
    assert (stated.tasks[0].group, stated.is_whole) == ("", True)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"scenes": ("street",)}, "scenes stand beside groups"),
        ({"pairs": FISHEYE.pairs}, "pairs stand beside groups"),
        ({"groups": (FISHEYE, FISHEYE)}, "expected a name each"),
        ({"groups": (), "pairs": FISHEYE.pairs}, "methods are missing"),
        (
            {"groups": (), "pairs": FISHEYE.pairs, "methods": ("abraham",), "rigs": ("t265",)},
            "rigs stand beside pairs",
        ),
        ({"groups": ()}, "rigs are missing"),
    ],
)
def test_a_report_is_one_grid_or_groups(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        rb.Report(**{"name": "parts", "title": "Parts", "groups": (FISHEYE,), **fields})


def test_rows_name_their_part_and_cells_may_run_alone(tmp_path: Path) -> None:
    wall = write_scene(tmp_path, "wall")
    parts = [
        rb.Group(
            name=name,
            pairs=((wall, "t265", "as-calibrated"),),
            methods=(method,),
            metrics=metrics,
            alone=name == "timing",
        )
        for name, method, metrics in (
            ("geometry", "abraham", ("distortion",)),
            ("timing", "conventional", ("timing",)),
        )
    ]
    table = run(report(*parts, seeds=(0,), image_width=96, spp=4, quality="fast"), tmp_path / "out")
    assert table[["group", "method", "status"]].to_numpy().tolist() == [
        ["geometry", "abraham", "ok"],
        ["timing", "conventional", "ok"],
    ]
    assert table["distortion_native"].notna().tolist() == [True, False]
    assert table["fit_s"].notna().tolist() == [False, True]
