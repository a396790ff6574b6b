"""The part of a view where a lens is blind: two cones about a line."""

import pickle
from typing import Any

import numpy as np
import pytest

import rectbench as rb
from rectbench.cameras.sensitivity import parameter_names, projection_by_parameters
from rectbench.formulas.evaluation import KERNEL_THRESHOLD
from tests.rigs_for_tests import LENSES, camera

CONES = rb.Cones(axis=(0.6, 0.0, 0.8), within_deg=9.0)


def blind(model: str = "kannala-brandt", **kwargs: Any) -> rb.Camera:
    lens = camera(model, **kwargs)
    return rb.Camera(lens.model, lens.size, lens.params, blind=CONES)


def angle_deg(rays: np.ndarray) -> np.ndarray:
    return np.degrees(np.arccos(np.clip(np.abs(rays @ CONES.axis), 0, 1)))


@pytest.mark.parametrize("model", LENSES)
def test_nothing_is_seen_within_the_cones_and_all_else_as_before(model: str) -> None:
    lens = blind(model)
    pixels = lens.pixel_grid()[::7, ::7]
    rays, seen = lens.unproject(pixels)
    whole_rays, whole_seen = lens.whole.unproject(pixels)
    np.testing.assert_array_equal(seen, whole_seen & (angle_deg(whole_rays) >= CONES.within_deg))
    np.testing.assert_array_equal(rays[seen], whole_rays[seen])
    assert 0 < (whole_seen & ~seen).sum() < seen.sum()
    np.testing.assert_array_equal(lens.project(whole_rays)[1], seen)


def test_both_cones_are_blind() -> None:
    wide = blind(fov_deg=170)
    backwards = rb.Camera(wide.model, wide.size, wide.params, blind=rb.Cones((-0.6, 0.0, -0.8), 9.0))
    pixels = wide.pixel_grid()
    np.testing.assert_array_equal(wide.unproject(pixels)[1], backwards.unproject(pixels)[1])


def test_a_kernel_is_as_blind_as_numpy() -> None:
    lens = blind()
    pixels = lens.pixel_grid().reshape(-1, 2)
    assert len(pixels) > KERNEL_THRESHOLD
    few = np.concatenate([lens.unproject(part)[1] for part in np.array_split(pixels, 20)])
    np.testing.assert_array_equal(lens.unproject(pixels)[1], few)


def test_a_lens_that_is_not_blind_has_no_number_more() -> None:
    assert "blind" not in camera().constants
    assert camera().whole is camera().whole or camera().whole == camera()


def test_a_blind_lens_is_told_from_a_whole_one_copied_and_scaled() -> None:
    lens = blind()
    assert lens != lens.whole
    assert hash(lens) != hash(lens.whole)
    assert lens.whole.blind is None
    assert eval(repr(lens), {"Camera": rb.Camera, "Cones": rb.Cones}) == lens
    assert pickle.loads(pickle.dumps(lens)) == lens
    assert lens.scaled(0.5).blind == CONES
    assert lens.fov_deg == lens.whole.fov_deg


def test_derivatives_outside_the_cones_are_those_of_the_whole_lens() -> None:
    lens = blind()
    rays = np.array([[0.1, 0.2, 1.0], [0.6, 0.0, 0.8]])
    np.testing.assert_array_equal(lens.project_jacobian(rays)[0], lens.whole.project_jacobian(rays)[0])
    assert np.isnan(lens.project_jacobian(rays)[1]).all()
    names = parameter_names(lens)
    by_parameters = projection_by_parameters(lens, rays, names)
    np.testing.assert_array_equal(by_parameters[0], projection_by_parameters(lens.whole, rays, names)[0])
    assert np.isnan(by_parameters[1]).all()


@pytest.mark.parametrize(
    ("axis", "within_deg"),
    [
        ((0, 0, 0), 7),
        ((1, 0), 7),
        ((np.nan, 0, 1), 7),
        ("x", 7),
        ((1, 0, 0), 0),
        ((1, 0, 0), 90),
        ((1, 0, 0), np.nan),
        ((1, 0, 0), "7"),
        ((1, 0, 0), True),
    ],
)
def test_cones_that_are_none_are_refused(axis: Any, within_deg: Any) -> None:
    with pytest.raises(rb.InvalidInput, match=r"^the (axis of the cones|cones' within_deg) is .*; expected "):
        rb.Cones(axis, within_deg)


def test_a_camera_wants_cones() -> None:
    lens = camera()
    with pytest.raises(rb.InvalidInput, match="blind is float; expected Cones, or None"):
        rb.Camera(lens.model, lens.size, lens.params, blind=7.0)  # type: ignore[arg-type]
