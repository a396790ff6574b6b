"""`rectbench uncertainty`: what it writes and says, and how it refuses."""

from __future__ import annotations

import json
import math
from pathlib import Path

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench import Unavailable
from rectbench.reporting.pictures import uncertainty_maps
from rectbench.rigs import RigCovariance
from tests.conftest import Shell
from tests.matching.box_room import pair_of
from tests.rigs_for_tests import rig

FILES = {f"uncertainty.{end}" for end in ("png", "pdf", "json", "npz")}
ROOM = rig("kannala-brandt", size=(360, 240))


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    ROOM.save("rig.yaml")


def numbers_of(folder: str) -> dict:
    return json.loads(Path(folder, "uncertainty.json").read_text())


def test_stated_sizes_become_a_picture_numbers_and_arrays(shell: Shell) -> None:
    sizes = ("--rotation-deg", 0.05, "--direction-deg", 0.3, "--baseline-mm", 0.4, "--centre-px", 0.2)
    code, out, err = shell("uncertainty", "--rig", "rig.yaml", *sizes, "--depth-m", "2,inf", "-o", "out")
    assert (code, err) == (0, "")
    assert {f.name for f in Path("out").iterdir()} == FILES == {Path(line).name for line in out.split()[-4:]}
    assert "rotation_deg 0.05" in out
    assert "infinity" in out

    believed = rb.load_rig("rig.yaml")
    covariance = RigCovariance.from_sigmas(
        believed, rotation_deg=0.05, direction_deg=0.3, baseline_m=0.4e-3, centre_px=0.2
    )
    found = rb.metrics.uncertainty(
        rb.rectify(believed),
        believed,
        covariance,
        depth_m=[2, math.inf],
        matching_px=0.25,
        pixels=believed.left.pixel_grid(),
    )
    arrays = np.load("out/uncertainty.npz", allow_pickle=False)
    for name in ("row_error_sigma_px", "inverse_depth_sigma_per_m", "matched_inverse_depth_sigma_per_m"):
        np.testing.assert_allclose(arrays[name], getattr(found, name), rtol=1e-12)
    assert arrays["depth_m"].tolist() == [2, math.inf]
    told = numbers_of("out")
    near, far = told["depths"]
    assert near["row_error_sigma_rms_px"] == pytest.approx(found.numbers()[0]["row_error_sigma_rms_px"])
    assert (far["depth_m"], far["depth_sigma_median_share"]) == ("infinity", None)
    assert (told["method"], told["sigmas"]["right.cx"]) == ("local-homography", 0.2)
    assert min(cv2.imread("out/uncertainty.png").shape[:2]) > 700


@pytest.mark.parametrize("depths", ["3", "1,2,4,8", "inf"])
def test_any_choice_of_distances_makes_a_picture(shell: Shell, depths: str) -> None:
    words = ("--rotation-deg", 0.05, "--depth-m", depths, "-m", "conventional", "-o", "out")
    assert shell("uncertainty", "--rig", "rig.yaml", *words)[0] == 0
    picture = cv2.imread("out/uncertainty.png")
    assert picture.std() > 20


def test_images_tell_the_pose_and_its_covariance_to_which_that_of_lenses_adds(shell: Shell) -> None:
    images = pair_of(ROOM)
    for name, image in zip(("left.png", "right.png"), images, strict=True):
        cv2.imwrite(name, image)
    words = ("left.png", "right.png", "--rig", "rig.yaml", "--focal-px", 0.4, "-o", "out")
    code, out, err = shell("uncertainty", *words)
    assert (code, err) == (0, "")
    assert "calibration: pose estimated from the images, lenses and baseline's length taken as exact" in out
    estimate = rb.estimate_pose(images, ROOM)
    told = numbers_of("out")
    assert "estimated from the images" in told["covariance"]
    assert told["sigmas"]["left.fx"] == 0.4
    sigma_deg = math.degrees(math.hypot(*(told["sigmas"][f"pose.r{axis}"] for axis in "xyz")))
    assert sigma_deg == pytest.approx(estimate.rotation_sigma_deg, rel=1e-6)


