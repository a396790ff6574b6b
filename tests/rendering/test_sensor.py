"""The sensor sees what Camera.project says, for any lens."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.path import Path as MplPath
from scipy.ndimage import binary_dilation
from small_worlds import LOOK_NORTH, fisheye, quad, world_of

from rectbench.calibrations.reading import load_rig
from rectbench.cameras import Camera
from rectbench.rendering import sensor as sensors
from rectbench.rendering.images import radiance
from rectbench.rendering.mitsuba_scene import fast_scene
from rectbench.rendering.variant import mitsuba
from rectbench.rendering.world import Material
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

PINHOLE = Camera(
    "pinhole",
    (120, 80),
    {"fx": 70.0, "fy": 71.0, "cx": 58.3, "cy": 41.2, "k1": -0.12, "k2": 0.02, "p1": 1e-3},
)
CAMERAS = [fisheye(160, 120), PINHOLE]


def sampled_rays(camera: Camera, pixels: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Directions [N, 3] in our camera axes and weights [N] that the sensor gives at pixels [N, 2]."""
    sensor = sensors.load_sensor(camera, sensors.CV_FROM_MITSUBA)
    mi = mitsuba()
    position = mi.Point2f(*((pixels + 0.5) / camera.size).T.astype(np.float32))
    ray, weight = sensor.sample_ray_differential(mi.Float(0), mi.Float(0.5), position, mi.Point2f(0.5))
    return np.array(ray.d).T @ sensors.CV_FROM_MITSUBA[:3, :3], np.array(weight.x)


@pytest.mark.parametrize("camera", CAMERAS, ids=lambda camera: camera.model)
def test_rays_between_pixel_centres_are_those_of_the_camera(camera: Camera) -> None:
    pixels = np.random.default_rng(0).uniform(-0.5, np.array(camera.size) - 0.5, (4000, 2))
    rays, weight = sampled_rays(camera, pixels)
    projected, ok = camera.project(rays)
    expected, inside = camera.unproject(pixels)
    deep = inside & (np.arccos(expected[:, 2]) < np.radians(93))
    assert deep.sum() > 2000
    assert (weight[deep] == 1).all()
    # The coarser the image, the more a lens bends between two pixels: 0.01 px holds even at 120 px.
    assert np.abs(projected - pixels)[deep & ok].max() < 0.01


def test_interpolation_error_vanishes_with_resolution() -> None:
    camera = fisheye(1280, 960)
    pixels = np.random.default_rng(0).uniform(200, 800, (4000, 2))
    projected, _ = camera.project(sampled_rays(camera, pixels)[0])
    assert np.abs(projected - pixels).max() < 1e-3


def test_nothing_is_seen_outside_the_image_circle_and_everything_inside() -> None:
    camera = fisheye(160, 120)
    pixels = np.random.default_rng(1).uniform(-0.5, np.array(camera.size) - 0.5, (20000, 2))
    rays, weight = sampled_rays(camera, pixels)
    _, inside = camera.unproject(pixels)
    outward = (pixels - [camera.params["cx"], camera.params["cy"]]) * 0.01
    _, further_in = camera.unproject(pixels - outward)
    _, further_out = camera.unproject(pixels + outward)
    assert 0 < (~inside).sum() < len(inside)
    assert (weight[inside & further_out] == 1).all()
    assert (weight[~inside & ~further_in] == 0).all()
    np.testing.assert_allclose(np.linalg.norm(rays, axis=1), 1.0, atol=1e-6)


