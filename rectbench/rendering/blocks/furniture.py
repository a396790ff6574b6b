"""Furniture and fittings of rooms.

Things stand on z = 0 at the origin; what has a front faces south (-y). Fittings for walls have the
wall's face at y = 0 and stick out towards -y.
"""

from __future__ import annotations

import numpy as np

from rectbench.rendering.blocks.prints import Prints
from rectbench.rendering.blocks.shape import Finish, Model, Shape, join, together
from rectbench.rendering.blocks.solids import (
    ball,
    box,
    boxes,
    cards,
    cylinder,
    panel,
    plank,
    rod,
    tubes,
    turned,
)

SEAT_M = 0.45
TABLE_M = 0.74
DOOR_LEAF_M = (0.9, 2.1)


def chair(wood: Finish, seat: Finish) -> Model:
    """A dining chair with a slatted back; seat at 45 cm."""
    x, front, back = 0.19, -0.19, 0.19
    legs = [rod((s * x, front, 0.0), (s * 0.9 * x, front, SEAT_M - 0.03), 0.017) for s in (-1, 1)]
    posts = [
        tubes([(s * x, back + 0.04, 0.0), (s * x, back, SEAT_M), (s * x, back + 0.1, 0.95)], 0.017)
        for s in (-1, 1)
    ]
    rungs = [rod((s * x, front, 0.2), (s * x, back, 0.2), 0.009, 6) for s in (-1, 1)]
    slats = [plank(2 * x, 0.014, 0.05).at(0, back + 0.02 + 0.2 * (z - SEAT_M), z) for z in (0.58, 0.70)]
    slats += [plank(2 * x + 0.05, 0.02, 0.09).at(0, back + 0.1, 0.85)]
    slats += [plank(2 * x, 0.02, 0.05).at(0, front, 0.37)]
    slats += [plank(0.02, 2 * x, 0.05).at(s * x, 0, 0.37) for s in (-1, 1)]
    cushion = ball(0.44, 0.43, 0.06, 0.35).at(z=SEAT_M - 0.04)
    return join([*legs, *posts, *rungs, *slats]).of(wood) + cushion.of(seat)


def stool(wood: Finish) -> Model:
    """A round stool on three splayed legs."""
    legs = [
        rod((0.2 * np.cos(a), 0.2 * np.sin(a), 0.0), (0.1 * np.cos(a), 0.1 * np.sin(a), 0.44), 0.018)
        for a in (0.5, 2.6, 4.7)
    ]
    return join([cylinder(0.17, 0.035).at(z=0.43), *legs]).of(wood)


def table(wood: Finish, *, width: float = 1.6, depth: float = 0.9, height: float = TABLE_M) -> Model:
    """A table on four square tapered legs."""
    x, y = width / 2 - 0.08, depth / 2 - 0.08
    legs = [plank(0.06, 0.06, height - 0.03).at(s * x, t * y) for s in (-1, 1) for t in (-1, 1)]
    aprons = [plank(2 * x, 0.02, 0.09).at(0, t * y, height - 0.12) for t in (-1, 1)]
    aprons += [plank(0.02, 2 * y, 0.09).at(s * x, 0, height - 0.12) for s in (-1, 1)]
    return join([plank(width, depth, 0.032).at(z=height - 0.032), *legs, *aprons]).of(wood)


def books(rng: np.random.Generator, spines: Prints, *, length: float, height: float = 0.3) -> Model:
    """A row of books along x with their spines to the south; some lean, some lie in a pile."""
    row, x = [], -length / 2
    while x < length / 2 - 0.07:
        thick, tall = rng.uniform(0.018, 0.055), height * rng.uniform(0.62, 0.97)
        deep, kind = rng.uniform(0.13, 0.2), int(rng.integers(64))
        if rng.random() < 0.06 and x < length / 2 - 0.32:
            row.append(_pile(rng, spines).at(x + 0.13))
            x += 0.28
            continue
        lean = rng.uniform(3, 12) if rng.random() < 0.1 else 0.0
        body = _book(thick, tall, deep).tipped((0, 1, 0), lean)
        row.append(spines.on(body, kind).at(x + thick / 2))
        x += thick + 0.003 + tall * np.sin(np.radians(lean))
    return together(row)


