"""Pairs of images: light, noise, repeatability, and what is refused."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from small_worlds import LOOK_NORTH, facing_wall, fisheye, quad, world_of

from rectbench.errors import InvalidInput, InvalidResult, UnknownName
from rectbench.images.stereo_pair import StereoPair
from rectbench.plugins.scene import Scene, scene
from rectbench.rendering.images import radiance, srgb8
from rectbench.rendering.integrator import fast_integrator
from rectbench.rendering.mitsuba_scene import fast_scene, path_scene
from rectbench.rendering.pair import Stage, render_pair
from rectbench.rendering.sensor import load_sensor
from rectbench.rendering.variant import mitsuba
from rectbench.rendering.world import Instances, Lamp, Material, Mesh, Sun, World
from rectbench.rigs.rig import Rig

GREY = Material((0.5, 0.5, 0.5))


def fast_radiance(world: World, spp: int = 64) -> Any:
    return radiance(
        fast_scene(world), load_sensor(fisheye(), LOOK_NORTH), fast_integrator(world), spp=spp, seed=0
    )


def path_radiance(world: World, spp: int = 64) -> Any:
    path = mitsuba().load_dict({"type": "path", "max_depth": 8})
    return radiance(path_scene(world), load_sensor(fisheye(), LOOK_NORTH), path, spp=spp, seed=0)


def pixel(x: float, y: float, z: float) -> tuple[int, int]:
    """Row and column of a point given in camera axes."""
    u, v = fisheye().project([x, y, z])[0]
    return round(v), round(u)


def mean_at(image: Any, *point: float) -> float:
    row, column = pixel(*point)
    return float(image[row - 1 : row + 2, column - 1 : column + 2].mean())


@pytest.mark.parametrize("quality", ["fast", "path"])
def test_a_pair_has_the_cameras_sizes_and_the_right_view_is_the_rigs(
    yard: World, rig: Rig, quality: str
) -> None:
    pair, truth = render_pair(yard, rig, quality=quality, spp=16)
    pair.check(rig)
    left, right = truth.matches(2000)
    ul, vl = left.astype(int).T
    ur, vr = np.round(right).astype(int).T
    a = pair.left[vl, ul].astype(float).ravel()
    b = pair.right[vr, ur].astype(float).ravel()
    assert np.corrcoef(a, b)[0, 1] > 0.7


@pytest.mark.parametrize("quality", ["fast", "path"])
def test_same_seed_same_bytes_another_seed_other_noise(yard: World, rig: Rig, quality: str) -> None:
    first, second, other = (
        render_pair(yard, rig, seed=seed, quality=quality, spp=4, truth=False)[0] for seed in (3, 3, 4)
    )
    assert first is not None
    assert second is not None
    assert other is not None
    np.testing.assert_array_equal(first.left, second.left)
    np.testing.assert_array_equal(first.right, second.right)
    assert (first.left != other.left).any()


@pytest.mark.parametrize("spp", [1, 2, 8, 32, 128])
def test_any_power_of_two_gives_the_same_picture(yard: World, spp: int) -> None:
    image, reference = fast_radiance(yard, spp), fast_radiance(yard, 256)
    assert image.mean() == pytest.approx(reference.mean(), rel=0.02)


def test_the_two_images_have_noise_of_their_own(yard: World) -> None:
    camera = fisheye()
    still = Rig(camera, camera, np.eye(3), np.array([1e-9, 0, 0]))
    pair, _ = render_pair(yard, still, quality="fast", spp=1, truth=False)
    assert pair is not None
    assert (pair.left != pair.right).any(axis=-1).mean() > 0.1


BYTES = """
import hashlib, sys
sys.path[:0] = {path!r}
import drjit
from small_worlds import fisheye, facing_wall, world_of
from rectbench.rendering.variant import mitsuba
mitsuba()
drjit.set_thread_count({threads})
import numpy as np
from rectbench.rendering.pair import Stage, render_pair
from rectbench.rendering.world import Material, Sun
from rectbench.rigs.rig import Rig
texels = np.random.default_rng(0).random((32, 32, 3)).astype(np.float32)
world = world_of(facing_wall(4.0, 3.0, Material(texels)), sun=Sun())
rig = Rig(fisheye(), fisheye(), np.eye(3), np.array([-0.2, 0, 0]))
pair, truth = render_pair(world, rig, quality="path", spp=16)
data = pair.left.tobytes() + pair.right.tobytes() + truth.depth_left.tobytes() + truth.visible_right.tobytes()
print(hashlib.sha256(data).hexdigest())
"""


def test_another_process_with_other_threads_gives_identical_bytes() -> None:
    digests = set()
    for threads in (1, 2):
        code = BYTES.format(path=[str(Path(__file__).parent), *sys.path], threads=threads)
        run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        digests.add(run.stdout.split()[-1])
    assert len(digests) == 1


def test_the_sun_casts_a_hard_shadow_and_the_sky_fills_it() -> None:
    ground = quad("ground", [[-50, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]], GREY)
    post = facing_wall(4.0, 0.6, GREY, z=0.6)
    image = fast_radiance(world_of(ground, post, sun=Sun(direction=(0.0, 1.0, 1.0))))
    # The sun stands in the north: the shadow falls towards the camera, 1.2 m long.
    shade, lit = mean_at(image, 0, 1.5, 3.6), mean_at(image, 0, 1.5, 1.8)
    assert 0.03 < shade < 0.5 * lit


def test_the_fast_lamps_agree_with_path_tracing() -> None:
    ground = quad("ground", [[-20, -20, 0], [20, -20, 0], [20, 20, 0], [-20, 20, 0]], GREY)
    lamps = (Lamp((0, 3, 3), (1, 0.5), (9, 9, 9)), Lamp((2.5, 3, 3), (0.5, 0.5), (9, 4, 4)))
    # On an open plane nothing returns light, so direct light is all that a path finds.
    world = world_of(ground, lamps=lamps)
    image = fast_radiance(world, spp=256)
    reference = path_radiance(world, spp=256)
    for x, z in ((0, 3), (2.5, 3), (-2, 4), (1.2, 2)):
        assert mean_at(image, x, 1.5, z) == pytest.approx(mean_at(reference, x, 1.5, z), rel=0.06)
    assert image.max() == pytest.approx(9.0, rel=0.01)
    assert reference.max() == pytest.approx(9.0, rel=0.01)


def test_a_mesh_behind_the_camera_still_shades_nothing_black(yard: World) -> None:
    image = srgb8(fast_radiance(yard))
    _, ok = fisheye().unproject(fisheye().pixel_grid())
    grey = image[ok].mean(axis=-1)
    assert (grey < 12).mean() < 0.02
    assert (grey > 250).mean() < 0.1
    assert (image[~ok].mean(axis=-1) < 200).all()


def test_instances_stand_where_their_placements_say() -> None:
    unit = quad("unit", [[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]], GREY)
    places = np.tile(np.eye(4), (2, 1, 1))
    places[0, :3, 3], places[1, :3, 3] = (-1, 4, 1.5), (1, 4, 1.5)
    world = World((), LOOK_NORTH, instances=(Instances("pair", (unit,), places),), sun=Sun())
    _, truth = render_pair(world, Rig(fisheye(), fisheye(), np.eye(3), np.array([-0.1, 0, 0])), images=False)
    assert truth is not None
    for x, expected in ((-1.0, True), (0.0, False), (1.0, True)):
        assert np.isfinite(truth.depth_left[pixel(x, 0, 4)]) == expected


def test_meshes_of_one_material_share_one_texture(checks: Material) -> None:
    scene_ = path_scene(
        world_of(facing_wall(3, 1, checks), facing_wall(5, 1, checks), facing_wall(7, 1, GREY))
    )
    assert len({shape.bsdf().ptr for shape in scene_.shapes()}) == 2


def test_srgb_follows_the_standard() -> None:
    linear = np.array([0.0, 0.0031308, 0.0005, 0.18, 0.5, 1.0, 7.0, -1.0])
    assert srgb8(linear).tolist() == [0, 10, 2, 118, 188, 255, 255, 0]
    assert srgb8(np.array([0.25]), exposure=2.0).tolist() == [188]


def test_images_larger_than_one_pass_have_the_same_brightness(
    yard: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = fast_radiance(yard, spp=16)
    monkeypatch.setattr("rectbench.rendering.images.SAMPLES_AT_ONCE", 96 * 16 * 10)
    banded = fast_radiance(yard, spp=16)
    assert banded.mean() == pytest.approx(whole.mean(), rel=0.01)
    assert np.corrcoef(banded.ravel(), whole.ravel())[0, 1] > 0.98


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"spp": 0}, "power of two"),
        ({"spp": 48}, "power of two"),
        ({"spp": 2.0}, "power of two"),
        ({"seed": -1}, "whole number from 0"),
        ({"seed": 0.5}, "whole number from 0"),
    ],
)
def test_bad_arguments_are_refused(yard: World, rig: Rig, arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        render_pair(yard, rig, **arguments)


def test_things_of_the_wrong_type_are_refused(yard: World, rig: Rig) -> None:
    with pytest.raises(InvalidInput, match="expected a Rig"):
        render_pair(yard, rig.left)  # type: ignore[call-overload]
    with pytest.raises(InvalidInput, match="expected a World"):
        render_pair("street", rig)  # type: ignore[call-overload]
    with pytest.raises(UnknownName, match="did you mean path"):
        render_pair(yard, rig, quality="paht")


def broken(**changes: Any) -> Mesh:
    fields = {
        "name": "odd",
        "vertices": np.eye(3),
        "faces": np.array([[0, 1, 2]]),
        "uv": np.zeros((3, 2)),
        "material": GREY,
    }
    return Mesh(**{**fields, **changes})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (broken(vertices=np.full((3, 3), np.nan)), "mesh odd: vertices"),
        (broken(faces=np.array([[0, 1, 3]])), "outside 0..2"),
        (broken(faces=np.array([[0.0, 1.0, 2.0]])), "expected integers"),
        (broken(uv=np.zeros((2, 2))), "mesh odd: uv"),
        (broken(material=Material(np.zeros((4, 4), np.float32))), "reflectance has shape"),
        (broken(material=Material((1.5, 0.2, 0.2))), r"leaves \[0, 1\]"),
    ],
)
def test_a_broken_mesh_is_named_before_it_crashes_the_renderer(mesh: Mesh, message: str) -> None:
    with pytest.raises(InvalidResult, match=message):
        fast_scene(world_of(mesh))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"world_from_left": np.eye(3)}, "world_from_left has shape"),
        ({"world_from_left": 2 * np.eye(4)}, "world_from_left has a last row"),
        ({"world_from_left": np.diag([1.0, 1, -1, 1])}, "world_from_left stretches or mirrors"),
        ({"exposure": 0.0}, "exposure is 0.0"),
        ({"sun": Sun(direction=(0, 0, 0))}, "the sun's direction"),
        ({"lamps": (Lamp((0, 0, 2), (0.0, 1.0), (1, 1, 1)),)}, "the lamp at"),
        ({"lamps": (Lamp((0, 0, 2), (1.0, 1.0), (1, float("nan"), 1)),)}, "the lamp at"),
        ({"ambient": (-1.0, 0, 0)}, "ambient is"),
        ({"meshes": ()}, "the world is empty"),
    ],
)
def test_a_broken_world_is_refused(yard: World, rig: Rig, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidResult, match=message):
        render_pair(replace(yard, **changes), rig)


def test_one_stage_serves_many_rigs_as_one_pair_each_would(yard: World, rig: Rig) -> None:
    stage = Stage.of(yard, "fast")
    for chosen in (rig, rig.scaled(0.5)):
        pair, truth = render_pair(yard, chosen, quality="fast", spp=4, seed=2)
        again = stage.photograph(chosen, seed=2, spp=4)
        np.testing.assert_array_equal(again.right, pair.right)
        np.testing.assert_array_equal(stage.survey(chosen).depth_left, truth.depth_left)


def test_pairs_are_saved_and_read_back(rig: Rig, tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    left, right = (
        rng.integers(0, 256, (c.height, c.width, 3)).astype(np.uint8) for c in (rig.left, rig.right)
    )
    StereoPair(left, right).save(tmp_path / "pair")
    loaded = StereoPair.load(tmp_path / "pair", rig)
    np.testing.assert_array_equal(loaded.left, left)
    np.testing.assert_array_equal(loaded.right, right)


def test_images_that_are_not_the_cameras_are_refused(rig: Rig, tmp_path: Path) -> None:
    small = np.zeros((10, 20, 3), np.uint8)
    cv2.imwrite(str(tmp_path / "left.png"), small)
    cv2.imwrite(str(tmp_path / "right.png"), small)
    with pytest.raises(InvalidInput, match="left image is 20x10 px; expected 96x72"):
        StereoPair.load(tmp_path, rig)
    (tmp_path / "right.png").write_text("no image")
    with pytest.raises(InvalidInput, match=r"right.png: not an image"):
        StereoPair.load(tmp_path)
    with pytest.raises(InvalidInput, match="no such image"):
        StereoPair.load(tmp_path / "nowhere")
    with pytest.raises(InvalidInput, match="expected uint8"):
        StereoPair(small.astype(float), small)  # type: ignore[arg-type]


def test_a_scene_is_a_named_builder() -> None:
    @scene("plain")
    def plain(seed: int) -> World:
        """A wall.

        And more prose.
        """
        return world_of(facing_wall(3.0, 1.0, GREY))

    assert isinstance(plain, Scene)
    assert (plain.name, plain.summary) == ("plain", "A wall.")
    assert isinstance(plain.build(0), World)


def test_a_scene_that_builds_no_world_is_refused() -> None:
    @scene("odd")
    def odd(seed: int) -> World:
        """Odd."""
        return None  # type: ignore[return-value]

    with pytest.raises(InvalidResult, match="scene odd returned NoneType"):
        odd.build(0)
    with pytest.raises(InvalidInput, match="no docstring"):
        scene("mute")(lambda seed: world_of())
