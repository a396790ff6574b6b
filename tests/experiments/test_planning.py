from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import rectbench as rb
from rectbench.experiments.execution.cells import cell_inputs
from rectbench.experiments.planning import find_report, make_plan
from rectbench.experiments.selecting import Selection
from rectbench.experiments.tasks import CellTask
from rectbench.pairs.opening import open_pair
from rectbench.store.keys import digest
from rectbench.store.store import Store
from tests.experiments.fakes import small_report, write_method, write_scene


def test_quick_is_all_fisheye_lenses_and_four_scenes_on_three_rigs_under_two_poses() -> None:
    plan = make_plan(find_report("quick"))
    by_group = {group: [t for t in plan.tasks if t.group == group] for group in ("lenses", "pairs")}
    assert len(by_group["lenses"]) == len(rb.fisheye_rigs()) * 2 * 5
    assert len(by_group["pairs"]) == 4 * 3 * 2 * 5
    assert len(plan.tasks) == sum(map(len, by_group.values()))
    assert len({task.pair for task in by_group["pairs"]}) == 12
    assert plan.is_whole
    first, second = plan.tasks[0].cell, plan.tasks[1].cell
    assert (first.scene, first.rig, first.pose) == (second.scene, second.rig, second.pose)


def test_a_task_survives_json() -> None:
    for task in make_plan(find_report("quick")).tasks[:7]:
        assert CellTask.model_validate(json.loads(json.dumps(task.model_dump(mode="json")))) == task


def test_a_selection_runs_in_the_place_of_the_reports_own_or_beside_it(tmp_path: Path) -> None:
    mine = write_method(tmp_path, "mine")
    report = small_report(methods=("abraham", "conventional"), seeds=(0, 1))

    def methods(*names: str) -> list[str]:
        plan = make_plan(report, Selection(methods=names))
        return list(dict.fromkeys(task.cell.method for task in plan.tasks))

    assert methods(mine) == ["mine"]
    assert methods(f"+{mine}") == ["abraham", "conventional", "mine"]
    assert methods("hartley", f"+{mine}") == ["hartley", "mine"]
    assert not make_plan(report, Selection(methods=["abraham"])).is_whole
    assert make_plan(report, Selection(methods=[f"+{mine}"])).is_whole
    assert not make_plan(report, Selection(seeds=[1])).is_whole