def test_images_of_another_rig_are_refused(shell: Shell) -> None:
    for name, image in zip(("right.png", "left.png"), pair_of(ROOM), strict=True):
        cv2.imwrite(name, image)
    code, _, err = shell("uncertainty", "left.png", "right.png", "--rig", "rig.yaml", "-o", "out")
    assert code == 2
    assert "the images look swapped" in err
    assert not Path("out").exists()


def test_a_file_and_stated_sizes_add(shell: Shell) -> None:
    Path("covariance.yaml").write_text("sigmas: {pose.rx: 3.0e-3}")
    words = ("--covariance", "covariance.yaml", "--focal-px", 1.5, "-o", "out")
    assert shell("uncertainty", "--rig", "rig.yaml", *words)[0] == 0
    sigmas = numbers_of("out")["sigmas"]
    assert (sigmas["pose.rx"], sigmas["left.fx"]) == pytest.approx((3e-3, 1.5))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            "",
            "nothing says how sure the calibration is; expected --covariance, a size such as",
        ),
        ("--rotation-deg -1", "--rotation-deg"),
        ("--rotation-deg 500", "rotation_deg is 500; expected degrees below 180"),
        ("--rotation-deg 1 --depth-m 1,near", "--depth-m is 1,near; expected distances in metres"),
        ("--rotation-deg 1 --depth-m -2", "--depth-m is [-2.0]; expected distances above 0"),
        ("--rotation-deg 1 --depth-m 1,2,3,4,5", "5 distances were given; expected at most 4"),
        ("--rotation-deg 1 --matching-px inf", "--matching-px is inf"),
        ("--rotation-deg 1 -m flat", "unknown method 'flat'"),
        ("left.png --rotation-deg 1", "one image was given, left.png; expected LEFT and RIGHT"),
        ("--covariance none.yaml", "none.yaml: cannot be read"),
        ("--covariance rig.yaml", "rig.yaml: unknown key"),
    ],
)
def test_what_cannot_be_used_is_one_line_and_leaves_nothing(shell: Shell, words: str, message: str) -> None:
    code, _, err = shell("uncertainty", "--rig", "rig.yaml", *words.split(), "-o", "out")
    assert code == 2
    assert err.count("\n") == 1
    assert message in err
    assert not Path("out").exists()


def test_a_full_disk_is_one_line(shell: Shell, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, _: object) -> None:
        raise Unavailable(f"{path} cannot be written: No space left on device")

    monkeypatch.setattr(uncertainty_maps, "write_atomically", full)
    code, _, err = shell("uncertainty", "--rig", "rig.yaml", "--rotation-deg", 1, "-o", "out")
    assert (code, err.count("\n")) == (2, 1)


def test_equal_questions_make_equal_files(shell: Shell) -> None:
    for folder in ("a", "b"):
        assert shell("uncertainty", "--rig", "rig.yaml", "--rotation-deg", 0.1, "-o", folder)[0] == 0
    for name in FILES - {"uncertainty.npz"}:
        assert Path("a", name).read_bytes() == Path("b", name).read_bytes(), name


def test_what_no_lens_shows_is_white_and_what_one_image_shows_alone_is_grey() -> None:
    from matplotlib import rc_context

    from rectbench.reporting.style import STYLE

    believed = rb.load_rig("t265")
    covariance = RigCovariance.from_sigmas(believed, rotation_deg=0.05)
    grid = uncertainty_maps.map_pixels(believed.left)
    assert grid.shape[0] * grid.shape[1] <= uncertainty_maps.MAP_PIXELS
    found = rb.metrics.uncertainty(
        rb.rectify(believed, "conventional"), believed, covariance, depth_m=2.0, pixels=grid
    )
    with rc_context(fname=STYLE):
        figure = uncertainty_maps.draw_uncertainty(found, believed.left)
    shades = np.asarray(figure.axes[0].images[0].get_array())
    seen = believed.left.unproject(grid)[1]
    assert (shades[~seen] == 1.0).all()
    lost = np.isnan(found.row_error_sigma_px[0]) & seen
    assert 0.1 < lost.mean() < 0.9
    assert np.ptp(shades[lost], axis=0).max() == 0
    assert np.ptp(shades[seen & ~lost], axis=0).max() > 0.2
