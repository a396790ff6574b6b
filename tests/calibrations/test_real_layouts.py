"""Files in the layouts that tools write, of known lenses and pose, read as such (see the data's README)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rectbench import InvalidInput, Rig, load_rig, rectifying_rotations

FOLDER = "calibrations-that-fail"
DOUBLE = (2.0, 0.0, 0.0)
"""How often as large the images are as those of the truth, and by how much their centre is moved, pixels."""

FISHEYES: dict[str, tuple[tuple[str, ...], tuple[float, float, float]]] = {
    "zed-one-fisheye": (("zed_one_fisheye.conf",), (2.0, 100.0, -200.0)),
    "zed-one-4k": (("zed_one_4k.conf",), (2.0, 100.0, -200.0)),
    "zed-one-opencv": (("zed_calibration_300000001.yml",), DOUBLE),
    "airslam": (("airslam.yaml",), (1.0, 0.0, 0.0)),
    "ros-camera-model": (("cm_l.yaml", "cm_r.yaml"), (1.0, 0.0, 0.0)),
    "ros-skew": (("ros682_l.yaml", "ros682_r.yaml"), (1.0, 0.0, 0.0)),
    "ros-today": (("roscal_l.yaml", "roscal_r.yaml"), (1.0, 0.0, 0.0)),
    "ros-own-focal": (("ros626_l.yaml", "ros626_r.yaml"), (1.0, 0.0, 0.0)),
    "kalibr-vertical": (("kalibr_vertical.yaml",), (1.0, 0.0, 0.0)),
}


@pytest.fixture
def layouts(real_data: Path) -> Path:
    folder = real_data / FOLDER
    if not folder.is_dir():
        pytest.skip(f"no {FOLDER} at {real_data}")
    return folder


@pytest.fixture
def truth(layouts: Path) -> dict[str, np.ndarray]:
    with np.load(layouts / "truth.npz") as file:
        return dict(file)


def load(folder: Path, *names: str) -> Rig:
    return load_rig([folder / name for name in names])


@pytest.mark.parametrize("name", FISHEYES)
def test_a_fisheye_pair_is_read_as_what_it_is(layouts: Path, truth: dict[str, np.ndarray], name: str) -> None:
    files, (scale, right, down) = FISHEYES[name]
    rig = load(layouts, *files)
    for number, camera in ((1, rig.left), (2, rig.right)):
        assert camera.model == "kannala-brandt"
        K = scale * truth[f"K{number}"] + [0, 0, right, down]
        np.testing.assert_allclose([camera.params[n] for n in ("fx", "fy", "cx", "cy")], K, rtol=1e-12)
        radial = [camera.params[f"k{place}"] for place in (1, 2, 3, 4)]
        np.testing.assert_allclose(radial, truth[f"D{number}"], rtol=1e-12)
    t = [0.0012, -0.064, 0.0021] if name == "kalibr-vertical" else truth["t"]
    np.testing.assert_allclose(rig.R_right_left, truth["R"], atol=1e-6)
    np.testing.assert_allclose(rig.t_right_left, t, atol=1e-6)


def test_fisheye_skew_is_kept(layouts: Path) -> None:
    rig = load(layouts, "ros682_l.yaml", "ros682_r.yaml")
    assert (rig.left.params["skew"], rig.right.params["skew"]) == (-0.96635, 0.5)


def test_a_zed_s_rational_lens_is_read(layouts: Path, truth: dict[str, np.ndarray]) -> None:
    rig = load(layouts, "zed_one_radtan.conf")
    assert rig.left.model == "pinhole"
    assert [rig.left.params[n] for n in ("k1", "k2", "p1", "p2", "k3")] == [
        -0.0066,
        0.0473,
        5e-4,
        -3e-4,
        0.01,
    ]
    np.testing.assert_allclose(rig.R_right_left, truth["R"], atol=1e-9)
    np.testing.assert_allclose(rig.t_right_left, truth["t"], atol=1e-9)


def test_airvo_s_second_lens_is_equidistant(layouts: Path) -> None:
    rig = load(layouts, "airvo_equidistant.yaml")
    assert (rig.left.model, rig.right.model, rig.left.size) == ("kannala-brandt",) * 2 + ((1024, 768),)
    assert rig.left.params["k4"] == 0.0059705
    assert rig.baseline_m == pytest.approx(52.149 / 437.07, rel=1e-9)


def test_an_oak_s_tilted_sensor_is_read(layouts: Path, truth: dict[str, np.ndarray]) -> None:
    rig = load(layouts, "oak_tilt.json")
    assert rig.left.model == "tilted-pinhole"
    assert (rig.left.params["tau_x"], rig.left.params["tau_y"]) == (-0.0248, -0.0058)
    np.testing.assert_allclose(rig.R_right_left, truth["R"], atol=1e-9)
    np.testing.assert_allclose(rig.t_right_left, truth["t"], atol=1e-9)


def test_boofcv_s_fourth_radial_coefficient_is_read(layouts: Path) -> None:
    rig = load(layouts, "boofcv_zed_4radial.yaml")
    assert (rig.left.model, rig.left.params["k4"]) == ("radial-tangential", -0.0029503)


@pytest.mark.parametrize("names", [("cam0", "cam2"), None])
def test_of_kalibr_s_three_cameras_two_are_asked_for(
    layouts: Path, truth: dict[str, np.ndarray], names: tuple[str, str] | None
) -> None:
    if names is None:
        with pytest.raises(InvalidInput, match=r"(?s)holds 3 cameras; .*\ncam0,cam2: baseline 0.064 m"):
            load_rig(layouts / "kalibr3.yaml")
        return
    rig = load_rig(layouts / "kalibr3.yaml", cameras=names)
    np.testing.assert_allclose(rig.R_right_left, truth["R"], atol=1e-9)
    np.testing.assert_allclose(rig.t_right_left, truth["t"], atol=1e-9)


def test_a_polynomial_that_turns_inside_the_image_is_told(
    layouts: Path, caplog: pytest.LogCaptureFixture
) -> None:
    load(layouts, "echo6_l.yaml", "echo6_r.yaml")
    left, _ = caplog.messages
    assert "the left camera's distortion turns at 48.7° from the axis, inside the image" in left


def test_a_vertical_pair_is_turned_so_that_disparity_is_positive(layouts: Path) -> None:
    rig = load(layouts, "kalibr_vertical.yaml")
    R_rect_left, _ = rectifying_rotations(rig)
    np.testing.assert_allclose(R_rect_left @ rig.centre_right_in_left, [rig.baseline_m, 0, 0], atol=1e-12)
