"""A user's Mitsuba scene file serves as a world."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from small_worlds import fisheye

from rectbench.errors import InvalidInput
from rectbench.rendering.pair import render_pair
from rectbench.rendering.xml_world import xml_world
from rectbench.rigs.rig import Rig

RIG = Rig(fisheye(), fisheye(), np.eye(3), np.array([-0.2, 0.0, 0.0]))

SENSOR = """<sensor type="perspective"><transform name="to_world">
<lookat origin="1, 2, 3" target="1, 9, 3" up="0, 0, 1"/></transform></sensor>"""

WALL = """<shape type="rectangle">
<transform name="to_world">
<scale x="2" y="4"/><rotate x="1" angle="90"/><translate x="{x}" y="6" z="3"/>
</transform>
<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="{colour}"/></bsdf></bsdf>
</shape>"""

# A wall 4 m north of the camera; red east of it, green west of it.
SHAPES = (
    '<emitter type="constant"/>'
    + WALL.format(x=3, colour="0.8, 0.1, 0.1")
    + WALL.format(x=-1, colour="0.1, 0.8, 0.1")
)


def written(tmp_path: Path, content: str) -> Path:
    path = tmp_path / "scene.xml"
    path.write_text(content)
    return path


@pytest.mark.parametrize("quality", ["fast", "path"])
def test_the_rig_stands_at_the_scenes_sensor_with_east_to_its_right(tmp_path: Path, quality: str) -> None:
    world = xml_world(written(tmp_path, f'<scene version="3.0.0">{SENSOR}{SHAPES}</scene>'))
    np.testing.assert_allclose(world.world_from_left[:3, 3], [1, 2, 3])
    np.testing.assert_allclose(world.world_from_left[:3, :3], [[1, 0, 0], [0, 0, 1], [0, -1, 0]], atol=1e-6)
    pair, truth = render_pair(world, RIG, quality=quality, spp=16)
    u, v = np.round(RIG.left.project([[1.0, 0.0, 4.0], [-1.0, 0.0, 4.0]])[0]).astype(int).T
    assert pair.left[v[0], u[0], 0] > 2 * pair.left[v[0], u[0], 1]
    assert pair.left[v[1], u[1], 1] > 2 * pair.left[v[1], u[1], 0]
    np.testing.assert_allclose(truth.points_left[v, u][:, 2], 4.0, rtol=1e-5)


def test_a_pose_of_ones_own_takes_the_sensors_place(tmp_path: Path) -> None:
    path = written(tmp_path, f'<scene version="3.0.0">{SHAPES}</scene>')
    pose = np.array([[1, 0, 0, 1], [0, 0, 1, 4], [0, -1, 0, 3], [0, 0, 0, 1]], dtype=float)
    world = xml_world(path, pose, exposure=0.5)
    _, truth = render_pair(world, RIG, images=False)
    assert truth is not None
    u, v = np.round(RIG.left.project([0.5, 0.0, 2.0])[0]).astype(int)
    assert truth.points_left[v, u, 2] == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("<scene", "not a Mitsuba scene"),
        ('<scene version="3.0.0"><shape type="nonsense"/></scene>', "not a Mitsuba scene"),
        (f'<scene version="3.0.0">{SHAPES}</scene>', "the scene has no sensor"),
    ],
)
def test_a_file_that_cannot_serve_gets_one_line(tmp_path: Path, content: str, message: str) -> None:
    path = written(tmp_path, content)
    with pytest.raises(InvalidInput, match=message) as error:
        xml_world(path)
    assert "\n" not in str(error.value)
    assert str(path) in str(error.value)


def test_a_missing_file_and_a_bad_pose_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="no such scene file"):
        xml_world(tmp_path / "nothing.xml")
    path = written(tmp_path, f'<scene version="3.0.0">{SHAPES}</scene>')
    for pose in (np.eye(3), 2 * np.eye(4), np.full((4, 4), np.nan), np.diag([-1.0, 1, 1, 1])):
        with pytest.raises(InvalidInput, match="pose"):
            xml_world(path, pose)
    with pytest.raises(InvalidInput, match="exposure"):
        xml_world(path, np.eye(4), exposure=0.0)
