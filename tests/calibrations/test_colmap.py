"""COLMAP's models: every camera, text and binary, images and rigs, and COLMAP's own numbers."""

from __future__ import annotations

import base64
import struct
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rectbench import InvalidInput, Rig, load_rig
from rectbench.calibrations.formats.photogrammetry.colmap import MODELS, NUMBERED, read_colmap

R_WORLD = Rotation.from_euler("xyz", [10, 20, -30], degrees=True)
R_RIG = Rotation.from_euler("xyz", [1, -2, 3], degrees=True)
T_WORLD, T_RIG = np.array([1.0, 2.0, 3.0]), np.array([-0.12, 0.01, -0.02])

# What COLMAP 4.2.1 writes for a rig of a THIN_PRISM_FISHEYE and a SIMPLE_RADIAL_FISHEYE, these poses, one
# frame with two images, of which the left one has two key points.
COLMAP_BINARY = {
    "rigs": """
        AQAAAAAAAAADAAAAAgAAAAAAAAABAAAAAAAAAAcAAAABvLIW45n77z/PG/k2d8yCP1bd3aBtoZG/e8Bk8bv0mj+4HoXrUbi+v3sU
        rkfheoQ/exSuR+F6lL8=""",
    "cameras": """
        AgAAAAAAAAABAAAACgAAAKAXAAAAAAAAwA8AAAAAAACkcD0K16aqQNejcD0KpKpArkfhepTCp0DhehSuR3ifQOIBZVOu8Mo/UaVm
        D7QCyz9eYZeMvH3Wvjg4CYyS40A//wWCABk6xL+qm4u/7QnaP8k8XDXCMBa/6spTlTc5TD8HAAAACAAAAAAFAAAAAAAAwAMAAAAA
        AAAAAAAAAAB5QAAAAAAAAIRAAAAAAAAAfkB7FK5H4XqEvw==""",
    "images": """
        AgAAAAAAAAABAAAAwOxYd+gy7j84eRTHzFfAP71kSc1di8I/sm8h4LAv0b8AAAAAAADwPwAAAAAAAABAAAAAAAAACEABAAAAbGVm
        dC8wMDAxLmpwZwACAAAAAAAAAAAAAAAAACRAAAAAAAAANED//////////wAAAAAAAD5AAAAAAAAARED//////////wIAAABupjbb
        f3PuPxf3+THvi8E/AUbtjEwzwT+xPzKaAbnOv7iuSneBc+U/eWEwS+4CAEDRZkgZR2EIQAcAAAByaWdodC8wMDAxLmpwZwAAAAAA
        AAAAAA==""",
}
COLMAP_TEXT = {
    "rigs": """\
# Rig calib list with one line of data per calib:
#   RIG_ID, NUM_SENSORS, REF_SENSOR_TYPE, REF_SENSOR_ID, SENSORS[] as (SENSOR_TYPE, SENSOR_ID, ...)
# Number of rigs: 1
3 2 CAMERA 1 CAMERA 7 1 0.99946302750830496 0.0091790498401120007 -0.017217362350007669 \
0.026324211700910354 -0.12 0.01 -0.02
""",
    "cameras": """\
# Camera list with one line of data per camera:
#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
# Number of cameras: 2
1 THIN_PRISM_FISHEYE 6048 4032 3411.4200000000001 3410.02 3041.29 2014.0699999999999 0.21046999999999999 \
0.21102000000000001 -5.3623100000000002e-06 0.00051541 -0.158023 0.406856 -8.4649900000000004e-05 \
0.00086131300000000005
7 SIMPLE_RADIAL_FISHEYE 1280 960 400 640 480 -0.01
""",
    "images": """\
# Image list with two lines of data per image:
#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME
#   POINTS2D[] as (X, Y, POINT3D_ID)
# Number of images: 2, mean observations per image: 0
1 0.94371436414748899 0.12767944069578063 0.14487812541736914 -0.26853582275156918 1 2 3 1 left/0001.jpg
10 20 -1 30 40 -1
2 0.95159905257351141 0.13708295765166476 0.13437802201455898 -0.24002094296565482 0.67034982012906763 \
2.0014310716762194 3.0474988913746093 7 right/0001.jpg

""",
}
# Where COLMAP's `project_point` puts two points of the world.
POINTS_WORLD = np.array([[0.3, -0.2, 1.0], [1.5, 0.7, 2.0]])
PIXELS_LEFT = [[4220.80245194, 3224.52411358], [5269.83142668, 2927.79933708]]
PIXELS_RIGHT = [[739.42460698, 615.08232877], [846.91008602, 581.8517863]]


