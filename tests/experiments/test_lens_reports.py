"""Lenses without a scene as a part of a report: stated as a grid, refused what they lack, and cheap."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from pydantic import ValidationError

import rectbench as rb
from rectbench.experiments.planning import Plan, make_plan
from rectbench.experiments.selecting import Selection
from rectbench.runs.making import run
from rectbench.runs.run import read_run
from rectbench.store.store import Store
from tests.experiments.fakes import write_method, write_scene

LENSES: dict[str, Any] = {
    "name": "lenses",
    "rigs": ("t265", "sony-as200v"),
    "motions": ("as-calibrated", "rolled"),
    "poses": ("exact",),
    "methods": ("conventional", "abraham"),
    "metrics": ("geometry",),
}
PAIRS: dict[str, Any] = {
    "name": "pairs",
    "scenes": ("street", "room"),
    "rigs": ("t265",),
    "methods": ("abraham",),
    "metrics": ("row_error",),
}


def report(*groups: dict[str, Any], **fields: Any) -> rb.Report:
    given: dict[str, Any] = {"name": "parts", "title": "Parts", "image_width": 96, "figures": ("bars",)}
    groups = groups or (LENSES, PAIRS)
    return rb.Report(groups=[rb.Group(**group) for group in groups], **{**given, **fields})


def lenses(**fields: Any) -> rb.Report:
    return report({**LENSES, **fields})


def places(plan: Plan) -> set[tuple[str, str, str, str]]:
    return {(t.group, t.cell.scene, t.cell.rig, t.cell.motion) for t in plan.tasks}


def test_rigs_without_scenes_are_a_grid_of_lenses() -> None:
    plan = make_plan(report())
    assert places(plan) == {
        *(("lenses", "none", rig, motion) for rig in LENSES["rigs"] for motion in LENSES["motions"]),
        *(("pairs", scene, "t265", "as-calibrated") for scene in PAIRS["scenes"]),
    }
    assert len(plan.tasks) == 2 * 2 * 2 + 2
    assert plan.is_whole


def test_a_report_of_its_own_states_them_as_a_group_does() -> None:
    whole = rb.Report(title="Lenses", **{**LENSES, "motions": ("rolled",)})
    stated = rb.Report(
        title="Lenses",
        name="lenses",
        pairs=[("none", "t265", "rolled"), ("none", "sony-as200v", "rolled")],
        methods=LENSES["methods"],
        metrics=("geometry",),
    )
    assert make_plan(whole).tasks == make_plan(stated).tasks
    assert len(make_plan(whole).tasks) == 4


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        (
            {"metrics": ("reconstruction",)},
            "metric reconstruction needs the truth, which lenses without a scene have not",
        ),
        ({"metrics": ("row_error_features",)}, "metric row_error_features needs images, which lenses"),
        ({"poses": ("exact", "estimated")}, "pose estimated needs images, which lenses"),
        ({"poses": ("calibrated",)}, "unknown pose 'calibrated'"),
        ({"figures": ("pairs",)}, "figure pairs needs images, which lenses"),
        ({"methods": ("hartley",)}, "method hartley needs matches, .* none of images; expected true"),
        ({"methods": ("hartley",), "matches": ("images",)}, "method hartley needs matches"),
        ({"rigs": ("t256",)}, "unknown rig 't256'"),
        ({"motions": ("sidewards",)}, "unknown motion 'sidewards'"),
    ],
)
def test_what_they_have_not_is_refused_at_planning_in_a_line(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(rb.InvalidInput, match=message) as caught:
        make_plan(lenses(**fields))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"pairs": (("none", "t265", "rolled"),)}, "rigs stand beside the pairs of group 'lenses'"),
        ({"rigs": ()}, "group 'lenses' has no pairs"),
        (
            {"rigs": (), "motions": None, "pairs": (("none", "t265", "rolled"), ("room", "t265", "rolled"))},
            "pairs with and without a scene stand together",
        ),
        ({"matches": ("truth",)}, "matches are 'truth'; expected images, true, or true"),
    ],
)
def test_a_group_states_its_pairs_in_one_way(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        lenses(**fields)


def test_a_method_that_needs_images_is_the_reports_slip_but_a_runs_own_one_joins_where_it_can(
    tmp_path: Path,
) -> None:
    path = Path(write_method(tmp_path, "sees"))
    text = path.read_text()
    path.write_text(text.replace('name = "sees"', 'name = "sees"\n    needs = frozenset({"images"})'))
    with pytest.raises(rb.InvalidInput, match="method sees needs images, which lenses"):
        make_plan(lenses(methods=(str(path),)))
    plan = make_plan(report(), Selection(methods=[f"+{path}"]))
    assert {t.group for t in plan.tasks if t.cell.method == "sees"} == {"pairs"}
    plan = make_plan(report(), Selection(methods=["+hartley"]))
    assert {t.group for t in plan.tasks if t.cell.method == "hartley"} == {"pairs"}


def test_usual_figures_are_those_that_need_no_images() -> None:
    plan = make_plan(report({**LENSES, "figures": None}, figures=None))
    assert not any(pair.demands for pair in plan.pairs)


def test_rigs_of_ones_own_join_and_scenes_do_not_apply(tmp_path: Path) -> None:
    mine = tmp_path / "mine.yaml"
    rb.load_rig("tumvi").save(mine)

    def rigs(*names: str) -> set[tuple[str, str]]:
        return {place[0::2][:2] for place in places(make_plan(report(), Selection(rigs=names)))}

    assert rigs(str(mine)) == {("lenses", "tumvi"), ("pairs", "tumvi")}
    assert rigs(f"+{mine}") == {
        *(("lenses", rig) for rig in ("t265", "sony-as200v", "tumvi")),
        *(("pairs", rig) for rig in ("t265", "tumvi")),
    }
    # Only lenses have it in this report: in the place of the rendered rigs it is as foreign as any other.
    assert rigs("sony-as200v") == {("lenses", "sony-as200v"), ("pairs", "sony-as200v")}
    by_scene = make_plan(report(), Selection(scenes=["street"]))
    assert {place for place in places(by_scene) if place[0] == "lenses"} == {
        place for place in places(make_plan(report())) if place[0] == "lenses"
    }
    assert {place[1] for place in places(by_scene)} == {"none", "street"}


def test_a_rig_that_rendered_parts_name_runs_in_no_part_that_lacks_it() -> None:
    perspective = {**PAIRS, "rigs": ("perspective-shifted",)}
    plan = make_plan(report(LENSES, perspective), Selection(rigs=["perspective-shifted"]))
    assert {place[0] for place in places(plan)} == {"pairs"}


def test_the_scene_none_selects_lenses_alone() -> None:
    plan = make_plan(report(), Selection(scenes=["none"]))
    assert {place[0] for place in places(plan)} == {"lenses"}
    assert not plan.is_whole


def test_scenes_cannot_be_selected_where_there_are_none() -> None:
    with pytest.raises(
        rb.InvalidInput, match="report parts is of lenses without a scene; expected no scenes"
    ):
        make_plan(lenses(), Selection(scenes=["street"]))


def test_a_scene_may_not_be_called_none(tmp_path: Path) -> None:
    wall = write_scene(tmp_path, "none")
    with pytest.raises(rb.InvalidInput, match="scene none stands for no scene"):
        make_plan(report({**PAIRS, "scenes": (wall,)}))


def seeds(plan: Plan, pose: str, method: str = "abraham") -> list[int]:
    return [
        t.cell.seed
        for t in plan.tasks
        if (t.cell.pose, t.cell.method, t.cell.rig, t.cell.motion) == (pose, method, "t265", "rolled")
    ]


def test_cells_are_repeated_for_seeds_only_where_these_draw_something() -> None:
    some = lenses(
        poses=("exact", "perturbed"),
        methods=("abraham", "hartley"),
        matches=("true", "true + 0.1 px"),
        seeds=(4, 5),
    )
    plan = make_plan(some)
    assert seeds(plan, "exact") == [0]
    assert seeds(plan, "perturbed") == [4, 5]
    assert sorted(seeds(plan, "exact", "hartley")) == [0, 4, 5]  # exact matches once, noisy ones twice
    selected = make_plan(some, Selection(seeds=[5]))
    assert {task.cell for task in selected.tasks} < {task.cell for task in plan.tasks}
    assert seeds(selected, "exact") == [0]


@pytest.fixture(scope="module")
def parts(tmp_path_factory: pytest.TempPathFactory) -> rb.Report:
    wall = write_scene(tmp_path_factory.mktemp("scenes"), "wall")
    return report(
        {
            **LENSES,
            "poses": ("exact", "perturbed"),
            "methods": ("abraham", "hartley"),
            "matches": ("true + 0.1 px",),
            "metrics": ("log_distortion",),
        },
        {**PAIRS, "scenes": (wall,)},
        seeds=(0, 1),
        quality="fast",
        spp=4,
    )


def test_nothing_is_rendered_for_them_and_the_rows_say_there_is_no_scene(
    parts: rb.Report, store: Store, tmp_path: Path
) -> None:
    table = run(parts, tmp_path / "run", Selection(scenes=["none"]), jobs=2)
    assert (table["status"] == "ok").all()
    assert (table["scene"] == "none").all()
    assert {path.name for path in store.root.iterdir()} == {"cells"}
    assert table["log_distortion"].between(0.05, 2).all()
    assert set(table["matches"]) == {"", "true + 0.1 px"}
    results = read_run(tmp_path / "run").results
    assert {r.method for r in results} == {"abraham", "hartley (true matches + 0.1 px)"}


def test_the_rows_are_the_same_for_any_selection_and_number_of_jobs(parts: rb.Report, tmp_path: Path) -> None:
    whole = run(parts, tmp_path / "whole", jobs=2)
    assert (whole["status"] == "ok").all()
    identity = [*whole.columns[:9]]
    for number, chosen in enumerate(
        (
            Selection(seeds=[1]),
            Selection(rigs=["sony-as200v"], scenes=["none"]),
            Selection(methods=["hartley"]),
        )
    ):
        some = run(parts, tmp_path / f"some{number}", chosen, jobs=1, fresh=True)
        assert 0 < len(some) < len(whole)
        expected = some[identity].merge(whole, on=identity, how="left")
        pd.testing.assert_frame_equal(some, expected[some.columns], check_exact=True)
