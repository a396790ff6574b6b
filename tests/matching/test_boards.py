"""Corners of a board: each the same point in both images, found to hundredths of a pixel, or none at all."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rectbench as rb
from rectbench import board_matches
from rectbench.images.reading import read_images
from tests.matching.flat_board import Seen, chessboard, misses, seen_board, tag_grid
from tests.matching.sphere_room import sphere_pair
from tests.rigs_for_tests import rig

FISHEYE = rig("kannala-brandt", size=(560, 360), fov_deg=140)
_LENS = rb.Camera("pinhole", (560, 360), {"fx": 380.0, "fy": 380.0, "cx": 279.0, "cy": 181.0})
PINHOLE = replace(FISHEYE, left=_LENS, right=_LENS)
LARGER_FISHEYE = rig("kannala-brandt", size=(640, 480), fov_deg=140)
_LARGER_LENS = rb.Camera("pinhole", (640, 480), {"fx": 430.0, "fy": 430.0, "cx": 319.0, "cy": 241.0})
LARGER_PINHOLE = replace(LARGER_FISHEYE, left=_LARGER_LENS, right=_LARGER_LENS)


def found_in(seen: Seen, kind: str) -> np.ndarray:
    found = board_matches(seen.left, seen.right)
    assert found is not None
    assert found.kind.startswith(kind)
    return misses(found.matches, seen.corners)


@pytest.mark.parametrize(
    ("lens", "columns", "rows"),
    [(PINHOLE, 9, 7), (PINHOLE, 6, 5), (FISHEYE, 9, 7), (FISHEYE, 8, 8), (FISHEYE, 10, 7)],
)
def test_a_chessboard_is_found_whole_to_hundredths_of_a_pixel(lens: rb.Rig, columns: int, rows: int) -> None:
    width_m = 0.3 if lens is PINHOLE else 0.55
    seen = seen_board(lens, chessboard(columns, rows), width_m=width_m)
    off = found_in(seen, f"chessboard {columns - 1}x{rows - 1}")
    assert len(off) == (columns - 1) * (rows - 1)
    assert np.abs(off).max() < 0.25
    assert off.std(axis=0).max() < 0.08
    assert np.abs(off.mean(axis=0)).max() < 0.03


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize(("lens", "width_m"), [(PINHOLE, 0.3), (FISHEYE, 0.5)], ids=["pinhole", "fisheye"])
def test_a_board_is_found_in_any_pose_before_a_busy_background(
    lens: rb.Rig, width_m: float, seed: int
) -> None:
    """Turned by up to 45 degrees, near or at twice the distance, its white rim a tenth to a whole square."""
    rng = np.random.default_rng(seed)
    columns, rows = [(9, 7), (8, 6), (10, 7)][seed % 3]
    seen = seen_board(
        lens,
        chessboard(columns, rows, margin=int(rng.choice([4, 12, 24, 40]))),
        width_m=width_m,
        distance_m=rng.uniform(0.6, 1.1),
        turn_deg=tuple(rng.uniform(-1, 1, 3) * [45, 45, 35]),
        before=sphere_pair(lens, seed) if seed % 2 else None,
        samples=2,
    )
    off = found_in(seen, f"chessboard {columns - 1}x{rows - 1}")
    assert len(off) == (columns - 1) * (rows - 1)
    # With four samples a pixel an edge is a comb.
    assert np.sqrt((off**2).mean()) < 0.2


@pytest.mark.parametrize(
    ("lens", "width_m", "distance_m", "turn_deg", "margin", "busy"),
    [
        (LARGER_PINHOLE, 0.3, 1.0779, (32.393, -46.306, 11.401), 40, True),
        (LARGER_FISHEYE, 0.5, 0.8358, (-54.939, 46.034, 5.932), 4, False),
    ],
    ids=["pinhole", "fisheye"],
)
def test_a_board_is_found_although_its_squares_are_but_eight_pixels_high(
    lens: rb.Rig,
    width_m: float,
    distance_m: float,
    turn_deg: tuple[float, float, float],
    margin: int,
    busy: bool,
) -> None:
    seen = seen_board(
        lens,
        chessboard(8, 6, margin=margin),
        width_m=width_m,
        distance_m=distance_m,
        turn_deg=turn_deg,
        before=sphere_pair(lens, 5) if busy else None,
        samples=2,
    )
    off = found_in(seen, "chessboard 7x5")
    assert len(off) == 35
    assert np.sqrt((off**2).mean()) < 0.2


@pytest.mark.parametrize(
    ("columns", "rows", "roll_deg"), [(9, 7, 35.0), (9, 7, -35.0), (8, 8, 35.0), (10, 7, -35.0)]
)
def test_corners_correspond_although_one_camera_is_rolled(columns: int, rows: int, roll_deg: float) -> None:
    roll = Rotation.from_euler("z", roll_deg, degrees=True).as_matrix()
    rolled = replace(
        PINHOLE, R_right_left=roll @ PINHOLE.R_right_left, t_right_left=roll @ PINHOLE.t_right_left
    )
    seen = seen_board(rolled, chessboard(columns, rows), width_m=0.25, distance_m=0.7, samples=3)
    assert np.abs(found_in(seen, f"chessboard {columns - 1}x{rows - 1}")).max() < 0.5


def test_a_board_that_colours_tell_apart_may_stand_on_its_head_in_one_image() -> None:
    seen = seen_board(PINHOLE, chessboard(10, 7), width_m=0.3, samples=3)
    found = board_matches(seen.left, np.ascontiguousarray(seen.right[::-1, ::-1]))
    assert found is not None
    turned = np.array(PINHOLE.right.size) - 1 - found.matches.right
    assert np.abs(misses(rb.Matches(found.matches.left, turned), seen.corners)).max() < 0.5


@pytest.mark.parametrize("cut", [np.s_[:, 330:], np.s_[:, :300]], ids=["left", "right"])
def test_a_board_that_is_cut_off_is_none(cut: tuple[slice, slice]) -> None:
    seen = seen_board(PINHOLE, chessboard(9, 7), width_m=0.3, samples=3)
    left = np.ascontiguousarray(seen.left[cut])
    assert board_matches(left, left) is None


@pytest.mark.parametrize(
    ("lens", "family"),
    [(PINHOLE, "DICT_APRILTAG_36h11"), (PINHOLE, "DICT_4X4_50"), (FISHEYE, "DICT_6X6_250")],
)
def test_tags_are_matched_by_identity_without_the_pull_of_blur(lens: rb.Rig, family: str) -> None:
    width_m = 0.35 if lens is PINHOLE else 0.6
    kinds = {"DICT_4X4_50": "ArUco 4x4", "DICT_6X6_250": "ArUco 6x6"}
    seen = seen_board(lens, tag_grid(4, 3, family), width_m=width_m)
    off = found_in(seen, kinds.get(family, "AprilTag 36h11"))
    assert len(off) >= 40
    assert np.abs(off.mean(axis=0)).max() < 0.06
    assert np.median(np.abs(off)) < 0.1
    # Outward along the diagonals, as a tag's corners look, cornerSubPix is 0.2 px off in either coordinate.
    middles = seen.corners.left.reshape(-1, 4, 2).mean(axis=1)
    found = board_matches(seen.left, seen.right)
    assert found is not None
    nearest = np.linalg.norm(found.matches.left[:, None] - middles, axis=2).argmin(axis=1)
    outward = np.sign(found.matches.left - middles[nearest])
    assert abs((off[:, :2] * outward).mean()) < 0.06


def test_the_corners_of_kalibrs_grid_are_as_good_as_a_chessboards() -> None:
    seen = seen_board(PINHOLE, tag_grid(4, 3, "DICT_APRILTAG_36h11", touching=True), width_m=0.4)
    off = found_in(seen, "AprilTag 36h11")
    assert len(off) >= 36
    assert np.abs(off).max() < 0.3
    assert off.std(axis=0).max() < 0.08


def test_three_tags_are_no_board() -> None:
    seen = seen_board(PINHOLE, tag_grid(3, 1, "DICT_APRILTAG_36h11"), width_m=0.3, samples=3)
    assert board_matches(seen.left, seen.right) is None


def test_images_of_16_bits_show_the_same_board() -> None:
    seen = seen_board(PINHOLE, chessboard(9, 7), width_m=0.3, samples=3)
    deep = board_matches(*(np.uint16(16) * image for image in (seen.left, seen.right)))
    assert deep is not None
    assert np.abs(misses(deep.matches, seen.corners)).max() < 0.3


@pytest.mark.parametrize("seed", range(3))
def test_where_there_is_no_board_none_is_found(seed: int) -> None:
    pair = sphere_pair(FISHEYE, seed)
    assert board_matches(pair.left, pair.right) is None


def test_noise_and_evenness_show_no_board() -> None:
    noise = np.random.default_rng(0).integers(0, 256, (240, 320)).astype(np.uint8)
    assert board_matches(noise, noise) is None
    assert board_matches(np.zeros((240, 320), np.uint8), noise) is None


def test_what_is_no_image_is_said() -> None:
    with pytest.raises(rb.InvalidInput, match="the right image has shape"):
        board_matches(np.zeros((9, 9), np.uint8), np.zeros(9, np.uint8))


@pytest.mark.parametrize(
    "names", ["t265/fs1.png t265/fs2.png", "bumblebee2/garden01_left.jpg bumblebee2/garden01_right.jpg"]
)
def test_photographs_without_a_board_have_none(real_data: Path, names: str) -> None:
    images = read_images(*(real_data / "pairs" / name for name in names.split()))
    assert board_matches(*images) is None


def test_a_photographed_grid_has_its_corners_near_the_epipolar_curves(real_data: Path) -> None:
    folder = real_data / "pairs/mynteye"
    found = board_matches(*read_images(folder / "left_fisheye_img_0.png", folder / "right_fisheye_img_0.png"))
    assert found is not None
    assert found.kind.startswith("AprilTag 36h11")
    assert len(found.matches.left) >= 4 * 33
    errors = rb.metrics.row_error(rb.rectify(rb.load_rig(folder)), *found.matches).source_px
    assert np.nanmedian(errors) < 0.25
    assert np.nanmax(errors) < 0.6