def write_model(folder: Path, suffix: str, *kinds: str) -> Path:
    """COLMAP's files of these kinds; the path of its cameras."""
    for kind in kinds:
        text, binary = COLMAP_TEXT[kind].encode(), base64.b64decode(COLMAP_BINARY[kind])
        (folder / f"{kind}{suffix}").write_bytes(binary if suffix == ".bin" else text)
    return folder / f"cameras{suffix}"


def check_projections(rig: Rig) -> None:
    points_left = R_WORLD.apply(POINTS_WORLD) + T_WORLD
    left, right = rig.left.project(points_left), rig.right.project(rig.right_from_left(points_left))
    assert left[1].all()
    assert right[1].all()
    np.testing.assert_allclose(left[0] + 0.5, PIXELS_LEFT, rtol=0, atol=1e-7)
    np.testing.assert_allclose(right[0] + 0.5, PIXELS_RIGHT, rtol=0, atol=1e-7)


@pytest.mark.parametrize("suffix", [".txt", ".bin"])
@pytest.mark.parametrize("kinds", [("cameras", "images"), ("cameras", "rigs"), ("cameras", "images", "rigs")])
def test_colmap_s_own_files_project_as_colmap_does(
    tmp_path: Path, suffix: str, kinds: tuple[str, ...]
) -> None:
    path = write_model(tmp_path, suffix, *kinds)
    for rig in (load_rig(path), load_rig(tmp_path)):
        check_projections(rig)
        np.testing.assert_allclose(rig.R_right_left, R_RIG.as_matrix(), rtol=0, atol=1e-14)
        np.testing.assert_allclose(rig.t_right_left, T_RIG, rtol=0, atol=1e-14)
        assert (rig.left.size, rig.right.size) == ((6048, 4032), (1280, 960))
        assert "arbitrary" in rig.source
        assert ("the rig's camera 7 (right)" in rig.source) == ("rigs" in kinds)


def test_the_binary_files_go_before_the_text_as_in_colmap(tmp_path: Path) -> None:
    write_model(tmp_path, ".bin", "cameras", "images")
    write_model(tmp_path, ".txt", "cameras", "images")
    (tmp_path / "images.txt").write_text("damaged")
    check_projections(load_rig(tmp_path))


@pytest.mark.parametrize("suffix", [".txt", ".bin"])
def test_images_asked_for_by_name_come_in_that_order(tmp_path: Path, suffix: str) -> None:
    path = write_model(tmp_path, suffix, "cameras", "images", "rigs")
    rig = load_rig(path, cameras=["right/0001.jpg", "left/0001.jpg"])
    assert (rig.left.model, rig.right.model) == ("kannala-brandt", "thin-prism-fisheye")
    np.testing.assert_allclose(rig.R_right_left, R_RIG.as_matrix().T, rtol=0, atol=1e-14)
    same = read_colmap(path, ["scene/images/right/0001.jpg", "scene/images/left/0001.jpg"])
    assert same == rig
    assert "image right/0001.jpg (left) and image left/0001.jpg (right)" in rig.source


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["left/0001.jpg", "left/0002.jpg"], "holds no 'left/0002.jpg'; expected one image of that name"),
        (["0001.jpg", "left/0001.jpg"], "holds 2 images that could be '0001.jpg'; expected one"),
        (
            ["left/0001.jpg", "left/0001.jpg"],
            "line 5: is asked for as left and as right; expected two images",
        ),
    ],
)
def test_names_of_no_image_or_two_are_refused(tmp_path: Path, names: list[str], message: str) -> None:
    path = write_model(tmp_path, ".txt", "cameras", "images")
    with pytest.raises(InvalidInput) as caught:
        load_rig(path, cameras=names)
    assert message in str(caught.value)


def test_the_unit_stated_beside_the_model_is_its_scale(tmp_path: Path) -> None:
    path = write_model(tmp_path, ".bin", "cameras", "images")
    rig = load_rig(path, unit="mm")
    np.testing.assert_allclose(rig.t_right_left, T_RIG * 1e-3, rtol=1e-12)
    assert "taken to be in mm" in rig.source


