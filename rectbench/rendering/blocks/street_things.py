"""What stands in streets and parks: lamp posts, benches, cars, bins, fences.

Things stand on z = 0 at the origin; long ones run along x and face south (-y).
"""

from __future__ import annotations

import numpy as np

from rectbench.rendering.blocks.shape import Finish, Model, Shape, join
from rectbench.rendering.blocks.solids import box, boxes, cylinder, loft, plank, rod, tubes, turned

CAR_M = (4.15, 1.72, 1.46)
"""Length, width and height of a car."""


def lamp_post(iron: Finish, glass: Finish, *, height: float = 4.6) -> Model:
    """A cast-iron post with a lantern."""
    post = turned([
        (0.0, 0.0), (0.16, 0.0), (0.16, 0.35), (0.10, 0.45), (0.085, 1.0), (0.11, 1.05), (0.06, 1.15),
        (0.045, height - 0.8), (0.075, height - 0.75), (0.03, height - 0.7), (0.03, height - 0.62),
        (0.0, height - 0.62),
    ], 14)  # fmt: skip
    bar = rod((-0.32, 0, height - 1.0), (0.32, 0, height - 1.0), 0.02)
    cap = turned([
        (0.0, height), (0.04, height - 0.08), (0.25, height - 0.18), (0.25, height - 0.2),
        (0.0, height - 0.2),
    ], 6)  # fmt: skip
    cage = join(
        rod((0.12 * c, 0.12 * s, height - 0.62), (0.2 * c, 0.2 * s, height - 0.2), 0.012, 4)
        for c, s in _ring(6)
    )
    lantern = turned(
        [(0.0, height - 0.61), (0.11, height - 0.61), (0.19, height - 0.21), (0.0, height - 0.21)], 6
    )
    return (post + bar + cap + cage).of(iron) + lantern.of(glass)


def _ring(count: int) -> list[tuple[float, float]]:
    angle = 2.0 * np.pi * np.arange(count) / count
    return [(float(np.cos(a)), float(np.sin(a))) for a in angle]


def bench(wood: Finish, iron: Finish, *, length: float = 1.8) -> Model:
    """A park bench with slats and iron ends; the seat is 45 cm high."""
    seat = [plank(length, 0.09, 0.035).at(0, y, 0.43) for y in (-0.2, -0.09, 0.02, 0.13)]
    back = [plank(length, 0.03, 0.09).at(0, 0.22 + 0.25 * (z - 0.5), z) for z in (0.55, 0.68, 0.81)]
    sides = []
    for x in (-length / 2 + 0.15, length / 2 - 0.15):
        legs = [
            [(x, -0.24, 0.0), (x, -0.2, 0.42), (x, 0.19, 0.42)],
            [(x, 0.26, 0.0), (x, 0.18, 0.42), (x, 0.31, 0.92)],
        ]
        sides.append(tubes(legs, 0.022, 6))
        sides.append(tubes([(x, -0.22, 0.0), (x, -0.24, 0.62), (x, 0.22, 0.64)], 0.02, 6))
    return join(seat + back).of(wood) + join(sides).of(iron)


def litter_bin(body: Finish, iron: Finish) -> Model:
    """A slatted bin, 90 cm high, on a post."""
    slats = [plank(0.07, 0.02, 0.62).at(0, -0.22).at(0, 0, 0.2, turn_deg=20.0 * k) for k in range(18)]
    hoops = join(tubes(_hoop(0.225, z), 0.014, 6) for z in (0.24, 0.52, 0.80))
    drum = cylinder(0.2, 0.55, 16).at(z=0.22) + rod((0, 0, 0), (0, 0, 0.3), 0.05)
    return join(slats).of(body) + (drum + hoops).of(iron)


def _hoop(radius: float, z: float, segments: int = 24) -> list[tuple[float, float, float]]:
    angle = np.linspace(0.0, 2.0 * np.pi, segments + 1)
    return [(float(radius * np.cos(a)), float(radius * np.sin(a)), z) for a in angle]


