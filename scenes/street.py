"""A street of brick houses under a clear sky: the setting of the local-homography paper.

x runs along the street, the front of the main house faces the camera from across the road.
"""

import numpy as np

import rectbench as rb

KERB_Y = (0.9, 7.0)
"""The road lies between these, metres; pavements on both sides."""
PAVEMENT_Z = 0.12
ROAD_END_X = 160.0
RED_BRICKS = (rb.blocks.RED_BRICK, (0.40, 0.17, 0.085), (0.31, 0.095, 0.06))
BACK_ROW_Y = -6.0
"""Front of the houses behind the camera."""


@rb.scene("street")
def street(seed: int) -> rb.World:
    """A brick house across a street, with neighbours, trees, parked cars and a sky."""
    rng = np.random.default_rng((seed, 101))
    front_y = rng.uniform(9.6, 11.2)
    models = [
        *ground(seed, front_y),
        *houses(seed, rng, front_y),
        *street_furniture(seed, rng, front_y),
        *parked_cars(seed, rng),
        *trees(seed, rng, front_y),
    ]
    place = rng.uniform(-1.0, 0.6), rng.uniform(-0.2, 0.3), PAVEMENT_Z + rng.uniform(1.5, 1.7)
    return rb.World(
        meshes=rb.blocks.meshes(models),
        world_from_left=rb.blocks.stand(*place, yaw_deg=rng.normal(0, 2.5)),
        sun=rb.Sun((rng.uniform(-0.75, -0.35), rng.uniform(-0.55, -0.38), 0.75), turbidity=3.0),
        exposure=3.7,
        fast_exposure=0.6,
    )


def ground(seed: int, front_y: float) -> list[rb.blocks.Model]:
    """Lawn to the horizon, the road with its markings, pavements with kerbs."""
    b = rb.blocks
    asphalt, paving, stone = b.asphalt(seed), b.paving(seed), b.concrete(seed + 1, (0.42, 0.40, 0.37))
    paint = b.plaster(seed + 5, (0.62, 0.61, 0.56))
    x = (-ROAD_END_X, ROAD_END_X)
    dashes = [b.floor((k, k + 2.0), (3.88, 4.02), 0.004) for k in np.arange(-80.0, 80.0, 5.0)]
    lines = [b.floor(x, (y, y + 0.1), 0.004) for y in (KERB_Y[0] + 0.25, KERB_Y[1] - 0.35)]
    kerbs = [
        b.boxes([k, y, -0.1], [k + 0.99, y + 0.16, PAVEMENT_Z + 0.01])
        for y in (KERB_Y[0] - 0.16, KERB_Y[1])
        for k in np.arange(-45.0, 45.0)
    ]
    covers = [b.cylinder(0.32, 0.006).at(cx, cy) for cx, cy in ((-3.2, 2.6), (4.5, 5.2), (11.0, 3.0))]
    repairs = [
        b.floor((c, c + w), (y, y + d), 0.002)
        for c, w, y, d in ((-6, 2.4, 4.3, 1.1), (2.2, 1.3, 1.5, 0.9), (7, 4, 2.2, 0.8))
    ]
    return [
        b.floor((-2500, 2500), (-2500, 2500), -0.06).of(b.lawn(seed)),
        b.floor(x, KERB_Y).of(asphalt),
        b.join(repairs).of(b.asphalt(seed + 1)),
        b.floor(x, (BACK_ROW_Y + 2.2, KERB_Y[0]), PAVEMENT_Z).of(paving),
        b.floor(x, (KERB_Y[1], front_y), PAVEMENT_Z).of(paving),
        b.join(dashes + lines).of(paint),
        *(kerb.of(stone) for kerb in kerbs),
        b.join(covers).of(b.enamel(seed + 2, (0.16, 0.14, 0.12), glossy=False)),
    ]


