"""The field of view of a lens, against brute force over its pixels, and what that makes a fisheye rig."""

from __future__ import annotations

import numpy as np
import pytest

import rectbench as rb
from rectbench.calibrations.built_in_rigs import FISHEYE_DEG


def widest_deg(camera: rb.Camera) -> float:
    rays, ok = camera.unproject(camera.pixel_grid()[::2, ::2])
    x, y, z = rays[ok].T
    return float(2 * np.degrees(np.arctan2(np.hypot(x, y), z).max()))


@pytest.mark.parametrize(
    "name", ["bumblebee2", "euroc-eucm", "mynteye", "ocam", "t265", "tumvi", "vi-sensor"]
)
def test_it_is_the_largest_angle_that_any_pixel_shows(name: str) -> None:
    rig = rb.load_rig(name)
    for camera in (rig.left, rig.right):
        # The rim lies up to two pixels beyond the last of these.
        pixel_deg = np.degrees(2 / rb.centre_resolution_px(rig))
        assert widest_deg(camera) - 1e-6 <= camera.fov_deg <= widest_deg(camera) + 6 * pixel_deg
    assert rig.fov_deg == min(rig.left.fov_deg, rig.right.fov_deg)


def test_a_pinhole_camera_has_that_of_its_corners() -> None:
    camera = rb.Camera("pinhole", (640, 480), {"fx": 500, "fy": 500, "cx": 319.5, "cy": 239.5})
    assert camera.fov_deg == pytest.approx(2 * np.degrees(np.arctan(np.hypot(320, 240) / 500)))


def test_an_image_circle_ends_it() -> None:
    params = {"fx": 200, "fy": 200, "cx": 399.5, "cy": 399.5}
    assert rb.Camera("equidistant", (800, 800), params, max_angle_deg=95).fov_deg == pytest.approx(
        190, abs=1e-5
    )
    # Smaller than the circle, the image shows what its corners do.
    narrow = rb.Camera("equidistant", (400, 400), {**params, "cx": 199.5, "cy": 199.5}, max_angle_deg=95)
    assert narrow.fov_deg == pytest.approx(2 * np.degrees(np.hypot(200, 200) / 200))


def test_fisheye_rigs_are_those_that_see_120_degrees_with_both_lenses() -> None:
    assert FISHEYE_DEG == 120
    assert rb.fisheye_rigs() == tuple(
        name
        for name in rb.rig_names()
        if name != "tumvi-kb"  # the lens of tumvi, once more
        and not name.startswith("lens-")  # made up
        and min(map(widest_deg, (rb.load_rig(name).left, rb.load_rig(name).right))) >= 120
    )
    assert {"t265", "tumvi", "sony-as200v"} <= set(rb.fisheye_rigs())
    assert not {"bumblebee2", "perspective-shifted", "vi-sensor"} & set(rb.fisheye_rigs())
    assert set(rb.fisheye_rigs(least_fov_deg=190)) < set(rb.fisheye_rigs())
