"""Targets of wide views: exact inverses and derivatives, tables that are the inverse, frames and files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

import rectbench as rb
from rectbench.warps.description import rectification_text
from tests.rigs_for_tests import rig

EVEN = rb.Radial("equidistant", 90.0, 160.0)
TARGETS: dict[str, rb.Target] = {
    "equirectangular": rb.Upright(EVEN, EVEN),
    "upright cylinder": rb.Upright(EVEN, rb.Radial("cylindrical", 80.0, 150.0)),
    "planospheric": rb.Planospheric(EVEN, rb.Radial("equidistant", 80.0, 150.0)),
    "stereographic": rb.Stereographic(75.0, 160.0, 150.0),
    "epipolar circles": rb.EpipolarCircles(75.0, 160.0, 150.0, (0.8, 0.0, 0.6)),
    "prism": rb.Prism(80.0, 160.0, 60.0, first_rad=-0.8, piece_rad=0.7, pieces=3),
}
by_target = pytest.mark.parametrize("target", TARGETS.values(), ids=TARGETS)


def rays_ahead(count: int = 400) -> np.ndarray:
    rng = np.random.default_rng(0)
    return rng.normal([0, 0, 1.2], 0.5, (count, 3))


@by_target
def test_a_pixels_ray_goes_back_to_it(target: rb.Target) -> None:
    rays = rays_ahead()
    pixels, ok = target.project(rays)
    assert ok.mean() > 0.7
    back, known = target.unproject(pixels[ok])
    assert known.all()
    unit = rays[ok] / np.linalg.norm(rays[ok], axis=1, keepdims=True)
    np.testing.assert_allclose(back, unit, atol=1e-12)


@by_target
def test_its_derivative_is_that_of_differences(target: rb.Target) -> None:
    rays = rays_ahead(100)
    exact = target.project_jacobian(rays)
    step = 1e-6
    moved = [target.project(rays + step * e)[0] - target.project(rays - step * e)[0] for e in np.eye(3)]
    numeric = np.stack(moved, axis=-1) / (2 * step)
    inner = np.isfinite(numeric).all(axis=(1, 2))
    assert inner.sum() > 60
    np.testing.assert_allclose(exact[inner], numeric[inner], rtol=1e-6, atol=1e-5)


@by_target
def test_a_window_of_it_is_the_same_image(target: rb.Target) -> None:
    rays, window = rays_ahead(100), (20.0, -10.0, 1.5, 0.5)
    pixels, ok = target.project(rays)
    framed, also = target.framed(*window).project(rays)
    np.testing.assert_array_equal(ok, also)
    np.testing.assert_allclose(framed, (pixels - window[:2]) * window[2:] - 0.5, atol=1e-9)


@by_target
def test_its_table_is_its_inverse_and_is_read_back(target: rb.Target, tmp_path: Path) -> None:
    rect = rb.Rectification.from_targets(rig(fov_deg=150), target, target, (320, 300))
    map_x, map_y = rect.maps("left")
    v, u = np.mgrid[:300:7, :320:5]
    exact = rect.left.inverse(np.stack([u, v], axis=-1).astype(float))
    seen = np.isfinite(exact).all(axis=-1)
    assert seen.mean() > 0.2
    np.testing.assert_allclose(map_x[v, u][seen], exact[seen][:, 0], atol=1e-3)
    np.testing.assert_allclose(map_y[v, u][seen], exact[seen][:, 1], atol=1e-3)
    np.testing.assert_array_equal(map_x[v, u][~seen], -16)
    rb.save_rectification(rect, tmp_path / "rectified.yaml")
    again = rb.load_rectification(tmp_path / "rectified.yaml")
    np.testing.assert_array_equal(again.maps("left"), (map_x, map_y))
    assert type(again.left.target) is type(target)


def test_a_reader_with_the_file_alone_gets_the_same_pixels_of_a_prism() -> None:
    rect = rb.Rectification.from_targets(rig(), TARGETS["prism"], TARGETS["prism"], (320, 300))
    told = yaml.safe_load(rectification_text(rect))["left"]["target"]
    rays = rays_ahead(100)
    x, y, z = rays.T
    beta, gamma = np.arctan2(y, z), np.arctan2(x, np.hypot(y, z))
    k = np.clip(np.round((beta - told["first_rad"]) / told["piece_rad"]), 0, told["pieces"] - 1)
    d = beta - told["first_rad"] - k * told["piece_rad"]
    u = told["cx"] + told["focal_px"] * np.tan(gamma) / np.cos(d)
    v = told["cy"] + told["focal_px"] * (2 * k * np.tan(told["piece_rad"] / 2) + np.tan(d))
    pixels, ok = rect.left.target.project(rays)
    np.testing.assert_allclose(np.stack([u, v], axis=-1)[ok], pixels[ok], atol=1e-9)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"piece_rad": 3.2}, "piece_rad is 3.2"),
        ({"piece_rad": 0.0}, "piece_rad is 0"),
        ({"pieces": 0}, "pieces is 0"),
        ({"pieces": 2.5}, "pieces is 2.5"),
    ],
)
def test_a_prism_that_is_none_is_refused(fields: dict[str, float], message: str) -> None:
    given = {"first_rad": 0.0, "piece_rad": 0.7, "pieces": 3} | fields
    with pytest.raises(rb.InvalidInput, match=message):
        rb.Prism(80.0, 0.0, 0.0, **given)


@pytest.mark.parametrize("baseline", [(1.0, 0.0), (0.0, 0.0, 0.0)])
def test_circles_without_a_direction_are_refused(baseline: tuple[float, ...]) -> None:
    with pytest.raises(rb.InvalidInput, match="expected a direction"):
        rb.EpipolarCircles(80.0, 0.0, 0.0, baseline)  # type: ignore[arg-type]