def test_option_sets_are_rows_of_their_own() -> None:
    report = small_report(
        methods=("conventional", "abraham"),
        options={"conventional": [{"focal": "fov"}, {"focal": "balance"}], "abraham": {"law": "equisolid"}},
    )
    cells = [task.cell for task in make_plan(report).tasks]
    assert [(cell.method, json.loads(cell.options)) for cell in cells] == [
        ("conventional", {"focal": "fov"}),
        ("conventional", {"focal": "balance"}),
        ("abraham", {"law": "equisolid"}),
    ]
    overlaid = make_plan(report, Selection(options={"abraham": {"focal_px": 100.0}})).tasks[-1]
    assert overlaid.options == {"law": "equisolid", "focal_px": 100.0}


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"scenes": ("strete",)}, "unknown scene 'strete'; did you mean street"),
        ({"rigs": ("t256",)}, "unknown rig 't256'; did you mean t265"),
        ({"methods": ("abrahm",)}, "unknown method 'abrahm'; did you mean abraham"),
        ({"motions": ("sidewards",)}, "unknown motion 'sidewards'; did you mean sideways"),
        ({"poses": ("exakt",)}, "unknown pose 'exakt'; did you mean exact"),
        ({"seeds": (-1,)}, "seed is -1; expected a whole number"),
        ({"options": {"abrahm": {}}}, "unknown method 'abrahm'"),
        ({"options": {"abraham": {"lew": 1}}}, "unknown option of abraham 'lew'; did you mean law"),
        (
            {"options": {"abraham": {"focal_px": -1}}},
            "abraham: option focal_px is -1; expected greater than 0",
        ),
        ({"options": {"abraham": {"law": "none"}}}, "abraham: option law is 'none'; expected 'equidistant'"),
    ],
)
def test_what_does_not_exist_is_said_before_anything_runs(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(rb.InvalidInput, match=message) as caught:
        make_plan(small_report(**fields))
    assert "\n" not in str(caught.value)


def test_two_files_of_one_method_name_clash(tmp_path: Path) -> None:
    first, second = write_method(tmp_path / "a", "mine"), write_method(tmp_path / "b", "mine")
    with pytest.raises(rb.InvalidInput, match="two methods are called 'mine'") as caught:
        make_plan(small_report(methods=(first, second)))
    assert first in str(caught.value)
    assert second in str(caught.value)


def test_two_files_of_one_rig_name_clash(tmp_path: Path) -> None:
    for folder, factor in (("a", 1.0), ("b", 0.5)):
        (tmp_path / folder).mkdir()
        rb.load_rig("t265").scaled(factor).save(tmp_path / folder / "rig.yaml")
    with pytest.raises(rb.InvalidInput, match="two rigs are called 't265'"):
        make_plan(small_report(rigs=(str(tmp_path / "a/rig.yaml"), str(tmp_path / "b/rig.yaml"))))


def test_the_true_rig_is_scaled_and_moved() -> None:
    task = make_plan(small_report(motions=("sideways",), image_width=200)).tasks[0]
    rig = open_pair(task.pair, Store.default()).rig
    assert rig.left.width == rig.right.width == 200
    assert rig.baseline_m == pytest.approx(rb.load_rig("t265").baseline_m)
    other = make_plan(small_report(motions=("sideways",), image_width=200, seeds=(1,))).tasks[0]
    assert (open_pair(other.pair, Store.default()).rig.R_right_left != rig.R_right_left).any()


def _key(**fields: Any) -> str:
    task = make_plan(small_report(**fields)).tasks[0]
    return digest(cell_inputs(task, open_pair(task.pair, Store.default())))


def test_all_that_shapes_a_cell_shapes_its_key(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    wall, mine = write_scene(tmp_path, "wall"), write_method(tmp_path, "mine")
    base: dict[str, Any] = {"scenes": (wall,), "methods": (mine,), "metrics": ("geometry", "row_error")}
    variants: list[dict[str, Any]] = [
        {"scenes": ("street",)},
        {"rigs": ("sony-as200v",)},
        {"motions": ("rolled",)},
        {"poses": ("perturbed",)},
        {"methods": ("abraham",)},
        {"seeds": (1,)},
        {"image_width": 97},
        {"options": {"mine": {"scale": 0.5}}},
        {"metrics": ("geometry",)},
        {"metrics": ("distortion",)},
        {"metrics": ("distortion", "timing")},
    ]
    keys = [_key(**{**base, **variant}) for variant in ({}, *variants)]
    write_scene(tmp_path, "wall", "x = 1")
    keys.append(_key(**base))
    write_scene(tmp_path, "wall")
    write_method(tmp_path, "mine", "x = 1")
    keys.append(_key(**base))
    write_method(tmp_path, "mine")
    for part in ("pairs.rendering", "experiments.execution.cells"):
        with monkeypatch.context() as patch:
            patch.setattr(f"rectbench.{part}.code_digest", lambda *_: "edited")
            keys.append(_key(**base))
        with monkeypatch.context() as patch:
            patch.setattr(f"rectbench.{part}.versions", lambda *_: {"numpy": "1.0"})
            keys.append(_key(**base))
    assert len(set(keys)) == len(keys)
    assert _key(**base) == keys[0]


def test_what_shapes_no_row_shapes_no_key() -> None:
    assert _key() == _key(
        name="other", title="Other", timeout_s=5.0, memory_gib=1.0, figures=("coverage-curve",)
    )
    # Images are rendered with samples, but these metrics do not look at images.
    assert _key(metrics=("geometry", "row_error")) == _key(metrics=("row_error", "geometry"), spp=8)
    assert _key(metrics=("row_error_features",)) != _key(metrics=("row_error_features",), spp=8)


def test_default_options_said_aloud_find_the_same_row() -> None:
    assert _key(options={"abraham": {"law": "equidistant"}}) == _key()


def test_images_hang_on_samples_and_the_truth_does_not() -> None:
    (few,), (many,) = (make_plan(small_report(spp=spp)).pairs for spp in (4, 8))
    first, second = (open_pair(spec, Store.default()) for spec in (few, many))
    assert digest(first.inputs) == digest(second.inputs)
    assert digest(first.image_inputs) != digest(second.image_inputs)


def test_an_edited_rig_file_changes_the_key(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    rb.load_rig("t265").save(path)
    first = _key(rigs=(str(path),))
    rb.load_rig("t265").scaled(0.999).save(path)
    assert _key(rigs=(str(path),)) != first


def test_only_what_is_asked_for_is_rendered() -> None:
    def pair(**fields: Any) -> tuple[bool, bool]:
        (task,) = make_plan(small_report(**fields)).pairs
        return task.truth, task.images

    assert pair() == (False, False)
    assert pair(metrics=("geometry", "row_error")) == (True, False)
    assert pair(methods=("hartley",)) == (False, True)
    assert pair(methods=("hartley",), matches=("true + 0.1 px",)) == (True, False)
    assert pair(methods=("hartley",), matches=("images", "true")) == (True, True)
    assert pair(figures=("pairs",)) == (False, True)
    assert pair(figures=None) == (False, True)
    assert pair(metrics=("row_error_features",)) == (False, True)
