"""A park wood: trunks, twigs, ferns and grass before one another, a path, a fence, a clearing.

The path leads north from the camera. Thin things at every distance make this the scene for
occlusion.
"""

import numpy as np

import rectbench as rb

PATH_HALF_WIDTH = 0.9
CLEARING_M = 3.4
"""No trunk stands closer to the camera."""
BUILT = np.array([
    (-1.9, 5.2), (-1.75, 6.9), (2.6, 4.0), (2.2, 4.6), (2.8, 7.7), (3.3, 10.5), (4.2, 13.5), (-8, 4), (-5, 5),
])  # fmt: skip
"""Where bench, bin, sign and fences stand, metres: nothing grows within `BUILT_MARGIN_M` of them."""
BUILT_MARGIN_M = 1.4


def path_x(y: np.ndarray) -> np.ndarray:
    """Where the middle of the path is, metres."""
    return 1.7 * np.sin(y / 9.0) + 0.02 * y


@rb.scene("forest")
def forest(seed: int) -> rb.World:
    """A park wood with birches, limes and spruces, ferns, grass, logs, a fence and a path."""
    rng = np.random.default_rng((seed, 104))
    return rb.World(
        meshes=rb.blocks.meshes(
            [*ground(seed), *built_things(seed, rng), *wood(seed, rng), *undergrowth(seed, rng)]
        ),
        world_from_left=rb.blocks.stand(
            rng.uniform(-0.5, 0.1), rng.uniform(-0.4, 0.4), rng.uniform(1.5, 1.7), yaw_deg=rng.normal(0, 3)
        ),
        sun=rb.Sun((rng.uniform(-0.7, -0.3), rng.uniform(-0.7, -0.3), 0.75), turbidity=3.5),
        exposure=4.0,
        fast_exposure=0.75,
    )


def height(x: np.ndarray, y: np.ndarray, seed: int) -> np.ndarray:
    """The lie of the land, metres: level at the camera and along the path, rolling elsewhere."""
    phase = 1.7 * seed
    hills = np.sin(x / 7.0 + phase) * np.cos(y / 9.0 - phase) + 0.5 * np.sin(x / 3.1 - y / 4.3 + phase)
    flat = np.clip((np.abs(x - path_x(y)) - 1.5) / 6.0, 0.0, 1.0)
    return 0.45 * hills * flat


def on_ground(x: np.ndarray, y: np.ndarray, seed: int, sink: float = 0.0) -> np.ndarray:
    """Places [K, 3] on the terrain."""
    return np.stack([x, y, height(x, y, seed) - sink], axis=1)


def ground(seed: int) -> list[rb.blocks.Model]:
    """Leaf litter near, grass to the horizon, and the path."""
    b = rb.blocks
    x, y = np.linspace(-45, 45, 121), np.linspace(-45, 60, 141)
    grid_x, grid_y = np.meshgrid(x, y)
    along = np.linspace(-30, 60, 200)
    across = np.linspace(-1.0, 1.0, 7)
    ragged = PATH_HALF_WIDTH * (1.0 + 0.12 * np.sin(5.1 * along) + 0.1 * np.sin(2.3 * along + 1.0))
    px = path_x(along)[:, None] + ragged[:, None] * across
    py = np.broadcast_to(along[:, None], px.shape)
    pz = height(px, py, seed) + 0.03 * (1.0 - across**2) - 0.012
    path = b.loft(np.stack([px, py, pz], axis=-1), closed=False)
    return [
        b.terrain(x, y, height(grid_x, grid_y, seed)).of(b.forest_floor(seed)),
        b.floor((-2500, 2500), (-2500, 2500), -0.5).of(b.lawn(seed, (0.085, 0.125, 0.04))),
        path.of(b.gravel(seed)),
    ]


