"""The base of methods that find homographies: what they are given, and where it puts their images."""

from __future__ import annotations

import numpy as np
import pytest

import rectbench as rb
from rectbench.plugins.rectifier import pose_problem
from tests.rigs_for_tests import points_before, rig

ASIDE = np.array([[1, 0, 40], [0, 1, -25], [0, 0, 1.0]])


class Aside(rb.HomographyRectifier):
    """Both images, moved by 40 pixels."""

    name = "aside"

    def homographies(self, view, options):  # type: ignore[no-untyped-def]
        return ASIDE, ASIDE, {}


class AsideItself(Aside):
    """The same, left there."""

    name = "aside-itself"

    def placement(self, view, H_left, H_right):  # type: ignore[no-untyped-def]
        return np.eye(3)


def test_the_middles_of_the_views_come_to_the_middle_of_the_frame() -> None:
    pair = rig("kannala-brandt")
    rect = Aside().fit(pose_problem(pair), rb.Options())
    middle, ok = rect.left.target.project(rect.R_rect_left @ [0, 0, 1])
    assert ok
    np.testing.assert_allclose(middle, (np.array(rect.size) - 1) / 2)


def test_a_method_may_place_its_images_itself() -> None:
    rect = AsideItself().fit(pose_problem(rig("kannala-brandt")), rb.Options())
    middle, _ = rect.left.target.project(rect.R_rect_left @ [0, 0, 1])
    np.testing.assert_allclose(middle, (np.array(rect.size) - 1) / 2 + [40, -25])


def test_the_view_is_the_believed_rig_with_pinholes() -> None:
    pair = rig("kannala-brandt")
    view = rb.PinholeView.of(pose_problem(pair))
    np.testing.assert_array_equal(view.rig.R_right_left, pair.R_right_left)
    np.testing.assert_array_equal(view.rig.t_right_left, pair.t_right_left)
    residuals = np.einsum(
        "ni,ij,nj->n",
        view.camera.unproject(view.matches.right)[0],
        view.rig.essential_matrix,
        view.camera.unproject(view.matches.left)[0],
    )
    np.testing.assert_allclose(residuals, 0, atol=1e-12)


def test_only_who_asks_for_matches_needs_enough_of_them() -> None:
    pair = rig("kannala-brandt")
    _, left, right = points_before(pair, 20)
    view = rb.PinholeView.of(pose_problem(pair, matches=rb.Matches(left[:5], right[:5])))
    assert view.rig.left == view.camera
    with pytest.raises(rb.Unsupported, match="expected 8 or more"):
        view.matches  # noqa: B018
