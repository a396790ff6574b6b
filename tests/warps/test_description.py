"""A rectification's YAML file is read back to the same maps, and refuses what it does not know."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.interpolate import BSpline

import rectbench as rb
from rectbench.warps import Framing, framed
from rectbench.warps.description import load_rectification, rectification_text, save_rectification
from tests.rigs_for_tests import rig
from tests.warps.test_windows import Squeezed

METHODS = (
    "conventional",
    "abraham",
    "local-homography",
    "hartley",
    "fusiello",
    "polar",
    "log-polar",
    "polar-optimal",
    "optimal",
)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("framing", [Framing(), Framing(coverage=0.8, pixels=20_000)], ids=["own", "framed"])
def test_what_is_read_is_what_was_written_to_the_last_bit(
    tmp_path: Path, method: str, framing: Framing
) -> None:
    rect = framed(rb.rectify(rig("double-sphere"), method), framing)
    save_rectification(rect, tmp_path / "rectified.yaml", method=method)
    again = load_rectification(tmp_path / "rectified.yaml")
    assert again.size == rect.size
    assert again.rig == rect.rig
    assert again.notes == rect.notes
    for side in ("left", "right"):
        for ours, theirs in zip(rect.maps(side), again.maps(side), strict=True):
            np.testing.assert_array_equal(ours, theirs)


def test_a_reader_with_the_file_alone_gets_the_same_pixels_of_surfaces() -> None:
    rect = rb.rectify(rig("equidistant"), "optimal")
    file = yaml.safe_load(rectification_text(rect))
    pixels = rb.evaluation_pixels(rect.rig.right, 60)
    x, y, z = np.array(file["right"]["R_rect_cam"]) @ rect.rig.right.unproject(pixels)[0].T
    told = file["right"]["target"]["u"]
    c = np.array(told["coefficients"])
    beta, gamma = (
        BSpline.design_matrix(angle, np.pad(np.linspace(*told[name], count - 2), 3, mode="edge"), 3).toarray()
        for name, angle, count in (
            ("beta", np.arctan2(y, z), len(c)),
            ("gamma", np.arctan2(x, np.hypot(y, z)), len(c[0])),
        )
    )
    columns = np.einsum("ni,ij,nj->n", beta, c, gamma)
    np.testing.assert_allclose(columns, rect.right.forward(pixels)[:, 0], atol=1e-9)


@pytest.mark.parametrize("method", ["polar", "log-polar"])
def test_pencils_of_lines_in_planes_are_written(tmp_path: Path, method: str) -> None:
    rect = rb.rectify(rb.load_rig("pinhole-toed-in"), method, form="planar")
    save_rectification(rect, tmp_path / "rectified.yaml")
    again = load_rectification(tmp_path / "rectified.yaml")
    for side in ("left", "right"):
        for ours, theirs in zip(rect.maps(side), again.maps(side), strict=True):
            np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("law", ["stereographic", "equisolid", "orthographic", "cylindrical"])
def test_each_lens_law_is_written(tmp_path: Path, law: str) -> None:
    rect = rb.rectify(rig("equisolid"), "abraham", law=law)
    save_rectification(rect, tmp_path / "rectified.yaml")
    again = load_rectification(tmp_path / "rectified.yaml")
    pixels = rb.evaluation_pixels(rect.rig.left, 50)
    np.testing.assert_array_equal(rect.left.forward(pixels), again.left.forward(pixels))


def test_a_reader_with_the_file_alone_gets_the_same_pixels() -> None:
    """By the formulas of the file's own header, with nothing of rectbench but the lens."""
    rect = rb.rectify(rig("equidistant"), "local-homography")
    file = yaml.safe_load(rectification_text(rect))
    pixels = rb.evaluation_pixels(rect.rig.right, 60)
    x, y, z = np.array(file["right"]["R_rect_cam"]) @ rect.rig.right.unproject(pixels)[0].T
    angles = {"u": np.arctan2(x, np.hypot(y, z)), "v": np.arctan2(y, z)}
    for name, angle in angles.items():
        cubic = file["right"]["target"][name]
        value = np.polyval([cubic[c] for c in ("c3", "c2", "c1", "c0")], angle)
        np.testing.assert_allclose(value, rect.right.forward(pixels)[:, "uv".index(name)], atol=1e-9)


