"""An institute's corridor: doors, posters, pipes and a far end wall, lit by ceiling panels.

The corridor runs along y, the camera looks down it to the north.
"""

import numpy as np

import rectbench as rb

HALF_WIDTH = 1.6
HEIGHT = 2.75
DADO_Z = 1.1
"""Tiles below, paint above."""
NEAR_Y, FAR_Y = -4.0, 21.0
LAMP_SPACING = 5.4


@rb.scene("corridor")
def corridor(seed: int) -> rb.World:
    """A long corridor with doors, posters, pipes, lockers and ceiling lamps."""
    rng = np.random.default_rng((seed, 102))
    models = [
        *surfaces(seed),
        *along_the_walls(seed, rng),
        *on_the_floor(seed, rng),
        *under_the_ceiling(seed, rng),
        *at_the_ends(seed, rng),
    ]
    place = rng.uniform(-0.50, -0.42), rng.uniform(-0.4, 0.4), rng.uniform(1.45, 1.65)
    return rb.World(
        meshes=rb.blocks.meshes(models),
        world_from_left=rb.blocks.stand(*place, yaw_deg=rng.normal(0, 2)),
        lamps=lamps(),
        exposure=1.9,
        fast_exposure=1.5,
    )


def lamps() -> tuple[rb.Lamp, ...]:
    """Panels of 60 x 180 cm let into the ceiling; few and large, which keeps path tracing clean."""
    places = np.arange(NEAR_Y + 2.4, FAR_Y - 0.5, LAMP_SPACING)
    return tuple(rb.Lamp((0.0, float(y), HEIGHT - 0.012), (0.58, 1.78), (13.0, 12.1, 10.6)) for y in places)


def on_wall(model: rb.blocks.Model, side: int, y: float, z: float = 0.0) -> rb.blocks.Model:
    """Hang a fitting on the left (-1) or right (+1) wall."""
    return model.at(side * HALF_WIDTH, y, z, turn_deg=-90.0 * side)


def painting(rng: np.random.Generator) -> int:
    """The number of a poster that is no notice: every third one is all words."""
    return int(3 * rng.integers(8) + rng.integers(2))


def surfaces(seed: int) -> list[rb.blocks.Model]:
    """Terrazzo floor, tiled dado with a rail, painted walls, fibre-board ceiling, skirting."""
    b = rb.blocks
    y, x = (NEAR_Y, FAR_Y), (-HALF_WIDTH, HALF_WIDTH)
    tiles, oak = b.glazed_tiles(seed), b.timber(seed, b.OAK)
    paints = b.wall_paint(seed, (0.60, 0.54, 0.40)), b.wall_paint(seed + 1, (0.52, 0.55, 0.46))
    models = [
        b.floor(x, y).of(b.terrazzo(seed)),
        b.floor(x, y, HEIGHT).of(b.ceiling_board(seed)),
    ]
    for side, paint in zip((-1, 1), paints, strict=True):
        at = side * HALF_WIDTH
        wall = [
            [(at, y[0], low), (at, y[1], low), (at, y[1], high), (at, y[0], high)]
            for low, high in ((0.0, DADO_Z), (DADO_Z, HEIGHT))
        ]
        rail = b.boxes(
            [min(at, at - side * 0.018), y[0], DADO_Z - 0.04],
            [max(at, at - side * 0.018), y[1], DADO_Z + 0.04],
        )
        skirt = b.boxes([min(at, at - side * 0.014), y[0], 0.0], [max(at, at - side * 0.014), y[1], 0.12])
        models += [b.quads(wall[:1]).of(tiles), b.quads(wall[1:]).of(paint), (rail + skirt).of(oak)]
    return models