# A camera of every model: its parameters as COLMAP lists them, a ray, and COLMAP's pixel of that.
RAY = [0.4, -0.2, 1.0]
EVERY_MODEL = {
    "SIMPLE_PINHOLE": ([300, 640, 480], [760.0, 420.0]),
    "PINHOLE": ([300, 310, 640, 480], [760.0, 418.0]),
    "SIMPLE_RADIAL": ([300, 640, 480, -0.2], [755.2, 422.4]),
    "RADIAL": ([300, 640, 480, -0.2, 0.1], [755.68, 422.16]),
    "OPENCV": ([300, 310, 640, 480, -0.2, 0.1, 0.01, -0.02], [752.08, 422.092]),
    "OPENCV_FISHEYE": ([300, 310, 640, 480, 0.1, -0.05, 0.02, -0.01], [754.6717100726, 420.7529497958]),
    "FULL_OPENCV": (
        [300, 310, 640, 480, -0.2, 0.1, 0.01, -0.02, 0.03, 0.1, 0.02, 0.01],
        [749.74221456, 423.2998558107],
    ),
    "FOV": ([300, 310, 640, 480, 0.9], [761.5923876384, 417.1772663868]),
    "SIMPLE_RADIAL_FISHEYE": ([300, 640, 480, -0.1], [750.8456164376, 424.5771917812]),
    "RADIAL_FISHEYE": ([300, 640, 480, -0.1, 0.05], [751.0220753322, 424.4889623339]),
    "THIN_PRISM_FISHEYE": (
        [300, 310, 640, 480, 0.1, -0.05, 0.01, -0.02, 0.02, -0.01, 0.03, 0.04],
        [753.0800679282, 424.590575855],
    ),
    "RAD_TAN_THIN_PRISM_FISHEYE": (
        [300, 310, 640, 480, 0.1, -0.05, 0.02, -0.01, 0.02, -0.03, 0.01, -0.02, 0.03, 0.04, -0.02, 0.01],
        [759.0171602587, 417.6856721532],
    ),
    "SIMPLE_DIVISION": ([300, 640, 480, -0.3], [753.552872566, 423.223563717]),
    "DIVISION": ([300, 310, 640, 480, 0.4], [771.5341561574, 412.0406859854]),
    "SIMPLE_FISHEYE": ([300, 640, 480], [752.8412032681, 423.5793983659]),
    "FISHEYE": ([300, 310, 640, 480], [752.8412032681, 421.6987116448]),
    "EUCM": ([300, 310, 640, 480, 0.6, 1.1], [752.9176193544, 421.6592300002]),
    # Of a COLMAP newer than that which gave the other pixels: its own formula.
    "BROWN_CONRADY": (
        [300, 640, 480, -0.2, 0.1, 0.03, 0.01, -0.02],
        [
            640 + 300 * (0.4 * (1 - 0.04 + 0.004 + 0.00024) + 2 * 0.01 * -0.08 - 0.02 * (0.2 + 0.32)),
            480 + 300 * (-0.2 * (1 - 0.04 + 0.004 + 0.00024) - 2 * 0.02 * -0.08 + 0.01 * (0.2 + 0.08)),
        ],
    ),
}


def model_with(name: str, params: list[float], folder: Path, suffix: str) -> Path:
    """A model whose camera 1 is this one, and whose two images see through it."""
    path = write_model(folder, suffix, "cameras", "images")
    if suffix == ".bin":
        number = next(number for number, (model, _) in NUMBERED.items() if model == name)
        camera = struct.pack(f"<QIiQQ{len(params)}d", 2, 1, number, 1280, 960, *params)
        path.write_bytes(camera + base64.b64decode(COLMAP_BINARY["cameras"])[-56:])
    else:
        numbers = " ".join(map(repr, params))
        path.write_text(f"1 {name} 1280 960 {numbers}\n7 SIMPLE_PINHOLE 1280 960 400 640 480\n")
    return path


# No release of COLMAP tells the number of BROWN_CONRADY in binary files.
IN_TEXT = [(name, ".txt") for name in EVERY_MODEL]
IN_BINARY = [(name, ".bin") for name in EVERY_MODEL if name != "BROWN_CONRADY"]


@pytest.mark.parametrize(("name", "suffix"), IN_TEXT + IN_BINARY)
def test_every_model_projects_as_colmap_does(tmp_path: Path, name: str, suffix: str) -> None:
    params, expected = EVERY_MODEL[name]
    left = load_rig(model_with(name, params, tmp_path, suffix)).left
    pixel, ok = left.project(RAY)
    assert ok
    np.testing.assert_allclose(pixel + 0.5, expected, rtol=0, atol=1e-8)


