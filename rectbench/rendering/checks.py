"""Refuses a world that the renderer would fail on: a scene file is anybody's code."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rectbench.errors import InvalidResult
from rectbench.rendering.world import Material, Mesh, World
from rectbench.types import FloatArray

POSE_TOLERANCE = 1e-4
"""Largest entry of RᵀR - 1 in a pose that still is rounding: Mitsuba keeps its own in float32."""


def check_world(world: World) -> None:
    """Raise InvalidResult for a pose, light or exposure that makes no sense; meshes are checked apart."""
    if not world.meshes and not world.instances:
        raise InvalidResult("the world is empty; expected meshes or instances")
    fault = pose_fault(world.world_from_left)
    if fault is not None:
        raise InvalidResult(f"world_from_left {fault}; expected a rigid motion [4, 4]")
    for name, exposure in (("exposure", world.exposure), ("fast_exposure", world.fast_exposure)):
        if not 0 < exposure < np.inf:
            raise InvalidResult(f"{name} is {exposure}; expected a number above 0")
    if world.sun is not None and not 0 < np.linalg.norm(world.sun.direction) < np.inf:
        raise InvalidResult(
            f"the sun's direction is {world.sun.direction}; expected a finite vector other than 0"
        )
    for lamp in world.lamps:
        if not (_finite(lamp.centre) and _finite(lamp.radiance) and _finite(lamp.size_m)):
            raise InvalidResult(f"the lamp at {lamp.centre} has a number that is not finite")
        if min(lamp.size_m) <= 0 or min(lamp.radiance) < 0:
            raise InvalidResult(f"the lamp at {lamp.centre} has no extent or negative radiance")
    if not _finite(world.ambient) or min(world.ambient) < 0:
        raise InvalidResult(f"ambient is {world.ambient}; expected a radiance of at least 0")


def pose_fault(pose: FloatArray) -> str | None:
    """What keeps a matrix from being a rigid motion, or None where it is one."""
    pose = np.asarray(pose)
    if pose.shape != (4, 4) or not _finite(pose):
        return f"has shape {pose.shape} or is not finite"
    if not np.array_equal(pose[3], [0, 0, 0, 1]):
        return "has a last row other than 0 0 0 1"
    if np.abs(pose[:3, :3].T @ pose[:3, :3] - np.eye(3)).max() > POSE_TOLERANCE or np.linalg.det(pose) < 0:
        return "stretches or mirrors"
    return None


def _finite(values: ArrayLike) -> bool:
    return bool(np.isfinite(np.asarray(values, dtype=np.float64)).all())


def checked_mesh(mesh: Mesh) -> tuple[NDArray[np.float32], NDArray[np.uint32], NDArray[np.float32]]:
    """The buffers of a mesh; an index out of range would crash the process inside Embree."""
    vertices = np.asarray(mesh.vertices, dtype=np.float32)
    faces, uv = np.asarray(mesh.faces), np.asarray(mesh.uv, dtype=np.float32)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or not np.isfinite(vertices).all():
        raise InvalidResult(f"mesh {mesh.name}: vertices {vertices.shape} are not finite [V, 3]")
    if faces.ndim != 2 or faces.shape[1] != 3 or not np.issubdtype(faces.dtype, np.integer):
        raise InvalidResult(
            f"mesh {mesh.name}: faces are {faces.dtype} {faces.shape}; expected integers [F, 3]"
        )
    if faces.size and (faces.min() < 0 or faces.max() >= len(vertices)):
        raise InvalidResult(f"mesh {mesh.name}: a face names a vertex outside 0..{len(vertices) - 1}")
    if uv.shape != (len(vertices), 2) or not np.isfinite(uv).all():
        raise InvalidResult(f"mesh {mesh.name}: uv {uv.shape} is not finite [{len(vertices)}, 2]")
    return vertices, faces.astype(np.uint32), uv


def check_material(material: Material, mesh: str) -> None:
    texels = np.asarray(material.reflectance)
    if texels.shape != (3,) and (texels.ndim != 3 or texels.shape[2] != 3 or 0 in texels.shape):
        raise InvalidResult(
            f"mesh {mesh}: reflectance has shape {texels.shape}; expected a colour or [H, W, 3]"
        )
    if not np.isfinite(texels).all() or texels.min() < 0 or texels.max() > 1:
        raise InvalidResult(f"mesh {mesh}: reflectance leaves [0, 1] or is not finite")


def checked_placements(placements: FloatArray, name: str) -> FloatArray:
    poses = np.asarray(placements, dtype=np.float64)
    if poses.ndim != 3 or poses.shape[1:] != (4, 4) or not np.isfinite(poses).all():
        raise InvalidResult(f"instances {name}: placements {poses.shape} are not finite [K, 4, 4]")
    return poses
