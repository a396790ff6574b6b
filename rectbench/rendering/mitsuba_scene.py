"""A World as a Mitsuba scene.

Two flavours: `path_scene` has real emitters for Mitsuba's path integrator; `fast_scene` has none,
because `rectbench.rendering.integrator` does the lighting itself, and then every scene, indoors and
out, runs on the same compiled kernel.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rectbench.rendering.checks import check_material, check_world, checked_mesh, checked_placements
from rectbench.rendering.variant import mitsuba
from rectbench.rendering.world import Lamp, Material, Mesh, World
from rectbench.types import FloatArray

SUN_APERTURE_DEG = 0.53

LAMP_OFFSET = 1.0
"""The fast scene has no emitters: a lamp is a surface of reflectance LAMP_OFFSET + radiance, above
what any real surface has."""


def path_scene(world: World) -> Any:
    """The `mi.Scene` of a world with its sun and sky, lamps and ambient light as emitters."""
    mi = mitsuba()
    scene = _geometry(world, _path_bsdf)
    for i, lamp in enumerate(world.lamps):
        scene[f"lamp-{i}"] = {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f(_lamp_pose(lamp)),
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.5}},
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": list(lamp.radiance)}},
        }
    if world.sun is not None:
        scene["sky"] = {
            "type": "sunsky",
            "sun_direction": list(world.sun.direction),
            "turbidity": world.sun.turbidity,
            "sun_aperture": SUN_APERTURE_DEG,
        }
    elif any(world.ambient):
        scene["ambient"] = {"type": "constant", "radiance": {"type": "rgb", "value": list(world.ambient)}}
    return _load(scene)


def fast_scene(world: World) -> Any:
    """The `mi.Scene` of a world without emitters, for `rectbench.rendering.integrator`."""
    mi = mitsuba()
    scene = _geometry(world, _fast_bsdf)
    for i, lamp in enumerate(world.lamps):
        glow = np.add(lamp.radiance, LAMP_OFFSET).astype(np.float32)
        scene[f"lamp-{i}"] = {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f(_lamp_pose(lamp)),
            "bsdf": {"type": "diffuse", "reflectance": _texture(glow.reshape(1, 1, 3))},
        }
    return _load(scene)


def _load(scene: dict[str, Any]) -> Any:
    # Loading in parallel, or merging identical objects, leaves their order to chance.
    return mitsuba().load_dict(scene, parallel=False, optimize=False)


def _geometry(world: World, bsdf_of: Callable[[Material], dict[str, Any]]) -> dict[str, Any]:
    """All meshes and instances; meshes that share a Material object share its BSDF and texture."""
    mi = mitsuba()
    check_world(world)
    bsdfs: dict[int, Any] = {}
    for mesh in _meshes(world):
        if id(mesh.material) not in bsdfs:
            check_material(mesh.material, mesh.name)
            bsdfs[id(mesh.material)] = mi.load_dict(bsdf_of(mesh.material), optimize=False)

    def shape(mesh: Mesh) -> Any:
        return _mesh(mesh, bsdfs[id(mesh.material)])

    scene: dict[str, Any] = {"type": "scene"}
    for i, mesh in enumerate(world.meshes):
        scene[f"mesh-{i}"] = shape(mesh)
    for i, instances in enumerate(world.instances):
        group = {f"mesh-{j}": shape(mesh) for j, mesh in enumerate(instances.meshes)}
        scene[f"group-{i}"] = {"type": "shapegroup", **group}
        for j, placement in enumerate(checked_placements(instances.placements, instances.name)):
            scene[f"instance-{i}-{j}"] = {
                "type": "instance",
                "shapegroup": {"type": "ref", "id": f"group-{i}"},
                "to_world": mi.ScalarTransform4f(placement),
            }
    return scene


def _meshes(world: World) -> Iterator[Mesh]:
    yield from world.meshes
    for instances in world.instances:
        yield from instances.meshes


def _mesh(mesh: Mesh, bsdf: Any) -> Any:
    mi = mitsuba()
    vertices, faces, uv = checked_mesh(mesh)
    props = mi.Properties()
    props["bsdf"] = bsdf
    loaded = mi.Mesh(
        mesh.name, len(vertices), len(faces), has_vertex_normals=False, has_vertex_texcoords=True, props=props
    )
    buffers = mi.traverse(loaded)
    buffers["vertex_positions"] = vertices.ravel()
    buffers["faces"] = faces.ravel()
    buffers["vertex_texcoords"] = uv.ravel()
    buffers.update()
    return loaded


def _path_bsdf(material: Material) -> dict[str, Any]:
    return {"type": "twosided", "surface": _fast_bsdf(material)}


def _fast_bsdf(material: Material) -> dict[str, Any]:
    # The integrator turns normals to the eye by itself, which spares it a second virtual call.
    if material.glossy:
        return {"type": "plastic", "diffuse_reflectance": _reflectance(material)}
    return {"type": "diffuse", "reflectance": _reflectance(material)}


def _reflectance(material: Material) -> dict[str, Any]:
    texels = np.asarray(material.reflectance, dtype=np.float32)
    # A plain colour is a texture of one texel: one kind of texture means one kernel for all scenes.
    return _texture(texels.reshape(1, 1, 3) if texels.ndim == 1 else texels)


def _texture(texels: NDArray[np.float32]) -> dict[str, Any]:
    mi = mitsuba()
    return {
        "type": "bitmap",
        "data": mi.TensorXf(np.ascontiguousarray(texels)),
        "raw": True,
        "filter_type": "bilinear",
        "wrap_mode": "repeat",
    }


def _lamp_pose(lamp: Lamp) -> FloatArray:
    """World from Mitsuba's rectangle [-1, 1]^2, whose normal +z is turned down."""
    pose = np.diag([lamp.size_m[0] / 2, -lamp.size_m[1] / 2, -1.0, 1.0])
    pose[:3, 3] = lamp.centre
    return pose
