"""Random rigs: lenses of 60° to 240°, turned by up to 120° against each other, baselines in any direction."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import rectbench as rb
from rectbench.metrics.row_misfit import simulated_matches
from rectbench.warps.rectification import in_frame
from rectbench.warps.view.overlap import overlap_share

ANGULAR = ("abraham", "local-homography")
METHODS = (*ANGULAR, "conventional")


@st.composite
def cameras(draw: st.DrawFn) -> rb.Camera:
    fov_deg = draw(st.floats(60, 240))
    width = draw(st.integers(160, 400))
    size = (width, round(width * draw(st.floats(0.5, 1.0))))
    focal = width / np.radians(fov_deg)
    centre = {"cx": size[0] / 2 + draw(st.floats(-5, 5)), "cy": size[1] / 2 + draw(st.floats(-5, 5))}
    bent = {"k1": draw(st.floats(-0.01, 0.02)), "k2": draw(st.floats(-0.002, 0.002))}
    circle = draw(st.sampled_from((None, fov_deg / 2)))
    if fov_deg > 150:  # beyond, an image's corners may lie behind the lens, where the model has a pole
        circle = fov_deg / 2
    return rb.Camera("kannala-brandt", size, {"fx": focal, "fy": focal, **centre, **bent}, circle)


def directions() -> st.SearchStrategy[np.ndarray]:
    numbers = st.lists(st.floats(-1, 1), min_size=3, max_size=3).map(np.array)
    return numbers.filter(lambda v: np.linalg.norm(v) > 0.1).map(lambda v: v / np.linalg.norm(v))


@st.composite
def any_rigs(draw: st.DrawFn) -> rb.Rig:
    left = draw(cameras())
    right = draw(st.one_of(st.just(left), cameras()))
    turn = np.radians(draw(st.floats(0, 120))) * draw(directions())
    return rb.Rig(left, right, Rotation.from_rotvec(turn).as_matrix(), 0.2 * draw(directions()))


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(pair=any_rigs())
@pytest.mark.parametrize("method", METHODS)
def test_any_rig_that_has_an_overlap_is_rectified(method: str, pair: rb.Rig) -> None:
    if not overlap_share(pair.trimmed(), 50_000):
        with pytest.raises(rb.Unsupported, match="have nothing in common"):
            rb.rectify(pair, method=method)
        return
    rect = rb.rectify(pair, method=method)
    for side in ("left", "right"):
        warp = rect.warp(side)
        assert all(np.isfinite(table).all() for table in rect.maps(side))
        whole = getattr(pair, side)
        pixels = rb.evaluation_pixels(whole, 1000)
        px_rect = warp.forward(pixels)
        assert not np.isinf(px_rect).any()
        shown = in_frame(px_rect, rect.size)
        np.testing.assert_allclose(warp.inverse(px_rect[shown]), pixels[shown], atol=1e-6)
        if method in ANGULAR:
            towards = pair.centre_right_in_left / pair.baseline_m
            towards = pair.R_right_left @ towards if side == "right" else towards
            off_deg = np.degrees(np.arccos(np.clip(np.abs(whole.unproject(pixels)[0] @ towards), 0, 1)))
            np.testing.assert_array_equal(shown, off_deg >= rb.MARGIN_DEG)
    errors = rb.metrics.row_error(rect, *simulated_matches(pair, 500, 3, 30)).rectified_px
    assert np.nan_to_num(errors).max(initial=0) < 1e-6