def test_both_sampling_routines_agree() -> None:
    mi = mitsuba()
    sensor = sensors.load_sensor(fisheye(), LOOK_NORTH)
    position = mi.Point2f(*np.random.default_rng(2).random((2, 500)).astype(np.float32))
    half = mi.Point2f(0.5)
    plain, plain_weight = sensor.sample_ray(mi.Float(0), mi.Float(0.5), position, half)
    with_differentials, weight = sensor.sample_ray_differential(mi.Float(0), mi.Float(0.5), position, half)
    np.testing.assert_array_equal(np.array(plain.d), np.array(with_differentials.d))
    np.testing.assert_array_equal(np.array(plain.maxt), np.array(with_differentials.maxt))
    np.testing.assert_array_equal(np.array(plain_weight), np.array(weight))
    np.testing.assert_allclose(np.array(plain.o).ravel(), [0, 0, 1.5])


@pytest.mark.parametrize("camera", CAMERAS, ids=lambda camera: camera.model)
@pytest.mark.parametrize("pixel", [(31.3, 22.8), (70.2, 44.4), (92.7, 65.1)])
def test_a_patch_is_imaged_where_the_camera_projects_its_outline(
    camera: Camera, pixel: tuple[float, float]
) -> None:
    ray = camera.unproject(pixel)[0]
    across = np.cross(ray, [0.1, 1.0, 0.2])
    across /= np.linalg.norm(across)
    sides = 0.06 * np.array([across, np.cross(ray, across)])
    corners = np.array([ray + i * sides[0] + j * sides[1] for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    world = world_of(quad("patch", corners @ LOOK_NORTH[:3, :3].T + LOOK_NORTH[:3, 3], Material((1, 1, 1))))
    sensor = sensors.load_sensor(camera, LOOK_NORTH)
    image = radiance(fast_scene(world), sensor, hit_or_miss(), spp=1024, seed=3)[..., 0]

    outline = projected_outline(camera, corners)
    expected = coverage(outline, image.shape)
    step = 0.1
    slopes = [
        (coverage(outline + shift, image.shape) - coverage(outline - shift, image.shape)) / (2 * step)
        for shift in ([step, 0.0], [0.0, step])
    ]
    offset = np.linalg.lstsq(
        np.stack(slopes, axis=-1).reshape(-1, 2), (image - expected).ravel(), rcond=None
    )[0]
    assert np.abs(offset).max() < 0.01
    assert np.abs(image - expected).max() < 0.02


def projected_outline(camera: Camera, corners: FloatArray) -> FloatArray:
    """The image [N, 2] of a polygon's outline, which a lens bends."""
    steps = np.linspace(0, 1, 50, endpoint=False)[:, None]
    sides = [a + (b - a) * steps for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    pixels, ok = camera.project(np.concatenate(sides))
    assert ok.all()
    return pixels


def coverage(outline: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """Share of each pixel [H, W] inside an outline [N, 2]."""
    parts = 32
    share = np.zeros(shape)
    u0, v0 = np.floor(outline.min(axis=0) + 0.5).astype(int)
    u1, v1 = np.ceil(outline.max(axis=0) + 0.5).astype(int)
    within = (np.arange((v1 - v0) * parts) + 0.5) / parts, (np.arange((u1 - u0) * parts) + 0.5) / parts
    v, u = np.meshgrid(within[0] + v0 - 0.5, within[1] + u0 - 0.5, indexing="ij")
    inside = MplPath(outline).contains_points(np.stack([u, v], axis=-1).reshape(-1, 2))
    share[v0:v1, u0:u1] = inside.reshape(v1 - v0, parts, u1 - u0, parts).mean(axis=(1, 3))
    return share


def hit_or_miss() -> object:
    """An integrator that is 1 on surfaces and 0 elsewhere."""
    mi = mitsuba()
    import drjit as dr

    class HitOrMiss(mi.SamplingIntegrator):  # type: ignore[misc]
        def sample(self, scene, sampler, ray, medium=None, active=True):  # type: ignore[no-untyped-def]
            hit = scene.ray_test(ray)
            return dr.select(hit, mi.Color3f(1), 0), hit, []

    return HitOrMiss(mi.Properties())


def scene_xml(sensor: str, width: int, height: int) -> str:
    return f"""<scene version="3.0.0">
      <sensor type="rectbench_camera">
        {sensor}
        <transform name="to_world"><lookat origin="1, 2, 3" target="1, 8, 3" up="0, 0, 1"/></transform>
        <film type="hdrfilm">
          <integer name="width" value="{width}"/><integer name="height" value="{height}"/>
          <rfilter type="box"/>
        </film>
      </sensor>
      <emitter type="constant"/>
      <integrator type="direct"/>
    </scene>"""


def test_a_scene_file_uses_the_sensor_with_a_rig_file_beside_it(rig: Rig, tmp_path: Path) -> None:
    rig.save(tmp_path / "rig.yaml")
    sensor = '<string name="camera" value="rig.yaml"/><string name="side" value="right"/>'
    (tmp_path / "scene.xml").write_text(scene_xml(sensor, *rig.right.size))
    mi = sensors.register()
    scene = mi.load_file(str(tmp_path / "scene.xml"))
    loaded = scene.sensors()[0]
    assert loaded.camera == rig.right
    image = np.array(mi.render(scene, spp=64))
    _, ok = rig.right.unproject(rig.right.pixel_grid())
    assert image.shape[:2] == ok.shape
    assert (image[ok].mean(axis=-1) > 0.3).all()
    assert (image[~ok].mean(axis=-1) < 0.7).all()
    ray, _ = loaded.sample_ray(mi.Float(0), mi.Float(0), mi.Point2f(0.5), mi.Point2f(0.5))
    np.testing.assert_allclose(np.array(ray.o).ravel(), [1, 2, 3])
    assert np.array(ray.d).ravel()[1] > 0.99


def test_a_scene_file_names_a_built_in_rig(tmp_path: Path) -> None:
    rig = load_rig("t265")
    (tmp_path / "scene.xml").write_text(scene_xml('<string name="rig" value="t265"/>', *rig.left.size))
    scene = sensors.register().load_file(str(tmp_path / "scene.xml"))
    assert scene.sensors()[0].camera == rig.left


@pytest.mark.parametrize(
    ("sensor", "size", "message"),
    [
        ("", (96, 72), "expected one of the strings"),
        ('<string name="camera" value="rig.yaml"/>', (96, 64), "the film is 96x64; expected 96x72"),
        (
            '<string name="camera" value="rig.yaml"/><string name="side" value="up"/>',
            (96, 72),
            "side is 'up'",
        ),
    ],
)
def test_a_wrong_sensor_says_what_it_expects(
    rig: Rig, tmp_path: Path, sensor: str, size: tuple[int, int], message: str
) -> None:
    rig.save(tmp_path / "rig.yaml")
    (tmp_path / "scene.xml").write_text(scene_xml(sensor, *size))
    with pytest.raises(Exception, match=message):
        sensors.register().load_file(str(tmp_path / "scene.xml"))


def test_a_film_of_the_same_shape_scales_the_lens(rig: Rig, tmp_path: Path) -> None:
    rig.save(tmp_path / "rig.yaml")
    (tmp_path / "scene.xml").write_text(
        scene_xml('<string name="camera" value="rig.yaml"/>', 2 * rig.left.width, 2 * rig.left.height)
    )
    scene = sensors.register().load_file(str(tmp_path / "scene.xml"))
    assert scene.sensors()[0].camera == rig.left.scaled(2)


def test_extrapolation_across_the_circle_continues_the_lens() -> None:
    camera = fisheye(160, 120)
    unbounded = Camera(camera.model, camera.size, dict(camera.params))
    table, full = sensors.ray_table(camera), sensors.ray_table(unbounded)
    beside = binary_dilation(table[..., 3] > 0, np.ones((3, 3)))
    extrapolated = (table[..., 3] == 0) & beside
    assert extrapolated.sum() > 50
    assert np.isfinite(table).all()
    assert np.abs(table - full)[extrapolated][:, :3].max() < 2e-3