def bollard(iron: Finish) -> Model:
    """A cast bollard, 95 cm high."""
    profile = [(0.1, 0.0), (0.1, 0.1), (0.075, 0.16), (0.06, 0.75), (0.085, 0.8), (0.085, 0.86), (0.0, 0.95)]
    return turned(profile, 14).of(iron)


def pillar_box(red: Finish, black: Finish) -> Model:
    """A letter box, 1.6 m high, its slot to the south."""
    body = turned(
        [(0.24, 0.0), (0.23, 0.15), (0.22, 1.38), (0.27, 1.42), (0.27, 1.48), (0.2, 1.56), (0.0, 1.6)]
    )
    base = cylinder(0.255, 0.14)
    slot = box(0.2, 0.03, 0.04).at(0, -0.22, 1.22)
    return body.of(red) + (base + slot).of(black)


def car(paint: Finish, glass: Finish, tyre: Finish, trim: Finish) -> Model:
    """A small family car along x, its bonnet to the east."""
    body = loft(np.array([_body_ring(*station) for station in _BODY]))
    cabin = loft(np.array([_body_ring(*station) for station in _CABIN]))
    roof = loft(np.array([_body_ring(x, y, top - 0.055, top) for x, y, top in _ROOF]))
    posts = tubes(_pillars(), 0.032, 6)
    wheels, hubs = [], []
    for x in (-1.28, 1.30):
        for y in (-0.75, 0.75):
            wheels.append(_wheel(0.31, 0.2).at(x, y, 0.31))
            hubs.append(_wheel(0.17, 0.215).at(x, y, 0.31))
    fittings = boxes(
        [(-2.13, -0.7, 0.32), (1.95, -0.7, 0.32), (2.0, -0.68, 0.62), (2.0, 0.42, 0.62)],
        [(-2.0, 0.7, 0.46), (2.1, 0.7, 0.46), (2.07, -0.42, 0.74), (2.07, 0.68, 0.74)],
    )
    mirrors = boxes([(0.62, -0.98, 0.92), (0.62, 0.86, 0.92)], [(0.78, -0.86, 1.04), (0.78, 0.98, 1.04)])
    seams = [[(x, y, 0.3), (x, y * 1.005, 0.9)] for x in (-0.62, 0.28, 1.0) for y in (-0.862, 0.862)]
    plates = boxes([(-2.16, -0.26, 0.5), (2.09, -0.26, 0.4)], [(-2.08, 0.26, 0.61), (2.13, 0.26, 0.51)])
    return (
        (body + roof + posts).of(paint)
        + cabin.of(glass)
        + join(wheels).of(tyre)
        + (fittings + mirrors + plates + join(hubs)).of(trim)
        + tubes(seams, 0.006, 4).of(tyre)
    )


_BODY = [
    (-2.08, 0.30, 0.45, 0.55), (-2.07, 0.74, 0.30, 0.80), (-1.95, 0.82, 0.24, 0.93), (-1.2, 0.86, 0.22, 0.95),
    (0.4, 0.86, 0.22, 0.94), (1.0, 0.86, 0.22, 0.91), (1.7, 0.83, 0.24, 0.78), (1.98, 0.76, 0.30, 0.68),
    (2.06, 0.60, 0.36, 0.60), (2.07, 0.20, 0.42, 0.52),
]  # fmt: skip
"""Stations from the tail to the nose, metres: x, half width, bottom, top."""
_CABIN = [
    (-1.98, 0.70, 0.9, 0.93), (-1.62, 0.69, 0.9, 1.41), (0.22, 0.69, 0.9, 1.42), (1.08, 0.70, 0.88, 0.90),
]  # fmt: skip
_ROOF = [(-1.72, 0.60, 1.42), (-1.55, 0.66, 1.445), (-0.6, 0.68, 1.46), (0.1, 0.67, 1.45), (0.28, 0.6, 1.42)]
"""x, half width, top."""