def test_there_is_an_example_of_every_model() -> None:
    assert {*EVERY_MODEL, "EQUIRECTANGULAR"} == set(MODELS)


HEADER = "1 1 0 0 0 0 0 0 1 a.jpg\n\n2 1 0 0 0 1 0 0 1 b.jpg\n\n"


@pytest.mark.parametrize(
    ("cameras", "images", "message"),
    [
        ("1 EQUIRECTANGULAR 1280 960 1280 960", HEADER, "line 1: camera 1: EQUIRECTANGULAR is a panorama"),
        ("1 PINHOL 640 480 1 1 1 1", HEADER, "unknown COLMAP camera model 'PINHOL'; did you mean PINHOLE"),
        ("1 PINHOLE 640 480 1 1 1", HEADER, "camera 1: has 3 parameters; expected 4 (fx fy cx cy)"),
        (
            "1 PINHOLE 640 480 -1 1 1 1",
            HEADER,
            "camera 1: pinhole has fx = -1; expected a number in",
        ),
        ("1 PINHOLE 640 480 1e999 1 1 1", HEADER, "line 1: '1e999' is no finite number"),
        ("1 PINHOLE 0 480 1 1 1 1", HEADER, "camera 1: size is (0.0, 480.0); expected (width, height)"),
        ("1 PINHOLE 640 480 1 1 1 1\n1 PINHOLE 640 480 1 1 1 1", HEADER, "line 2: camera 1: is there twice"),
        ("2 PINHOLE 640 480 1 1 1 1", HEADER, "images.txt: line 1: its camera 1 is missing; expected it in"),
        ("1 PINHOLE 640 480 1 1 1 1", None, "images.txt: cannot be read (No such file"),
        ("1 PINHOLE 640 480 1 1 1 1", "# none\n", "images.txt: holds 0 images; expected two at least"),
        ("1 PINHOLE 640 480 1 1 1 1", HEADER[:25], "images.txt: holds 1 images; expected two at least"),
        ("1 PINHOLE 640 480 1 1 1 1", HEADER.replace("\n\n", "\n"), "line 2: is an image; expected the line"),
        ("1 PINHOLE 640 480 1 1 1 1", "1 1 0 0 0\n", "line 1: is '1 1 0 0 0'; expected an image's number"),
        (
            "1 PINHOLE 640 480 1 1 1 1",
            HEADER.replace("1 0 0 0 0", "2 0 0 0 0"),
            "have the length 2; expected 1",
        ),
        ("1 PINHOLE 640 480 1 1 1 1", HEADER.replace("2 1", "2 nan"), "line 3: 'nan' is no finite number"),
        ("1 PINHOLE 640 480 1 1 1 1", HEADER.replace(" 1 0 0 1 b", " 0 0 0 1 b"), "the baseline is zero"),
    ],
)
def test_a_fault_in_a_text_file_names_its_line(
    tmp_path: Path, cameras: str, images: str | None, message: str
) -> None:
    (tmp_path / "cameras.txt").write_text(f"{cameras}\n")
    if images is not None:
        (tmp_path / "images.txt").write_text(images)
    with pytest.raises(InvalidInput) as caught:
        load_rig(tmp_path / "cameras.txt")
    assert message in str(caught.value)
    assert str(caught.value).startswith(str(tmp_path))
    assert "\n" not in str(caught.value)


def record(count: int, *fields: bytes) -> bytes:
    return struct.pack("<Q", count) + b"".join(fields)


PINHOLE = struct.pack("<IiQQ4d", 1, 1, 640, 480, 300, 300, 320, 240)
IMAGE = struct.pack("<I7dI", 1, 1, 0, 0, 0, 0, 0, 0, 1) + b"a.jpg\0"


