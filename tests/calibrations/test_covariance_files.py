"""Files that say how sure a calibration is: what they mean, and how those that say nothing are refused."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from rectbench import Camera, InvalidInput, RectbenchError, Rig, RigCovariance, load_covariance, load_rig
from tests.calibrations.calibration_files import R_RIGHT_LEFT, T_RIGHT_LEFT
from tests.calibrations.mutations import damaged

LEFT = {
    "fx": 461.6,
    "fy": 460.2,
    "cx": 362.7,
    "cy": 246.0,
    "k1": -0.277,
    "k2": 0.067,
    "p1": 7e-4,
    "p2": -3e-4,
}
PINHOLES = Rig(
    Camera("pinhole", (752, 480), LEFT),
    Camera("pinhole", (752, 480), LEFT | {"fx": 457.5, "k1": -0.281}),
    R_RIGHT_LEFT,
    T_RIGHT_LEFT,
    name="pinholes",
)


def kalibr_results(rig: Rig) -> str:
    """As Kalibr's `printParameters` writes them; NumPy has broken a long line."""
    lines = ["Calibration results", "====================", "Camera-system parameters:"]
    for number, camera in enumerate((rig.left, rig.right)):
        p = [camera.params[name] for name in ("k1", "k2", "p1", "p2", "fx", "fy", "cx", "cy")]
        lines += [
            f"\tcam{number} (/cam{number}/image_raw):",
            "\t type: <class 'aslam_cv.libaslam_cv_python.DistortedPinholeCameraGeometry'>",
            f"\t distortion: [{p[0]:.8f}  {p[1]:.8f}",
            f"  {p[2]:.8f} {p[3]:.8f}] +- [0.005 0.015 0.0005 0.0004]",
            f"\t projection: [{p[4]:.8f} {p[5]:.8f}  {p[6]:.8f}  {p[7]:.8f}] +- [0.8 0.7 0.07 {number + 1}.]",
            "\t reprojection error: [0.000121, -0.000036] +- [0.380177, 0.318709]",
            "",
        ]
    t = " ".join(f"{number:.8f}" for number in rig.t_right_left)
    return "\n".join(
        [
            *lines,
            "\tbaseline T_1_0:",
            "\t q: [-0.00087935 -0.00270995 -0.0008824   0.99999555] +- [0.0015 0.00034 0.00017]",
            f"\t t: [{t}] +- [0.0001 0.00006 0.0003]",
            "\n",
            "Target configuration",
            "====================",
            "\n  Type: aprilgrid",
        ]
    )


def interactive_calibration(camera: Camera, focal: tuple[float, float] = (0.9, 0.8)) -> str:
    """As OpenCV's interactive-calibration writes it."""
    p = camera.params
    storage = cv2.FileStorage(".yml", cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_MEMORY)
    storage.write("cameraMatrix", np.array([[p["fx"], 0, p["cx"]], [0, p["fy"], p["cy"]], [0, 0, 1]]))
    storage.write("cameraMatrix_std_dev", np.array([*focal, 0.3, 0.4]).reshape(4, 1))
    storage.write("dist_coeffs", np.array([[p[name] for name in ("k1", "k2", "p1", "p2", "k3")]]))
    storage.write("dist_coeffs_std_dev", np.array([0.01, 0.02, 1e-4, 2e-4, 0.0]).reshape(5, 1))
    storage.write("avg_reprojection_error", 0.3)
    text: str = storage.releaseAndGetString()
    return text


def read(folder: Path, *texts: str, rig: Rig = PINHOLES) -> RigCovariance:
    paths = [folder / f"covariance{number}.yaml" for number in range(len(texts))]
    for path, text in zip(paths, texts, strict=True):
        path.write_text(text)
    return load_covariance(paths if len(paths) > 1 else paths[0], rig)


def test_sigmas_by_name_are_those_of_plain_sizes(tmp_path: Path) -> None:
    text = "sigmas: {rotation_deg: 0.05, direction_deg: 0.3, focal_px: 0.5, left.k1: 0.001, pose.tx: 0.002}"
    found = read(tmp_path, text)
    stated = RigCovariance.from_sigmas(
        PINHOLES,
        rotation_deg=0.05,
        direction_deg=0.3,
        focal_px=0.5,
        parameters={"left.k1": 0.001, "pose.tx": 0.002},
    )
    np.testing.assert_array_equal(found.over(stated.parameters), stated.matrix)
    assert found.source == "covariance0"


