"""A report of photographs: what is wrong with a calibration is measured, from folder to page."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pandas as pd
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

import rectbench as rb
from rectbench.experiments.planning import make_plan
from rectbench.experiments.selecting import Selection
from rectbench.experiments.tasks import CellTask
from rectbench.reporting.report import write_report
from rectbench.runs.gating import accept, gate
from rectbench.runs.making import run
from rectbench.store.store import STORE_VARIABLE
from tests.conftest import Shell
from tests.matching.flat_board import chessboard, seen_board
from tests.matching.sphere_room import sphere_pair
from tests.rigs_for_tests import rig

TRUE = rig("kannala-brandt", size=(480, 320), fov_deg=130)
TILT_DEG = 0.5
REPORT = rb.Report(
    name="photos",
    title="Photographs",
    photographs=True,
    poses=("calibrated", "estimated"),
    methods=("abraham", "hartley"),
    metrics=("geometry", "row_error_features", "row_error_board"),
    figures=("bars", "pairs"),
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A room with a board in it, seen by the true rig, beside a calibration tilted by half a degree."""
    place = tmp_path_factory.mktemp("photos")
    tilt = Rotation.from_euler("x", TILT_DEG, degrees=True).as_matrix()
    tilted = replace(TRUE, R_right_left=tilt @ TRUE.R_right_left, t_right_left=tilt @ TRUE.t_right_left)
    room = sphere_pair(TRUE)
    seen = seen_board(TRUE, chessboard(7, 6), width_m=0.4, distance_m=0.5, before=room)
    for name, calibrated in (("true", TRUE), ("tilted", tilted)):
        (place / name).mkdir()
        calibrated.save(place / name / "rig.yaml")
        for side, image in (("left", seen.left), ("right", seen.right)):
            cv2.imwrite(str(place / name / f"room_{side}.png"), image)
    small = place / "true/small"
    for side in ("left", "right"):
        small.mkdir(exist_ok=True)
        cv2.imwrite(str(small / f"thumb_{side}.png"), seen.left[::2, ::2])
    return place


@pytest.fixture(scope="module")
def table(folder: Path) -> pd.DataFrame:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(STORE_VARIABLE, str(folder.parent / "store-of-photos"))
        return rb.run(REPORT, folder.parent / "run-of-photos", data=folder, jobs=2)


