"""A lived-in room: books, table, sofa, desk, plants, blinds before a garden, cables and bunting.

The camera stands near the south wall and looks north over the room.
"""

import numpy as np

import rectbench as rb

WEST, EAST, SOUTH, NORTH = -3.6, 3.6, -2.4, 5.0
HEIGHT = 2.8
NORTH_WINDOW = (0.7, 2.9, 0.95, 2.35)
WEST_WINDOW = (-1.0, 1.0, 0.95, 2.35)
"""Left, right, bottom, top in metres, along the wall from its middle."""


@rb.scene("room")
def room(seed: int) -> rb.World:
    """A cluttered room with fine structure: chair legs, slats, leaves, cables, rows of books."""
    rng = np.random.default_rng((seed, 103))
    models = [
        *walls(seed),
        *library(seed, rng),
        *dining_corner(seed, rng),
        *sofa_corner(seed, rng),
        *desk_corner(seed, rng),
        *hangings(seed, rng),
        *odds_and_ends(seed, rng),
        *garden(seed),
    ]
    place = rng.uniform(-0.6, -0.3), rng.uniform(-0.9, -0.6), rng.uniform(1.45, 1.65)
    return rb.World(
        meshes=rb.blocks.meshes(models),
        world_from_left=rb.blocks.stand(*place, yaw_deg=rng.normal(0, 3), pitch_deg=-4),
        lamps=(
            rb.Lamp((-1.5, 0.3, HEIGHT - 0.02), (0.9, 0.4), (26.0, 24.0, 20.5)),
            rb.Lamp((-1.4, 3.6, HEIGHT - 0.02), (0.9, 0.4), (26.0, 24.0, 20.5)),
            rb.Lamp((2.0, -0.6, HEIGHT - 0.02), (0.9, 0.4), (26.0, 24.0, 20.5)),
            rb.Lamp((1.6, 2.5, 1.72), (0.26, 0.26), (22.0, 19.0, 14.0)),
        ),
        ambient=(0.42, 0.44, 0.46),
        exposure=2.6,
        fast_exposure=2.1,
    )


def choice(seed: int, colours: list[tuple[float, float, float]]) -> tuple[float, float, float]:
    """One of the colours, another with every seed."""
    return colours[seed % len(colours)]


def walls(seed: int) -> list[rb.blocks.Model]:
    """Boards, papered and painted walls with two windows, beams under a plastered ceiling."""
    b = rb.blocks
    width, depth = EAST - WEST, NORTH - SOUTH
    middle = (NORTH + SOUTH) / 2
    white = b.enamel(seed, (0.58, 0.57, 0.52), glossy=False, wear=0.6)
    walnut, stone = b.timber(seed, b.WALNUT), b.concrete(seed)
    print_ = choice(seed, [(0.22, 0.09, 0.06), (0.07, 0.12, 0.20), (0.26, 0.17, 0.04)])
    paint = choice(seed, [(0.56, 0.49, 0.35), (0.42, 0.50, 0.46), (0.52, 0.36, 0.26)])
    ceiling = b.floor((WEST - 0.4, EAST + 0.4), (SOUTH - 0.4, NORTH + 0.4), HEIGHT)
    north, west = b.Opening(*NORTH_WINDOW), b.Opening(*WEST_WINDOW)
    beams = [b.plank(width, 0.16, 0.17).at(0, y, HEIGHT - 0.17) for y in np.arange(SOUTH + 0.6, NORTH, 1.5)]
    skirts = b.boxes(
        [(WEST, NORTH - 0.02, 0), (WEST, SOUTH, 0), (EAST - 0.02, SOUTH, 0), (WEST, SOUTH, 0)],
        [(EAST, NORTH, 0.13), (WEST + 0.02, NORTH, 0.13), (EAST, NORTH, 0.13), (EAST, SOUTH + 0.02, 0.13)],
    )
    plain = b.quads([
        [(EAST, SOUTH, 0), (EAST, NORTH, 0), (EAST, NORTH, HEIGHT), (EAST, SOUTH, HEIGHT)],
        [(WEST, SOUTH, 0), (EAST, SOUTH, 0), (EAST, SOUTH, HEIGHT), (WEST, SOUTH, HEIGHT)],
    ])  # fmt: skip
    wall_west = b.pierced_wall(depth, HEIGHT, [west])
    glazing = [_casement(o, white, stone) for o in (north, west)]
    return [
        b.floor((WEST, EAST), (SOUTH, NORTH)).of(b.floorboards(seed)),
        ceiling.of(b.plaster(seed, (0.72, 0.69, 0.62))),
        b.pierced_wall(width, HEIGHT, [north]).of(b.wallpaper(seed)).at(0, NORTH),
        wall_west.at(WEST, middle, turn_deg=90).of(b.wallpaper(seed + 1, (0.46, 0.36, 0.26), print_)),
        plain.of(b.wall_paint(seed, paint)),
        b.join(beams).of(walnut),
        skirts.of(white),
        glazing[0].at(0, NORTH),
        glazing[1].at(WEST, middle, turn_deg=90),
    ]


