"""What a folder holds: every image and calibration belongs to a pair, or is left out with a reason."""

from __future__ import annotations

import math
import shutil
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

import rectbench as rb
from rectbench.pairs.finding.manifest import MANIFEST
from rectbench.pairs.finding.photographs import Photographs, find_photographs
from tests.rigs_for_tests import rig

RIG = rig("kannala-brandt", size=(96, 64), fov_deg=100)


def write_image(path: Path, size: tuple[int, int] = (96, 64), seed: int = 0) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    image = np.random.default_rng(seed).integers(60, 255, size[::-1])
    cv2.imwrite(str(path), image.astype(np.uint8))


def write_pair(folder: Path, name: str = "a") -> None:
    write_image(folder / f"{name}_left.png")
    write_image(folder / f"{name}_right.png", seed=1)


def reasons(found: Photographs) -> dict[str, str]:
    return {out.path.relative_to(found.folder).as_posix(): out.reason for out in found.left_out}


def test_a_calibration_serves_the_images_beside_and_below_it(tmp_path: Path) -> None:
    for place in ("hall", "hall/later/night", "yard"):
        write_pair(tmp_path / place)
    RIG.save(tmp_path / "hall/rig.yaml")
    RIG.save(tmp_path / "hall/later/rig.yaml")
    found = find_photographs(tmp_path)
    assert {(pair.left.parent.name, pair.calibration.name) for pair in found.pairs} == {
        ("hall", "hall"),
        ("night", "later"),
    }
    assert reasons(found) == dict.fromkeys(
        ("yard/a_left.png", "yard/a_right.png"), "no calibration is beside or above it"
    )


def test_the_rig_is_the_files(tmp_path: Path) -> None:
    write_pair(tmp_path)
    RIG.save(tmp_path / "rig.yaml")
    (pair,) = find_photographs(tmp_path).pairs
    assert pair.calibration.rig() == RIG
    assert (pair.name, pair.calibration.name) == ("a", tmp_path.name)


def test_a_pair_beside_two_calibrations_is_there_for_each(tmp_path: Path) -> None:
    write_pair(tmp_path)
    RIG.save(tmp_path / "old.yaml")
    RIG.save(tmp_path / "new.yaml")
    names = [pair.calibration.name for pair in find_photographs(tmp_path).pairs]
    assert names == [f"{tmp_path.name}-new", f"{tmp_path.name}-old"]


def test_calibrations_of_one_name_are_told_apart_by_their_paths(tmp_path: Path) -> None:
    for place in ("x/front", "y/front"):
        write_pair(tmp_path / place)
        RIG.save(tmp_path / place / "rig.yaml")
    names = [pair.calibration.name for pair in find_photographs(tmp_path).pairs]
    assert names == ["x-front-rig", "y-front-rig"]


def test_a_folder_for_each_camera_with_its_calibration_is_one_rig(tmp_path: Path) -> None:
    body = np.eye(4)
    for side, x in ((0, 0.0), (1, 0.11)):
        body[0, 3] = x
        write_image(tmp_path / f"cam{side}/data/17.png", seed=side)
        sensor = {
            "sensor_type": "camera",
            "T_BS": {"cols": 4, "rows": 4, "data": body.ravel().tolist()},
            "resolution": [96, 64],
            "camera_model": "pinhole",
            "intrinsics": [80.0, 80.0, 48.0, 32.0],
            "distortion_model": "radial-tangential",
            "distortion_coefficients": [0.0, 0.0, 0.0, 0.0],
        }
        (tmp_path / f"cam{side}/sensor.yaml").write_text(yaml.safe_dump(sensor))
    (pair,) = find_photographs(tmp_path).pairs
    assert (pair.name, pair.left.parent.parent.name) == ("17", "cam0")
    assert pair.calibration.rig().centre_right_in_left == pytest.approx([0.11, 0, 0])


def test_pairs_of_one_name_are_told_apart_by_their_folders(tmp_path: Path) -> None:
    for place in ("one", "two"):
        write_pair(tmp_path / place)
    RIG.save(tmp_path / "rig.yaml")
    assert [pair.name for pair in find_photographs(tmp_path).pairs] == ["one-a", "two-a"]


def test_what_is_no_photograph_is_left_out_with_its_reason(tmp_path: Path) -> None:
    write_pair(tmp_path)
    RIG.save(tmp_path / "rig.yaml")
    for name in ("mask.png", "disp0.png", "preview.png"):
        write_image(tmp_path / name)
    (tmp_path / "broken.png").write_bytes(b"no image")
    (tmp_path / "notes.txt").write_text("a sunny day")
    (tmp_path / "camera.json").write_text('{"exposure": 1}')
    (tmp_path / ".hidden.png").write_bytes(b"no image")
    found = reasons(find_photographs(tmp_path))
    assert found == {
        "mask.png": "a mask, no photograph",
        "disp0.png": "no photograph, by the word 'disp' in its name",
        "preview.png": "no other image's name differs from its own in the side alone",
        "broken.png": "not an image that OpenCV can read",
        "camera.json": "no calibration of a format known here",
    }