def houses(seed: int, rng: np.random.Generator, front_y: float) -> list[rb.blocks.Model]:
    """The red main house, its neighbours, and a row on the near side of the street."""
    b = rb.blocks
    trim = b.enamel(seed + 10, (0.62, 0.60, 0.54), glossy=False, wear=0.7)
    stone = b.concrete(seed, (0.47, 0.44, 0.38))
    panes = b.window_panes(seed)
    roofs = [b.roof_tiles(seed), b.roof_tiles(seed + 1, (0.13, 0.125, 0.13))]
    colours = [(0.05, 0.16, 0.11), (0.30, 0.05, 0.045), (0.06, 0.11, 0.25)]
    doors = [b.enamel(seed + k, colour) for k, colour in enumerate(colours)]
    walls = [
        b.brick(seed, RED_BRICKS[seed % len(RED_BRICKS)]),
        b.brick(seed + 1, b.YELLOW_BRICK, rows=64, columns=32),
        b.plaster(seed, (0.58, 0.47, 0.32)),
        b.brick(seed + 2, b.BROWN_BRICK, rows=64, columns=32),
        b.plaster(seed + 1, (0.36, 0.44, 0.46)),
    ]

    def dressed(wall: int) -> rb.blocks.HouseFinishes:
        roof, door = roofs[int(rng.integers(2))], doors[int(rng.integers(3))]
        return b.HouseFinishes(walls[wall], trim, stone, roof, door, panes)

    def row(first: int, start_x: float, step: int) -> list[rb.blocks.Model]:
        built, x = [], start_x
        for k in range(4):
            width = rng.uniform(8.5, 12.5)
            model = b.house(rng, dressed(1 + (first + k) % 4), width=width, storeys=int(rng.integers(2, 4)))
            built.append(model.at(x + step * width / 2, rng.uniform(0.0, 0.8)))
            x += step * (width + (rng.uniform(1.8, 4.0) if k % 2 else 0.02))
        return built

    half = rng.uniform(6.6, 7.6)
    main = b.house(rng, dressed(0), width=2 * half, storeys=3)
    shift = int(rng.integers(4))
    east = row(shift, half + rng.uniform(0.05, 2.5), 1)
    across = [main, *east, *row(shift + 2, -half - rng.uniform(0.05, 2.5), -1)]
    behind = [*row(shift + 1, rng.uniform(-3, 3), 1), *row(shift + 3, -4.5, -1)]
    return [
        *(model.at(0, front_y, PAVEMENT_Z) for model in across),
        *(model.at(0, BACK_ROW_Y, PAVEMENT_Z, turn_deg=180) for model in behind),
    ]


def street_furniture(seed: int, rng: np.random.Generator, front_y: float) -> list[rb.blocks.Model]:
    """Lamp posts, benches, bins, bollards, a letter box, bicycles, railings, parcels at a door."""
    b = rb.blocks
    iron = b.enamel(seed + 20, (0.055, 0.065, 0.06), glossy=False)
    wood, glass = b.timber(seed, b.OAK), b.enamel(seed + 21, (0.66, 0.62, 0.50))
    red, green = b.enamel(seed + 22, (0.42, 0.045, 0.035)), b.enamel(seed + 23, (0.05, 0.17, 0.10))
    tyre, boxes = b.enamel(seed + 24, (0.045, 0.045, 0.045), glossy=False), b.parcels(seed)
    z, wall_y = PAVEMENT_Z, front_y - 0.55
    things = [
        b.lamp_post(iron, glass).at(x, KERB_Y[1] + 0.55, z)
        for x in (-17.0, rng.uniform(-4.6, -3.4), 10.5, 24.0)
    ]
    things += [b.lamp_post(iron, glass).at(x, KERB_Y[0] - 0.5, z) for x in (-11.0, 5.0, 18.0)]
    things += [b.bench(wood, iron).at(x, wall_y + 0.1, z) for x in (rng.uniform(0.6, 2.4), -9.3)]
    things += [b.bench(wood, iron).at(3.4, -0.9, z, turn_deg=180 + rng.normal(0, 8))]
    things += [b.bollard(iron).at(x, KERB_Y[1] + 0.4, z) for x in np.arange(-1.8, 3.6, 1.3)]
    things += [
        b.litter_bin(wood, iron).at(4.4, wall_y, z),
        b.litter_bin(wood, iron).at(-3.6, -1.3, z),
        b.pillar_box(red, iron).at(rng.uniform(5.6, 6.6), KERB_Y[1] + 0.6, z),
        b.bicycle(red, tyre).tipped((1, 0, 0), -7).at(-2.3, wall_y + 0.38, z),
        b.bicycle(green, tyre).tipped((1, 0, 0), -6).at(8.3, wall_y + 0.35, z, turn_deg=180),
        b.railing(iron, length=7.8).at(12.5, front_y - 0.9, z),
        b.railing(iron, length=7.8).at(-13.0, front_y - 0.9, z),
        b.railing(iron, length=11.7).at(-8.0, -3.2, z),
    ]
    for _ in range(9):
        width, depth, height = rng.uniform(0.25, 0.6, 3)
        x, y = rng.choice([-5.6, 6.9, 9.5, -10.8]) + rng.uniform(-0.8, 0.8), wall_y + rng.uniform(-0.3, 0.2)
        parcel = b.parcel(boxes, (width, depth, height), int(rng.integers(16)))
        things.append(parcel.at(x, y, z, turn_deg=rng.uniform(-30, 30)))
    return things


