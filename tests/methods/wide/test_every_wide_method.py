"""What all methods of wide lenses promise: they pass the checks, and are read back to the same maps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rectbench as rb
from rectbench.applications import check_method
from rectbench.plugins.rectifier import METHODS
from rectbench.registry import registry
from tests.rigs_for_tests import points_before, rig

ANY_LENS = (
    "mrcal-latlon",
    "mrcal-pinhole",
    "spherical",
    "psph",
    "cylinder",
    "multi-pinhole",
    "equirectangular",
    "stereographic-circles",
)
LENS = {"opencv-fisheye": "kannala-brandt", "opencv-omnidir": "unified"}
WITH_SCAN_LINES = [*(name for name in ANY_LENS if name != "equirectangular"), *LENS]


@pytest.mark.parametrize("method", [*ANY_LENS, *LENS])
def test_it_passes_every_check(monkeypatch: pytest.MonkeyPatch, method: str) -> None:
    monkeypatch.setattr(check_method, "RIGS", ("mynteye" if method == "opencv-fisheye" else "kitti-360",))
    found = list(check_method.check_method(registry(METHODS).get(method)))
    assert [finding for finding in found if finding.result == "failed"] == []
    assert sum(finding.result == "passed" for finding in found) >= 8


@pytest.mark.parametrize("method", [*ANY_LENS, *LENS])
def test_it_is_read_back_to_the_last_bit(tmp_path: Path, method: str) -> None:
    rect = rb.rectify(rig(LENS.get(method, "double-sphere")), method)
    for number, framing in enumerate((rb.Framing(), rb.Framing(coverage=0.2, pixels=20_000))):
        framed = rb.framed(rect, framing)
        file = tmp_path / f"{number}.yaml"
        rb.save_rectification(framed, file)
        again = rb.load_rectification(file)
        for side in ("left", "right"):
            np.testing.assert_array_equal(framed.maps(side), again.maps(side))


@pytest.mark.parametrize("method", WITH_SCAN_LINES)
def test_a_vertical_rig_is_rectified_too(method: str) -> None:
    pair = rig(LENS.get(method, "equidistant"), (0.5, 0.4, -0.3), (0.001, 0.12, 0.0), size=(320, 320))
    _, px_left, px_right = points_before(pair, 200)
    errors = rb.metrics.row_error(rb.rectify(pair, method), px_left, px_right).columns()
    assert errors["row_error_max_px"] < 1e-6
    assert errors["row_error_matches"] > 40


@pytest.mark.parametrize(
    "method", ["spherical", "psph", "cylinder", "multi-pinhole", "stereographic-circles"]
)
def test_a_rig_that_sees_its_epipoles_is_rectified_but_for_what_is_about_them(method: str) -> None:
    forward = rig(centre_m=(0.02, 0.0, 0.3))
    _, px_left, px_right = points_before(forward, 400)
    rect = rb.rectify(forward, method)
    errors = rb.metrics.row_error(rect, px_left, px_right).columns()
    assert errors["row_error_max_px"] < 1e-6
    assert errors["row_error_matches"] > 20


@pytest.mark.parametrize("right_first", [False, True])
@pytest.mark.parametrize("method", [name for name in WITH_SCAN_LINES if name != "stereographic-circles"])
def test_disparities_are_depths(method: str, right_first: bool) -> None:
    pair = rig(LENS.get(method, "kannala-brandt"), centre_m=(-0.12 if right_first else 0.12, 0.006, -0.004))
    rect = rb.rectify(pair, method)
    points, px_left, px_right = points_before(pair)
    left, right = rect.left.forward(px_left), rect.right.forward(px_right)
    both = np.isfinite(left + right).all(axis=1)
    assert both.sum() > 50
    found = rect.triangulate(left[both], left[both, 0] - right[both, 0])
    np.testing.assert_allclose(found, points[both], rtol=1e-6)


def test_controls_have_no_distortion_at_equal_view_and_say_why() -> None:
    pair = rb.load_rig("mynteye").scaled(0.25)
    choice = rb.best_method(pair, methods=["equirectangular", "stereographic-circles", "abraham"])
    assert choice.best.method == "abraham"
    for candidate in choice.candidates[1:]:
        assert np.isnan(candidate.measured["log_distortion_on_view"])
        assert "rows are bent by" in candidate.reason
