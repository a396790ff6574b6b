"""A pair of lenses knows its rig and nothing that would have to be rendered."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rectbench as rb
from rectbench.pairs.lenses import LensPair
from rectbench.pairs.opening import open_pair
from rectbench.pairs.pair import Pair
from rectbench.pairs.spec import LensSpec
from rectbench.store.keys import digest
from rectbench.store.store import Store


def lenses(**fields: Any) -> Pair:
    given = {"rig": "t265", "motion": "sideways", "seed": 0, "rig_source": "t265", "image_width": 320}
    return open_pair(LensSpec(**{**given, **fields}), Store.default())


@pytest.mark.parametrize(
    "ask",
    [
        lambda pair: pair.images,
        lambda pair: pair.truth,
        lambda pair: pair.board,
        lambda pair: pair.estimate,
        lambda pair: pair.shown_matches(),
        lambda pair: pair.features(by_estimate=True),
        lambda pair: pair.given_matches("images", 100),
        lambda pair: pair.believed_rig("estimated"),
    ],
)
def test_what_needs_a_scene_is_refused_in_a_line_that_says_so(
    ask: Callable[[Pair], Any], store: Store
) -> None:
    with pytest.raises(rb.InvalidInput, match=r"the lenses t265, sideways have no (images|truth)") as caught:
        ask(lenses())
    assert "expected a scene" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_its_true_matches_are_points_at_5_to_200_baselines_on_which_exact_rows_agree() -> None:
    pair = lenses()
    left, right = pair.true_matches
    assert len(left) > 8_000
    rect = rb.rectify(pair.rig, method="abraham")
    assert np.abs(rect.left.forward(left) - rect.right.forward(right))[:, 1].max() < 1e-9
    px_left, px_right = rect.left.forward(left), rect.right.forward(right)
    points = rect.triangulate(px_left, px_left[:, 0] - px_right[:, 0])
    distances = np.linalg.norm(points, axis=1) / pair.rig.baseline_m
    assert distances.min() == pytest.approx(5, rel=0.01)
    assert distances.max() == pytest.approx(200, rel=0.05)


def test_it_is_the_rig_as_the_motion_places_it_whatever_the_seed() -> None:
    pair = lenses()
    assert isinstance(pair, LensPair)
    assert pair.rig.left.width == 320
    assert (pair.rig.R_right_left != rb.load_rig("t265").R_right_left).any()
    assert lenses(seed=3).rig == pair.rig
    assert lenses(motion="as-calibrated", image_width=None).rig == rb.load_rig("t265")


def test_an_exact_pose_is_the_true_one_and_a_perturbed_one_hangs_on_the_seed() -> None:
    first, second = lenses(), lenses(seed=1)
    assert first.believed_rig("exact") == first.rig
    assert first.believed_rig("perturbed") != first.rig
    assert first.believed_rig("perturbed") != second.believed_rig("perturbed")


def off_their_epipolar_planes_px(pair: Pair, level: str) -> np.ndarray:
    matches, rig = pair.given_matches(level, 2000), pair.rig
    (rays_left, _), (rays_right, _) = rig.left.unproject(matches.left), rig.right.unproject(matches.right)
    normals = rays_left @ rig.essential_matrix.T
    sines = (rays_right * normals).sum(axis=-1) / np.linalg.norm(normals, axis=-1)
    return np.asarray(sines * rb.centre_resolution_px(rig))


def test_true_matches_fit_the_true_rig_and_noise_is_what_its_level_says() -> None:
    pair = lenses(rig="sony-as200v", rig_source="sony-as200v")
    assert np.abs(off_their_epipolar_planes_px(pair, "true")).max() < 1e-9
    noisy, exact = (pair.given_matches(level, 2000) for level in ("true + 0.5 px", "true"))
    for side in ("left", "right"):
        noise = getattr(noisy, side) - getattr(exact, side)
        assert noise.std() == pytest.approx(0.5, rel=0.05)
        assert abs(noise.mean()) < 0.05
    again = lenses(rig="sony-as200v", rig_source="sony-as200v").given_matches("true + 0.5 px", 2000)
    np.testing.assert_array_equal(again.left, noisy.left)
    other = lenses(rig="sony-as200v", rig_source="sony-as200v", seed=1).given_matches("true + 0.5 px", 2000)
    assert (other.left != noisy.left).all()


def test_all_that_shapes_it_shapes_its_key(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    rb.load_rig("t265").save(path)
    variants: list[dict[str, Any]] = [
        {},
        {"motion": "rolled"},
        {"seed": 1},
        {"image_width": 321},
        {"rig": "tumvi", "rig_source": "tumvi"},
    ]
    keys = [digest(lenses(**variant).inputs) for variant in variants]
    assert len(set(keys)) == len(keys)
    copied = {"rig_source": str(path)}
    assert digest(lenses(**copied).inputs) == keys[0]
    rb.load_rig("t265").scaled(0.999).save(path)
    assert digest(lenses(**copied).inputs) != keys[0]