def test_a_matrix_is_read_in_the_order_of_its_names(tmp_path: Path) -> None:
    found = read(
        tmp_path,
        "source: bundle adjustment\nparameters: [right.fx, pose.rx]\ncovariance: [[4, 1e-4], [1e-4, 1e-6]]",
    )
    assert (found.parameters, found.source) == (("right.fx", "pose.rx"), "bundle adjustment")
    np.testing.assert_array_equal(found.matrix, [[4, 1e-4], [1e-4, 1e-6]])


def test_kalibr_s_deviations_go_to_lenses_and_pose(tmp_path: Path) -> None:
    found = read(tmp_path, kalibr_results(PINHOLES))
    expected = {"left.fx": 0.8, "left.cy": 1.0, "right.cy": 2.0, "right.k2": 0.015, "left.p2": 0.0004}
    expected |= {"pose.rx": 0.0015, "pose.rz": 0.00017, "pose.tx": 1e-4, "pose.tz": 3e-4}
    for name, sigma in expected.items():
        assert found.sigma(name) == pytest.approx(sigma), name
    np.testing.assert_array_equal(found.matrix, np.diag(np.diag(found.matrix)))
    assert "without correlations" in found.source


def test_kalibr_s_results_fit_the_camchain_beside_them(tmp_path: Path) -> None:
    PINHOLES.save(tmp_path / "camchain.yaml", "kalibr")
    found = read(tmp_path, kalibr_results(PINHOLES), rig=load_rig(tmp_path / "camchain.yaml"))
    assert len(found.parameters) == 22


@pytest.mark.parametrize("model", ["unified", "double-sphere", "extended-unified"])
def test_kalibr_s_projections_begin_with_what_is_before_the_focal_length(tmp_path: Path, model: str) -> None:
    extra = {"unified": ("xi",), "double-sphere": ("xi", "alpha"), "extended-unified": ("alpha", "beta")}[
        model
    ]
    params = dict.fromkeys(extra, 0.6) | {name: LEFT[name] for name in ("fx", "fy", "cx", "cy")}
    lens = Camera(model, (752, 480), params)
    rig = Rig(lens, lens, PINHOLES.R_right_left, PINHOLES.t_right_left)
    values = " ".join(str(params[name]) for name in (*extra, "fx", "fy", "cx", "cy"))
    sigmas = " ".join(str(0.001 * (place + 1)) for place in range(len(params)))
    cameras = [
        f"cam{n} (/c{n}):\n distortion: [] +- []\n projection: [{values}] +- [{sigmas}]\n" for n in (0, 1)
    ]
    pose = kalibr_results(rig.__class__(PINHOLES.left, PINHOLES.right, rig.R_right_left, rig.t_right_left))
    found = read(tmp_path, "\n".join([*cameras, pose[pose.index("\tbaseline") :]]), rig=rig)
    for place, name in enumerate((*extra, "fx", "fy", "cx", "cy")):
        assert found.sigma(f"right.{name}") == pytest.approx(0.001 * (place + 1))


def test_opencv_s_deviations_are_one_file_a_camera_left_first(tmp_path: Path) -> None:
    found = read(
        tmp_path, interactive_calibration(PINHOLES.left), interactive_calibration(PINHOLES.right, (1.9, 1.8))
    )
    assert (found.sigma("left.fx"), found.sigma("right.fx")) == pytest.approx((0.9, 1.9))
    assert (found.sigma("left.cy"), found.sigma("right.p2")) == pytest.approx((0.4, 2e-4))
    assert "left.k3" not in found.uncertain
    assert found.over(("left.fx", "left.fy"))[0, 1] == 0


def test_a_focal_ratio_that_opencv_held_makes_both_move_as_one(tmp_path: Path) -> None:
    held = (0.0, 0.8)
    found = read(tmp_path, *(interactive_calibration(c, held) for c in (PINHOLES.left, PINHOLES.right)))
    ratio = LEFT["fx"] / LEFT["fy"]
    expected = 0.64 * np.outer([ratio, 1], [ratio, 1])
    np.testing.assert_allclose(found.over(("left.fx", "left.fy")), expected)


def test_what_calibrate_camera_extended_gives_is_read(tmp_path: Path) -> None:
    numbers = np.linspace(0.1, 1.6, 16).tolist()
    texts = [f"stdDeviationsIntrinsics: {[[n] for n in [*numbers, 0, 0]]}"] * 2
    found = read(tmp_path, *texts)
    assert found.sigma("right.s4") == pytest.approx(1.6)
    assert found.sigma("left.p1") == pytest.approx(0.7)