def test_a_calibration_without_images_is_left_out(tmp_path: Path) -> None:
    write_pair(tmp_path / "hall")
    RIG.save(tmp_path / "hall/rig.yaml")
    (tmp_path / "yard").mkdir()
    RIG.save(tmp_path / "yard/rig.yaml")
    assert reasons(find_photographs(tmp_path)) == {"yard/rig.yaml": "no pair of images is beside or below it"}


def test_a_damaged_calibration_says_what_is_wrong_with_it(tmp_path: Path) -> None:
    write_pair(tmp_path / "hall")
    RIG.save(tmp_path / "hall/rig.yaml")
    damaged = (tmp_path / "hall/rig.yaml").read_text().replace("fx:", "fz:")
    (tmp_path / "hall/other.yaml").write_text(damaged)
    assert "fx" in reasons(find_photographs(tmp_path))["hall/other.yaml"]


def test_nothing_to_measure_is_an_error_with_the_reasons(tmp_path: Path) -> None:
    write_pair(tmp_path)
    with pytest.raises(rb.InvalidInput, match=r"a_left\.png: no calibration is beside or above it"):
        find_photographs(tmp_path)
    with pytest.raises(rb.InvalidInput, match="no such folder"):
        find_photographs(tmp_path / "nowhere")


def write_opencv(path: Path, baseline: float, size: tuple[int, int] | None) -> None:
    """A stereo calibration as OpenCV's samples write it."""
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for name, value in {
        "M1": np.array([[80.0, 0, 48], [0, 80, 32], [0, 0, 1]]),
        "D1": np.zeros((1, 5)),
        "M2": np.array([[80.0, 0, 48], [0, 80, 32], [0, 0, 1]]),
        "D2": np.zeros((1, 5)),
        "R": np.eye(3),
        "T": np.array([[-baseline], [0.0], [0.0]]),
    }.items():
        file.write(name, value)
    for name, length in zip(("image_width", "image_height"), size or (), strict=False):
        file.write(name, length)
    file.release()


def test_a_long_baseline_without_a_unit_is_told_to_be_in_millimetres(tmp_path: Path) -> None:
    write_pair(tmp_path)
    write_opencv(tmp_path / "stereo.yml", 120.0, (96, 64))
    (pair,) = find_photographs(tmp_path).pairs
    assert pair.calibration.rig().baseline_m == pytest.approx(0.12)
    assert pair.calibration.remarks == (
        "its baseline, whose unit the file leaves open, is taken to be in mm",
    )


def test_a_size_that_the_files_leave_out_is_the_images(tmp_path: Path) -> None:
    write_pair(tmp_path)
    write_opencv(tmp_path / "stereo.yml", 0.12, None)
    (pair,) = find_photographs(tmp_path).pairs
    assert pair.calibration.rig().left.size == (96, 64)
    assert "image size" in pair.calibration.remarks[0]


def circle(camera: rb.Camera, angle_deg: float) -> np.ndarray:
    rays, _ = camera.unproject(camera.pixel_grid())
    return np.arctan2(np.hypot(rays[..., 0], rays[..., 1]), rays[..., 2]) < math.radians(angle_deg)


def test_a_mask_or_the_black_rim_ends_the_lens_and_a_stated_end_stands(tmp_path: Path) -> None:
    fisheye = rig("equidistant", size=(240, 200), fov_deg=180)
    for side, camera in (("left", fisheye.left), ("right", fisheye.right)):
        shown = np.random.default_rng(0).integers(60, 255, (200, 240)) * circle(camera, 72)
        (tmp_path / "rim").mkdir(exist_ok=True)
        cv2.imwrite(str(tmp_path / f"rim/{side}.png"), shown.astype(np.uint8))
    shutil.copytree(tmp_path / "rim", tmp_path / "masked")
    shutil.copytree(tmp_path / "rim", tmp_path / "stated")
    cv2.imwrite(str(tmp_path / "masked/mask.png"), (255 * circle(fisheye.left, 60)).astype(np.uint8))
    for place in ("rim", "masked"):
        fisheye.save(tmp_path / place / "rig.yaml")
    fisheye.within(50.0).save(tmp_path / "stated/rig.yaml")
    by_rig = {pair.calibration.name: pair.calibration for pair in find_photographs(tmp_path).pairs}
    angles = {name: one.rig().left.max_angle_deg for name, one in by_rig.items()}
    assert angles["rim"] == pytest.approx(72, abs=1.01)
    assert angles["masked"] == pytest.approx(60, abs=1.01)
    assert angles["stated"] == 50.0
    assert by_rig["rim"].remarks[0].endswith("by the black rim of its images")
    assert by_rig["masked"].remarks[0].endswith("by mask.png")
    assert by_rig["stated"].remarks == ()