def _book(thick: float, tall: float, deep: float) -> Shape:
    """A closed book whose spine, at y = 0, bears the print and whose other sides bear its colours."""
    shape = box(thick, deep, tall).at(0, deep / 2)
    across = shape.vertices[:, 0] / thick + 0.5
    return Shape(shape.vertices, shape.faces, np.stack([across, shape.vertices[:, 2] / tall], axis=1))


def _pile(rng: np.random.Generator, spines: Prints) -> Model:
    pile, z = [], 0.0
    for _ in range(int(rng.integers(2, 5))):
        thick = rng.uniform(0.02, 0.05)
        lying = _book(thick, rng.uniform(0.18, 0.25), rng.uniform(0.13, 0.18)).tipped((0, 1, 0), 90).at(-0.12)
        pile.append(spines.on(lying, int(rng.integers(64))).at(rng.uniform(-0.02, 0.02), 0, z + thick / 2))
        z += thick
    return together(pile)


def bookcase(
    rng: np.random.Generator,
    wood: Finish,
    spines: Prints,
    parcels: Prints,
    *,
    width: float = 1.0,
    shelves: int = 6,
) -> Model:
    """A full bookcase, its back at y = 0, books in front of it."""
    height, depth, gap = 0.08 + 0.35 * shelves, 0.3, 0.35
    boards = [plank(width, depth, 0.022).at(0, -depth / 2, 0.08 + gap * k) for k in range(shelves + 1)]
    sides = [plank(0.022, depth, height + 0.03).at(s * width / 2, -depth / 2) for s in (-1, 1)]
    back = plank(width, 0.01, height).at(0, -0.005)
    filled = []
    for k in range(shelves):
        level = 0.105 + gap * k
        used = width - 0.06 - (0.3 if rng.random() < 0.3 else 0.0)
        filled.append(
            books(rng, spines, length=used, height=gap - 0.04).at((used - width) / 2 + 0.03, -0.24, level)
        )
        if used < width - 0.1:
            size = (rng.uniform(0.16, 0.24), 0.18, rng.uniform(0.12, 0.26))
            filled.append(parcel(parcels, size, int(rng.integers(16))).at(width / 2 - 0.17, -0.15, level))
    return join([*boards, *sides, back]).of(wood) + together(filled)


def parcel(prints: Prints, size: tuple[float, float, float], picture: int) -> Model:
    """A box of (width, depth, height) metres with a printed side all round."""
    shape = box(*size)
    low, high = shape.vertices.min(0), shape.vertices.max(0)
    across = (shape.vertices - low) / (high - low)
    sides = np.repeat([0, 0, 1, 1, 0, 0], 4), np.repeat([2, 2, 2, 2, 1, 1], 4)
    uv = np.stack([across[np.arange(24), axis] for axis in sides], axis=-1)
    return prints.on(Shape(shape.vertices, shape.faces, uv), picture)


