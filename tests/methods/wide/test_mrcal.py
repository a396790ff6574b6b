"""mrcal-latlon and mrcal-pinhole: mrcal's own systems where it is installed, and what it promises of them."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rectbench as rb
from tests.rigs_for_tests import rig

SYSTEM_PYTHON = Path("/usr/bin/python3")
METHODS = {"mrcal-latlon": "LENSMODEL_LATLON", "mrcal-pinhole": "LENSMODEL_PINHOLE"}


def has_mrcal() -> bool:
    if not SYSTEM_PYTHON.exists():
        return False
    asked = subprocess.run([SYSTEM_PYTHON, "-c", "import mrcal"], capture_output=True)
    return asked.returncode == 0


def toed_in(model: str, params: dict[str, float]) -> rb.Rig:
    """Two cameras that look a little apart, the second one before the first."""
    lens = rb.Camera(model, (480, 320), params)
    R = Rotation.from_rotvec([0.03, -0.08, 0.02]).as_matrix()
    return rb.Rig(lens, lens, R, -R @ np.array([0.2, 0.01, 0.04]))


RIGS = {
    "LENSMODEL_OPENCV4": toed_in(
        "pinhole",
        {"fx": 330, "fy": 332, "cx": 235, "cy": 162, "k1": -0.2, "k2": 0.04, "p1": 1e-3, "p2": -5e-4},
    ),
    "LENSMODEL_STEREOGRAPHIC": toed_in("stereographic", {"fx": 170, "fy": 171, "cx": 236, "cy": 161}),
}
COEFFICIENTS = {"LENSMODEL_OPENCV4": ("k1", "k2", "p1", "p2"), "LENSMODEL_STEREOGRAPHIC": ()}


@pytest.mark.skipif(
    not has_mrcal(), reason="compares with Debian's mrcal, which is not installed: apt install python3-mrcal"
)
@pytest.mark.parametrize("lens", RIGS)
@pytest.mark.parametrize("method", METHODS)
def test_its_tables_are_those_of_mrcal(method: str, lens: str) -> None:
    pair = RIGS[lens]
    options = {"az_fov_deg": 95.0, "el_fov_deg": 70.0, "pixels_per_deg": 0.7}
    rect = rb.rectify(pair, method, **options)
    names = ("fx", "fy", "cx", "cy", *COEFFICIENTS[lens])
    asked = options | {
        "lens": lens,
        "rectification": METHODS[method],
        "size": pair.left.size,
        "intrinsics": [[camera.params[name] for name in names] for camera in (pair.left, pair.right)],
        "Rt_cam_left": [
            np.vstack([np.eye(3), np.zeros(3)]).tolist(),
            np.vstack([pair.R_right_left, pair.t_right_left]).tolist(),
        ],
        "every": 7,
    }
    script = Path(__file__).with_name("mrcal_oracle.py")
    said = subprocess.run(
        [SYSTEM_PYTHON, script], input=json.dumps(asked), capture_output=True, text=True, check=True
    )
    theirs = json.loads(said.stdout)
    assert rect.size == tuple(theirs["size"])
    for side, table in zip(("left", "right"), theirs["maps"], strict=True):
        ours = np.stack(rect.maps(side), axis=-1)[::7, ::7]
        seen = rect.valid(side)[::7, ::7]
        assert seen.mean() > 0.3
        np.testing.assert_allclose(ours[seen], np.array(table)[seen], atol=1e-3)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("lens", RIGS)
def test_its_middle_looks_where_the_cameras_look_at_the_first_ones_resolution(method: str, lens: str) -> None:
    pair = RIGS[lens]
    rect = rb.rectify(pair, method, az_fov_deg=80.0, el_fov_deg=60.0)
    middle = (np.array(rect.size) - 1) / 2
    right = pair.centre_right_in_left / pair.baseline_m
    forward = np.array([0, 0, 1]) + pair.R_right_left.T[:, 2]
    ray = rect.left.target.unproject(middle)[0] @ rect.R_rect_left
    assert ray @ right == pytest.approx(forward @ right / np.linalg.norm(forward), abs=1e-2)
    assert np.cross(right, forward) @ ray == pytest.approx(0, abs=1e-2)  # elevation 0
    steps = [rect.left.inverse(middle + step) - rect.left.inverse(middle - step) for step in 0.5 * np.eye(2)]
    np.testing.assert_allclose(np.linalg.norm(steps, axis=1), 1.0, rtol=0.02)


@pytest.mark.parametrize("method", METHODS)
def test_its_outer_rays_span_the_field_of_view(method: str) -> None:
    rect = rb.rectify(RIGS["LENSMODEL_STEREOGRAPHIC"], method, az_fov_deg=100.0, el_fov_deg=60.0)
    middle = (np.array(rect.size) - 1) / 2
    outer = 0.5 if method == "mrcal-latlon" else 0.0  # latlon counts whole pixels, pinhole their middles
    row = rect.left.target.project([0.0, 0.0, 1.0])[0][1]
    ends = [[-outer, row], [rect.size[0] - 1 + outer, row]]
    first, last = rect.left.target.unproject(ends)[0]
    assert np.degrees(np.arccos(first @ last)) == pytest.approx(100.0, abs=0.3)
    assert np.isfinite(rect.left.target.unproject(middle)[0]).all()


@pytest.mark.parametrize("method", METHODS)
def test_without_a_stated_field_of_view_it_takes_what_both_lenses_see(method: str) -> None:
    pair = rig("double-sphere", fov_deg=80.0, size=(400, 300))
    coverage = rb.metrics.coverage(rb.rectify(pair, method), pair)
    assert coverage["coverage_pixels"] > 0.999


@pytest.mark.parametrize("method", METHODS)
def test_a_first_camera_that_does_not_see_the_middle_tells_no_resolution(method: str) -> None:
    params = {"fx": 120, "fy": 120, "cx": 150, "cy": 150}
    narrow, wide = (rb.Camera("equidistant", (400, 300), params, angle) for angle in (30.0, 89.0))
    apart = Rotation.from_rotvec([0.0, -np.radians(80), 0.0]).as_matrix()
    pair = rb.Rig(narrow, wide, apart, -apart @ np.array([0.0, 0.2, 0.0]))
    with pytest.raises(rb.Unsupported, match="does not see the middle"):
        rb.rectify(pair, method)


@pytest.mark.parametrize("method", METHODS)
def test_cameras_in_a_row_have_no_frame(method: str) -> None:
    lens = rig().left
    with pytest.raises(rb.Unsupported, match=r"look 0\.0° off the baseline"):
        rb.rectify(rb.Rig(lens, lens, np.eye(3), np.array([0, 0, -0.2])), method)
