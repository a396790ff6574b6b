from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rectbench as rb
from rectbench.experiments.execution.cells import Desk
from rectbench.experiments.planning import make_plan
from rectbench.pairs.opening import open_pair
from rectbench.pairs.pair import Pair
from rectbench.pairs.spec import CALIBRATED, ESTIMATED, PhotographedSpec
from rectbench.store.store import Store
from tests.experiments.fakes import small_report, write_scene


@pytest.fixture
def rendered(tmp_path: Path, store: Store) -> Pair:
    report = small_report(
        scenes=(write_scene(tmp_path, "wall"),),
        motions=("sideways",),
        image_width=320,
        metrics=("row_error", "row_error_features"),
    )
    (spec,) = make_plan(report).pairs
    return open_pair(spec, store)


@pytest.fixture
def photographed(rendered: Pair, tmp_path: Path, store: Store) -> Pair:
    """The same pictures as photographs, with their calibration."""
    rendered.images.save(tmp_path)
    rendered.rig.save(tmp_path / "rig.yaml")
    spec = PhotographedSpec(
        scene="wall",
        rig="t265",
        motion="as-calibrated",
        seed=0,
        left=str(tmp_path / "left.png"),
        right=str(tmp_path / "right.png"),
        calibration=(str(tmp_path / "rig.yaml"),),
        size=None,
        unit=None,
        max_angle_deg=None,
    )
    return open_pair(spec, store)


def test_what_a_pair_found_it_keeps_and_the_store_gives_again(rendered: Pair, store: Store) -> None:
    for name in ("rig", "images", "truth", "true_matches", "estimate", "board"):
        assert getattr(rendered, name) is getattr(rendered, name), name
    assert rendered.features(by_estimate=False) is rendered.features(by_estimate=False)
    again = open_pair(rendered.spec, store)
    assert again.is_made
    np.testing.assert_array_equal(again.images.left, rendered.images.left)
    np.testing.assert_array_equal(again.truth.depth_left, rendered.truth.depth_left)


def test_a_key_is_told_without_rendering(rendered: Pair) -> None:
    assert rendered.image_inputs.keys() > rendered.inputs.keys()
    assert not rendered.is_made


def test_a_forgotten_pair_is_made_again(rendered: Pair, store: Store) -> None:
    before = rendered.images.left
    rendered.forget()
    again = open_pair(rendered.spec, store)
    assert not again.is_made
    np.testing.assert_array_equal(again.images.left, before)


def test_photographs_know_no_truth_and_believe_their_calibration(photographed: Pair) -> None:
    photographed.require()
    assert not photographed.knows_truth
    with pytest.raises(rb.InvalidInput, match="nobody knows the truth about the photographs of wall"):
        _ = photographed.truth
    assert photographed.believed_rig(CALIBRATED) is photographed.rig
    assert photographed.believed_rig(ESTIMATED) == photographed.estimate.rig(photographed.rig)
    assert photographed.given_matches("images", 100) is photographed.estimate.inliers


def test_photographs_of_another_size_than_their_calibration_are_refused(
    photographed: Pair, tmp_path: Path, store: Store
) -> None:
    before, small = photographed.image_inputs, rb.StereoPair.load(tmp_path)
    rb.StereoPair(small.left[:-8], small.right).save(tmp_path)
    again = open_pair(photographed.spec, store)
    assert again.image_inputs != before
    with pytest.raises(rb.InvalidInput, match="the size of rig"):
        again.require()


def test_a_desk_keeps_the_last_pair_alone(rendered: Pair, photographed: Pair, store: Store) -> None:
    desk = Desk()
    first = desk.pair(rendered.spec, store)
    assert desk.pair(rendered.spec, store) is first
    assert desk.pair(photographed.spec, store).spec == photographed.spec
    assert desk.pair(rendered.spec, store) is not first
