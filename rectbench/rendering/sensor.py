"""The Mitsuba sensor that sees through any Camera.

The lens does not run inside the render kernel: the Camera computes the direction of every pixel
once, in float64, and the sensor interpolates that table (at most 1e-3 px off). So every projection
model costs the same, and a new lens needs no new kernel.
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rendering.variant import drjit, mitsuba

PLUGIN = "rectbench_camera"

CV_FROM_MITSUBA = np.diag([-1.0, -1.0, 1.0, 1.0])
"""Camera axes: ours are x right, y down; Mitsuba's x left, y up; both look along +z. Its own inverse."""

LEAST_TEXELS = 1024
"""Texels along the image's longer side. One a pixel is enough from there on; the pixels of a smaller
image are further apart in angle, and the error of interpolation grows with the square of that."""

ROWS_AT_ONCE = 256
"""Rows unprojected together: bounds the float64 scratch space of a large image."""


def texels_per_pixel(camera: Camera) -> int:
    """Density of the camera's ray table."""
    return math.ceil(LEAST_TEXELS / max(camera.size))


def ray_table(camera: Camera) -> NDArray[np.float32]:
    """Directions and validity [(H + 1) k + 1, (W + 1) k + 1, 4], k texels a pixel.

    The first texel lies at pixel (-1, -1) and the last at (W, H), so that the outer half pixels are
    interpolated too. Channels 0 to 2 are the unit ray in Mitsuba's camera axes, channel 3 is 1
    where the lens sees and 0 elsewhere. Texels next to the image circle carry a direction
    extrapolated from inside: interpolation across the edge stays exact to first order, and the edge
    itself falls where the interpolated validity is one half.
    """
    k = texels_per_pixel(camera)
    width, height = (camera.width + 1) * k + 1, (camera.height + 1) * k + 1
    table = np.zeros((height, width, 4), dtype=np.float32)
    u = np.arange(width) / k - 1.0
    for top in range(0, height, ROWS_AT_ONCE):
        v = np.arange(top, min(top + ROWS_AT_ONCE, height)) / k - 1.0
        rays, ok = camera.unproject(np.stack(np.meshgrid(u, v), axis=-1))
        rows = table[top : top + len(v)]
        # Even where nothing is seen a ray has a direction: NaN times a weight of 0 would be NaN.
        rows[..., :3] = np.where(ok[..., None], rays, (0.0, 0.0, 1.0)) * np.diag(CV_FROM_MITSUBA)[:3]
        rows[..., 3] = ok
    _extrapolate(table)
    return table


def _extrapolate(table: NDArray[np.float32]) -> None:
    """Fill the invalid texels that touch a valid one: the mean of 2a - b over the eight directions."""
    ok = table[..., 3] > 0
    if ok.all():
        return
    near = np.pad(ok, 2)
    touching = np.zeros_like(ok)
    offsets = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
    for i, j in offsets:
        touching |= near[2 + i : 2 + i + ok.shape[0], 2 + j : 2 + j + ok.shape[1]]
    rows, columns = np.nonzero(touching & ~ok)
    rays = np.pad(table, ((2, 2), (2, 2), (0, 0)))
    total = np.zeros((len(rows), 3))
    for i, j in offsets:
        a = rays[rows + 2 + i, columns + 2 + j]
        b = rays[rows + 2 + 2 * i, columns + 2 + 2 * j]
        # A lone valid neighbour still gives a direction: its own, extrapolated by nothing.
        b = np.where(b[:, 3:] > 0, b, a)
        total += np.where(a[:, 3:] > 0, 2.0 * a - b, 0.0)[:, :3]
    length = np.linalg.norm(total, axis=-1, keepdims=True)
    table[rows, columns, :3] = total / np.maximum(length, 1e-12)


def load_sensor(camera: Camera, world_from_camera: NDArray[np.float64]) -> Any:
    """The sensor of a Camera at a pose [4, 4] (axes x right, y down, z forward), with a film of its size."""
    mi = register()
    return mi.load_dict(
        {
            "type": PLUGIN,
            "lens": _camera_object_class(mi.variant())(camera),
            "to_world": mi.ScalarTransform4f(world_from_camera @ CV_FROM_MITSUBA),
            "film": {
                "type": "hdrfilm",
                "width": camera.width,
                "height": camera.height,
                "rfilter": {"type": "box"},
                "pixel_format": "rgb",
                "component_format": "float32",
            },
        },
        parallel=False,
        optimize=False,
    )


def register() -> Any:
    """Make `rectbench_camera` known to Mitsuba (for .xml scenes too); returns the module `mitsuba`."""
    mi = mitsuba()
    _register(mi.variant())
    return mi


@cache
def _register(variant: str) -> None:
    mi = mitsuba()
    sensor = _sensor_class(variant)
    mi.register_sensor(PLUGIN, lambda properties: sensor(properties))


@cache
def _camera_object_class(variant: str) -> Any:
    """A Camera as an object of Mitsuba's, as its Properties hold no others."""
    mi = mitsuba()
    base: Any = mi.Object

    class CameraObject(base):  # type: ignore[misc]
        def __init__(self, camera: Camera) -> None:
            super().__init__()
            self.camera = camera

    return CameraObject