def test_a_manifest_states_what_names_do_not(tmp_path: Path) -> None:
    for i, name in enumerate(("x/17.png", "y/23.png")):
        write_image(tmp_path / name, seed=i)
    RIG.save(tmp_path / "calib.yaml")
    manifest = {
        "rigs": {"front": {"files": ["calib.yaml"], "max_angle_deg": 40}},
        "pairs": [{"name": "gate", "left": "y/23.png", "right": "x/17.png", "rig": "front"}],
    }
    (tmp_path / MANIFEST).write_text(yaml.safe_dump(manifest))
    (pair,) = find_photographs(tmp_path).pairs
    assert (pair.name, pair.left.name, pair.calibration.name) == ("gate", "23.png", "front")
    assert pair.calibration.rig() == replace(RIG.within(40.0))


@pytest.mark.parametrize(
    ("manifest", "said"),
    [
        ({"pairs": [{}]}, "pairs.0.left: Field required"),
        ({"rig": {}}, "rig: Extra inputs are not permitted"),
        ({"rigs": {"a": {"files": ["gone.yaml"]}}}, "rigs.a.files.0: gone.yaml: no such file"),
        (["a"], "the file: Input should be a valid dictionary"),
    ],
)
def test_a_wrong_manifest_names_the_key(tmp_path: Path, manifest: object, said: str) -> None:
    (tmp_path / MANIFEST).write_text(yaml.safe_dump(manifest))
    with pytest.raises(rb.InvalidInput, match=MANIFEST) as error:
        find_photographs(tmp_path)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_a_manifest_of_tags_runs_nothing(tmp_path: Path) -> None:
    (tmp_path / MANIFEST).write_text("pairs: !!python/object/apply:os.system ['true']")
    with pytest.raises(rb.InvalidInput, match="cannot be read"):
        find_photographs(tmp_path)


def test_one_camera_files_of_both_sides_complete_each_other(real_data: Path) -> None:
    found = find_photographs(real_data / "pairs")
    assert [(pair.name, pair.calibration.name) for pair in found.pairs] == [
        ("garden01", "bumblebee2"),
        ("sundial01", "bumblebee2"),
        ("fisheye-img0", "mynteye"),
        ("fs", "t265"),
        ("robot", "t265"),
    ]
    assert set(reasons(found)) == {"mynteye/sidebyside_ref_img_0.png", "t265/mask.png"}
    told = {one.name: " ".join(one.remarks) for one in found.calibrations}
    assert "80° from their axes, by mask.png" in told["t265"]
    assert told["mynteye"] == ""


def test_without_its_mask_the_t265s_rim_is_found(real_data: Path, tmp_path: Path) -> None:
    for file in (real_data / "pairs/t265").iterdir():
        if file.name != "mask.png":
            shutil.copy(file, tmp_path)
    (one,) = find_photographs(tmp_path).calibrations
    assert one.max_angle_deg == pytest.approx(83, abs=2)


@pytest.mark.parametrize(("left", "right", "focal"), [("cam0", "cam1", 100.0), ("cam2", "cam3", 200.0)])
def test_of_many_cameras_those_are_taken_that_the_names_number(
    tmp_path: Path, left: str, right: str, focal: float
) -> None:
    lens = rb.Camera("pinhole", (64, 48), {"fx": 100, "fy": 100, "cx": 31, "cy": 23})
    rb.Rig(lens, lens, np.eye(3), np.array([-0.1, 0, 0])).save(tmp_path / "chain.yaml", format="kalibr")
    chain = yaml.safe_load((tmp_path / "chain.yaml").read_text())
    for name, model in (("cam2", "cam1"), ("cam3", "cam1")):
        chain[name] = {**chain[model], "intrinsics": [200, 200, 31, 23]}
    (tmp_path / "chain.yaml").write_text(yaml.safe_dump(chain))
    for side in (left, right):
        (tmp_path / side).mkdir()
        cv2.imwrite(str(tmp_path / side / "7.png"), np.zeros((48, 64), np.uint8))
    (pair,) = find_photographs(tmp_path).pairs
    assert pair.calibration.rig().left.params["fx"] == focal
    assert pair.calibration.rig().right.params["fx"] == focal


def test_of_many_cameras_none_is_guessed(tmp_path: Path) -> None:
    lens = rb.Camera("pinhole", (64, 48), {"fx": 100, "fy": 100, "cx": 31, "cy": 23})
    rb.Rig(lens, lens, np.eye(3), np.array([-0.1, 0, 0])).save(tmp_path / "chain.yaml", format="kalibr")
    for side in ("cam2", "cam3"):
        (tmp_path / side).mkdir()
        cv2.imwrite(str(tmp_path / side / "7.png"), np.zeros((48, 64), np.uint8))
    with pytest.raises(rb.InvalidInput, match="which took it is not told"):
        find_photographs(tmp_path)