def sofa(fabric: Finish, cushions: Finish, wood: Finish, *, width: float = 1.9) -> Model:
    """A sofa with loose cushions on wooden feet."""
    seat_count, arm = 3, 0.18
    inner = width - 2 * arm
    frame = [ball(width, 0.85, 0.26, 0.25).at(z=0.12), ball(width, 0.22, 0.62, 0.3).at(0, 0.34, 0.16)]
    frame += [ball(arm, 0.85, 0.5, 0.35).at(s * (width - arm) / 2, 0, 0.12) for s in (-1, 1)]
    each = inner / seat_count
    for k in range(seat_count):
        x = (k - 1) * each
        frame.append(ball(each - 0.01, 0.62, 0.17, 0.35).at(x, -0.08, 0.32))
        frame.append(ball(each - 0.02, 0.17, 0.42, 0.4).tipped((1, 0, 0), -12).at(x, 0.2, 0.43))
    loose = [
        ball(0.42, 0.16, 0.40, 0.5).tipped((1, 0, 0), -25).at(x, 0.02, 0.48, turn_deg=t)
        for x, t in ((-0.6, 20), (0.62, -25))
    ]
    feet = [
        turned([(0.015, 0.0), (0.03, 0.14), (0.0, 0.14)], 10).at(s * (width / 2 - 0.1), t * 0.34)
        for s in (-1, 1)
        for t in (-1, 1)
    ]
    return join(frame).of(fabric) + join(loose).of(cushions) + join(feet).of(wood)


def cabinet(
    wood: Finish,
    knob: Finish,
    *,
    width: float = 0.9,
    height: float = 0.8,
    depth: float = 0.42,
    drawers: int = 3,
) -> Model:
    """A chest of drawers, its back at y = 0."""
    body = plank(width, depth, height - 0.08).at(0, -depth / 2, 0.08)
    top = plank(width + 0.04, depth + 0.03, 0.025).at(0, -depth / 2, height)
    each = (height - 0.12) / drawers
    fronts = [
        plank(width - 0.05, 0.02, each - 0.02).at(0, -depth - 0.01, 0.1 + each * k) for k in range(drawers)
    ]
    feet = [
        plank(0.05, 0.05, 0.08).at(s * (width / 2 - 0.05), y) for s in (-1, 1) for y in (-0.05, 0.05 - depth)
    ]
    knobs = [
        ball(0.032, 0.032, 0.032).at(s * width / 4, -depth - 0.035, 0.1 + each * (k + 0.45))
        for k in range(drawers)
        for s in (-1, 1)
    ]
    return join([body, top, *fronts, *feet]).of(wood) + join(knobs).of(knob)


def floor_lamp(iron: Finish, shade: Finish) -> Model:
    """A standard lamp of 1.6 m with a cloth shade."""
    stand = turned([(0.0, 0.0), (0.15, 0.0), (0.14, 0.025), (0.014, 0.04), (0.012, 1.4), (0.0, 1.4)], 16)
    hood = turned([(0.21, 1.3), (0.2, 1.3), (0.13, 1.58), (0.14, 1.58), (0.21, 1.3)], 24)
    return stand.of(iron) + hood.of(shade)


def desk_lamp(metal: Finish, cloth: Finish) -> Model:
    """A jointed work lamp, 45 cm high."""
    arms = tubes([(0, 0, 0.02), (-0.09, 0, 0.24), (0.12, 0, 0.44)], 0.008, 6)
    foot = cylinder(0.085, 0.02)
    hood = turned([(0.025, 0.0), (0.03, -0.05), (0.085, -0.13), (0.08, -0.13), (0.02, -0.05)], 16)
    return (arms + foot).of(metal) + hood.at(0.14, 0, 0.47).of(cloth)


def pendant(shade: Finish, flex: Finish, *, drop: float) -> Model:
    """A lampshade that hangs `drop` metres below z = 0 on its flex."""
    profile = [(0.05, 0.0), (0.07, -0.02), (0.24, -0.2), (0.235, -0.2), (0.06, -0.03), (0.05, 0.0)]
    hung = rod((0, 0, 0), (0, 0, -drop), 0.005, 6) + cylinder(0.05, 0.02).at(z=-0.02)
    return turned(profile, 24).at(z=-drop).of(shade) + hung.of(flex)


def picture(prints: Prints, frame: Finish, index: int, *, width: float = 0.6, height: float = 0.8) -> Model:
    """A framed print on a wall, its lower edge at z = 0, centred on x = 0."""
    bar, out = 0.03, -0.03
    a = width / 2
    edges = boxes(
        [(-a - bar, out, -bar), (-a - bar, out, height), (-a - bar, out, 0), (a, out, 0)],
        [(a + bar, 0, 0), (a + bar, 0, height + bar), (-a, 0, height), (a + bar, 0, height)],
    )
    return prints.on(panel(width, height).at(-a, -0.012), index) + edges.of(frame)