@cache
def _sensor_class(variant: str) -> Any:
    """The plugin's class; Mitsuba's base classes differ from variant to variant."""
    mi, dr = mitsuba(), drjit()
    base: Any = mi.Sensor

    class CameraSensor(base):  # type: ignore[misc]
        """A camera of any projection model, for scene files once `register` has run.

        ============  ==========  =================================================================
        Parameter     Type        Meaning
        ============  ==========  =================================================================
        ``rig``       string      Name of a built-in rig (``t265``); or
        ``camera``    string      path of a rig file (native, Kalibr or OpenCV), found from the
                                  scene's own folder.
        ``side``      string      ``left`` (default) or ``right`` camera of that rig.
        ``to_world``  transform   Pose in Mitsuba's axes: looks along +z, x to the left, y up. A
                                  scale in it is ignored.
        (film)        film        As large as the camera's image, or the same shape at another
                                  resolution (the lens is scaled with it).
        ============  ==========  =================================================================

        A sample outside the image circle has weight 0 and a ray of length 0.
        """

        def __init__(self, properties: Any) -> None:
            super().__init__(properties)
            camera = _camera_of(properties)
            size = self.film().size()
            self.camera = _fitted(camera, (int(size[0]), int(size[1])))
            table = ray_table(self.camera)
            self.table = mi.Texture2f(
                mi.TensorXf(table),
                use_accel=False,  # CUDA's texture units round the position to 1/256 texel
                filter_mode=dr.FilterMode.Linear,
                wrap_mode=dr.WrapMode.Clamp,
            )
            rows, columns = table.shape[:2]
            crop, offset = self.film().crop_size(), self.film().crop_offset()
            # Film position (0.5, 0.5) is the centre of pixel 0, which is the centre of texel k.
            k = texels_per_pixel(self.camera)
            self.scale = mi.Vector2f(k * float(crop[0]) / columns, k * float(crop[1]) / rows)
            self.shift = mi.Vector2f(
                (k * (float(offset[0]) + 0.5) + 0.5) / columns, (k * (float(offset[1]) + 0.5) + 0.5) / rows
            )
            pose = np.array(properties.get("to_world", mi.ScalarTransform4f()).matrix, dtype=np.float64)
            rotation = pose[:3, :3] / np.linalg.norm(pose[:3, :3], axis=0)
            self.rotation = mi.Matrix3f(rotation)
            self.origin = mi.Point3f(pose[:3, 3])
            # As literals these would be baked into the kernel: every rig and pose would compile anew.
            dr.make_opaque(self.scale, self.shift, self.rotation, self.origin)
            self.m_needs_sample_2 = True
            self.m_needs_sample_3 = False

        def sample_ray(
            self, time: Any, sample1: Any, sample2: Any, sample3: Any, active: Any = True
        ) -> tuple[Any, Any]:
            return self._aimed(mi.Ray3f, sample2, time, active)

        def sample_ray_differential(
            self, time: Any, sample1: Any, sample2: Any, sample3: Any, active: Any = True
        ) -> tuple[Any, Any]:
            # The base class would find differentials from two more samples; nothing here uses them.
            ray, weight = self._aimed(mi.RayDifferential3f, sample2, time, active)
            ray.has_differentials = False
            return ray, weight

        def _aimed(self, kind: Any, position: Any, time: Any, active: Any) -> tuple[Any, Any]:
            """The ray of a film position and its weight, 0 where the lens sees nothing."""
            x, y, z, seen = self.table.eval(dr.fma(position, self.scale, self.shift), active)
            inside = seen >= 0.5
            ray = dr.zeros(kind)
            ray.o = mi.Point3f(self.origin)
            ray.d = self.rotation @ dr.normalize(mi.Vector3f(x, y, z))
            ray.time = time
            ray.maxt = dr.select(inside, dr.largest(mi.Float), 0.0)
            return ray, mi.Color3f(dr.select(inside, 1.0, 0.0))

        def bbox(self) -> Any:
            return mi.ScalarBoundingBox3f()

        def to_string(self) -> str:
            return f"CameraSensor[{self.camera.model} {self.camera.width}x{self.camera.height}]"

    return CameraSensor


def _camera_of(properties: Any) -> Camera:
    """The camera that a plugin's properties name."""
    if "lens" in properties:
        camera: Camera = properties["lens"].camera
        return camera
    mi = mitsuba()

    from rectbench.calibrations.reading import load_rig

    side = str(properties.get("side", "left"))
    if side not in ("left", "right"):
        raise InvalidInput(f"{PLUGIN}: side is '{side}'; expected left or right")
    if ("rig" in properties) == ("camera" in properties):
        raise InvalidInput(
            f"{PLUGIN}: expected one of the strings 'rig' (a built-in rig) and 'camera' (a rig file)"
        )
    if "rig" in properties:
        source = str(properties["rig"])
    else:
        source = str(Path(str(mi.file_resolver().resolve(str(properties["camera"])))))
    chosen: Camera = getattr(load_rig(source), side)
    return chosen


def _fitted(camera: Camera, size: tuple[int, int]) -> Camera:
    """The camera on a film of `size`: itself, or scaled where the film has its shape."""
    if camera.size == size:
        return camera
    scaled = camera.scaled(size[0] / camera.width)
    if scaled.size == size:
        return scaled
    raise InvalidInput(
        f"{PLUGIN}: the film is {size[0]}x{size[1]}; expected {camera.width}x{camera.height}, the size "
        "of the camera, or the same shape at another resolution"
    )