def along_the_walls(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """Doors in turn with posters, notice boards, radiators, lockers and extinguishers."""
    b = rb.blocks
    leaves = [b.timber(seed + 2, b.WALNUT), b.enamel(seed, (0.07, 0.17, 0.22)), b.timber(seed + 3, b.PINE)]
    frame = b.enamel(seed + 1, (0.50, 0.49, 0.44), glossy=False)
    steel = b.enamel(seed + 2, (0.40, 0.40, 0.39), wear=0.6)
    prints, cork = b.posters(seed), b.cloth(seed, (0.30, 0.18, 0.09))
    green, red = b.enamel(seed + 3, (0.12, 0.22, 0.20)), b.enamel(seed + 4, (0.42, 0.05, 0.04))
    black, white = (
        b.enamel(seed + 5, (0.05, 0.05, 0.05)),
        b.enamel(seed + 6, (0.56, 0.55, 0.50), glossy=False),
    )
    models = []
    for side in (-1, 1):
        y = NEAR_Y + rng.uniform(0.8, 1.6)
        for k in range(9):
            leaf = leaves[int(rng.integers(3))]
            models.append(on_wall(b.door(leaf, frame, steel, prints, int(rng.integers(24))), side, y))
            models += [on_wall(sheet, side, y - 0.75, 1.25) for sheet in _pinned_sheets(prints, rng)]
            middle = y + 1.45
            match (k + (side > 0) + seed) % 4:
                case 0:
                    board = b.notice_board(cork, leaves[2], prints, rng, width=1.3)
                    models.append(on_wall(board, side, middle, 1.2))
                    models.append(on_wall(b.radiator(white, width=1.0), side, middle))
                case 1:
                    models.append(on_wall(b.lockers(green, steel, count=4), side, middle))
                case 2:
                    framed = b.picture(prints, black, painting(rng), width=0.9, height=1.2)
                    models.append(on_wall(framed, side, middle, 1.2))
                    models.append(on_wall(b.extinguisher(red, black), side, middle + 0.4, 0.3))
                case _:
                    for offset, size in ((-0.35, 0.5), (0.35, 0.42)):
                        index = painting(rng)
                        framed = b.picture(prints, leaves[0], index, width=size, height=size * 4 / 3)
                        models.append(on_wall(framed, side, middle + offset, 1.3 + rng.uniform(0, 0.15)))
            y += 2.75 + rng.uniform(0.0, 0.2)
            if y > FAR_Y - 1.0:
                break
    return models


def _pinned_sheets(prints: rb.blocks.Prints, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """Papers pinned to a wall beside a door, and one on the door itself."""
    places = ((0.02, -0.006, 0.0), (-0.25, -0.008, 0.05), (-0.1, -0.01, 0.36), (0.75, -0.055, 0.25))
    return [
        prints.on(
            rb.blocks.panel(0.21, 0.29).tipped((0, 1, 0), rng.normal(0, 3)).at(x, y, z), int(rng.integers(24))
        )
        for x, y, z in places
    ]  # fmt: skip


def on_the_floor(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """Chairs, a bench, plants, parcels, a ladder, a bicycle somebody brought in."""
    b = rb.blocks
    oak, cloth = b.timber(seed + 10, b.OAK), b.cloth(seed + 1, (0.26, 0.06, 0.05), (0.42, 0.22, 0.08))
    iron, boxes = b.enamel(seed + 10, (0.06, 0.065, 0.07)), b.parcels(seed)
    clay, soil = b.plaster(seed + 3, (0.36, 0.15, 0.08)), b.forest_floor(seed)
    palm = b.foliage(seed, (0.06, 0.17, 0.04))
    plants = [b.potted_plant(seed + k, clay, soil, palm, height=1.0 + 0.3 * k) for k in range(2)]
    models = [
        b.chair(oak, cloth).at(1.2, 3.2 + rng.uniform(-0.2, 0.2), turn_deg=rng.uniform(240, 280)),
        b.chair(oak, cloth).at(1.22, 3.95, turn_deg=rng.uniform(255, 290)),
        b.bench(oak, iron).at(-1.25, 6.2 + rng.uniform(-0.3, 0.3), turn_deg=90),
        b.bench(oak, iron).at(1.25, 12.4, turn_deg=-90),
        plants[0].at(-1.2, 2.55),
        plants[1].at(1.15, 8.3, turn_deg=70),
        plants[0].at(-1.2, 15.0, turn_deg=200),
        b.step_ladder(oak, iron).at(-1.05, 9.8, turn_deg=rng.uniform(60, 120)),
        b.bicycle(b.enamel(seed + 11, (0.36, 0.06, 0.04)), iron)
        .tipped((1, 0, 0), 8)
        .at(1.36, 5.9, turn_deg=90),
    ]
    for x, y, count in ((1.15, 10.2, 4), (-1.15, 4.3, 3), (1.2, 15.6, 4), (-1.1, -1.8, 3), (1.2, -1.4, 2)):
        z = 0.0
        for k in range(count):
            size = (rng.uniform(0.3, 0.5), rng.uniform(0.3, 0.45), rng.uniform(0.2, 0.36))
            box = b.parcel(boxes, size, int(rng.integers(16)))
            models.append(
                box.at(x + 0.05 * rng.normal(), y + 0.05 * rng.normal(), z, turn_deg=rng.normal(0, 12))
            )
            z += size[2]
            if k == 1:
                z, y = 0.0, y + 0.6
    return models


def under_the_ceiling(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """Painted pipes with flanges, a cable tray, hanging signs."""
    b = rb.blocks
    red, blue = b.enamel(seed + 20, (0.38, 0.07, 0.05)), b.enamel(seed + 21, (0.09, 0.20, 0.32))
    steel = b.enamel(seed + 22, (0.42, 0.42, 0.40), wear=1.5)
    copper = b.enamel(seed + 23, (0.42, 0.19, 0.10), wear=1.5)
    models = []
    for x, z, radius, finish in (
        (-1.45, 2.6, 0.06, red),
        (-1.28, 2.63, 0.045, copper),
        (1.42, 2.58, 0.075, blue),
        (1.2, 2.66, 0.03, steel),
    ):
        models.append(b.rod((x, NEAR_Y, z), (x, FAR_Y, z), radius, 14).of(finish))
        collars = [
            b.rod((x, y, z), (x, y + 0.06, z), 1.35 * radius, 14)
            for y in np.arange(NEAR_Y + rng.uniform(0.2, 1), FAR_Y, 1.9)
        ]
        models.append(b.join(collars).of(steel))
    rungs = [b.box(0.3, 0.025, 0.012).at(-0.95, y, 2.62) for y in np.arange(NEAR_Y, FAR_Y, 0.3)]
    edges = [b.boxes([x, NEAR_Y, 2.6], [x + 0.012, FAR_Y, 2.66]) for x in (-1.11, -0.80)]
    models.append(b.join(rungs + edges).of(steel))
    cables = [
        b.cable((x, y, 2.65), (x, y + 5.0, 2.65), -0.01, 0.012)
        for x in np.arange(-1.06, -0.84, 0.05) for y in np.arange(NEAR_Y, FAR_Y, 5.0)
    ]  # fmt: skip
    models += [b.join(cables[0::2]).of(red), b.join(cables[1::2]).of(blue)]
    prints = b.posters(seed + 1)
    for y in (5.5, 11.5, 17.0):
        sign = b.panel(0.7, 0.3).at(-0.35, y, 2.2)
        wires = b.join(b.rod((x, y, 2.5), (x, y, HEIGHT), 0.004, 4) for x in (-0.3, 0.3))
        models += [prints.on(sign, 2 + 3 * int(rng.integers(8))), wires.of(steel)]
    return models


def at_the_ends(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """Brick end walls: a double door under a clock in front, a door and a painting behind."""
    b = rb.blocks
    wall = b.brick(seed, b.YELLOW_BRICK, rows=64, columns=32)
    red, frame = b.enamel(seed + 30, (0.34, 0.06, 0.05)), b.timber(seed + 6, b.WALNUT)
    steel, prints = b.enamel(seed + 31, (0.40, 0.40, 0.39)), b.posters(seed)
    a = HALF_WIDTH
    ends = [[(-a, y, 0), (a, y, 0), (a, y, HEIGHT), (-a, y, HEIGHT)] for y in (NEAR_Y, FAR_Y)]
    clock = b.cylinder(0.16, 0.05, 32).tipped((1, 0, 0), 90).at(0, FAR_Y, 2.42)
    hands = b.boxes(
        [(-0.006, FAR_Y - 0.06, 2.42), (0.0, FAR_Y - 0.06, 2.414)],
        [(0.006, FAR_Y - 0.05, 2.55), (0.09, FAR_Y - 0.05, 2.426)],
    )
    far = [b.door(red, frame, steel, prints, int(rng.integers(24))).at(x, FAR_Y) for x in (-0.46, 0.46)]
    near = [
        b.door(red, frame, steel, prints, int(rng.integers(24))).at(0.6, NEAR_Y, turn_deg=180),
        b.picture(prints, frame, painting(rng), width=0.9, height=1.2).at(-0.8, NEAR_Y, 1.0, turn_deg=180),
    ]
    clock_face = b.plaster(seed, (0.62, 0.60, 0.54))
    return [b.quads(ends).of(wall), clock.of(clock_face), hands.of(steel), *far, *near]
