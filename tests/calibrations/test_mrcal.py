"""mrcal's cameramodels: its own pixels, poses from the reference, its parser's liberties, and damage."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rectbench import InvalidInput, load_rig
from rectbench.calibrations.formats.toolboxes.mrcal import parse

RT_LEFT = [0.02, -0.3, -0.01, 1.0, 2.0, -3.0]
RT_RIGHT = [0.2, 0.1, -0.01, 2.0, 2.0, -2.5]
OPENCV8 = [1512, 1112, 500, 333, -0.012, 0.035, -0.001, 0.002, 0.019, 0.014, -0.056, 0.050]
CAHVOR = [4842.918, 4842.771, 1970.528, 1085.302, -0.001, 0.002, -0.637, -0.002, 0.016]


def cameramodel(lensmodel: str, intrinsics: list[float], rt_cam_ref: list[float]) -> str:
    """A file as mrcal writes it."""
    return f"""\
# generated on 2020-11-14 21:49:59 with   mrcal-calibrate-cameras 'frame*.jpg'
# # # Npoints_all {{ [ not a dictionary yet
{{
    'lensmodel':  '{lensmodel}',

    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....
    'intrinsics': [ {" ".join(f"{number!r}," for number in intrinsics)}],

    'valid_intrinsics_region': [
    [ 622, 0 ],
    [ 0, 634 ],
],

    # extrinsics are rt_fromref
    'extrinsics': [ {" ".join(f"{number!r}," for number in rt_cam_ref)}],

    'imagersize': [ 4000, 2200,],

    'icam_intrinsics': 0,

    # The optimization inputs contain all the data used to compute this model.
    'optimization_inputs': b'P)h>@6aWAK2mk;8AprP8D`%|$007_s000gE6aZ;%baH8Kb7^C9E^csn0RRvH-~a#s#{{}}[(,:',
}}
"""


def write_pair(folder: Path, left: str, right: str | None = None) -> list[Path]:
    paths = [folder / "left.cameramodel", folder / "right.cameramodel"]
    for path, text in zip(paths, (left, left if right is None else right), strict=True):
        path.write_text(text)
    return paths


# mrcal, test/test-projections.py (Apache-2.0): three points and their pixels by each model.
POINTS = [[1.0, 2.0, 10.0], [-1.1, 0.3, 1.0], [-0.9, -1.5, 1.0]]
MRCAL_PIXELS = {
    "LENSMODEL_PINHOLE": (OPENCV8[:4], [[651.2, 555.4], [-1163.2, 666.6], [-860.8, -1335.0]]),
    "LENSMODEL_STEREOGRAPHIC": (
        OPENCV8[:4],
        [[649.35582325, 552.6874014], [-821.79644263, 598.1222302], [-402.7032835, -773.48815174]],
    ),
    "LENSMODEL_OPENCV4": (
        OPENCV8[:8],
        [[651.27371, 555.23042], [-1223.38516, 678.01468], [-1246.7310448, -1822.799928]],
    ),
    "LENSMODEL_OPENCV5": (
        OPENCV8[:9],
        [[651.2740691, 555.2309482], [-1292.8121176, 691.9401448], [-1987.550162, -2730.85863427]],
    ),
    "LENSMODEL_OPENCV8": (
        OPENCV8,
        [[651.1885442, 555.10514968], [-1234.45480366, 680.23499814], [-770.03274263, -1238.4871943]],
    ),
    "LENSMODEL_CAHVOR": (
        CAHVOR,
        [[2143.17840406, 1442.93419919], [-92.63813066, 1653.09646897], [-249.83199315, -2606.46477164]],
    ),
}


@pytest.mark.parametrize("lensmodel", MRCAL_PIXELS)
def test_each_model_projects_as_mrcal_does(tmp_path: Path, lensmodel: str) -> None:
    intrinsics, expected = MRCAL_PIXELS[lensmodel]
    paths = write_pair(
        tmp_path, cameramodel(lensmodel, intrinsics, RT_LEFT), cameramodel(lensmodel, intrinsics, RT_RIGHT)
    )
    pixels, ok = load_rig(paths).left.project(POINTS)
    # The made-up lens of mrcal's test folds before its last point; there it has no ray to give.
    assert ok[:2].all()
    np.testing.assert_allclose(pixels[ok], np.array(expected)[ok], rtol=0, atol=1e-7)


def test_twelve_coefficients_are_opencv_s(tmp_path: Path) -> None:
    intrinsics = [
        1512,
        1112,
        500,
        333,
        -0.1,
        0.03,
        1e-3,
        2e-3,
        0.01,
        0.02,
        0.03,
        0.01,
        1e-3,
        2e-3,
        -1e-3,
        3e-3,
    ]
    left, right = (cameramodel("LENSMODEL_OPENCV12", intrinsics, rt) for rt in (RT_LEFT, RT_RIGHT))
    rig = load_rig(write_pair(tmp_path, left, right))
    rays = np.array([[0.3, -0.2, 1.0], [-0.4, 0.5, 2.0]])
    K = np.array([[1512, 0, 500], [0, 1112, 333], [0, 0, 1.0]])
    expected, _ = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), K, np.array(intrinsics[4:]))
    np.testing.assert_allclose(rig.left.project(rays)[0], expected[:, 0], rtol=0, atol=1e-9)
    assert rig.left.size == (4000, 2200)


def test_the_pose_is_from_the_left_camera_to_the_right(tmp_path: Path) -> None:
    left, right = (cameramodel("LENSMODEL_OPENCV8", OPENCV8, rt) for rt in (RT_LEFT, RT_RIGHT))
    rig = load_rig(write_pair(tmp_path, left, right))
    points_ref = np.random.default_rng(2).normal(size=(20, 3))
    in_left, in_right = (
        points_ref @ cv2.Rodrigues(np.array(rt[:3]))[0].T + rt[3:] for rt in (RT_LEFT, RT_RIGHT)
    )
    np.testing.assert_allclose(rig.right_from_left(in_left), in_right, atol=1e-12)
    swapped = load_rig([tmp_path / "right.cameramodel", tmp_path / "left.cameramodel"])
    np.testing.assert_allclose(swapped.R_right_left, rig.R_right_left.T, atol=1e-14)


def test_mrcal_s_own_files_are_read(real_data: Path) -> None:
    folder = real_data / "calib/mrcal"
    rig = load_rig([folder / f"cam{number}.opencv8.cameramodel" for number in (0, 1)])
    assert rig.left.params["k1"] == -0.01266096516
    assert rig.right.params["fx"] == 1761
    R = [Rotation.from_rotvec(rt[:3]).as_matrix() for rt in (RT_LEFT, RT_RIGHT)]
    np.testing.assert_allclose(rig.R_right_left, R[1] @ R[0].T, atol=1e-14)
    np.testing.assert_allclose(
        rig.t_right_left, np.array(RT_RIGHT[3:]) - rig.R_right_left @ RT_LEFT[3:], atol=1e-13
    )
    assert load_rig(folder) == rig


# What mrcal's own parser takes, its test/test-parser-cameramodel.c: either quote, bytes, parentheses,
# comments anywhere, unknown keys, the newer name of the pose.
LIBERTIES = """
{ # a comment, with ' and {
    'lensmodel' :  b"LENSMODEL_CAHVOR", 'f': 'g', 'jj': # fff # ads 'q',
    'b', "vvvv": [ 1,2, [4,5],[3,[4,3,[]],444], ],
    b'rt_cam_ref' :[ 0., 1, 2, 33, 44e4, -55.3E-3, ],
    "intrinsics": (4, 3, 4, 5, 0, 1, .3, +5, 4. ),    'imagersize': [110, 400],
    b'xxx': b'asdf;lkj&*()DSFEWR]]{}}}' }