def built_things(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """A rustic fence beside the path, a bench, a litter bin, boulders, a signpost."""
    b = rb.blocks
    weathered, iron = b.timber(seed, (0.25, 0.21, 0.165)), b.enamel(seed, (0.06, 0.065, 0.06), glossy=False)
    rock, prints = b.concrete(seed + 1, (0.27, 0.26, 0.235)), b.posters(seed)
    models = [
        b.rail_fence(weathered, rng, length=14.0).at(3.3, 10.5, turn_deg=78 + rng.normal(0, 3)),
        b.rail_fence(weathered, rng, length=10.0).at(-6.6, 4.4, turn_deg=20 + rng.normal(0, 4)),
        b.bench(weathered, iron).at(-1.9, 5.2 + rng.uniform(-0.3, 0.3), turn_deg=75),
        b.litter_bin(weathered, iron).at(-1.75, 6.9),
        b.plank(0.12, 0.12, 2.0).at(2.6, 4.0, -0.1).of(weathered),
        prints.on(b.panel(0.55, 0.42).at(-0.27, -0.07, 1.3), 2 + 3 * int(rng.integers(8))).at(
            2.6, 4.0, turn_deg=-20
        ),
    ]
    for x, y, z in on_ground(*standing_places(rng, 14, 3.4, 15.0, 1.4).T, seed):
        models.append(
            b.boulder(rng, rng.uniform(0.25, 0.95)).at(x, y, z, turn_deg=rng.uniform(0, 360)).of(rock)
        )
    return models


def standing_places(
    rng: np.random.Generator, count: int, near: float, far: float, apart: float
) -> np.ndarray:
    """Up to `count` places [K, 2] from `near` to `far` metres off, `apart` metres from each other.

    None is on the path or in the way of what is built beside it.
    """
    angle, away = rng.uniform(0, 2 * np.pi, 6 * count), np.sqrt(rng.uniform(near**2, far**2, 6 * count))
    candidates = np.stack([away * np.cos(angle), away * np.sin(angle)], axis=1)
    off_path = np.abs(candidates[:, 0] - path_x(candidates[:, 1])) > PATH_HALF_WIDTH + 0.7
    off_built = np.linalg.norm(candidates[:, None] - BUILT, axis=2).min(axis=1) > min(BUILT_MARGIN_M, apart)
    candidates = candidates[off_path & off_built]
    chosen = candidates[:0]
    for place in candidates:
        if len(chosen) < count and (np.hypot(*(chosen - place).T) > apart).all():
            chosen = np.concatenate([chosen, place[None]])
    return chosen


def wood(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """Trees of five kinds, thin near the camera and closing in with distance."""
    b = rb.blocks
    bark, white = b.bark(seed), b.birch_bark(seed)
    green, pale = b.foliage(seed, (0.10, 0.20, 0.035)), b.foliage(seed + 1, (0.20, 0.24, 0.04))
    dark = b.foliage(seed + 2, (0.05, 0.105, 0.035), variety=0.7)

    def kinds(detail: float) -> list[rb.blocks.Model]:
        return [
            b.broadleaf(seed, bark, green, height=11.0, clear=0.42, detail=detail),
            b.birch(seed, white, pale, height=11.0, detail=detail),
            b.spruce(seed, bark, dark, height=10.0, detail=detail),
        ]

    models = []
    # Nearest to farthest: count, metres from and to, metres apart, detail.
    for count, near, far, apart, detail in (
        (10, CLEARING_M, 11.0, 2.6, 0.7),
        (24, 11.0, 21.0, 2.6, 0.2),
        (80, 21.0, 50.0, 2.8, 0.06),
        (200, 50.0, 110.0, 3.0, 0.02),
    ):
        xy = standing_places(rng, count, near, far, apart)
        places = on_ground(xy[:, 0], xy[:, 1], seed, sink=0.05)
        # Spruces are opaque: they stand back, where they close the view.
        kind = rng.choice(3, len(xy), p=(0.5, 0.5, 0.0) if detail > 0.5 else (0.4, 0.3, 0.3))
        for k, tree in enumerate(kinds(detail)):
            models.append(b.copies(tree, b.scattered(rng, places[kind == k], (0.8, 1.25))))
    saplings = standing_places(rng, 9, 4.8, 13.0, 1.5)
    dry = b.bare_tree(seed, bark, height=4.5)
    return [*models, b.copies(dry, b.scattered(rng, on_ground(*saplings.T, seed, sink=0.05), (0.5, 1.1)))]


def undergrowth(seed: int, rng: np.random.Generator) -> list[rb.blocks.Model]:
    """Grass, ferns, bushes and fallen trunks."""
    b = rb.blocks
    bark, grass = b.bark(seed + 1), b.foliage(seed + 3, (0.15, 0.21, 0.05))
    green, fronds = b.foliage(seed + 4, (0.09, 0.18, 0.04)), b.foliage(seed + 5, (0.12, 0.21, 0.035))

    def strewn(
        model: rb.blocks.Model, count: int, near: float, far: float, apart: float, low: float, high: float
    ) -> rb.blocks.Model:
        xy = standing_places(rng, count, near, far, apart)
        return b.copies(model, b.scattered(rng, on_ground(*xy.T, seed, sink=0.02), (low, high)))

    return [
        strewn(b.grass_tuft(seed, grass, height=0.24, count=40), 500, 1.3, 13.0, 0.25, 0.6, 1.5),
        strewn(b.fern(seed, fronds), 36, 1.9, 9.0, 0.8, 0.7, 1.4),
        strewn(b.fern(seed + 1, fronds), 36, 1.9, 16.0, 0.8, 0.7, 1.4),
        strewn(b.bush(seed, bark, green), 26, 4.4, 26.0, 1.5, 0.6, 1.1),
        strewn(b.log(seed, bark, length=3.2), 5, 4.0, 14.0, 3.0, 0.7, 1.1),
    ]