@pytest.mark.parametrize(
    ("cameras", "images", "message"),
    [
        (record(1), b"", "cameras.bin: is cut short after 8 bytes"),
        (record(1 << 60, PINHOLE), b"", "cameras.bin: is cut short"),
        (
            record(1, struct.pack("<IiQQ", 1, 99, 640, 480)),
            b"",
            "camera 1: has the model 99; expected 0",
        ),
        (record(1, PINHOLE), record(1 << 62), "images.bin: is cut short after 8 bytes"),
        (record(1, PINHOLE), record(2, IMAGE, struct.pack("<Q", 1 << 61)), "images.bin: is cut short"),
        (record(1, PINHOLE), record(2, IMAGE[:-1] + b"a" * 5000), "image 1: has a name of over 4096 bytes"),
        (record(1, PINHOLE), record(2, IMAGE[:-1]), "images.bin: is cut short"),
        (record(1, PINHOLE), b"", "images.bin: is cut short after 0 bytes"),
    ],
)
def test_a_fault_in_a_binary_file_names_its_record(
    tmp_path: Path, cameras: bytes, images: bytes, message: str
) -> None:
    # Images are read first; where the fault is in the cameras they must be whole.
    whole = base64.b64decode(COLMAP_BINARY["images"])
    (tmp_path / "cameras.bin").write_bytes(cameras)
    (tmp_path / "images.bin").write_bytes(images or (b"" if "images" in message else whole))
    with pytest.raises(InvalidInput) as caught:
        load_rig(tmp_path / "cameras.bin")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("rigs", "message"),
    [
        ("1 2 CAMERA 1 CAMERA 7", "rigs.txt: line 1: '' is no whole number; expected a rig's number"),
        ("1 2 CAMERA 1 CAMERA 7 1 1 0 0 0", "line 1: ends amid a sensor"),
        ("1 3 CAMERA 1 CAMERA 7 1 1 0 0 0 1 0 0", "line 1: has 2 sensors; expected 3"),
        ("1 2 LIDAR 1 CAMERA 7 1 1 0 0 0 1 0 0", "line 1: 'LIDAR' is no sensor; expected CAMERA or IMU"),
        ("1 2 CAMERA 1 CAMERA 9 1 1 0 0 0 1 0 0", "line 1: its camera 9 is missing"),
        ("1 2 CAMERA 1 CAMERA 7 1 1 1 0 0 1 0 0", "have the length 1.41421; expected 1"),
    ],
)
def test_a_fault_in_a_rig_file_names_its_line(tmp_path: Path, rigs: str, message: str) -> None:
    path = write_model(tmp_path, ".txt", "cameras", "images")
    (tmp_path / "rigs.txt").write_text(rigs)
    with pytest.raises(InvalidInput) as caught:
        load_rig(path)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    "rigs", ["1 1 CAMERA 1\n2 1 CAMERA 7\n", "3 2 CAMERA 1 CAMERA 7 0\n", "1 0\n", "1 2 IMU 1 CAMERA 1 0\n"]
)
def test_rigs_of_a_camera_each_leave_it_to_the_images(tmp_path: Path, rigs: str) -> None:
    path = write_model(tmp_path, ".txt", "cameras", "images")
    (tmp_path / "rigs.txt").write_text(rigs)
    check_projections(load_rig(path))


def test_a_rig_about_an_imu_is_read_by_its_cameras(tmp_path: Path) -> None:
    path = write_model(tmp_path, ".txt", "cameras", "images")
    (tmp_path / "rigs.txt").write_text("1 3 IMU 1 CAMERA 1 1 1 0 0 0 5 0 0 CAMERA 7 1 1 0 0 0 4 0 0\n")
    np.testing.assert_allclose(load_rig(path).t_right_left, [-1, 0, 0], atol=1e-15)


def test_two_models_are_not_one(tmp_path: Path) -> None:
    for folder in ("0", "1"):
        (tmp_path / folder).mkdir()
        write_model(tmp_path / folder, ".txt", "cameras", "images")
    with pytest.raises(InvalidInput, match="expected one COLMAP model"):
        load_rig(tmp_path)


def test_a_size_that_differs_is_refused(tmp_path: Path) -> None:
    path = write_model(tmp_path, ".txt", "cameras", "images")
    with pytest.raises(InvalidInput, match="camera 1: size is \\(6048, 4032\\); expected \\(640, 480\\)"):
        load_rig(path, size=(640, 480))


def test_the_points_of_an_image_may_be_a_line_of_any_length(tmp_path: Path) -> None:
    path = write_model(tmp_path, ".txt", "cameras", "images")
    text = COLMAP_TEXT["images"].replace("10 20 -1 30 40 -1", "10.5 20.5 -1 " * 100_000)
    (tmp_path / "images.txt").write_text(text)
    check_projections(load_rig(path))