@pytest.fixture
def run_dir(folder: Path, table: pd.DataFrame, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(STORE_VARIABLE, str(folder.parent / "store-of-photos"))
    return folder.parent / "run-of-photos"


def column(table: pd.DataFrame, name: str, **wanted: str) -> np.ndarray:
    rows = table[(table.scene == "room") & (table.method != "hartley")]
    for key, value in wanted.items():
        rows = rows[rows[key] == value]
    return rows[name].to_numpy()


def test_a_tilted_calibration_shows_in_board_and_features_alike(table: pd.DataFrame) -> None:
    expected = np.radians(TILT_DEG) * float(rb.centre_resolution_px(TRUE))
    board = column(table, "row_error_board_source_mean_px", rig="tilted", pose="calibrated")
    features = column(table, "row_error_features_median_px", rig="tilted", pose="calibrated")
    assert board == pytest.approx(expected, rel=0.15)
    assert features == pytest.approx(expected, rel=0.3)  # pixels of the output


def test_the_true_calibration_and_the_pose_in_the_images_show_little(table: pd.DataFrame) -> None:
    for wanted in ({"rig": "true"}, {"rig": "tilted", "pose": "estimated"}):
        assert column(table, "row_error_board_mean_px", **wanted).max() < 0.15
        assert column(table, "row_error_features_median_px", **wanted).max() < 0.2
    assert (column(table, "row_error_board_points") == 30).all()


def test_how_far_the_pose_is_from_the_calibration_is_told(table: pd.DataFrame) -> None:
    off = column(table, "pose_rotation_difference_deg", rig="tilted", pose="estimated")
    assert off == pytest.approx(TILT_DEG, abs=0.1)
    assert column(table, "pose_rotation_difference_deg", rig="true", pose="estimated").max() < 0.1
    assert "pose_rotation_error_deg" not in table


def test_images_of_another_size_are_rows_with_the_reason(table: pd.DataFrame) -> None:
    thumbs = table[table.scene == "thumb"]
    assert len(thumbs) == 4
    assert (thumbs.status == "invalid").all()
    assert thumbs.reason.str.contains("left image is 240x160 px; expected 480x320").all()


def test_the_run_tells_its_folder_its_board_and_what_is_left_out(run_dir: Path, folder: Path) -> None:
    facts = json.loads((run_dir / "run.json").read_text())
    assert facts["data"] == str(folder)
    assert f"--data {folder}" in facts["command"]
    assert facts["is_whole"]
    pairs = facts["photographs"]["pairs"]
    assert [(pair["name"], pair["rig"]) for pair in pairs] == [
        ("room", "tilted"),
        ("room", "true"),
        ("thumb", "true"),
    ]
    page = (run_dir / "index.html").read_text()
    assert "chessboard 6x5" in page
    assert "true/room_left.png" in page
    assert "no picture" not in page
    for figure in ("row-error-calibrated", "rectified-tilted"):
        assert (run_dir / f"figures/{figure}.png").is_file()


def test_a_report_of_the_run_is_made_again(run_dir: Path) -> None:
    before = (run_dir / "tables/photographs.md").read_text()
    write_report(run_dir)
    assert (run_dir / "tables/photographs.md").read_text() == before


def test_its_tasks_survive_json(folder: Path) -> None:
    task = make_plan(REPORT, data=folder).tasks[0]
    assert CellTask.model_validate(json.loads(json.dumps(task.model_dump(mode="json")))) == task


def test_it_resumes_and_an_edited_image_runs_anew(
    folder: Path, run_dir: Path, table: pd.DataFrame, tmp_path: Path
) -> None:
    measured = "row_error_board_mean_px"
    again = run(REPORT, tmp_path / "again", Selection(scenes=["room"], rigs=["true"]), data=folder, jobs=1)
    assert (
        again[measured].tolist() == table[(table.scene == "room") & (table.rig == "true")][measured].tolist()
    )
    image = folder / "true/room_right.png"
    kept = image.read_bytes()
    try:
        cv2.imwrite(str(image), np.roll(cv2.imread(str(image)), 1, axis=0))
        moved = run(
            REPORT,
            tmp_path / "moved",
            Selection(scenes=["room"], rigs=["true"], methods=["abraham"]),
            data=folder,
            jobs=1,
        )
    finally:
        image.write_bytes(kept)
    assert moved[measured][0] > again[measured][0] + 0.5


def test_the_gate_needs_a_path_and_then_holds_the_run_to_it(
    run_dir: Path, tmp_path: Path, shell: Shell
) -> None:
    code, _, said = shell("gate", run_dir)
    assert code == 2
    assert "expected a file of their own, --accepted" in said
    accepted = tmp_path / "mine.csv"
    accept(run_dir, accepted)
    assert gate(run_dir, accepted).exit_code == 0
    numbers = pd.read_csv(accepted)
    numbers["row_error_board_mean_px"] /= 2
    numbers.to_csv(accepted, index=False)
    assert any("row_error_board_mean_px" in line for line in gate(run_dir, accepted).regressions)


def test_data_and_report_have_to_fit(tmp_path: Path, folder: Path, shell: Shell) -> None:
    for words, said in (
        (("run", "real"), "report real takes photographs; expected a folder of them, --data"),
        (("run", "quick", "--data", folder), "report quick takes no photographs; expected no --data"),
        (("run", "real", "--data", tmp_path / "gone"), "no such folder"),
        (("run", "real", "--data", folder, "--scenes", "attic"), "unknown scene 'attic'"),
    ):
        code, _, error = shell(*words)
        assert code == 2
        assert said in error
    assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"poses": ("exact",)}, "pose of photographs is exact; expected calibrated or estimated"),
        ({"scenes": ("street",)}, "scenes stand beside photographs"),
        ({"methods": ()}, "methods are missing"),
    ],
)
def test_what_photographs_have_not_cannot_be_asked(change: dict[str, object], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        rb.Report(**{**REPORT.model_dump(), **change})


def test_a_metric_of_photographs_needs_no_truth(folder: Path) -> None:
    asking = REPORT.model_copy(update={"metrics": ("geometry", "row_error")})
    with pytest.raises(
        rb.InvalidInput, match="metric row_error needs true matches, which photographs have not"
    ):
        make_plan(asking, data=folder)