# the end
"""


def test_what_mrcal_s_parser_takes_is_read(tmp_path: Path) -> None:
    other = LIBERTIES.replace("33, 44e4", "33.5, 44e4")
    rig = load_rig(write_pair(tmp_path, LIBERTIES, other))
    assert (rig.left.model, rig.left.size) == ("cahvor", (110, 400))
    assert [rig.left.params[name] for name in ("beta", "r0", "r1", "r2")] == [1, 0.3, 5, 4]
    np.testing.assert_allclose(rig.t_right_left, [0.5, 0, 0], atol=1e-9)


@pytest.mark.parametrize(
    ("key", "value"),
    [("lens_model", "LENSMODEL_OPENCV8"), ("distortion_model", "DISTORTION_OPENCV8")],
)
def test_old_names_of_the_model_are_known(tmp_path: Path, key: str, value: str) -> None:
    left, right = (cameramodel("LENSMODEL_OPENCV8", OPENCV8, rt) for rt in (RT_LEFT, RT_RIGHT))
    now = "'lensmodel':  'LENSMODEL_OPENCV8'"
    old = [text.replace(now, f"'{key}': '{value}'") for text in (left, right)]
    (tmp_path / "now").mkdir()
    assert load_rig(write_pair(tmp_path, *old)) == load_rig(write_pair(tmp_path / "now", left, right))


def test_the_content_tells_the_kind_whatever_the_suffix(tmp_path: Path) -> None:
    paths = []
    for number, rt in enumerate((RT_LEFT, RT_RIGHT)):
        paths.append(tmp_path / f"{number}.json")
        paths[-1].write_text(cameramodel("LENSMODEL_CAHVOR", CAHVOR, rt))
    assert load_rig(paths).right.model == "cahvor"


def test_a_file_with_much_to_optimise_is_read(tmp_path: Path) -> None:
    left, right = (cameramodel("LENSMODEL_CAHVOR", CAHVOR, rt) for rt in (RT_LEFT, RT_RIGHT))
    long = left.replace("b'P)h", "b'" + "P)h" * 2_000_000)
    assert load_rig(write_pair(tmp_path, long, right)).left.params["fx"] == 4842.918


GOOD = cameramodel("LENSMODEL_CAHVOR", CAHVOR, RT_LEFT)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "LENSMODEL_CAHVOR",
            "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=20_fov_x_deg=170",
            "expected a model without splines, which mrcal-convert-lensmodel fits",
        ),
        ("LENSMODEL_CAHVOR", "LENSMODEL_CAHVORE_linearity=0.34", "expected a lens with one centre"),
        ("LENSMODEL_CAHVOR", "LENSMODEL_LONLAT", "expected a lens, which a panorama is not"),
        (
            "LENSMODEL_CAHVOR",
            "LENSMODEL_OPENCV6",
            "'LENSMODEL_OPENCV6'; expected LENSMODEL_PINHOLE, LENSMODEL_",
        ),
        ("'lensmodel'", "'lens'", "lensmodel is missing; expected LENSMODEL_PINHOLE"),
        ("0.016", "0.016, 1", "expected 9 finite numbers (fx fy cx cy alpha beta r0 r1 r2)"),
        ("0.016", "1e999", "intrinsics is ['4842.918'"),
        ("4842.918", "-1", "intrinsics: cahvor has fx = -1; expected a number in (0, inf)"),
        ("'intrinsics'", "'intrinsic'", "intrinsics is missing"),
        ("'imagersize'", "'imager_size'", "imagersize is missing; expected [width, height] in whole pixels"),
        ("[ 4000, 2200,]", "[ 4000, 0]", "imagersize is ['4000', '0']; expected [width, height]"),
        ("'extrinsics'", "'extrinsic'", "does not say where its camera stands; expected a third file"),
        (
            "-0.3, -0.01,",
            "-0.3,",
            "extrinsics is ['0.02', '-0.3', '1.0', '2.0', '-3.0']; expected a rotation",
        ),
        ("-0.3, -0.01,", "-0.3, nan,", "extrinsics is "),
        ("-0.3, -0.01,", "-0.3, 1e300,", "extrinsics: its rotation is not finite"),
        ("'icam_intrinsics'", "'intrinsics'", "'intrinsics' is there twice; expected different keys"),
        ("4000, 2200,]", "4000, 2200", "':' follows a value; expected a comma or ']'"),
        ("{\n", "", "begins with 'lensmodel'; expected a Python dictionary"),
        ("\n}\n", "\n} 3\n", "goes on after its end with '3'"),
        ("\n}\n", "\n", "ends amid a dictionary"),
        ("'icam_intrinsics': 0", "'icam_intrinsics' 0", "no colon follows the key 'icam_intrinsics'"),
        ("'icam_intrinsics': 0", "3: 0", "'3' stands for a key"),
        ("'icam_intrinsics': 0", "'icam_intrinsics': }", "'}' stands for a value"),
        ("'icam_intrinsics': 0", "'a': " + "[" * 30, "is nested too deeply"),
        ("'icam_intrinsics': 0", "'a': [" + "0," * 90_000 + "]", "has over 20000 values"),
        ("'icam_intrinsics': 0", "'a': __import__('os')", "'(' follows a value"),
    ],
)
def test_a_fault_is_said_in_one_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in GOOD
    right = cameramodel("LENSMODEL_CAHVOR", CAHVOR, RT_RIGHT)
    with pytest.raises(InvalidInput) as caught:
        load_rig(write_pair(tmp_path, GOOD.replace(old, new, 1), right))
    assert message in str(caught.value)
    assert str(caught.value).startswith(str(tmp_path / "left.cameramodel"))
    assert "\n" not in str(caught.value)


def test_two_cameras_never_posed_are_no_rig(tmp_path: Path) -> None:
    both = cameramodel("LENSMODEL_CAHVOR", CAHVOR, [0.0] * 6)
    with pytest.raises(InvalidInput, match="put both cameras at one place"):
        load_rig(write_pair(tmp_path, both))


@pytest.mark.parametrize(
    "text", ["{'a':" + "[" * 200_000, "#\n" * 200_000, "{'" + "\\" * 200_001, "{'a':'" * 9]
)
def test_a_text_made_to_be_slow_is_refused_at_once(text: str) -> None:
    with pytest.raises(InvalidInput):
        parse(text, "file")
