"""A rig written in any format is the same rig when it is read again; or it is refused."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rectbench import Camera, InvalidInput, Rig, UnknownName, load_rig
from rectbench.calibrations import calibration_formats
from rectbench.cameras.equivalents import equal_cameras
from rectbench.rigs import written_formats
from tests.calibrations.calibration_files import R_RIGHT_LEFT, T_RIGHT_LEFT
from tests.calibrations.examples import (
    AFFINE1,
    FISHEYES,
    FOCAL1,
    POLY1,
    RATIONALS,
    UNIFIEDS,
    ocam_camera,
)
from tests.cameras.random_cameras import FOCAL, MODELS, any_camera, cameras
from tests.rigs_for_tests import assert_same_pose

FORMATS = tuple(written_formats())
RAYS = np.random.default_rng(3).normal(size=(400, 3)) * [1, 1, 0.7]
FIXED = dict(zip(FOCAL, (300.0, 301.0, 640.2, 480.7), strict=True))


def path_in(folder: Path, format: str) -> Path:
    return folder / (format if written_formats()[format] else f"{format}.yml")


def assert_same_lens(read: Camera, written: Camera) -> None:
    """To 1e-9 px where a pixel can be near an image; where a domain ends may differ by a hair."""
    (pixels, ok), (expected, expected_ok) = read.project(RAYS), written.project(RAYS)
    assert read.size == written.size
    assert np.mean(ok != expected_ok) <= 0.01
    both = ok & expected_ok & (np.abs(expected).max(axis=-1) < 5000)
    np.testing.assert_allclose(pixels[both], expected[both], rtol=0, atol=1e-9)


def rig_of(camera: Camera, right: Camera | None = None) -> Rig:
    return Rig(camera, right or camera, R_RIGHT_LEFT, T_RIGHT_LEFT)


F_THETA = {"cx": 640.2, "cy": 480.7, "angle_poly": [1 / 300, 1e-7]}
EVERY = {"native"}
SPHERES = {"kalibr", "basalt", "colmap", "opencv", "camodocal", "vins"}
HOLDERS: dict[str, tuple[dict[str, float], set[str]]] = {
    "pinhole": ({}, {*SPHERES, "ros", "mrcal"}),
    "pinhole k1": ({"k1": -0.1}, {*SPHERES, "ros", "mrcal"}),
    "pinhole k3": ({"k3": -0.1}, {"opencv", "ros", "mrcal", "basalt", "colmap", "camodocal", "vins"}),
    "pinhole s4": ({"s4": 1e-4}, {"opencv", "mrcal"}),
    "kannala-brandt": ({"k1": 0.01}, {*SPHERES, "ros"}),
    "kannala-brandt skew": ({"skew": 1.7}, {"opencv", "ros"}),
    "equidistant": ({}, {*SPHERES, "ros"}),
    "thin-prism-fisheye k1": ({"k1": 0.01}, {*SPHERES, "ros"}),
    "thin-prism-fisheye sx1": ({"sx1": 0.001}, {"colmap"}),
    "fisheye624 k3": ({"k3": 0.001}, {*SPHERES, "ros"}),
    "fisheye624 k4": ({"k4": 0.001}, {"colmap"}),
    "unified xi": ({"xi": 0.9}, SPHERES),
    "unified xi k1": ({"xi": 0.9, "k1": -0.1}, {"kalibr", "opencv", "camodocal", "vins"}),
    "extended-unified beta": ({"alpha": 0.6, "beta": 1.1}, {"kalibr", "basalt", "colmap"}),
    "double-sphere": ({"xi": -0.2, "alpha": 0.6}, {"kalibr", "basalt"}),
    "field-of-view": ({"omega": 0.9}, {"kalibr", "basalt", "colmap"}),
    "stereographic": ({}, {*SPHERES, "mrcal"}),
    "division": ({"k": -0.1}, {"colmap"}),
    "cahvor": ({"alpha": 0.01}, {"mrcal"}),
    "tilted-pinhole tau_x": ({"k1": -0.1, "tau_x": 0.01}, {"opencv"}),
    "tilted-pinhole k1": ({"k1": -0.1}, {*SPHERES, "ros", "mrcal"}),
    "radial-tangential k4": ({"k1": -0.1, "k4": 0.01}, set()),
    "radial-tangential k3": (
        {"k3": -0.1},
        {"opencv", "ros", "mrcal", "basalt", "colmap", "camodocal", "vins"},
    ),
    "equisolid": ({}, set()),
    "orthographic": ({}, set()),
    "ocam": ({}, {"ocamcalib"}),
    "f-theta": ({}, set()),
}


def models_for(format: str) -> list[str]:
    """Models for a rig to be written: mostly such as the format may hold."""
    held = [name.split()[0] for name, (_, holders) in HOLDERS.items() if format in holders]
    return [*held, *held, *MODELS]


def with_first(camera: Camera, count: int) -> Camera:
    """The camera with so many of its parameters beyond the focal length, the others at their simplest."""
    if camera.model in ("ocam", "f-theta"):
        return camera
    own = [name for name in camera.params if name not in FOCAL][count:]
    return replace(camera, params={**camera.params, **{name: float(name == "beta") for name in own}})


@st.composite
def rigs(draw: Callable[[st.SearchStrategy], object], format: str) -> Rig:
    """Rigs of two lenses of one model or of two, of few parameters or of many, anyhow turned."""
    model = draw(st.sampled_from(models_for(format)))
    other = draw(st.sampled_from([model, model, *models_for(format)]))
    left, right = (
        with_first(draw(cameras(name)), draw(st.sampled_from([0, 1, 2, 4, 5, 8, 12])))
        for name in (model, other)
    )
    angles = draw(st.tuples(*[st.floats(-1.5, 1.5)] * 3))
    t = draw(st.tuples(*[st.floats(-2, 2)] * 3).filter(lambda t: np.linalg.norm(t) > 0.01))
    return Rig(left, right, Rotation.from_rotvec(angles).as_matrix(), t)


def refusal(rig: Rig, path: Path, format: str) -> str:
    """Why a format refuses a rig; empty where it is written."""
    try:
        rig.save(path, format)
    except InvalidInput as error:
        return str(error)
    return ""


@pytest.mark.parametrize("format", FORMATS)
@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_what_is_written_is_read_as_the_same_rig_or_refused(
    tmp_path: Path, format: str, data: st.DataObject
) -> None:
    rig = data.draw(rigs(format))
    path = path_in(tmp_path, format)
    reason = refusal(rig, path, format)
    if reason:
        assert f"{format} has no place for the" in reason
        assert "expected one of the formats that have: native" in reason
        return
    read = load_rig(path)
    assert_same_lens(read.left, rig.left)
    assert_same_lens(read.right, rig.right)
    assert_same_pose(read, rig)


def held_by(rig: Rig, folder: Path) -> set[str]:
    """The formats that write a rig; of the others nothing may be there."""
    refused = {format for format in FORMATS if refusal(rig, path_in(folder, format), format)}
    assert not any(path_in(folder, format).exists() for format in refused)
    return set(FORMATS) - refused


@pytest.mark.parametrize("name", HOLDERS)
def test_which_formats_hold_which_lens(tmp_path: Path, name: str) -> None:
    params, holders = HOLDERS[name]
    model = name.split()[0]
    own = (F_THETA if model == "f-theta" else FIXED) | params
    camera = ocam_camera(POLY1, FOCAL1[2:], AFFINE1) if model == "ocam" else Camera(model, (1280, 960), own)
    assert held_by(rig_of(camera), tmp_path) == EVERY | holders


def test_every_model_is_asked_for_its_formats() -> None:
    assert {name.split()[0] for name in HOLDERS} == set(MODELS)


def test_a_refusal_names_lens_parameter_and_the_formats_that_hold_the_rig(tmp_path: Path) -> None:
    skewed = Camera("kannala-brandt", (1280, 960), FIXED | {"skew": 1.7})
    rig = rig_of(FISHEYES.left, skewed)
    with pytest.raises(InvalidInput) as caught:
        rig.save(tmp_path / "chain.yaml", "kalibr")
    assert str(caught.value) == (
        "kalibr has no place for the right camera, kannala-brandt with skew = 1.7; "
        "expected one of the formats that have: native, opencv, ros"
    )
    assert not any(tmp_path.iterdir())


@settings(max_examples=200)
@given(camera=any_camera())
def test_equal_cameras_are_equal(camera: Camera) -> None:
    first, *others = equal_cameras(camera)
    assert first == camera
    for other in others:
        assert_same_lens(other, camera)


@pytest.mark.parametrize("model", MODELS)
def test_a_plain_camera_of_each_model_equals_its_kin(model: str) -> None:
    """Parameters at their simplest, where most equalities hold."""
    simple = {"alpha": 0.5, "beta": 1.0} if model == "extended-unified" else {}
    if model == "ocam":
        return
    own = F_THETA if model == "f-theta" else FIXED | simple
    camera = Camera(model, (1280, 960), own)
    for other in equal_cameras(camera):
        assert_same_lens(other, camera)


def test_an_image_circle_without_a_place_is_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    FISHEYES.within(75).save(tmp_path / "chain.yaml", "kalibr")
    assert "kalibr leaves out the left camera's max_angle_deg = 75" in caplog.text
    assert load_rig(tmp_path / "chain.yaml").left.max_angle_deg is None


def test_basalt_keeps_a_pinhole_s_image_circle(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.WARNING)
    RATIONALS.within(41).save(tmp_path / "calibration.json", "basalt")
    assert not caplog.records
    assert load_rig(tmp_path / "calibration.json").right.max_angle_deg == pytest.approx(41, abs=1e-12)


def fisheye(storage: cv2.FileStorage, number: int, points: np.ndarray) -> np.ndarray:
    K, D = (storage.getNode(f"{key}{number}").mat() for key in "KD")
    flat = K.copy()
    flat[0, 1] = 0
    return cv2.fisheye.projectPoints(
        points[:, None], np.zeros(3), np.zeros(3), flat, D, alpha=K[0, 1] / K[0, 0]
    )[0]


def pinhole(storage: cv2.FileStorage, number: int, points: np.ndarray) -> np.ndarray:
    K, D = (storage.getNode(f"{key}{number}").mat() for key in "KD")
    return cv2.projectPoints(points, np.zeros(3), np.zeros(3), K, D)[0]


def omnidir(storage: cv2.FileStorage, number: int, points: np.ndarray) -> np.ndarray:
    K, D = (storage.getNode(f"{key}{number}").mat() for key in "KD")
    xi = storage.getNode(f"xi_{number}").real()
    return cv2.omnidir.projectPoints(points[:, None], np.zeros(3), np.zeros(3), K, xi, D)[0]


SKEWED = rig_of(replace(FISHEYES.left, params={**FISHEYES.left.params, "skew": -1.2}), FISHEYES.right)
PRISMS = rig_of(replace(RATIONALS.left, params={**RATIONALS.left.params, "s1": 1e-3}), RATIONALS.right)


@pytest.mark.parametrize("suffix", [".yml", ".xml", ".json"])
@pytest.mark.parametrize(
    ("rig", "project"),
    [
        (FISHEYES, fisheye),
        (SKEWED, fisheye),
        (RATIONALS, pinhole),
        (PRISMS, pinhole),
        (UNIFIEDS, omnidir),
    ],
    ids=["fisheye", "skewed", "rational", "prism", "omnidir"],
)
def test_opencv_projects_with_its_file_as_the_camera_does(
    tmp_path: Path, rig: Rig, project: Callable[..., np.ndarray], suffix: str
) -> None:
    (path,) = rig.save(tmp_path / f"rig{suffix}", "opencv")
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    points = RAYS[RAYS[:, 2] > 0.5]
    for number, camera, X in ((1, rig.left, points), (2, rig.right, points @ rig.R_right_left.T)):
        expected, ok = camera.project(X)
        np.testing.assert_allclose(project(storage, number, X)[ok, 0], expected[ok], atol=1e-9)
    np.testing.assert_allclose(storage.getNode("R").mat(), rig.R_right_left, atol=1e-15)
    np.testing.assert_allclose(storage.getNode("T").mat()[:, 0], rig.t_right_left, atol=1e-15)


def test_ocamcalib_s_own_functions_see_as_the_camera_does(tmp_path: Path) -> None:
    """cam2world and world2cam by their documented formulas, x being the row; the second is a fit here."""
    camera = replace(
        ocam_camera(POLY1, FOCAL1[2:], AFFINE1),
        params={**ocam_camera(POLY1, FOCAL1[2:], AFFINE1).params, "inverse_poly": ()},
    )
    left, *_ = rig_of(camera).save(tmp_path / "ocam", "ocamcalib")
    blocks = [
        [float(word) for word in line.split()]
        for line in left.read_text().splitlines()
        if line and not line.startswith("#")
    ]
    (_, *ss), (_, *invpol), (xc, yc), (c, d, e), size = blocks
    assert size == [camera.height, camera.width]
    pixels = np.random.default_rng(0).uniform([80, 80], [760, 720], (100, 2))
    x, y = np.linalg.solve([[c, d], [e, 1]], (pixels[:, ::-1] - [xc, yc]).T)
    world = np.stack([x, y, np.polynomial.polynomial.polyval(np.hypot(x, y), ss)], axis=-1)
    rays, _ = camera.unproject(pixels)
    own = world[:, [1, 0, 2]] * [1, 1, -1]
    np.testing.assert_allclose(own / np.linalg.norm(own, axis=-1, keepdims=True), rays, atol=1e-12)
    norm = np.linalg.norm(world[:, :2], axis=-1)
    rho = np.polynomial.polynomial.polyval(np.arctan2(world[:, 2], norm), invpol)
    x, y = world[:, 0] / norm * rho, world[:, 1] / norm * rho
    back = np.stack([x * e + y + yc, x * c + y * d + xc], axis=-1)
    np.testing.assert_allclose(back, pixels, atol=0.02)


def test_a_fitted_polynomial_is_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    camera = Camera("ocam", (848, 800), {"cx": 420, "cy": 400, "poly": POLY1})
    rig_of(camera).save(tmp_path / "ocam", "ocamcalib")
    assert "fits world2cam to the left camera's cam2world" in caplog.text


def test_kalibr_s_keys_are_kalibr_s(tmp_path: Path) -> None:
    UNIFIEDS.save(tmp_path / "chain.yaml", "kalibr")
    chain = yaml.safe_load((tmp_path / "chain.yaml").read_text())
    assert chain["cam0"]["camera_model"] == "omni"
    assert chain["cam1"]["distortion_model"] == "radtan"
    assert chain["cam0"]["intrinsics"] == [UNIFIEDS.left.params[n] for n in ("xi", "fx", "fy", "cx", "cy")]
    np.testing.assert_array_equal(np.array(chain["cam1"]["T_cn_cnm1"])[:3, 3], UNIFIEDS.t_right_left)


def test_colmap_itself_projects_as_the_camera_does(tmp_path: Path) -> None:
    """With COLMAP's own code, where `pycolmap` is installed."""
    pycolmap = pytest.importorskip("pycolmap")
    points = RAYS[RAYS[:, 2] > 0.4]
    for name in (name for name, (_, formats) in HOLDERS.items() if "colmap" in formats):
        rig = rig_of(Camera(name.split()[0], (1280, 960), FIXED | HOLDERS[name][0]))
        rig.save(tmp_path / name, "colmap")
        model = pycolmap.Reconstruction(tmp_path / name)
        image = next(image for image in model.images.values() if image.name == "right.png")
        expected, ok = rig.right.project(rig.right_from_left(points))
        pose, camera = image.cam_from_world(), model.cameras[image.camera_id]
        read = np.array([camera.img_from_cam(pose * point) for point in points[ok]])
        np.testing.assert_allclose(read - 0.5, expected[ok], atol=1e-9, err_msg=name)


