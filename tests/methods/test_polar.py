"""polar: the paper's construction step by step, and no pixel lost, on planes and on the sphere."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rectbench as rb
from rectbench.scored import check_agreement
from rectbench.warps.jacobians import entries, singular_values
from tests.rigs_for_tests import LENSES, points_before, rig

MOTIONS = {
    "sideways": (0.1, 0.01, 0.0),
    "diagonal": (0.2, 0.02, 0.2),
    "at the edge": (0.1, 0.01, 0.12),
    "forward": (0.01, 0.004, 0.3),
    "backward": (0.01, 0.0, -0.3),
    "vertical": (0.004, 0.12, 0.003),
}


def pinholes(centre_m: tuple[float, float, float]) -> rb.Rig:
    """Two different pinholes, turned against each other."""
    left = rb.Camera("pinhole", (320, 240), {"fx": 190, "fy": 192, "cx": 157, "cy": 122})
    right = rb.Camera("pinhole", (300, 250), {"fx": 215, "fy": 214, "cx": 147, "cy": 127})
    R = Rotation.from_rotvec([0.02, -0.05, 0.03]).as_matrix()
    return rb.Rig(left, right, R, -R @ np.array(centre_m), name="pinholes")


class Image:
    """One image of the pair, by its own pixels, for the paper's construction."""

    def __init__(self, camera: rb.Camera, epipole: np.ndarray) -> None:
        self.camera, self.epipole = camera, epipole

    def far_end(self, direction: np.ndarray) -> np.ndarray:
        """Where the half line from the epipole leaves the image: by halving, from a place inside outwards."""
        reach = np.linalg.norm(self.epipole) + sum(self.camera.size)
        places = np.linspace(0, 2 * reach, 4001)
        inside = self.camera.contains(self.epipole + places[:, None] * direction)
        low, high = places[np.flatnonzero(inside)[-1] + np.array([0, 1])]
        for _ in range(40):
            middle = (low + high) / 2
            low, high = (
                (middle, high) if self.camera.contains(self.epipole + middle * direction) else (low, middle)
            )
        return self.epipole + low * direction


def steps_of_the_paper(pair: rb.Rig, direction: np.ndarray, turns: int, sense: int) -> np.ndarray:
    """Far ends [turns, 2] in the left image of lines, each one pixel from the last at one of two far ends.

    The end of a line is moved by one pixel across it, in either image; what the right one asks for is carried
    to the left by a point in front of both cameras, and the smaller step is taken.
    """
    to_right = pair.centre_right_in_left
    left = Image(pair.left, pair.left.project(to_right)[0])
    right = Image(pair.right, pair.right.project(pair.R_right_left @ to_right)[0])

    def across(direction: np.ndarray) -> np.ndarray:
        return sense * np.array([-direction[1], direction[0]])

    def towards(pixel: np.ndarray, image: Image) -> np.ndarray:
        return (pixel - image.epipole) / np.linalg.norm(pixel - image.epipole)

    def in_right(pixel: np.ndarray) -> np.ndarray:
        far = 1e4 * pair.left.unproject(pixel)[0]
        return towards(pair.right.project(pair.right_from_left(far))[0], right)

    def in_left(pixel: np.ndarray) -> np.ndarray:
        far = 1e4 * pair.right.unproject(pixel)[0]
        return towards(pair.left.project(pair.R_right_left.T @ (far - pair.t_right_left))[0], left)

    ends = []
    for _ in range(turns):
        end = left.far_end(direction)
        ends.append(end)
        by_left = towards(end + across(direction), left)
        other = in_right(end)
        end_right = right.far_end(other)
        by_right = in_left(end_right + across(other))
        direction = max(by_left, by_right, key=lambda d: float(d @ direction))
    return np.array(ends)


@pytest.mark.parametrize("motion", ["forward", "at the edge"])
def test_rows_are_the_lines_that_the_papers_steps_find(motion: str) -> None:
    pair = pinholes(MOTIONS[motion])
    rect = rb.rectify(pair, "polar")
    to_right = pair.left.project(pair.centre_right_in_left)[0]
    start = np.array([40.0, 200.0]) - to_right
    start /= np.linalg.norm(start)
    ends = steps_of_the_paper(pair, start, 150, sense=1)
    inwards = ends + 1e-6 * (to_right - ends)
    rows = np.diff(rect.left.forward(inwards)[:, 1])
    rows = np.abs(rows[np.abs(rows) < 10])  # the seam is in one of them, where epipoles are in the view
    assert len(rows) >= 148
    # One row a step; where lines draw together within a step, up to a hundredth more.
    assert rows.min() > 1 - 2e-3
    assert rows.mean() < 1 + 5e-3
    assert rows.max() < 1 + 2e-2


def test_columns_keep_lengths_along_the_lines() -> None:
    pair = pinholes(MOTIONS["forward"])
    rect = rb.rectify(pair, "polar")
    for warp, lens, towards in (
        (rect.left, pair.left, pair.centre_right_in_left),
        (rect.right, pair.right, pair.R_right_left @ pair.centre_right_in_left),
    ):
        pixels = rb.evaluation_pixels(warp.source)
        radii = np.linalg.norm(pixels - lens.project(towards)[0], axis=1)
        columns = warp.forward(pixels)[:, 0]
        np.testing.assert_allclose(columns + radii, (columns + radii)[0], atol=1e-9)