def parked_cars(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """Cars along both kerbs, with a gap before the main door."""
    b = rb.blocks
    colours = [
        (0.32, 0.035, 0.03), (0.045, 0.11, 0.24), (0.50, 0.49, 0.46), (0.07, 0.16, 0.10), (0.52, 0.38, 0.10),
    ]  # fmt: skip
    paints = [b.enamel(seed + 30 + k, colours[k], wear=0.35) for k in rng.permutation(5)]
    glass, trim = b.enamel(seed + 36, (0.06, 0.075, 0.085), wear=0.4), b.enamel(seed + 37, (0.42, 0.42, 0.41))
    tyre = b.enamel(seed + 38, (0.04, 0.04, 0.042), glossy=False)
    places = [
        (-7.4, 6.0), (7.2, 6.0), (12.6, 6.05), (-12.9, 5.95), (-18.4, 6.0), (19.5, 6.0),
        (9.6, 1.95), (-9.4, 1.95), (15.2, 1.9), (-16.0, 1.95),
    ]  # fmt: skip
    return [
        b.car(paints[k % 5], glass, tyre, trim).at(
            x + rng.uniform(-0.5, 0.5), y, turn_deg=rng.normal(0, 1) + 180 * (y > 4)
        )
        for k, (x, y) in enumerate(places)
    ]


def trees(seed: int, rng: np.random.Generator, front_y: float) -> list[rb.blocks.Model]:
    """Limes along the pavements, gardens behind the houses, a wood on the horizon, tufts at the kerbs."""
    b = rb.blocks
    bark, leaves = b.bark(seed), [b.foliage(seed), b.foliage(seed + 1, (0.15, 0.20, 0.03))]
    limes = [b.broadleaf(seed + k, bark, leaves[k], height=(6.8, 7.4)[k]) for k in range(2)]
    pavement = [(-5.6, 7.9), (5.0, 7.85), (15.8, 8.0), (-14.8, 7.9), (-7.4, -1.2), (9.4, -1.6)]
    near = [(x + rng.uniform(-1.2, 1.2), y, PAVEMENT_Z) for x, y in pavement]
    far = [
        (x, y, PAVEMENT_Z)
        for x, y in ((27, 8), (-26, 8), (-20, -1.3), (22, -1.4), (38, 8), (-38, 8), (36, -1.4))
    ]
    far += [
        (rng.uniform(-60, 60), side, 0.0) for side in (front_y + 13, front_y + 18, -22, -27) for _ in range(6)
    ]
    angle, away = rng.uniform(0, 2 * np.pi, 190), rng.uniform(75, 170, 190)
    horizon = np.stack([away * np.cos(angle), away * np.sin(angle), np.full(190, -0.1)], axis=1)
    horizon = horizon[np.abs(horizon[:, 1] - 3.0) > 9.0]
    middling = b.broadleaf(seed + 2, bark, leaves[0], height=7.5, detail=0.12)
    distant = b.broadleaf(seed + 3, bark, leaves[1], height=9.0, detail=0.02)
    edge_y = rng.choice([KERB_Y[1] + 0.2, front_y - 0.1, -3.3], 90)
    tufts = np.column_stack([rng.uniform(-14, 14, 90), edge_y, np.full(90, PAVEMENT_Z)])
    return [
        *(b.copies(lime, b.scattered(rng, near[k::2], (0.85, 1.15))) for k, lime in enumerate(limes)),
        b.copies(middling, b.scattered(rng, far)),
        b.copies(distant, b.scattered(rng, horizon)),
        b.copies(b.grass_tuft(seed, leaves[0], height=0.12, radius=0.08, count=25), b.scattered(rng, tufts)),
    ]