def test_a_pixel_centre_is_a_half_in_colmap(tmp_path: Path) -> None:
    cameras, *_ = FISHEYES.save(tmp_path / "model", "colmap")
    line = next(line for line in cameras.read_text().splitlines() if line.startswith("1 "))
    assert line.split()[1:4] == ["OPENCV_FISHEYE", "848", "800"]
    assert float(line.split()[6]) == FISHEYES.left.params["cx"] + 0.5


def test_an_unknown_format_lists_those_that_are_written(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match=r"unknown format that is written 'kalibre'; did you mean kalibr"):
        FISHEYES.save(tmp_path / "chain.yaml", "kalibre")
    assert set(written_formats()) < set(calibration_formats())


def test_opencv_wants_a_suffix_of_its_own(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match=r"rig.toml: has no suffix of OpenCV's; expected .yml, .yaml"):
        FISHEYES.save(tmp_path / "rig.toml", "opencv")


def test_a_second_file_that_fails_leaves_the_first_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    FISHEYES.save(tmp_path, "ros")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    calls = iter(range(9))

    def full_disk(descriptor: int) -> None:
        if next(calls) == 1:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full_disk)
    with pytest.raises(InvalidInput, match=r"right.yaml: cannot be written"):
        RATIONALS.save(tmp_path, "ros")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_file_where_a_folder_should_be_says_so(tmp_path: Path) -> None:
    (tmp_path / "rig").write_text("mine")
    with pytest.raises(InvalidInput, match="rig: cannot be written"):
        FISHEYES.save(tmp_path / "rig", "ros")
    assert (tmp_path / "rig").read_text() == "mine"
