"""Methods that work from matches get those of the images, and true ones only as a level of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from pydantic import ValidationError

import rectbench as rb
from rectbench.experiments.execution.cells import cell_inputs, problem_of
from rectbench.experiments.planning import make_plan
from rectbench.experiments.tasks import CellTask
from rectbench.pairs.opening import open_pair
from rectbench.runs.comparing import compare
from rectbench.runs.gating import accept, gate
from rectbench.runs.making import run
from rectbench.runs.run import read_run
from rectbench.store.keys import digest
from rectbench.store.store import STORE_VARIABLE, Store
from tests.experiments.fakes import small_report, write_report_file, write_scene

LEVELS = ("images", "true + 0.1 px")
TILES = "np.random.default_rng(seed).uniform(0.1, 0.9, (64, 64, 3))"


def tasks(**fields: Any) -> tuple[CellTask, ...]:
    return make_plan(small_report(**fields)).tasks


def test_each_level_is_a_row_of_the_methods_that_need_matches_and_of_no_other() -> None:
    cells = [task.cell for task in tasks(methods=("abraham", "hartley"), matches=LEVELS)]
    assert [(cell.method, cell.matches) for cell in cells] == [
        ("abraham", ""),
        ("hartley", "images"),
        ("hartley", "true + 0.1 px"),
    ]
    assert [task.cell.matches for task in tasks(methods=("hartley",))] == ["images"]


def test_matches_of_the_images_are_those_of_the_pose_that_these_tell_under_any_pose(
    tmp_path: Path, store: Store
) -> None:
    wall = write_scene(tmp_path, "wall")
    fields: dict[str, Any] = {"scenes": (wall,), "motions": ("sideways",), "image_width": 320}
    poses = ("exact", "perturbed", "estimated")
    for task in tasks(methods=("hartley",), poses=poses, **fields):
        pair = open_pair(task.pair, store)
        found = problem_of(task, pair).known_matches
        assert found is not None
        np.testing.assert_array_equal(found.left, pair.estimate.inliers.left)


def test_true_matches_are_true_up_to_their_noise_under_an_estimated_pose_too(
    tmp_path: Path, store: Store
) -> None:
    wall = write_scene(tmp_path, "wall")
    fields: dict[str, Any] = {"scenes": (wall,), "motions": ("sideways",), "image_width": 320}
    exact, noisy = (
        problem_of(task, open_pair(task.pair, store)).known_matches
        for task in tasks(
            methods=("hartley",), poses=("estimated",), matches=("true", "true + 0.5 px"), **fields
        )
    )
    assert exact is not None
    assert noisy is not None
    assert len(exact.left) == 1000
    assert (noisy.left - exact.left).std() == pytest.approx(0.5, rel=0.1)


def key(**fields: Any) -> str:
    (task,) = tasks(**fields)
    return digest(cell_inputs(task, open_pair(task.pair, Store.default())))


def test_a_level_shapes_the_key_of_those_cells_alone_that_it_is_given_to() -> None:
    levels: list[dict[str, Any]] = [
        {"matches": ("images",)},
        {"matches": ("images",), "spp": 8},
        {"matches": ("true",)},
        {"matches": ("true + 0.1 px",)},
        {"matches": ("true",), "match_count": 999},
    ]
    keys = [key(methods=("hartley",), **level) for level in levels]
    assert len(set(keys)) == len(keys)
    assert key(methods=("hartley",), match_count=999) == keys[0]
    assert key(methods=("hartley",), matches=("true",), spp=8) == keys[2]  # the truth has no samples
    assert len({key(methods=("abraham",), **level) for level in levels}) == 1


@pytest.fixture(scope="module")
def run_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run on a wall of tiles, and on one without any texture."""
    folder = tmp_path_factory.mktemp("levels")
    scenes = (write_scene(folder, "wall"), write_scene(folder, "blank"))
    blank = Path(scenes[1])
    blank.write_text(blank.read_text().replace(TILES, "np.full((64, 64, 3), 0.5)"))
    report = small_report(
        scenes=scenes,
        motions=("sideways",),
        methods=("abraham", "hartley"),
        matches=LEVELS,
        metrics=("log_distortion",),
        image_width=320,
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(STORE_VARIABLE, str(folder / "store"))
        run(report, folder / "run", jobs=2)
    return folder / "run"


def test_where_images_tell_no_pose_the_cell_says_why(run_dir: Path) -> None:
    table = read_run(run_dir).table
    blank = table[table["scene"] == "blank"].set_index("matches")
    assert blank.loc["images", "status"] == "unsupported"
    assert "matches" in blank.loc["images", "reason"]
    assert (blank.loc[["", "true + 0.1 px"], "status"] == "ok").all()
    assert (table.loc[table["scene"] == "wall", "status"] == "ok").all()


def test_true_matches_stand_in_no_column_unmarked(run_dir: Path, tmp_path: Path) -> None:
    run = read_run(run_dir)
    assert run.methods == ("abraham", "hartley", "hartley (true matches + 0.1 px)")
    assert {r.cell.matches for r in run.results if r.method == "hartley"} == {"images"}
    compared = compare(run_dir, run_dir)
    assert set(compared.table["method"]) == set(run.methods)
    accepted = tmp_path / "accepted.csv"
    assert accept(run_dir, accepted) == len(run.results) == 6
    assert gate(run_dir, accepted).exit_code == 0
    worse = pd.read_csv(accepted)
    worse.loc[worse["matches"] == "true + 0.1 px", "log_distortion"] = 1e-3
    worse.to_csv(accepted, index=False)
    lines = gate(run_dir, accepted).regressions
    assert len(lines) == 2
    assert all(line.startswith("hartley (true matches + 0.1 px) on ") for line in lines)


def test_accepted_numbers_of_before_there_were_levels_say_what_to_do(run_dir: Path, tmp_path: Path) -> None:
    accepted = tmp_path / "accepted.csv"
    accept(run_dir, accepted)
    pd.read_csv(accepted).drop(columns="matches").to_csv(accepted, index=False)
    with pytest.raises(
        rb.InvalidInput, match="lacks the column matches; `rectbench gate RUN --accept` makes"
    ):
        gate(run_dir, accepted)


def test_a_report_that_states_noise_as_before_is_told_the_level_to_write(tmp_path: Path) -> None:
    path = write_report_file(tmp_path, match_noise_px=0.1)
    expected = "match_noise_px is no field of a report; expected matches=('true + 0.1 px',) instead"
    with pytest.raises(rb.InvalidInput) as caught:
        rb.run(path, tmp_path / "run")
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


def test_photographs_have_no_true_matches() -> None:
    with pytest.raises(ValidationError, match="matches of photographs are true; expected images"):
        rb.Report(
            name="p",
            title="P",
            photographs=True,
            poses=("calibrated",),
            methods=("abraham",),
            matches=["true"],
        )