def lost(rect: rb.Rectification) -> list[float]:
    """The least singular value of either map, over many pixels."""
    least = []
    for warp in (rect.left, rect.right):
        J = warp.jacobian(rb.evaluation_pixels(warp.source, 20_000))
        least.append(float(np.nanmin(singular_values(*entries(J), np)[1])))
    return least


@pytest.mark.parametrize("motion", MOTIONS)
def test_no_pixel_of_a_pinhole_is_lost(motion: str) -> None:
    pair = pinholes(MOTIONS[motion])
    on_planes, on_spheres = (rb.rectify(pair, "polar", form=form) for form in ("planar", "spherical"))
    assert min(lost(on_planes)) >= 1 - 1e-9
    assert min(lost(on_spheres)) >= 1
    # Nor are there more rows than that takes: on some line the farthest pixel is as large as in its source.
    assert min(lost(on_planes)) < 1 + 1e-3


@pytest.mark.parametrize("model", sorted(LENSES))
@pytest.mark.parametrize("motion", ["sideways", "diagonal"])
def test_no_pixel_of_any_lens_is_lost(model: str, motion: str) -> None:
    least = lost(rb.rectify(rig(model, centre_m=MOTIONS[motion]), "polar"))
    assert min(least) >= 1
    assert min(least) < 1.03


def test_a_circle_about_the_epipole_has_the_closed_form() -> None:
    # An equidistant lens along the baseline: columns are radii, and every line ends on the image circle, at
    # R, so that rows are R pixels a radian.
    middle, angle = 200.0, np.radians(70)
    params = {"fx": middle / angle, "fy": middle / angle, "cx": middle, "cy": middle}
    lens = rb.Camera("equidistant", (401, 401), params, max_angle_deg=70)
    rect = rb.rectify(rb.Rig(lens, lens, np.eye(3), np.array([0.0, 0, -0.3])), "polar")
    u, v = rect.left.target.target.u, rect.left.target.target.v
    gamma, beta = np.radians(np.linspace(25, 80, 12)), np.linspace(-3.0, 3.0, 40)
    np.testing.assert_allclose((u(gamma + 1e-4) - u(gamma - 1e-4)) / 2e-4, middle / angle, rtol=0.01)
    slopes = (v(beta + 1e-4) - v(beta - 1e-4)) / 2e-4
    assert (slopes >= middle * (1 - 5e-3)).all()
    assert (slopes <= middle * 1.015).all()


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("form", ["planar", "spherical"])
def test_rows_agree_and_points_are_found_again(motion: str, form: str) -> None:
    pair = pinholes(MOTIONS[motion])
    rect = rb.rectify(pair, "polar", form=form)
    points, px_left, px_right = points_before(pair, 300)
    left, right = rect.left.forward(px_left), rect.right.forward(px_right)
    both = np.isfinite(left).all(axis=1) & np.isfinite(right).all(axis=1)
    assert both.sum() > 100
    np.testing.assert_allclose(left[both, 1], right[both, 1], atol=1e-6)
    found = rect.triangulate(left[both], (left - right)[both, 0])
    np.testing.assert_allclose(found, points[both], rtol=1e-5)


def test_planes_are_for_pinholes_without_distortion() -> None:
    assert isinstance(rb.rectify(rig("unified"), "polar").left.target, rb.Epipolar)
    assert isinstance(rb.rectify(pinholes(MOTIONS["sideways"]), "polar").left.target, rb.PlanarPolar)
    for method in ("polar", "log-polar"):
        with pytest.raises(rb.Unsupported, match="form=planar works on images of pinholes"):
            rb.rectify(rig("unified"), method, form="planar")


def test_rows_go_all_around_an_epipole_in_the_view() -> None:
    rect = rb.rectify(pinholes(MOTIONS["forward"]), "polar")
    assert rect.turn_px == pytest.approx(rect.size[1], abs=1)
    assert rect.left.target.target.v == rect.right.target.target.v


@pytest.mark.parametrize("method", ["polar", "log-polar", "polar-optimal"])
@pytest.mark.parametrize("motion", MOTIONS)
def test_all_of_the_trimmed_view_is_shown_by_maps_that_agree(method: str, motion: str) -> None:
    for pair in (pinholes(MOTIONS[motion]), rig("equidistant", centre_m=MOTIONS[motion])):
        trimmed = pair.trimmed()
        rect = rb.rectify(pair, method)
        delivered = rb.Delivered.of(rect, rb.ScoredView.of(trimmed))
        check_agreement(rect, delivered)
        assert delivered.keeps(1.0)


@pytest.mark.parametrize("method", ["polar", "log-polar"])
@pytest.mark.parametrize("name", ["pinhole-toed-in", "pinhole-rolled", "pinhole-unequal"])
def test_what_is_far_away_has_about_the_same_columns_in_planes_too(method: str, name: str) -> None:
    # The epipoles of cameras that are turned towards each other lie on opposite sides of their images.
    pair = rb.load_rig(name)
    rect = rb.rectify(pair, method, form="planar")
    far = 1e4 * pair.left.unproject(rb.evaluation_pixels(pair.left))[0]
    px_right, seen = pair.right.project(pair.right_from_left(far))
    both = seen & pair.right.contains(px_right)
    apart = rect.left.forward(rb.evaluation_pixels(pair.left)[both]) - rect.right.forward(px_right[both])
    assert abs(np.median(apart[:, 0])) < 1
    assert rect.size[0] < 1.6 * pair.left.width
    assert (rect.valid("left") & rect.valid("right")).mean() > 0.3
