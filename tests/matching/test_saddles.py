"""A saddle is found where it is, and what is none is NaN."""

import numpy as np

from rectbench.matching.boards.saddles import refined_saddles


def test_a_start_outside_of_the_image_finds_nothing_and_stops_nothing() -> None:
    image = np.zeros((60, 80), np.uint8)
    image[:30, :40] = image[30:, 40:] = 200
    starts = np.array([[41.0, 29.0], [-3.0, 10.0], [90.0, 20.0], [np.nan, 5.0]])
    found = refined_saddles(image, starts, 5)
    np.testing.assert_allclose(found[0], [39.5, 29.5], atol=0.05)
    assert np.isnan(found[1:]).all()
