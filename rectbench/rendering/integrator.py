"""The fast integrator: what a picture needs for matching, and no light transport beyond it.

A surface gets its colour from the sun or one lamp, each through one shadow ray, and from its
surroundings, through one ambient-occlusion ray. Nothing bounces, so 16 samples a pixel are clean.
One kernel serves every world: lights are data, and a light that is absent costs an idle ray.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from rectbench.rendering.mitsuba_scene import LAMP_OFFSET
from rectbench.rendering.variant import drjit, mitsuba
from rectbench.rendering.world import World
from rectbench.types import FloatArray

SUN_RADIANCE = (2.4, 2.25, 2.0)

OUTDOOR_REACH_M = 6.0
INDOOR_REACH_M = 1.5
"""How far a surface can darken another: the length of the ambient-occlusion ray."""
OCCLUDED_SHARE = 0.3
"""What is left of the ambient light where that ray hits something: it is lit too."""

ROOM_REFLECTANCE = 0.5
"""Mean reflectance of a room's surfaces, for the light that its walls return."""
ROOM_MARGIN_M = 4.0
"""What stands farther than this beyond all lamps is not the room: a garden, another building."""

LEAST_ROOM_M2 = 10.0

LEAST_COSINE = 0.05
"""Floor of the cosines by which a lamp is chosen, so that one half below the horizon stays possible."""


@dataclass(frozen=True)
class Surroundings:
    """Radiance that arrives from above, from the horizon and from below."""

    zenith: FloatArray
    horizon: FloatArray
    ground: FloatArray


CLEAR_SKY = Surroundings(
    np.array([0.25, 0.42, 0.80]), np.array([0.75, 0.82, 0.95]), np.array([0.22, 0.20, 0.17])
)


def fast_integrator(world: World) -> Any:
    """A `mi.SamplingIntegrator` with the lights of a world, for its `fast_scene`."""
    return _integrator_class(mitsuba().variant())(world)


def room_light(world: World) -> Surroundings:
    """What the surfaces of a room return: the flux of its lamps spread over its walls, over and over.

    With flux Φ on walls of area A and reflectance ρ the radiosity settles at Φ/A · ρ/(1 - ρ).
    Lamps shine down, so more of it comes from the floor than from the ceiling. Where there are no
    lamps, the ambient light is all.
    """
    if not world.lamps:
        ambient = np.asarray(world.ambient, dtype=np.float64)
        return Surroundings(ambient, ambient, ambient)
    centres = np.array([lamp.centre for lamp in world.lamps], dtype=np.float64)
    vertices = np.concatenate([centres, *(np.asarray(mesh.vertices) for mesh in world.meshes)])
    low = np.maximum(vertices.min(axis=0), centres.min(axis=0) - ROOM_MARGIN_M)
    high = np.minimum(vertices.max(axis=0), centres.max(axis=0) + ROOM_MARGIN_M)
    x, y, z = high - low
    area = max(2.0 * (x * y + y * z + z * x), LEAST_ROOM_M2)
    flux = sum(np.pi * lamp.size_m[0] * lamp.size_m[1] * np.asarray(lamp.radiance) for lamp in world.lamps)
    returned = flux / area * ROOM_REFLECTANCE / (1.0 - ROOM_REFLECTANCE) / np.pi
    return Surroundings(0.7 * returned, returned, 1.5 * returned)