KALIBR = kalibr_results(PINHOLES)


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        (["sigmas: {rotation_deg: wide}"], "sigmas.rotation_deg is 'wide'; expected a standard deviation"),
        (["sigmas: {rotation_deg: -1}"], "sigmas: the standard deviation rotation_deg is -1"),
        (["sigmas: {yaw_deg: 1}"], "sigmas: unknown parameter of a rig 'yaw_deg'"),
        (["sigmas: {left.xi: 1}"], r"sigmas: unknown parameter of the left lens \(pinhole\) 'xi'"),
        (['sigmas: {"\\uFEFFleft.k1": wide}'], "sigmas. left.k1 is 'wide'; expected a standard deviation"),
        (["sigmas: 3"], "sigmas is '3'; expected standard deviations by name"),
        (["sigma: {rotation_deg: 1}"], "unknown key 'sigma'; did you mean sigmas"),
        (["sigmas: {}\ncovariance: [[1]]"], "sigmas stands beside covariance"),
        (["source: me"], "parameters is missing; expected sigmas:, or parameters: and covariance:"),
        (["parameters: [pose.rx]"], "covariance is missing; expected a 1x1 matrix"),
        (["parameters: []\ncovariance: []"], "parameters is .*; expected a list of 1 to 100 names"),
        (["parameters: [[a]]\ncovariance: [[1]]"], "parameters.0 is .*; expected a name"),
        (["parameters: [pose.rx]\ncovariance: [[1, 2]]"], "covariance.0 is .*; expected 1 finite numbers"),
        (["parameters: [pose.rx, pose.ry]\ncovariance: [[1, 0], [1, 1]]"], "covariance: .* symmetric"),
        (["parameters: [pose.rx, pose.ry]\ncovariance: [[1, 2], [2, 1]]"], "covariance: .* positive semidef"),
        (["parameters: [left.k9]\ncovariance: [[1]]"], "covariance: unknown parameter of the left lens"),
        ([KALIBR.replace("cam1", "cam2")], "cam1 is missing; expected Kalibr's results of two cameras"),
        (
            [KALIBR.replace("0.015 ", "")],
            "cam0 distortion is .*; expected finite values and their deviations",
        ),
        ([KALIBR.replace("0.015", "1e999")], "cam0 distortion is .*; expected finite values"),
        ([KALIBR.replace("0.015", "-0.015")], "cam0: the standard deviation of k2 is -0.015"),
        ([KALIBR.replace("461.6", "561.6")], "cam0 projection and distortion are .* the rig's left lens"),
        ([KALIBR.replace("projection", "p")], r"cam0 projection is missing; expected projection: \[values\]"),
        ([KALIBR.replace("baseline", "b")], "baseline T_1_0 is missing"),
        ([interactive_calibration(PINHOLES.left)], "is of one camera; expected a file of each camera"),
        ([interactive_calibration(PINHOLES.left), "a: 1"], "cameraMatrix_std_dev is missing"),
        (["stdDeviationsIntrinsics: [1, 2]"] * 2, "stdDeviationsIntrinsics is .*; expected standard dev"),
        ([f"stdDeviationsIntrinsics: {[1] * 18}"] * 2, "a sensor that is not tilted"),
        (["a: 1"] * 3, "3 covariance files were given"),
        ([""], "is empty"),
    ],
)
def test_what_says_nothing_is_refused_by_file_and_key(tmp_path: Path, texts: list[str], message: str) -> None:
    with pytest.raises(InvalidInput, match=message) as refusal:
        read(tmp_path, *texts)
    assert str(refusal.value).isprintable()
    assert len(texts) == 3 or str(tmp_path) in str(refusal.value)


def test_opencv_s_deviations_of_another_lens_are_refused(tmp_path: Path, rig: Rig) -> None:
    with pytest.raises(InvalidInput, match="is of OpenCV's pinhole model; expected one of the left lens"):
        read(tmp_path, *[interactive_calibration(PINHOLES.left)] * 2, rig=rig)


OWN = "parameters: [pose.rx, pose.ry, left.k1]\ncovariance: [[1, 0, 0], [0, 2, 0.1], [0, 0.1, 3]]"


@pytest.mark.parametrize(
    "text", [OWN, KALIBR, "sigmas: {rotation_deg: 0.05, left.k1: 1e-3}"], ids=["matrix", "kalibr", "sigmas"]
)
def test_damaged_files_give_a_covariance_or_one_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / "covariance.yaml"
    for number in range(150):
        path.write_bytes(damaged(text.encode(), np.random.default_rng(number)))
        message = str(path)
        try:
            assert isinstance(load_covariance(path, PINHOLES), RigCovariance)
        except RectbenchError as error:
            message = str(error)
        assert message.isprintable(), number
        assert str(tmp_path) in message, (number, message)
