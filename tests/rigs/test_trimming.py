"""A rig whose lenses are blind about its epipoles."""

import logging
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rectbench as rb
from tests.rigs_for_tests import aligned_rig, rig


def angles_deg(pair: rb.Rig, side: str) -> tuple[np.ndarray, np.ndarray]:
    """Of all pixels of the whole lens: how far from the baseline's line they look; whether they are seen."""
    camera: rb.Camera = getattr(pair, side)
    rays, seen = camera.whole.unproject(camera.pixel_grid())
    towards = pair.centre_right_in_left / pair.baseline_m
    if side == "right":
        towards = pair.R_right_left @ towards
    angle = np.degrees(np.arccos(np.clip(np.abs(rays[seen] @ towards), 0, 1)))
    return angle, camera.unproject(camera.pixel_grid())[1][seen]


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("centre_m", [(0.02, 0.0, 0.3), (0.1, 0.2, 0.3), (0.0, 0.0, -0.3)])
def test_each_lens_is_blind_about_the_baseline_in_its_own_frame(side: str, centre_m: Any) -> None:
    pair = rig(rotation_deg=(4.0, -9.0, 5.0), centre_m=centre_m, fov_deg=150).trimmed(8)
    angle, seen = angles_deg(pair, side)
    np.testing.assert_array_equal(seen, angle >= 8)
    assert (~seen).any()


def test_a_lens_that_sees_nothing_there_stays_what_it_is() -> None:
    pair = rb.load_rig("t265")
    assert pair.trimmed().left is pair.left
    assert pair.trimmed() == pair
    assert pair.trimmed().margin_deg is None


def test_a_corner_that_reaches_into_the_cones_is_found() -> None:
    # The epipoles lie on the sides of the image's corners; only corners come near enough.
    lens = rb.Camera("equidistant", (400, 400), {"fx": 200, "fy": 200, "cx": 199.5, "cy": 199.5})
    ray, _ = lens.unproject([399.5, 399.5])
    outwards = ray + 0.1 * (ray - [0, 0, ray[2]])
    outwards /= np.linalg.norm(outwards)
    off_deg = np.degrees(np.arccos(ray @ outwards))
    pair = rb.Rig(lens, lens, np.eye(3), -0.1 * outwards)
    assert pair.trimmed(off_deg + 0.05).left.blind is not None
    assert pair.trimmed(off_deg - 0.05).left.blind is None


def test_trimming_again_is_trimming_once() -> None:
    pair = aligned_rig(420, 420, 200)
    assert pair.trimmed(10).trimmed(5) == pair.trimmed(5)
    assert pair.trimmed(10).whole == pair
    assert pair.trimmed(10).margin_deg == 10
    assert hash(pair.trimmed(10).whole) == hash(pair)


@pytest.mark.parametrize("margin_deg", [0, -1, 46, np.nan, np.inf, "7", None, True])
def test_a_margin_out_of_range_is_refused(margin_deg: Any) -> None:
    with pytest.raises(rb.InvalidInput, match=r"margin_deg is .*; expected degrees above 0, at most 45"):
        rb.load_rig("t265").trimmed(margin_deg)


def test_a_trimmed_rig_is_written_and_read_to_the_last_bit(tmp_path: Path) -> None:
    pair = rig(rotation_deg=(4.0, -9.0, 5.0), centre_m=(0.02, 0.0, 0.3)).trimmed(7.3)
    pair.save(tmp_path / "rig.yaml")
    assert rb.load_rig(tmp_path / "rig.yaml") == pair


def test_a_format_without_a_place_for_it_says_so(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    lens = rig("kannala-brandt", centre_m=(0.02, 0.0, 0.3))
    with caplog.at_level(logging.WARNING):
        lens.trimmed(7).save(tmp_path / "chain.yaml", format="kalibr")
    assert "leaves out that the left camera is blind within 7 degrees about a line" in caplog.text


def test_a_file_with_no_cones_in_their_place_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    rig(centre_m=(0.02, 0.0, 0.3)).trimmed(7).save(path)
    path.write_text(path.read_text().replace("within_deg: 7.0", "within_deg: 97.0"))
    with pytest.raises(rb.InvalidInput, match=r"rig\.yaml: cameras\.left\.blind.*within_deg is 97"):
        rb.load_rig(path)


def test_an_epipole_of_a_trimmed_rig_is_not_in_view() -> None:
    wide = aligned_rig(420, 420, 200)
    with pytest.raises(rb.Unsupported):
        rb.refuse_epipole_in_view(wide)
    rb.refuse_epipole_in_view(wide.trimmed(5))


def test_the_cameras_of_two_rigs_with_one_pose_are_compared() -> None:
    pair = aligned_rig(420, 420, 200)
    assert replace(pair, name="other") == pair
    assert hash(replace(pair, name="other")) == hash(pair)