def _casement(o: rb.blocks.Opening, frame: rb.blocks.Finish, stone: rb.blocks.Finish) -> rb.blocks.Model:
    """An unglazed window frame with glazing bars, a sill and a half-drawn blind."""
    b = rb.blocks
    x = np.linspace(o.left, o.right, 4)
    uprights = [b.boxes([k - 0.025, 0.08, o.bottom], [k + 0.025, 0.13, o.top]) for k in x]
    across = [
        b.boxes([o.left, 0.08, z - 0.025], [o.right, 0.13, z + 0.025])
        for z in (o.bottom + 0.02, o.bottom + 0.95, o.top - 0.02)
    ]
    sill = b.boxes([o.left - 0.1, -0.12, o.bottom - 0.04], [o.right + 0.1, 0.2, o.bottom])
    blind = b.blind(frame, stone, width=o.right - o.left - 0.06, height=0.62).at(
        (o.left + o.right) / 2, 0.04, o.top
    )
    return b.join([*uprights, *across]).of(frame) + sill.of(stone) + blind


def library(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """Bookcases along the north wall and one behind the camera."""
    b = rb.blocks
    wood, spines, parcels = b.timber(seed + 1, b.OAK), b.book_spines(seed), b.parcels(seed)
    brass, clay = b.enamel(seed + 1, (0.44, 0.30, 0.10)), b.enamel(seed + 2, (0.10, 0.20, 0.26))
    cases = [b.bookcase(rng, wood, spines, parcels).at(x, NORTH - 0.02) for x in (-3.05, -2.02, -0.99)]
    low = b.bookcase(rng, wood, spines, parcels, width=1.2, shelves=2).at(0.12, NORTH - 0.02)
    return [
        *cases,
        low,
        b.vase(clay, height=0.34).at(-0.05, NORTH - 0.18, 0.84),
        b.books(rng, spines, length=0.35).at(0.38, NORTH - 0.24, 0.85),
        b.bookcase(rng, wood, spines, parcels, width=1.2, shelves=5).at(-2.6, SOUTH + 0.02, turn_deg=180),
        b.cabinet(wood, brass).at(1.2, SOUTH + 0.02, turn_deg=180),
        b.vase(clay, height=0.26).at(1.0, SOUTH + 0.25, 0.83),
    ]


def dining_corner(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """A laid table with four chairs under a pendant lamp, a radiator under the window."""
    b = rb.blocks
    wood, seat = b.timber(seed + 2, b.PINE), b.cloth(seed, (0.09, 0.17, 0.24), (0.36, 0.32, 0.20))
    white, red = b.enamel(seed + 4, (0.60, 0.58, 0.53)), b.enamel(seed + 5, (0.40, 0.07, 0.05))
    x, y = 1.6 + rng.uniform(-0.15, 0.15), rng.uniform(2.35, 2.7)
    seats = [(-0.42, -0.72, 180), (0.42, -0.70, 180), (-0.42, 0.72, 0), (0.45, 0.70, 0)]
    chairs = [
        b.chair(wood, seat).at(
            x + dx + rng.normal(0, 0.04), y + dy + rng.normal(0, 0.04), turn_deg=turn + rng.normal(0, 14)
        )
        for dx, dy, turn in seats
    ]
    plates = [
        b.turned([(0.0, 0.012), (0.08, 0.012), (0.125, 0.028), (0.08, 0.006), (0.0, 0.0)]).at(
            x + dx, y + 0.42 * dy, b.TABLE_M
        )
        for dx, dy, _ in seats
    ]
    cups = [b.vase(red, height=0.1).at(x + dx + 0.17, y + 0.35 * dy, b.TABLE_M) for dx, dy, _ in seats]
    leaves = b.posy(seed, b.foliage(seed + 4, (0.12, 0.20, 0.05)), height=0.3)
    return [
        b.table(wood, width=1.7).at(x, y),
        *chairs,
        b.join(plates).of(white),
        *cups,
        b.vase(white, height=0.22).at(x - 0.02, y, b.TABLE_M),
        leaves.at(x - 0.02, y, b.TABLE_M + 0.2),
        b.books(rng, b.book_spines(seed + 1), length=0.22, height=0.26).at(
            x + 0.62, y, b.TABLE_M, turn_deg=30
        ),
        b.pendant(red, b.enamel(seed + 6, (0.05, 0.05, 0.05)), drop=0.9).at(1.6, 2.5, HEIGHT),
        b.radiator(white, width=1.5).at(1.9, NORTH),
    ]


def sofa_corner(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """Sofa under the west window, rug, low table with books, standard lamp, palm."""
    b = rb.blocks
    fabric = b.cloth(seed + 1, choice(seed, [(0.30, 0.12, 0.055), (0.07, 0.16, 0.15), (0.30, 0.20, 0.06)]))
    cushion, oak = b.cloth(seed + 2, (0.10, 0.20, 0.20), (0.42, 0.36, 0.20)), b.timber(seed + 3, b.OAK)
    iron, shade = b.enamel(seed + 7, (0.06, 0.055, 0.05)), b.cloth(seed + 3, (0.56, 0.47, 0.32))
    clay, soil = b.plaster(seed + 1, (0.36, 0.15, 0.08)), b.forest_floor(seed)
    palm = b.foliage(seed + 2, (0.06, 0.18, 0.045))
    rug = b.cards([[(-2.0, 0.35, 0.012), (0.55, 0.35, 0.012), (0.55, 2.1, 0.012), (-2.0, 2.1, 0.012)]])
    return [
        b.sofa(fabric, cushion, oak).at(-3.0, rng.uniform(1.2, 1.7), turn_deg=90),
        rug.of(b.rug(seed, choice(seed, [(0.33, 0.075, 0.06), (0.08, 0.14, 0.26), (0.30, 0.17, 0.05)]))),
        b.table(oak, width=0.95, depth=0.55, height=0.42).at(
            -1.45 + rng.uniform(-0.1, 0.1), 1.55, turn_deg=90 + rng.normal(0, 5)
        ),
        b.books(rng, b.book_spines(seed + 2), length=0.25, height=0.24).at(-1.45, 1.7, 0.42, turn_deg=50),
        b.floor_lamp(iron, shade).at(-3.2, 3.15),
        b.potted_plant(seed, clay, soil, palm, height=1.45, count=34).at(rng.uniform(-2.7, -2.0), 3.55),
        b.potted_plant(seed + 1, clay, soil, palm, height=0.9).at(-3.1, -0.35),
        b.potted_plant(seed + 2, clay, soil, palm, height=0.5).at(0.95, NORTH + 0.02, 0.95),
    ]


def desk_corner(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """A desk on the east wall with screen, lamp, papers, and the cables that hang off it."""
    b = rb.blocks
    wood, black = b.timber(seed + 4, b.WALNUT), b.enamel(seed + 8, (0.05, 0.05, 0.055), wear=0.5)
    brass, prints = b.enamel(seed + 9, (0.46, 0.32, 0.11)), b.posters(seed + 2)
    seat = b.cloth(seed + 4, (0.10, 0.10, 0.11))
    x, y, top = EAST - 0.4, 0.5 + rng.uniform(-0.15, 0.15), 0.74
    papers = [
        prints.on(b.cards([[(-0.1, -0.14, 0), (0.1, -0.14, 0), (0.1, 0.14, 0), (-0.1, 0.14, 0)]]), 2 + 3 * k)
        .at(x - 0.18 + 0.05 * k, y - 0.45 + 0.07 * k, top + 0.003 + 0.003 * k, turn_deg=rng.uniform(0, 360))
        for k in range(4)
    ]  # fmt: skip
    cables = [
        b.cable((x + 0.3, y + 0.1 * k, top), (x + 0.35, y + 0.7 + 0.25 * k, 0.05), 0.25 + 0.08 * k, 0.005)
        for k in range(4)
    ]
    return [
        b.table(wood, width=1.5, depth=0.7).at(x, y, turn_deg=-90),
        b.monitor(black, prints, int(rng.integers(24))).at(x + 0.1, y, top, turn_deg=-90),
        b.desk_lamp(brass, brass).at(x + 0.15, y + 0.55, top, turn_deg=200),
        b.chair(wood, seat).at(x - 0.62, y - 0.1, turn_deg=90 + rng.normal(0, 12)),
        *papers,
        b.join(cables).of(black),
        b.books(rng, b.book_spines(seed), length=0.4).at(x + 0.12, y - 0.52, top, turn_deg=-90),
    ]


def hangings(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """Pictures on the walls, a string of bunting across the room, a clothes line of cables."""
    b = rb.blocks
    prints, frame = b.posters(seed), b.timber(seed + 5, b.WALNUT)
    east = []
    for y, z, w in (
        (2.0, 1.2, 0.62),
        (2.95, 1.35, 0.48),
        (3.75, 1.15, 0.66),
        (-0.55, 1.35, 0.5),
        (-1.5, 1.2, 0.62),
    ):
        framed = b.picture(prints, frame, int(rng.integers(24)), width=w, height=w * 4 / 3)
        east.append(framed.at(EAST, y, z, turn_deg=-90))
    south = [
        b.picture(prints, frame, int(rng.integers(24))).at(x, SOUTH, 1.2, turn_deg=180) for x in (-1.3, 0.9)
    ]
    west = [
        b.picture(prints, frame, int(rng.integers(24)), width=0.5, height=0.66).at(WEST, y, 1.3, turn_deg=90)
        for y in (3.2, -1.2)
    ]
    line = b.enamel(seed + 11, (0.30, 0.26, 0.20), glossy=False)
    colours = [(0.40, 0.08, 0.06), (0.10, 0.20, 0.30), (0.46, 0.33, 0.10)]
    flags = [b.cloth(seed + 5 + k, colour) for k, colour in enumerate(colours)]
    bunting = []
    for start, end in (((WEST, 4.2, 2.5), (EAST, 2.2, 2.5)), ((WEST, -0.2, 2.5), (EAST, 4.4, 2.55))):
        bunting.append(b.cable(start, end, 0.22, 0.003).of(line))
        for k, t in enumerate(np.linspace(0.04, 0.96, 21)):
            straight = np.asarray(start) + t * (np.asarray(end) - np.asarray(start))
            x, y, z = straight - [0, 0, 0.88 * t * (1 - t)]
            tip = (x, y + rng.normal(0, 0.02), z - 0.2)
            flag = b.quads([[(x - 0.09, y, z), tip, tip, (x + 0.09, y, z)]])
            bunting.append(flag.of(flags[k % 3]))
    return [*east, *south, *west, *bunting]


def odds_and_ends(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """Parcels, a ladder, a stool, a bicycle against the wall, a door, flex on the floor."""
    b = rb.blocks
    boxes, wood = b.parcels(seed), b.timber(seed + 6, b.PINE)
    steel = b.enamel(seed + 12, (0.38, 0.38, 0.37))
    tyre = b.enamel(seed + 13, (0.05, 0.05, 0.05), glossy=False)
    door = b.door(b.timber(seed + 7, b.OAK), wood, steel, b.posters(seed), int(rng.integers(24)))
    models = [
        b.step_ladder(wood, steel).at(2.9, 4.2, turn_deg=30),
        b.stool(wood).at(0.55, 3.6),
        b.stool(wood).at(-2.3, -0.8),
        door.at(2.7, SOUTH, turn_deg=180),
        b.cable((-3.2, 3.0, 0.02), (-0.2, 3.3, 0.02), 0.0, 0.006).of(tyre),
    ]
    for x, y, count in ((3.1, -0.9, 3), (2.55, -1.3, 2), (-1.0, 3.5, 2), (-3.2, -1.5, 3)):
        z = 0.0
        for _ in range(count):
            size = (rng.uniform(0.3, 0.48), rng.uniform(0.3, 0.42), rng.uniform(0.18, 0.34))
            parcel = b.parcel(boxes, size, int(rng.integers(16)))
            models.append(parcel.at(x, y, z, turn_deg=rng.normal(0, 14)))
            z += size[2]
    return models


def garden(seed: int) -> list[rb.blocks.Model]:
    """What the windows show: grass, hedges, apple trees, a brick wall around it."""
    b = rb.blocks
    bark, leaves = b.bark(seed), b.foliage(seed, (0.22, 0.34, 0.09))
    hedge = b.hedge(seed, bark, leaves, height=1.9)
    hedges = [b.placement(x, NORTH + 6, -0.3) for x in np.arange(-3, 8, 2.0)]
    hedges += [b.placement(WEST - 5, y, -0.3, turn_deg=90) for y in np.arange(-3, 8, 2.0)]
    apples = [
        b.placement(2.6, NORTH + 4.2, -0.3),
        b.placement(WEST - 3.5, 1.2, -0.3, 80),
        b.placement(0.5, NORTH + 5, -0.3, 30, 1.2),
    ]
    return [
        b.floor((WEST - 8, EAST + 8), (SOUTH - 1, NORTH + 8), -0.3).of(b.lawn(seed)),
        b.boxes(
            [(WEST - 8, NORTH + 7.7, -0.3), (WEST - 8, SOUTH - 1, -0.3)],
            [(EAST + 8, NORTH + 8, 1.9), (WEST - 7.7, NORTH + 8, 1.9)],
        ).of(b.brick(seed, rows=64, columns=32)),
        b.copies(hedge, hedges),
        b.copies(b.broadleaf(seed, bark, leaves, height=4.5, detail=0.3), apples),
    ]