def _body_ring(x: float, half_width: float, bottom: float, top: float) -> list[tuple[float, float, float]]:
    """A rounded rectangle across the car at `x`, narrower at the top."""
    middle, shoulder = 0.45 * bottom + 0.55 * top, bottom + 0.9 * (top - bottom)
    half = [
        (0.0, top), (0.8, top), (0.93, shoulder), (1.0, middle),
        (0.97, bottom + 0.04), (0.85, bottom), (0.0, bottom),
    ]  # fmt: skip
    right = [(x, half_width * y, z) for y, z in half]
    left = [(x, -half_width * y, z) for y, z in half[-2:0:-1]]
    return right + left


def _pillars() -> list[list[tuple[float, float, float]]]:
    """The posts between the windows, on both sides."""
    lines = [
        ((1.06, 0.70, 0.91), (0.24, 0.63, 1.42)),
        ((-0.62, 0.71, 0.93), (-0.66, 0.65, 1.42)),
        ((-1.96, 0.68, 0.93), (-1.62, 0.62, 1.41)),
    ]
    return [[(x, side * y, z) for x, y, z in line] for line in lines for side in (-1.0, 1.0)]


def _wheel(radius: float, width: float) -> Shape:
    """A disc whose axis is y, centred on the origin."""
    return cylinder(radius, width, 20).at(z=-width / 2).tipped((1.0, 0.0, 0.0), 90.0)


def railing(iron: Finish, *, length: float, height: float = 1.1) -> Model:
    """An iron fence along x: bars every 13 cm, two rails, spear tips."""
    x = np.arange(-length / 2, length / 2 + 1e-6, 0.13)
    bars = tubes(
        [[(at, 0, 0), (at, 0, height - 0.06), (at, 0, height)] for at in x], [0.009, 0.009, 0.001], 5
    )
    rails = join(rod((-length / 2, 0, z), (length / 2, 0, z), 0.014, 5) for z in (0.15, height - 0.15))
    posts = join(
        box(0.05, 0.05, height + 0.05).at(at) for at in np.arange(-length / 2, length / 2 + 0.1, 1.95)
    )
    return (bars + rails + posts).of(iron)


def rail_fence(wood: Finish, rng: np.random.Generator, *, length: float, height: float = 1.1) -> Model:
    """A rustic fence along x: posts every two metres and three weathered rails between them."""
    posts, rails = [], []
    for x in np.arange(-length / 2, length / 2 + 0.1, 2.0):
        lean = rng.normal(0.0, 2.5)
        posts.append(plank(0.11, 0.11, height + 0.3).at(z=-0.2).tipped((0.0, 1.0, 0.0), lean).at(float(x)))
    for x in np.arange(-length / 2 + 1.0, length / 2, 2.0):
        for z in (0.3, 0.62, 0.94):
            rail = plank(2.1, 0.035, 0.1).tipped((0.0, 1.0, 0.0), rng.normal(0.0, 1.2))
            rails.append(rail.at(float(x), -0.06, z * height / 1.1))
    return join(posts + rails).of(wood)


def bicycle(frame: Finish, tyre: Finish) -> Model:
    """A bicycle along x, 1.7 m long."""
    wheels = []
    for x in (-0.52, 0.52):
        rim = tubes(_hoop(0.33, 0.0), 0.016, 6)
        spokes = tubes([[(0, 0, 0), (0.33 * c, 0.33 * s, 0)] for c, s in _ring(18)], 0.0025, 3)
        wheels.append((rim + spokes).tipped((1.0, 0.0, 0.0), 90.0).at(x, 0, 0.345))
    saddle, crank, head = (-0.2, 0, 0.92), (-0.08, 0, 0.3), (0.36, 0, 0.86)
    lines = [
        (crank, saddle), (crank, (0.33, 0, 0.74)), ((-0.17, 0, 0.78), head), ((-0.52, 0, 0.345), crank),
        ((-0.52, 0, 0.345), (-0.17, 0, 0.78)), (head, (0.52, 0, 0.345)), (head, (0.33, 0, 1.02)),
        ((0.33, -0.27, 1.04), (0.33, 0.27, 1.04)),
    ]  # fmt: skip
    seat = box(0.26, 0.13, 0.05).at(-0.22, 0, 0.92)
    return tubes(lines, 0.016, 7).of(frame) + join([*wheels, seat]).of(tyre)
