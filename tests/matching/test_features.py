"""SIFT matches: a known shift is found; blank images have none."""

import numpy as np
import pytest

import rectbench as rb


def texture(seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    coarse = sum(np.kron(rng.uniform(0, 80, (240 // s, 320 // s)), np.ones((s, s))) for s in (4, 10, 20))
    return np.clip(coarse, 0, 255).astype(np.uint8)


def test_a_shifted_image_is_matched_at_its_shift() -> None:
    image = texture()
    left, right = rb.sift_matches(image[:, 12:], image[:, :-12])
    assert len(left) > 50
    np.testing.assert_allclose(np.median(right - left, axis=0), [12, 0], atol=0.05)


@pytest.mark.parametrize("image", [np.zeros((100, 100), np.uint8), np.full((40, 60, 3), 200, np.uint8)])
def test_blank_images_have_no_matches(image: np.ndarray) -> None:
    left, right = rb.sift_matches(image, image)
    assert left.shape == right.shape == (0, 2)