def door(leaf: Finish, frame: Finish, metal: Finish, plate: Prints, index: int) -> Model:
    """A door in its frame on a wall, 0.9 x 2.1 m, with panels, handle, kick plate and a name plate."""
    width, height = DOOR_LEAF_M
    a = width / 2
    frames = boxes(
        [(-a - 0.1, -0.06, 0), (a, -0.06, 0), (-a - 0.1, -0.06, height)],
        [(-a, 0, height), (a + 0.1, 0, height), (a + 0.1, 0, height + 0.1)],
    )
    slab = plank(width, 0.03, height).at(0, -0.015)
    fields = [
        plank(0.28, 0.014, tall).at(x, -0.035, z)
        for x in (-0.2, 0.2)
        for z, tall in ((0.35, 0.6), (1.1, 0.8))
    ]
    handle = tubes([(a - 0.08, -0.03, 1.02), (a - 0.08, -0.08, 1.02), (a - 0.2, -0.08, 1.02)], 0.011, 8)
    kick = boxes([(-a + 0.03, -0.034, 0.03)], [(a - 0.03, -0.03, 0.24)])
    sign = plate.on(panel(0.2, 0.26).at(a + 0.17, -0.008, 1.45), index)
    return join([slab, *fields]).of(leaf) + frames.of(frame) + (handle + kick).of(metal) + sign


def radiator(enamel: Finish, *, width: float = 1.2, height: float = 0.6) -> Model:
    """A ribbed radiator on a wall, 15 cm above the floor."""
    x = np.arange(-width / 2, width / 2 + 1e-6, 0.06)
    low = np.stack([x - 0.024, np.full_like(x, -0.15), np.full_like(x, 0.15)], axis=1)
    ribs = boxes(low, low + np.array([0.048, 0.11, height]))
    pipes = tubes([[(-width / 2, -0.1, z), (width / 2, -0.1, z)] for z in (0.19, 0.1 + height)], 0.022, 8)
    feed = rod((width / 2 + 0.05, -0.1, 0.0), (width / 2 + 0.05, -0.1, 0.2), 0.012)
    return (ribs + pipes + feed).of(enamel)


def blind(slat: Finish, cord: Finish, *, width: float, height: float, tilt_deg: float = 35.0) -> Model:
    """A venetian blind that hangs from z = 0, slats of 4 cm."""
    one = box(width, 0.04, 0.002).tipped((1, 0, 0), tilt_deg)
    slats = [one.at(z=-z) for z in np.arange(0.05, height, 0.045)]
    cords = [rod((x, 0, 0), (x, 0, -height), 0.002, 4) for x in (-0.35 * width, 0.0, 0.35 * width)]
    return join([*slats, box(width, 0.05, 0.03).at(z=-0.03)]).of(slat) + join(cords).of(cord)


def notice_board(
    cork: Finish, frame: Finish, prints: Prints, rng: np.random.Generator, *, width: float = 1.8
) -> Model:
    """A cork board full of pinned sheets, 1.1 m high."""
    height = 1.1
    board = box(width, 0.02, height).at(0, -0.01).of(cork)
    rim = boxes(
        [(-width / 2, -0.03, -0.03), (-width / 2, -0.03, height)],
        [(width / 2, 0, 0), (width / 2, 0, height + 0.03)],
    )
    sheets = []
    for k, x in enumerate(np.arange(-width / 2 + 0.16, width / 2 - 0.1, 0.27)):
        for z in (0.08, 0.58):
            sheet = (
                panel(0.21, 0.29)
                .tipped((0, 1, 0), rng.normal(0, 5))
                .at(x - 0.1, -0.022 - 0.002 * k, z + rng.uniform(0, 0.1))
            )
            sheets.append(prints.on(sheet, int(rng.integers(24))))
    return board + rim.of(frame) + together(sheets)


