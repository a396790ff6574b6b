"""Resampling by points and by areas: what must not change, what must be averaged, and how well."""

import warnings
from collections.abc import Callable

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench import llvm
from rectbench.warps.lookup import footprints
from rectbench.warps.lookup.resampling import REMAPPED_TYPES, Filter
from tests.rigs_for_tests import aligned_rig, rig

METHODS = ("conventional", "abraham", "local-homography", "hartley", "fusiello")
SIZE = (480, 320)


def noise(
    dtype: object = np.uint8, channels: tuple[int, ...] = (), size: tuple[int, int] = SIZE
) -> np.ndarray:
    return np.random.default_rng(0).uniform(0, 255, (size[1], size[0], *channels)).astype(dtype)


def straight(size: tuple[int, int]) -> rb.Rectification:
    """A rectification that moves no pixel."""
    focal, centre = 500.0, ((size[0] - 1) / 2, (size[1] - 1) / 2)
    lens = rb.Camera("pinhole", size, {"fx": focal, "fy": focal, "cx": centre[0], "cy": centre[1]})
    pair = rb.Rig(lens, lens, np.eye(3), np.array([-0.1, 0, 0]))
    target = rb.Perspective.from_focal(focal, *centre)
    return rb.Rectification.from_targets(pair, target, target, size)


@pytest.mark.parametrize("interpolation", [cv2.INTER_NEAREST, cv2.INTER_LINEAR, cv2.INTER_CUBIC])
@pytest.mark.parametrize("dtype", REMAPPED_TYPES, ids=str)
def test_points_are_those_of_opencv_to_the_bit(dtype: np.dtype, interpolation: int) -> None:
    rect = rb.rectify(rig(), method="abraham").scaled(0.5)
    image = noise(dtype, (3,))
    expected = cv2.remap(image, *rect.maps("right"), interpolation, borderMode=cv2.BORDER_CONSTANT)
    np.testing.assert_array_equal(rect.remap(image, image, interpolation)[1], expected)


@pytest.mark.parametrize("dtype", REMAPPED_TYPES, ids=str)
def test_where_the_warp_does_not_shrink_areas_are_points_to_the_bit(dtype: np.dtype) -> None:
    rect = rb.rectify(rig(), method="abraham")
    image = noise(dtype, (3,))
    v, u = np.mgrid[: rect.size[1], : rect.size[0]]
    derivatives = np.nan_to_num(rect.left.inverse_jacobian(np.stack([u, v], axis=-1)))
    kept = np.linalg.svd(derivatives, compute_uv=False)[..., 0] ** 2 < footprints.UNSHRUNK - 1e-4
    points, areas = (rect.remap(image, image, filter=name)[0] for name in ("point", "area"))
    assert 0.05 < kept.mean() < 0.95
    np.testing.assert_array_equal(points[kept], areas[kept])
    assert (points[~kept] != areas[~kept]).any()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("factor", [1.0, 0.3, 0.03])
def test_a_flat_image_stays_flat_up_to_its_rim(method: str, factor: float) -> None:
    rect = rb.rectify(rig(), method=method).scaled(factor)
    resampler = rb.Resampler.of(rect, "left", "area")
    for dtype, level in (("uint8", 255), ("uint16", 65535), ("int16", -32768), ("float64", 0.7)):
        flat = resampler(np.full((SIZE[1], SIZE[0]), level, dtype))[rect.valid("left")]
        np.testing.assert_allclose(flat, np.array(level, dtype), rtol=1e-6)


