"""cylinder: where rays meet a cylinder of radius f, about the baseline or upright."""

import numpy as np
import pytest

import rectbench as rb
from tests.rigs_for_tests import aligned_rig, points_before, rig

RAYS = np.array([[0.0, 0.0, 1.0], [0.3, 0.2, 0.8], [-0.6, -0.4, 0.7], [0.1, 0.5, -0.4]])


@pytest.mark.parametrize(("axis", "along"), [("baseline", 0), ("vertical", 1)])
def test_pixels_are_lengths_on_the_unrolled_cylinder(axis: str, along: int) -> None:
    focal = 130.0
    target = rb.rectify(aligned_rig(480, 320, 150), "cylinder", axis=axis, focal_px=focal).left.target
    around = 1 - along
    hits = focal * RAYS / np.hypot(RAYS[:, around], RAYS[:, 2])[:, None]
    expected = np.empty((len(RAYS), 2))
    expected[:, along] = hits[:, along]
    expected[:, around] = focal * np.arctan2(hits[:, around], hits[:, 2])
    pixels, ok = target.project(RAYS)
    assert ok.all()
    np.testing.assert_allclose(pixels - pixels[0], expected - expected[0], atol=1e-9)


@pytest.mark.parametrize("axis", ["baseline", "vertical"])
def test_it_ends_where_it_is_told(axis: str) -> None:
    rect = rb.rectify(aligned_rig(480, 320, 150), "cylinder", axis=axis, along_deg=60.0, focal_px=100.0)
    length = rect.size[0] if axis == "baseline" else rect.size[1]
    assert length == np.ceil(200 * np.tan(np.radians(30)))


def test_an_upright_cylinder_has_no_epipolar_rows() -> None:
    pair = rig()
    _, px_left, px_right = points_before(pair)
    errors = rb.metrics.row_error(rb.rectify(pair, "cylinder", axis="vertical"), px_left, px_right)
    assert errors.columns()["row_error_p95_px"] > 1