def lockers(enamel: Finish, metal: Finish, *, count: int = 4) -> Model:
    """Steel lockers 30 cm wide and 1.8 m high, backs at y = 0."""
    width = 0.3 * count
    body = box(width, 0.44, 1.8).at(0, -0.22)
    doors = [box(0.285, 0.015, 1.7).at(-width / 2 + 0.15 + 0.3 * k, -0.448, 0.06) for k in range(count)]
    vents, handles = [], []
    for k in range(count):
        x = -width / 2 + 0.15 + 0.3 * k
        vents += [box(0.16, 0.008, 0.012).at(x, -0.458, z) for z in (1.5, 1.54, 1.58, 1.62, 0.2, 0.24)]
        handles.append(box(0.02, 0.03, 0.12).at(x + 0.1, -0.47, 0.95))
    return join([body, *doors]).of(enamel) + join(vents + handles).of(metal)


def extinguisher(red: Finish, black: Finish) -> Model:
    """A fire extinguisher on a wall bracket, 60 cm high, its foot at z = 0."""
    body = turned([(0.0, 0.0), (0.075, 0.01), (0.075, 0.42), (0.03, 0.49), (0.02, 0.52), (0.0, 0.52)], 16)
    hose = tubes([(0.02, -0.1, 0.52), (0.12, -0.12, 0.48), (0.12, -0.12, 0.2), (0.09, -0.12, 0.08)], 0.012, 6)
    fittings = box(0.03, 0.12, 0.03).at(0, -0.12, 0.52), box(0.12, 0.03, 0.1).at(0, -0.015, 0.2)
    return body.at(0, -0.1).of(red) + join([hose, *fittings]).of(black)


def monitor(black: Finish, prints: Prints, index: int) -> Model:
    """A screen on its foot and a keyboard before it, for a desk."""
    stand = boxes([(-0.02, 0.02, 0), (-0.11, -0.08, 0)], [(0.02, 0.05, 0.2), (0.11, 0.1, 0.012)])
    case = boxes([(-0.29, 0.0, 0.12)], [(0.29, 0.02, 0.47)])
    keys = boxes([(-0.22, -0.38, 0)], [(0.22, -0.24, 0.018)])
    face = cards(
        [[(-0.275, -0.003, 0.135), (0.275, -0.003, 0.135), (0.275, -0.003, 0.455), (-0.275, -0.003, 0.455)]]
    )
    return (stand + case + keys).of(black) + prints.on(face, index)


def vase(clay: Finish, *, height: float = 0.3) -> Model:
    """A thrown vase."""
    radii = (0.0, 0.25, 0.42, 0.33, 0.16, 0.2, 0.17, 0.13)
    levels = (0.0, 0.0, 0.35, 0.7, 0.86, 1.0, 1.0, 0.86)
    profile = [(r * 0.6 * height, z * height) for r, z in zip(radii, levels, strict=True)]
    return turned(profile).of(clay)


def step_ladder(wood: Finish, metal: Finish, *, height: float = 1.7) -> Model:
    """An open step ladder, steps to the south."""
    lean = 0.28 * height
    rails = [tubes([(s * 0.23, -lean, 0.0), (s * 0.17, 0, height)], 0.018, 6) for s in (-1, 1)]
    rails += [tubes([(s * 0.25, lean, 0.0), (s * 0.17, 0, height)], 0.014, 6) for s in (-1, 1)]
    levels = np.arange(0.25, height - 0.1, 0.25)
    steps = [plank(0.42 - 0.05 * z, 0.09, 0.025).at(0, -lean * (1 - z / height), z) for z in levels]
    return join([*steps, plank(0.4, 0.22, 0.025).at(z=height)]).of(wood) + join(rails).of(metal)