@pytest.mark.parametrize("factor", [0.5, 0.1])
def test_a_ramp_stays_a_ramp(factor: float) -> None:
    rect = rb.rectify(rig(), method="abraham").scaled(factor)
    v, u = np.mgrid[: SIZE[1], : SIZE[0]].astype(np.float32)
    resampler = rb.Resampler.of(rect, "left", "area")
    map_x, map_y = rect.maps("left")
    rim = 1.5 * resampler.footprints.largest_px  # no sample of these pixels leaves the image
    inner = (map_x > rim) & (map_x < SIZE[0] - 1 - rim) & (map_y > rim) & (map_y < SIZE[1] - 1 - rim)
    assert inner.mean() > 0.3
    assert np.abs(resampler(u) - map_x)[inner].max() < 0.01
    assert np.abs(resampler(v) - map_y)[inner].max() < 0.01


@pytest.mark.parametrize("times", [2, 3, 4, 5, 8, 16])
def test_an_image_made_smaller_a_whole_number_of_times_is_the_mean_of_whole_pixels(times: int) -> None:
    size = (240, 160) if times != 3 else (240, 159)
    rect = straight(size).scaled(1 / times)
    image = noise(np.float32, (3,), size)
    expected = cv2.resize(image, rect.size, interpolation=cv2.INTER_AREA)
    areas, _ = rect.remap(image, image, filter="area")
    assert np.abs(areas - expected).max() < 0.02
    assert areas.mean() == pytest.approx(image.mean(), abs=1e-3)
    eight_bits = image.astype(np.uint8)
    expected = cv2.resize(eight_bits.astype(np.float32), rect.size, interpolation=cv2.INTER_AREA)
    assert np.abs(rect.remap(eight_bits, eight_bits, filter="area")[0] - expected).max() < 0.53


def rings() -> np.ndarray:
    """A zone plate that reaches a period of 2.5 pixels in the corners."""
    v, u = np.mgrid[: SIZE[1], : SIZE[0]]
    u, v = u - SIZE[0] / 2, v - SIZE[1] / 2
    return (127.5 + 127 * np.cos(np.pi * 0.4 / np.hypot(*SIZE) * 2 * (u * u + v * v))).astype(np.float32)


def stripes() -> np.ndarray:
    """Oblique stripes with a period of 3 pixels."""
    v, u = np.mgrid[: SIZE[1], : SIZE[0]]
    return (127.5 + 127 * np.sin(2 * np.pi / 3 * (u * np.cos(0.6) + v * np.sin(0.6)))).astype(np.float32)


@pytest.mark.parametrize("picture", [rings, stripes])
@pytest.mark.parametrize(("factor", "gain"), [(0.5, 1.5), (0.25, 6), (0.1, 30)])
@pytest.mark.parametrize("method", METHODS)
def test_the_error_against_256_samples_a_pixel_falls(
    method: str, factor: float, gain: float, picture: Callable[[], np.ndarray]
) -> None:
    rect = rb.rectify(rig(), method=method).scaled(factor)
    image = picture()
    fine = rect.scaled(16)
    seen = cv2.resize(fine.valid("left").astype(np.float32), rect.size, interpolation=cv2.INTER_AREA) == 1
    mean = cv2.resize(fine.remap(image, image)[0], rect.size, interpolation=cv2.INTER_AREA)
    points, areas = (
        np.sqrt(np.square(rect.remap(image, image, filter=name)[0] - mean)[seen].mean())
        for name in ("point", "area")
    )
    assert points / areas > gain


