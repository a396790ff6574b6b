"""Feature matches: a known shift is found at its pixel, whatever the detector, depth and channels."""

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench.images.reading import grey8
from rectbench.matching import match_features
from rectbench.matching.features.detectors import DETECTORS, detector_named


def texture(seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    coarse = sum(np.kron(rng.uniform(0, 80, (240 // s, 320 // s)), np.ones((s, s))) for s in (4, 10, 20))
    return np.clip(coarse, 0, 255).astype(np.uint8)


def shift_of(matches: rb.Matches) -> np.ndarray:
    return np.median(matches.right - matches.left, axis=0)


def test_a_shifted_image_is_matched_at_its_shift() -> None:
    image = texture()
    left, right = rb.sift_matches(image[:, 12:], image[:, :-12])
    assert len(left) > 50
    np.testing.assert_allclose(np.median(right - left, axis=0), [12, 0], atol=0.05)


@pytest.mark.parametrize("image", [np.zeros((100, 100), np.uint8), np.full((40, 60, 3), 200, np.uint8)])
def test_blank_images_have_no_matches(image: np.ndarray) -> None:
    left, right = rb.sift_matches(image, image)
    assert left.shape == right.shape == (0, 2)


@pytest.mark.parametrize("detector", ["sift", "akaze", "orb"])
def test_every_detector_finds_the_shift(detector: str) -> None:
    image = texture()
    found = match_features(image[:, 12:], image[:, :-12], detector=detector)
    assert len(found.left) > 50
    np.testing.assert_allclose(shift_of(found), [12, 0], atol=0.1)


def test_surf_is_there_or_says_why_not() -> None:
    image = texture()
    try:
        cv2.xfeatures2d.SURF_create()
    except (AttributeError, cv2.error):
        with pytest.raises(rb.Unavailable, match=r"no SURF.*use sift"):
            match_features(image, image, detector="surf")
    else:
        assert len(match_features(image, image, detector="surf").left) > 50


def test_an_unknown_detector_is_told_with_the_known_ones() -> None:
    with pytest.raises(rb.UnknownName, match="sift"):
        match_features(texture(), texture(), detector="sfit")
    assert set(DETECTORS) == {"sift", "akaze", "orb", "surf"}


@pytest.mark.parametrize("axis", [0, 1])
def test_sift_features_of_a_mirrored_image_lie_in_the_mirrored_places(axis: int) -> None:
    """OpenCV's own are a quarter of a pixel off (its bilinear enlargement of the first octave)."""
    image = texture()
    mirrored = np.ascontiguousarray(np.flip(image, axis))
    here, there = (detector_named("sift").features(view, None, None).pixels for view in (image, mirrored))
    coordinate = 1 - axis
    there[:, coordinate] = image.shape[axis] - 1 - there[:, coordinate]
    offsets = here[:, None, :] - there[None, :, :]
    nearest = np.linalg.norm(offsets, axis=-1).argmin(axis=1)
    assert abs(np.median(offsets[np.arange(len(here)), nearest, coordinate])) < 0.02


def test_working_pixels_keep_the_corners_in_place() -> None:
    image = np.kron(texture(), np.ones((3, 3), np.uint8))
    whole = match_features(image[:, 36:], image[:, :-36])
    reduced = match_features(image[:, 36:], image[:, :-36], working_pixels=image.size / 9)
    np.testing.assert_allclose(shift_of(reduced), shift_of(whole), atol=0.1)
    assert reduced.left.max() > 0.9 * image.shape[1] - 36
    # Both find the same corners of the blocks: the pixel centres are mapped, not the pixel numbers.
    offsets = reduced.left[:, None, :] - whole.left[None, :, :]
    nearest = offsets[np.arange(len(offsets)), np.linalg.norm(offsets, axis=-1).argmin(axis=1)]
    close = nearest[np.linalg.norm(nearest, axis=-1) < 1.5]
    assert len(close) > 30
    np.testing.assert_allclose(np.median(close, axis=0), 0, atol=0.25)


def test_a_cell_keeps_no_more_than_asked_and_the_clearest_first() -> None:
    image = texture()
    everything = match_features(image[:, 12:], image[:, :-12])
    thinned = match_features(image[:, 12:], image[:, :-12], per_cell=2)
    cells, counts = np.unique(np.floor(thinned.left / (308 / 16)), axis=0, return_counts=True)
    assert counts.max() == 2
    assert len(cells) == len(np.unique(np.floor(everything.left / (308 / 16)), axis=0))


def test_a_distance_limit_drops_matches() -> None:
    noisy = np.clip(texture() + np.random.default_rng(1).normal(0, 12, (240, 320)), 0, 255).astype(np.uint8)
    free = match_features(texture(), noisy)
    assert 0 < len(match_features(texture(), noisy, farthest=0.3).left) < len(free.left)


@pytest.mark.parametrize(
    "convert",
    [
        lambda grey: grey.astype(np.uint16) * 256,
        lambda grey: grey.astype(np.uint16) * 16 + 40,
        lambda grey: grey / 255.0,
        lambda grey: np.stack([grey] * 3, axis=-1),
        lambda grey: np.dstack([grey, grey, grey, np.full_like(grey, 255)]),
        lambda grey: grey[:, :, None],
    ],
    ids=["16-bit", "12 of 16 bits", "float", "RGB", "RGBA", "one channel"],
)
def test_depth_and_channels_do_not_matter(convert) -> None:
    image = convert(texture())
    found = match_features(image[:, 12:], image[:, :-12])
    assert len(found.left) > 50
    np.testing.assert_allclose(shift_of(found), [12, 0], atol=0.05)


def test_eight_bits_stay_what_they_are() -> None:
    np.testing.assert_array_equal(grey8(texture()), texture())


@pytest.mark.parametrize(
    "image", [np.zeros((4, 4, 5)), np.zeros(9), np.zeros((0, 4)), np.full((4, 4), "a")], ids=str
)
def test_what_is_no_image_is_refused(image: np.ndarray) -> None:
    with pytest.raises(rb.InvalidInput, match="left image"):
        match_features(image, texture())


def test_an_image_of_nan_is_blank() -> None:
    assert not grey8(np.full((8, 8), np.nan)).any()
