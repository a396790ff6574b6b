"""psph: JPL's construction of a pixel's ray, by two planes that are turned about their axes."""

import numpy as np
from scipy.spatial.transform import Rotation

import rectbench as rb
from tests.rigs_for_tests import aligned_rig


def test_a_pixels_ray_is_where_its_two_planes_meet() -> None:
    focal = 150.0
    rect = rb.rectify(aligned_rig(480, 320, 150), "psph", focal_px=focal)
    middle = rect.left.target.project([0, 0, 1])[0]
    offsets = np.array([[0.0, 0.0], [80.0, 30.0], [-120.0, 100.0], [150.0, -90.0]])
    rays, ok = rect.left.target.unproject(middle + offsets)
    assert ok.all()
    for (across, down), ray in zip(offsets, rays, strict=True):
        column = Rotation.from_rotvec([0, across / focal, 0]).apply([1, 0, 0])  # the plane's normal
        row = Rotation.from_rotvec([-down / focal, 0, 0]).apply([0, 1, 0])
        meeting = np.cross(column, row)
        np.testing.assert_allclose(ray, meeting / np.linalg.norm(meeting), atol=1e-12)


def test_what_lies_towards_90_degrees_is_masked() -> None:
    wide = aligned_rig(400, 400, 190, max_angle_deg=95)
    target = rb.rectify(wide, "psph").left.target
    degrees = np.radians([80.0, 84.9, 85.1, 89.0, 95.0])
    flat = np.zeros(5)
    up = np.stack([flat, np.sin(degrees), np.cos(degrees)], axis=-1)
    aside = np.stack([np.sin(degrees), flat, np.cos(degrees)], axis=-1)
    for rays in (up, aside):
        assert target.project(rays)[1].tolist() == [True, True, False, False, False]