def seen_scene(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Oblique waves of periods from 3 to 40 source pixels, at any place."""
    angles, periods = np.linspace(0, 3, 12), np.geomspace(3, 40, 12)
    waves = [
        np.cos(2 * np.pi / period * (u * np.cos(a) + v * np.sin(a)) + 7 * a)
        for a, period in zip(angles, periods, strict=True)
    ]
    return np.asarray(127.5 + 30 * sum(waves), np.float32)


@pytest.mark.parametrize("method", METHODS)
def test_areas_come_closer_to_the_scene_and_closest_with_cubic_samples(method: str) -> None:
    rect = rb.rectify(rig(), method=method).scaled(0.25)
    map_x, map_y = rect.scaled(16).maps("left")
    scene = cv2.resize(seen_scene(map_x, map_y), rect.size, interpolation=cv2.INTER_AREA)
    fine = [(np.arange(8 * side) + 0.5) / 8 - 0.5 for side in SIZE]
    image = cv2.resize(seen_scene(*np.meshgrid(*fine)), SIZE, interpolation=cv2.INTER_AREA)
    inner = cv2.erode(rect.valid("left").astype(np.uint8), np.ones((9, 9)), borderValue=0) > 0

    def error(filter: Filter, interpolation: int) -> float:
        resampled = rb.Resampler.of(rect, "left", filter, interpolation)(image)
        return float(np.sqrt(np.square(resampled - scene)[inner].mean()))

    points, areas = error("point", cv2.INTER_LINEAR), error("area", cv2.INTER_LINEAR)
    assert areas < points / 6
    assert error("area", cv2.INTER_CUBIC) < areas / 2


def test_the_same_without_a_compiler_and_in_other_tiles(monkeypatch: pytest.MonkeyPatch) -> None:
    rect = rb.rectify(rig(), method="abraham").scaled(0.2)
    image = noise(np.uint8, (3,))
    first = rb.Resampler.of(rect, "left", "area")(image).astype(int)
    monkeypatch.setattr(llvm, "available", lambda: False)
    monkeypatch.setattr(footprints, "TILE_ROWS", 17)
    monkeypatch.setattr(footprints, "TILE_COLUMNS", 200)
    again = rb.Resampler.of(rect, "left", "area")(image).astype(int)
    assert np.abs(first - again).max() <= 1


@pytest.mark.parametrize("channels", [(), (1,), (3,), (4,), (6,)])
@pytest.mark.parametrize("dtype", REMAPPED_TYPES, ids=str)
def test_types_and_channels_are_kept_and_channels_are_apart(
    dtype: np.dtype, channels: tuple[int, ...]
) -> None:
    rect = rb.rectify(rig(), method="local-homography").scaled(0.3)
    image = noise(dtype, channels)
    resampler = rb.Resampler.of(rect, "right", "area")
    areas = resampler(image)
    assert (areas.dtype, areas.shape) == (image.dtype, rb.Resampler.of(rect, "right")(image).shape)
    first, alone = (
        areas.reshape(*areas.shape[:2], -1)[..., 0],
        resampler(image.reshape(320, 480, -1)[..., 0].copy()),
    )
    # OpenCV reads images of 2 or more than 4 channels at steps of 1/32 px.
    assert np.abs(first.astype(float) - alone).max() <= (6 if channels == (6,) else 1e-3)


def test_one_resampler_serves_many_images_and_agrees_with_remap() -> None:
    rect = rb.rectify(rig(), method="abraham").scaled(0.5)
    left, right = noise(), noise()[::-1].copy()
    resamplers = [rb.Resampler.of(rect, side, "area") for side in ("left", "right")]
    for images in ((left, right), (right, left), (left, right)):
        both = rect.remap(*images, filter="area")
        for resampler, image, expected in zip(resamplers, images, both, strict=True):
            np.testing.assert_array_equal(resampler(image), expected)


def test_a_view_up_to_the_epipoles_is_resampled_without_a_warning() -> None:
    rect = rb.rectify(aligned_rig(*SIZE, 200.0, max_angle_deg=90.0), method="abraham").scaled(0.5)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        areas, _ = rect.remap(*[noise(np.float32)] * 2, filter="area")
    assert np.isfinite(areas).all()


def test_an_unknown_filter_or_side_is_refused() -> None:
    rect = rb.rectify(rig())
    with pytest.raises(rb.InvalidInput, match="filter is 'box'; expected 'point' or 'area'"):
        rb.Resampler.of(rect, "left", "box")  # type: ignore[arg-type]
    with pytest.raises(rb.InvalidInput, match="side is 'top'"):
        rb.Resampler.of(rect, "top")  # type: ignore[arg-type]