@cache
def _integrator_class(variant: str) -> Any:
    mi, dr = mitsuba(), drjit()
    base: Any = mi.SamplingIntegrator

    def _colours(light: Surroundings) -> tuple[Any, Any, Any]:
        return mi.Color3f(light.zenith), mi.Color3f(light.horizon), mi.Color3f(light.ground)

    def _from(colours: tuple[Any, Any, Any], direction: Any) -> Any:
        zenith, horizon, ground = colours
        above = dr.lerp(horizon, zenith, dr.clip(1.3 * direction.z, 0.0, 1.0))
        below = dr.lerp(horizon, ground, dr.clip(-8.0 * direction.z, 0.0, 1.0))
        return dr.select(direction.z > 0.0, above, below)

    class FastIntegrator(base):  # type: ignore[misc]
        """Albedo, hard sun, one lamp, one ambient-occlusion ray."""

        def __init__(self, world: World) -> None:
            super().__init__(mi.Properties())
            outdoors = world.sun is not None
            direction = np.asarray(world.sun.direction if world.sun else (0.0, 0.0, 1.0), dtype=np.float64)
            fill = CLEAR_SKY if outdoors else room_light(world)
            outside = CLEAR_SKY if outdoors else Surroundings(*[np.asarray(world.ambient)] * 3)
            self.sun = mi.Vector3f(direction / np.linalg.norm(direction))
            self.sun_radiance = mi.Color3f(SUN_RADIANCE if outdoors else (0.0, 0.0, 0.0))
            self.fill = _colours(fill)
            self.outside = _colours(outside)
            self.reach = mi.Float(OUTDOOR_REACH_M if outdoors else INDOOR_REACH_M)
            # Indoors a ray that finds no wall at all left through a window.
            self.sight = mi.Float(OUTDOOR_REACH_M if outdoors else np.inf)
            # An idle lamp keeps the kernel the same outdoors.
            lamps = [(lamp.centre, lamp.size_m, lamp.radiance) for lamp in world.lamps]
            self.lamp_count = mi.UInt32(len(lamps))
            centres, sizes, radiances = zip(*(lamps or [((0, 0, 0), (0, 0), (0, 0, 0))]), strict=True)
            self.lamp_centre = mi.Float(np.ravel(centres).astype(np.float32))
            self.lamp_size = mi.Float(np.ravel(sizes).astype(np.float32))
            self.lamp_radiance = mi.Float(np.ravel(radiances).astype(np.float32))
            # As literals these would be baked into the kernel: every world would compile anew.
            dr.make_opaque(*(value for value in vars(self).values()))

        def sample(
            self, scene: Any, sampler: Any, ray: Any, medium: Any = None, active: Any = True
        ) -> tuple[Any, Any, list[Any]]:
            si = scene.ray_intersect(ray, active)
            hit = si.is_valid()
            bsdf = si.bsdf(ray)
            albedo = bsdf.eval_diffuse_reflectance(si, hit)
            polished = hit & mi.has_flag(bsdf.flags(), mi.BSDFFlags.DeltaReflection)
            toward_eye = dr.dot(si.n, ray.d) < 0.0
            normal = dr.select(toward_eye, si.n, -si.n)

            light = self._surroundings(scene, sampler, si, normal, hit)
            light += self._sunlight(scene, si, normal, hit)
            light += self._lamplight(scene, sampler, si, normal, hit)
            colour = albedo * light

            mirrored = ray.d - 2.0 * dr.dot(ray.d, normal) * normal
            grazing = 1.0 - dr.abs(dr.dot(ray.d, normal))
            fresnel = dr.select(polished, 0.04 + 0.96 * grazing**5, 0.0)
            colour = dr.lerp(colour, _from(self.fill, mirrored), fresnel)

            lamp = dr.max(albedo) > LAMP_OFFSET
            colour = dr.select(lamp, albedo - LAMP_OFFSET, colour)
            return dr.select(hit, colour, _from(self.outside, ray.d)), active, []

        def _surroundings(self, scene: Any, sampler: Any, si: Any, normal: Any, active: Any) -> Any:
            local = mi.warp.square_to_cosine_hemisphere(sampler.next_2d(active))
            direction = mi.Frame3f(normal).to_world(local)
            ray = si.spawn_ray(direction)
            # Whether there is anything is told sooner than what is nearest.
            ray.maxt = self.reach
            near = scene.ray_test(ray, active)
            ray.maxt = self.sight
            far = scene.ray_test(ray, active & ~near & (self.sight > self.reach))
            room = _from(self.fill, direction) * dr.select(near, OCCLUDED_SHARE, 1.0)
            return dr.select(near | far, room, _from(self.outside, direction))

        def _sunlight(self, scene: Any, si: Any, normal: Any, active: Any) -> Any:
            cosine = dr.dot(normal, self.sun)
            lit = active & (cosine > 0.0) & (self.sun_radiance.x > 0.0)
            lit &= ~scene.ray_test(si.spawn_ray(self.sun), lit)
            return self.sun_radiance * dr.select(lit, cosine, 0.0)

        def _lamplight(self, scene: Any, sampler: Any, si: Any, normal: Any, active: Any) -> Any:
            """Irradiance over π from one lamp, drawn in proportion to what each would give unshadowed."""
            lamp, chance = self._draw_lamp(sampler.next_1d(active), si.p, normal)
            offset = sampler.next_2d(active) - 0.5
            size = dr.gather(mi.Vector2f, self.lamp_size, lamp)
            corner = dr.gather(mi.Point3f, self.lamp_centre, lamp)
            point = corner + mi.Vector3f(offset.x * size.x, offset.y * size.y, 0.0)
            way = point - si.p
            square = dr.maximum(dr.squared_norm(way), 1e-4)
            # Both cosines at once, each times the distance; the lamp faces straight down.
            cosines = dr.maximum(dr.dot(normal, way), 0.0) * dr.maximum(way.z, 0.0) / square
            lit = active & (cosines > 0.0) & (chance > 0.0)
            lit &= ~scene.ray_test(si.spawn_ray_to(point), lit)
            factor = size.x * size.y * cosines / (dr.pi * square * chance)
            return dr.gather(mi.Color3f, self.lamp_radiance, lamp) * dr.select(lit, factor, 0.0)

        def _draw_lamp(self, number: Any, point: Any, normal: Any) -> tuple[Any, Any]:
            """A lamp and its probability: weighted reservoir sampling that reuses one random number."""

            def step(i: Any, chosen: Any, weight: Any, total: Any, u: Any) -> tuple[Any, ...]:
                size = dr.gather(mi.Vector2f, self.lamp_size, i)
                way = dr.gather(mi.Point3f, self.lamp_centre, i) - point
                square = dr.squared_norm(way)
                floor = LEAST_COSINE * dr.sqrt(square)
                facing = dr.maximum(dr.dot(normal, way), floor) * dr.maximum(way.z, floor)
                strength = dr.sum(dr.gather(mi.Color3f, self.lamp_radiance, i)) * size.x * size.y
                w = strength * facing / dr.maximum(dr.square(square), 1e-6)
                total = total + w
                share = dr.select(total > 0.0, w / total, 0.0)
                take = u < share
                u = dr.select(take, u / share, (u - share) / (1.0 - share))
                return i + 1, dr.select(take, i, chosen), dr.select(take, w, weight), total, u

            lanes = dr.zeros(mi.Float, dr.width(number))
            state = (mi.UInt32(lanes), mi.UInt32(lanes), mi.Float(lanes), mi.Float(lanes), number)
            _, lamp, weight, total, _ = dr.while_loop(
                state, lambda i, *_: i < self.lamp_count, step, label="draw lamp", mode="symbolic"
            )
            return lamp, dr.select(total > 0.0, weight / total, 0.0)

        def to_string(self) -> str:
            return "FastIntegrator[]"

    return FastIntegrator
