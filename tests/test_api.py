"""`rb.rectify` and `rb.render`: what they give, and what they refuse."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rectbench as rb
from rectbench.plugins.rectifier import pose_problem
from tests.experiments.fakes import write_method, write_scene


@pytest.fixture(scope="module")
def rig() -> rb.Rig:
    return rb.load_rig("t265").scaled(0.25)


def test_rectify_takes_a_name_options_and_pixels(rig: rb.Rig) -> None:
    plain = rb.rectify(rig)
    assert isinstance(plain, rb.Rectification)
    assert plain.rig == rig
    small = rb.rectify(rig, "abraham", focal_px=20.0)
    assert small.notes["focal_px"] == 20.0
    centre = np.array([[100.0, 100.0], [110.0, 100.0], [100.0, 110.0], [110.0, 112.0]])
    near = rb.rectify(rig, pixels=centre)
    assert rb.metrics.distortion(near, rig, pixels=centre) < rb.metrics.distortion(plain, rig, pixels=centre)


def test_rectify_takes_a_file(rig: rb.Rig, tmp_path: Path) -> None:
    path = write_method(tmp_path, "mine")
    assert rb.rectify(rig, path, scale=0.5).size[0] < rb.rectify(rig, Path(path)).size[0]


def test_matches_reach_the_method_that_needs_them(rig: rb.Rig) -> None:
    usual = rb.rectify(rig, "hartley")
    rng = np.random.default_rng(0)
    matches = pose_problem(rig).matches
    noisy = [px + rng.normal(0, 0.5, px.shape) for px in matches]
    other = rb.rectify(rig, "hartley", matches=noisy)
    assert not np.allclose(usual.left.forward([[100, 100]]), other.left.forward([[100, 100]]))


IMAGE = np.zeros((200, 212, 3), np.uint8)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"method": "abrahm"}, "unknown method 'abrahm'; did you mean abraham"),
        ({"method": "abraham", "lew": "equisolid"}, "unknown option of abraham 'lew'; did you mean law"),
        ({"method": "abraham", "focal_px": -1}, "option focal_px is -1; expected greater than 0"),
        ({"method": "abraham", "focal_px": float("nan")}, "option focal_px is nan; expected"),
        ({"pixels": [[1, 2, 3]]}, r"pixels have shape \(1, 3\); expected \[N, 2\]"),
        ({"pixels": np.empty((0, 2))}, r"pixels have shape \(0, 2\)"),
        ({"pixels": [[1, np.nan]]}, "pixels hold NaN or infinity"),
        ({"pixels": "all"}, "pixels are no numbers"),
        ({"matches": [[[1, 2]]]}, "matches hold 1 arrays"),
        ({"matches": ([[1, 2]], [[1, 2], [3, 4]])}, "matches have 1 left and 2 right pixels"),
        ({"matches": ([[1, 2]], [[1, np.inf]])}, "right matches hold NaN or infinity"),
        ({"images": (IMAGE, IMAGE[:100])}, "the right image is 212x100 px; expected 212x200"),
        ({"images": (IMAGE,)}, "images hold 1 arrays"),
        ({"seed": -1}, "seed is -1"),
        ({"seed": 0.5}, "seed is 0.5"),
    ],
)
def test_rectify_refuses_in_one_line(rig: rb.Rig, arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(rb.InvalidInput, match=message) as caught:
        rb.rectify(rig, **arguments)
    assert "\n" not in str(caught.value)


def test_rectify_wants_a_rig() -> None:
    with pytest.raises(rb.InvalidInput, match="rig is str; expected a Rig"):
        rb.rectify("t265")  # type: ignore[arg-type]


def test_an_epipole_in_view_is_trimmed_by_the_margin(rig: rb.Rig) -> None:
    forward = rb.Rig(rig.left, rig.right, np.eye(3), np.array([0, 0, -0.1]), name="forward")
    assert rb.rectify(forward, margin_deg=9).rig == forward.trimmed(9)
    with pytest.raises(rb.InvalidInput, match="margin_deg is 0; expected"):
        rb.rectify(forward, margin_deg=0)


def test_a_plugin_that_returns_something_else_is_told(rig: rb.Rig, tmp_path: Path) -> None:
    with pytest.raises(rb.InvalidResult, match="odd returned int; expected a Rectification"):
        rb.rectify(rig, write_method(tmp_path, "odd", "return 3"))


def test_render_gives_a_pair_and_its_truth(rig: rb.Rig, tmp_path: Path) -> None:
    wall = write_scene(tmp_path, "wall")
    pair, truth = rb.render(wall, rig, "sideways", seed=3, spp=4, quality="fast")
    assert pair.left.shape == (200, 212, 3)
    assert pair.left.dtype == np.uint8
    assert truth.rig.baseline_m == pytest.approx(rig.baseline_m)
    px_left, px_right = truth.matches(100)
    assert px_left.shape == px_right.shape == (100, 2)
    again, _ = rb.render(wall, rig, "sideways", seed=3, spp=4, quality="fast")
    assert np.array_equal(again.left, pair.left)
    other, moved = rb.render(wall, rig, "sideways", seed=4, spp=4, quality="fast", image_width=100)
    assert other.left.shape[1] == moved.rig.left.width == 100


def test_render_refuses_in_one_line(rig: rb.Rig) -> None:
    with pytest.raises(rb.UnknownName, match="unknown motion"):
        rb.render("street", rig, "sidewards")
    with pytest.raises(rb.UnknownName, match="unknown scene"):
        rb.render("strete", rig)
    with pytest.raises(rb.UnknownName, match="unknown rig"):
        rb.render("street", "t256")
    with pytest.raises(rb.InvalidInput, match="image_width"):
        rb.render("street", rig, image_width=0)
