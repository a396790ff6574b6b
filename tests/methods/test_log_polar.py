"""log-polar: conformal on the sphere and in planes, and bounded at the epipoles."""

import numpy as np
import pytest

import rectbench as rb
from tests.methods.test_polar import MOTIONS, pinholes
from tests.rigs_for_tests import aligned_rig, points_before, rig


@pytest.mark.parametrize("model", ["equidistant", "double-sphere"])
def test_it_is_conformal_on_the_sphere(model: str) -> None:
    rect = rb.rectify(rig(model), "log-polar")
    rays = rect.rig.left.unproject(rb.evaluation_pixels(rect.rig.left))[0] @ rect.R_rect_left.T
    J = rect.left.target.project_jacobian(rays)
    gamma = np.arctan2(rays[:, 0], np.hypot(rays[:, 1], rays[:, 2]))
    scale = (rect.notes["focal_px"] / np.cos(gamma)) ** 2
    np.testing.assert_allclose(J @ J.mT, scale[:, None, None] * np.eye(2), rtol=1e-9, atol=1e-6)


def test_of_a_parabolic_mirror_it_is_the_bipolar_coordinates_of_its_image() -> None:
    """Geyer and Daniilidis's own construction: the image is a complex plane, both epipoles are its poles."""
    pair = rig("stereographic", centre_m=(0.1, 0.02, -0.03))
    lens = rb.Camera("stereographic", pair.left.size, dict(pair.left.params) | {"fy": pair.left.params["fx"]})
    pair = rb.Rig(lens, lens, pair.R_right_left, pair.t_right_left)
    rect = rb.rectify(pair, "log-polar", focal_px=100.0)
    towards = pair.centre_right_in_left
    ahead, behind = lens.project([towards, -towards])[0] @ [1, 1j]
    pixels = rb.evaluation_pixels(lens, 200)
    place = pixels @ [1, 1j]
    bipolar = np.log((place - behind) / (place - ahead))
    u, v = rect.left.forward(pixels).T
    known = np.isfinite(u)
    assert known.sum() > 150
    np.testing.assert_allclose((u - 100 * bipolar.real)[known], (u - 100 * bipolar.real)[known][0], atol=1e-8)
    turned = np.exp(1j * (v / 100 - bipolar.imag))[known]  # angles, up to whole turns
    np.testing.assert_allclose(turned, turned[0], atol=1e-9)


def test_its_columns_are_the_closed_form() -> None:
    rect = rb.rectify(aligned_rig(480, 320, 120), "log-polar", focal_px=200.0)
    gamma = np.array([0.0, 0.4, -1.0])
    rays = np.stack([np.sin(gamma), 0 * gamma, np.cos(gamma)], axis=-1)
    u = rect.left.target.project(rays)[0][:, 0]
    np.testing.assert_allclose(u - u[0], 200 * np.arctanh(np.sin(gamma)), atol=1e-9)


def test_in_planes_of_equal_cameras_it_is_conformal_and_the_papers_logarithms() -> None:
    lens = rb.Camera("pinhole", (320, 240), {"fx": 190, "fy": 190, "cx": 157, "cy": 122})
    pair = rb.Rig(lens, lens, np.eye(3), np.array([0.02, -0.01, -0.3]))
    rect = rb.rectify(pair, "log-polar", form="planar")
    epipole = lens.project(pair.centre_right_in_left)[0]
    corners = np.array([[-0.5, -0.5], [319.5, -0.5], [-0.5, 239.5], [319.5, 239.5]])
    reach = np.linalg.norm(corners - epipole, axis=1).max()
    for warp in (rect.left, rect.right):
        pixels = rb.evaluation_pixels(warp.source, 2000)
        radius = np.linalg.norm(pixels - epipole, axis=1)
        J = warp.jacobian(pixels)
        scale = ((reach / radius) ** 2)[:, None, None]
        np.testing.assert_allclose(J @ J.mT / scale, np.broadcast_to(np.eye(2), J.shape), atol=1e-3)
        u = warp.forward(pixels)[:, 0] + reach * np.log(radius)
        np.testing.assert_allclose(u, u[0], atol=1e-6)


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("form", ["planar", "spherical"])
def test_rows_agree_for_any_motion(motion: str, form: str) -> None:
    pair = pinholes(MOTIONS[motion])
    rect = rb.rectify(pair, "log-polar", form=form)
    _, px_left, px_right = points_before(pair, 300)
    left, right = rect.left.forward(px_left), rect.right.forward(px_right)
    both = np.isfinite(left).all(axis=1) & np.isfinite(right).all(axis=1)
    assert both.sum() > 100
    np.testing.assert_allclose(left[both, 1], right[both, 1], atol=1e-6)


def test_the_epipole_itself_is_left_out_where_the_margin_is_less_than_a_pixel() -> None:
    focal, margin_deg = 160.0, 0.1
    params = {"fx": focal, "fy": focal, "cx": 200, "cy": 200}
    lens = rb.Camera("equidistant", (401, 401), params, max_angle_deg=70)
    pair = rb.Rig(lens, lens, np.eye(3), np.array([0.0, 0, -0.3]))
    rect = rb.rectify(pair, "log-polar", margin_deg=margin_deg)
    inner, outer = np.arctanh(np.cos(1 / focal)), np.arctanh(np.cos(np.radians(70)))
    assert rect.size[0] == pytest.approx(focal * (inner - outer), rel=0.01)
