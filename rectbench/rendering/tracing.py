"""Casts the rays that the truth is made of."""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from rectbench.cameras import Camera
from rectbench.cameras.projection import BoolArray
from rectbench.rendering.rectified_truth import RectifiedTruth, RectifiedView
from rectbench.rendering.truth import Truth
from rectbench.rendering.variant import drjit, mitsuba
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray
from rectbench.warps import Rectification

RAYS_AT_ONCE = 1 << 20
"""Rays in flight: bounds the float64 scratch space of a large image."""

SAME_SURFACE = 1e-4
"""Share of a distance by which two hits may differ and still be one: float32 rays err by 1e-6."""


class View(Protocol):
    """Pixels that are rays: a camera, or a rectified image of one."""

    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    def unproject(self, pixels: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Unit rays [..., 3] of pixels [..., 2], and which of them show anything."""


class PosedCamera(NamedTuple):
    """A camera and where it stands: [4, 4] world from camera (x right, y down, z forward)."""

    camera: Camera
    world_from_camera: FloatArray


def posed_cameras(rig: Rig, world_from_left: FloatArray) -> tuple[PosedCamera, PosedCamera]:
    """Both cameras of a rig whose left one stands at `world_from_left` [4, 4]."""
    left_from_right = np.eye(4)
    left_from_right[:3, :3] = rig.R_right_left.T
    left_from_right[:3, 3] = rig.centre_right_in_left
    return PosedCamera(rig.left, world_from_left), PosedCamera(rig.right, world_from_left @ left_from_right)


def trace_truth(scene: Any, rig: Rig, world_from_left: FloatArray) -> Truth:
    """The truth of a rig in a `mi.Scene`, its left camera at `world_from_left` [4, 4]."""
    left, right = posed_cameras(rig, world_from_left)
    depth_left, visible_left = _trace(scene, left.camera, left.world_from_camera, right)
    depth_right, visible_right = _trace(scene, right.camera, right.world_from_camera, left)
    return Truth(rig, depth_left, depth_right, visible_left, visible_right)


def trace_rectified(scene: Any, rect: Rectification, world_from_left: FloatArray) -> RectifiedTruth:
    """The truth about a rectified left image, its rig being the true one, in a `mi.Scene`."""
    _, right = posed_cameras(rect.rig, world_from_left)
    depth, visible = _trace(scene, RectifiedView(rect), world_from_left, right)
    return RectifiedTruth(rect, depth, visible)


def _trace(
    scene: Any, view: View, world_from_view: FloatArray, there: PosedCamera
) -> tuple[NDArray[np.float32], BoolArray]:
    """Depth [H, W] along the rays of a view, and which of the points `there` sees too."""
    depth = np.full((view.height, view.width), np.nan, dtype=np.float32)
    visible = np.zeros((view.height, view.width), dtype=bool)
    u = np.arange(view.width, dtype=np.float64)
    rows = max(1, RAYS_AT_ONCE // view.width)
    for top in range(0, view.height, rows):
        v = np.arange(top, min(top + rows, view.height), dtype=np.float64)
        rays, ok = view.unproject(np.stack(np.meshgrid(u, v), axis=-1))
        directions = rays[ok] @ world_from_view[:3, :3].T
        distance, unoccluded = _cast(
            scene, world_from_view[:3, 3], there.world_from_camera[:3, 3], directions
        )
        points = world_from_view[:3, 3] + distance[:, None].astype(np.float64) * directions
        points_there = (points - there.world_from_camera[:3, 3]) @ there.world_from_camera[:3, :3]
        depth[top : top + len(v)][ok] = distance
        visible[top : top + len(v)][ok] = unoccluded & there.camera.sees(points_there)
    return depth, visible


def _cast(
    scene: Any, origin: FloatArray, other: FloatArray, directions: FloatArray
) -> tuple[NDArray[np.float32], BoolArray]:
    """Distance [N] to what each ray hits (NaN: nothing), and whether `other` sees the point hit.

    It does where both ways agree: the way from the surface to the other centre is free, and the ray
    from that centre meets the surface at the point. Rounding and cracks between triangles fool one
    of them, hardly ever both. Nothing is asked of a surface but its distance, so no virtual call
    is compiled, and every scene runs on one small kernel.
    """
    mi, dr = mitsuba(), drjit()
    # Component by component: an [N, 3] array would be picked apart with N baked into the kernel.
    x, y, z = (mi.Float(np.ascontiguousarray(column)) for column in directions.T.astype(np.float32))
    ray = mi.Ray3f(_opaque_point(origin), mi.Vector3f(x, y, z))
    first = scene.ray_intersect_preliminary(ray, coherent=True)
    hit = first.is_valid()
    point, centre = ray(first.t), _opaque_point(other)
    length = dr.norm(point - centre)
    way = (point - centre) / length

    back = scene.ray_intersect_preliminary(mi.Ray3f(centre, way), coherent=True, active=hit)
    agrees = dr.abs(back.t - length) < SAME_SURFACE * length
    out = mi.Ray3f(point - SAME_SURFACE * length * way, -way)
    out.maxt = (1.0 - 2.0 * SAME_SURFACE) * length
    free = ~scene.ray_test(out, hit)

    distance, seen = dr.select(hit, first.t, dr.nan), hit & agrees & free
    dr.eval(distance, seen)
    return distance.numpy(), seen.numpy()


def _opaque_point(point: FloatArray) -> Any:
    dr = drjit()

    # As a literal it would be baked into the kernel: every pose would compile anew.
    return dr.opaque(mitsuba().Point3f, [float(x) for x in point])