def test_a_reader_with_the_file_alone_gets_the_same_pixels_of_splines() -> None:
    rect = rb.rectify(rig("equidistant"), "polar-optimal")
    file = yaml.safe_load(rectification_text(rect))
    pixels = rb.evaluation_pixels(rect.rig.right, 60)
    x, y, z = np.array(file["right"]["R_rect_cam"]) @ rect.rig.right.unproject(pixels)[0].T
    for place, angle in enumerate((np.arctan2(x, np.hypot(y, z)), np.arctan2(y, z))):
        told = file["right"]["target"]["uv"[place]]
        outer = [told["knots"][0]] * 2, [told["knots"][-1]] * 2
        rise = BSpline([*outer[0], *told["knots"], *outer[1]], told["slopes"], 2).antiderivative()
        value = told["value_low"] + rise(angle) - rise(told["knots"][0])
        np.testing.assert_allclose(value, rect.right.forward(pixels)[:, place], atol=1e-9)


def test_a_reader_with_the_file_alone_gets_the_same_pixels_of_a_pencil() -> None:
    rect = rb.rectify(rb.load_rig("pinhole-toed-in"), "polar", form="planar")
    target = yaml.safe_load(rectification_text(rect))["left"]["target"]
    pixels = rb.evaluation_pixels(rect.rig.left, 60)
    a, b, w = np.array(target["matrix"])[:, 0]
    reach, reference = (
        np.linalg.norm(np.subtract(px, [a / w, b / w]), axis=-1) for px in (pixels, target["reference"])
    )
    value = target["start_px"] - np.sign(w) * (reach - reference)
    np.testing.assert_allclose(value, rect.left.forward(pixels)[:, 0], atol=1e-6)


def test_a_reader_with_the_file_alone_gets_the_same_points() -> None:
    rect = rb.rectify(rig("equidistant"), "local-homography")
    file = yaml.safe_load(rectification_text(rect))
    gamma_left, gamma_right, beta = 0.3, 0.25, -0.2
    r = file["baseline_m"] / (np.tan(gamma_left) - np.tan(gamma_right))
    point = np.array([r * np.tan(gamma_left), r * np.sin(beta), r * np.cos(beta)])
    px_left = rect.left.target.project(point)[0]
    px_right = rect.right.target.project(point - [file["baseline_m"], 0, 0])[0]
    found = rect.triangulate(px_left, px_left[0] - px_right[0])
    np.testing.assert_allclose(rect.R_rect_left @ found, point, rtol=1e-9)


def test_a_target_of_somebody_elses_is_named_and_not_read(tmp_path: Path) -> None:
    rect = rb.Rectification.from_targets(rig(), Squeezed(), Squeezed(), (300, 120))
    save_rectification(rect, tmp_path / "rectified.yaml")
    with pytest.raises(rb.InvalidInput, match=r"left\.target\.kind.*unknown target 'Squeezed'"):
        load_rectification(tmp_path / "rectified.yaml")


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("rectbench_rectification",), 2, "rectbench_rectification is '2'"),
        (("size",), [0, 10], "size"),
        (("size",), [100], "size"),
        (("left", "R_rect_cam"), [[1, 0, 0], [0, 1, 0]], "left.R_rect_cam"),
        (("left", "R_rect_cam"), [[2, 0, 0], [0, 1, 0], [0, 0, 1]], "no rotation"),
        (("left", "target", "kind"), "circular", "unknown target 'circular'"),
        (("left", "target", "u", "c1"), "wide", "left.target.u.c1"),
        (("left", "target", "u", "c1"), -1e9, "left.target.u"),
        (("left", "target", "v"), None, "left.target.v"),
        (("rig", "cameras"), 3, "rig.cameras"),
    ],
)
def test_a_damaged_file_is_one_line_that_names_the_key(
    tmp_path: Path, path: tuple[str, ...], value: object, message: str
) -> None:
    file = yaml.safe_load(rectification_text(rb.rectify(rig(), "local-homography")))
    place = file
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    (tmp_path / "bad.yaml").write_text(yaml.safe_dump(file))
    with pytest.raises(rb.InvalidInput) as raised:
        load_rectification(tmp_path / "bad.yaml")
    assert message in str(raised.value)
    assert "bad.yaml" in str(raised.value)
    assert len(str(raised.value).splitlines()) == 1
