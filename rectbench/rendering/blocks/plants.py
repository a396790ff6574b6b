"""Trees, bushes, ferns and grass, grown branch by branch.

Wood is tubes, leaves are small folded cards. A plant stands at the origin; repeat it through
`instances`, for it has thousands of leaves.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rectbench.rendering.blocks.prints import Prints
from rectbench.rendering.blocks.shape import Finish, Model, Shape, join
from rectbench.rendering.blocks.solids import loft, tubes, turned
from rectbench.types import FloatArray

GOLDEN_ANGLE = np.radians(137.50776)
"""Between one shoot and the next around a stem, so that none shades another."""
UP = np.array([0.0, 0.0, 1.0])
LEAF_FOLD = 0.35
"""How far a leaf's sides rise above its midrib, as a share of its half width."""


@dataclass(frozen=True, eq=False)
class Branches:
    """Paths [B, K, 3] metres and their radii [B, K]."""

    paths: FloatArray
    radii: FloatArray

    def wood(self, sides: int) -> Shape:
        """The branches as tubes."""
        return tubes(self.paths, self.radii, sides)

    def points(
        self, branch: NDArray[np.integer[Any]], share: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Point, unit direction and radius at a `share` 0..1 of the length of each `branch` number."""
        knots = self.paths.shape[1]
        position = np.clip(share, 0.0, 1.0) * (knots - 1)
        first = np.minimum(position.astype(int), knots - 2)
        rest = (position - first)[:, None]
        start, end = self.paths[branch, first], self.paths[branch, first + 1]
        radius = self.radii[branch, first] * (1 - rest[:, 0]) + self.radii[branch, first + 1] * rest[:, 0]
        return start + rest * (end - start), _unit(end - start), radius


def _unit(vectors: FloatArray) -> FloatArray:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    unit: FloatArray = vectors / np.maximum(length, 1e-12)
    return unit


def _aside(direction: FloatArray, angle: FloatArray) -> FloatArray:
    """Unit vectors [N, 3] square to `direction`, turned about it by `angle`."""
    reference = np.where(np.abs(direction[:, 2:]) > 0.9, (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    first = _unit(np.cross(direction, reference))
    return np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * np.cross(direction, first)


def trunk(
    rng: np.random.Generator, height: float, radius: float, sway: float = 0.03, knots: int = 12
) -> Branches:
    """One stem that wanders by `sway` of its height and flares at the root."""
    t = np.linspace(0.0, 1.0, knots)
    wander = np.cumsum(rng.normal(0.0, sway * height / np.sqrt(knots), (knots, 2)), axis=0) * t[:, None]
    path = np.concatenate([wander, (height * t - 0.25)[:, None]], axis=1)
    radii = radius * ((1.0 - t) ** 0.8 + 0.04) + 0.5 * radius * np.exp(-t * height / 0.35)
    return Branches(path[None], radii[None])


def sprout(
    rng: np.random.Generator,
    parents: Branches,
    count: int,
    *,
    length: tuple[float, float],
    share: tuple[float, float] = (0.3, 1.0),
    angle_deg: tuple[float, float] = (35.0, 65.0),
    lift: float = 0.25,
    thickness: float = 0.6,
    knots: int = 6,
) -> Branches:
    """`count` branches on each parent.

    `length` in metres at the first and last `share` of the parent, `angle_deg` between them and
    the parent, `lift` how far they bend up (down if negative) as a share of their length.
    """
    total = len(parents.paths) * count
    order = (np.arange(total) % count + rng.uniform(0.0, 1.0, total)) / count
    branch = np.repeat(np.arange(len(parents.paths)), count)
    base, ahead, radius = parents.points(branch, share[0] + (share[1] - share[0]) * order)
    azimuth = GOLDEN_ANGLE * np.arange(total) + rng.normal(0.0, 0.4, total)
    angle = np.radians(rng.uniform(*angle_deg, total))[:, None]
    ahead = np.cos(angle) * ahead + np.sin(angle) * _aside(ahead, azimuth)
    reach = (length[0] + (length[1] - length[0]) * order) * rng.uniform(0.75, 1.25, total)
    t = np.linspace(0.0, 1.0, knots)[None, :, None]
    bend = np.array([0.0, 0.0, lift]) + rng.normal(0.0, 0.08, (total, 1, 3))
    kink = np.cumsum(rng.normal(0.0, 0.05, (total, knots, 3)), axis=1) * t
    paths = base[:, None] + reach[:, None, None] * (t * ahead[:, None] + t**2 * bend + kink / np.sqrt(knots))
    radii = np.maximum(thickness * radius, 0.003)[:, None] * (1.0 - 0.8 * t[:, :, 0])
    return Branches(paths, radii)


def leaves(
    rng: np.random.Generator,
    twigs: Branches,
    prints: Prints,
    per_twig: int,
    length: float,
    *,
    width: float = 0.55,
    droop: float = 0.2,
    share: tuple[float, float] = (0.2, 1.0),
    detail: float = 1.0,
) -> Model:
    """Leaves of about `length` metres, `width` times as wide, along twigs.

    Their number falls with `detail` while the area they cover stays.
    """
    every = max(1, round(1.0 / (per_twig * detail)))
    count = max(1, round(per_twig * detail))
    length = length * np.sqrt(per_twig / count) * np.sqrt(every)
    twigs, per_twig = Branches(twigs.paths[::every], twigs.radii[::every]), count
    total = len(twigs.paths) * per_twig
    branch = np.repeat(np.arange(len(twigs.paths)), per_twig)
    base, ahead, _ = twigs.points(branch, rng.uniform(*share, total))
    out = _aside(ahead, rng.uniform(0.0, 2.0 * np.pi, total))
    ahead = _unit(0.6 * ahead + out + rng.normal(0.0, 0.25, (total, 3)) - [0.0, 0.0, droop])
    size = length * rng.uniform(0.65, 1.25, (total, 1))
    across = _unit(
        _aside(ahead, rng.uniform(0.0, 2.0 * np.pi, total)) + 0.6 * np.cross(ahead, (0.0, 0.0, 1.0))
    )
    return _folded(rng, prints, base, ahead * size, across * (0.5 * width * size))


def _folded(
    rng: np.random.Generator, prints: Prints, base: FloatArray, ahead: FloatArray, across: FloatArray
) -> Model:
    """Leaf-shaped cards [N]: two triangles each, folded along the midrib."""
    up = LEAF_FOLD * np.cross(_unit(ahead), across)
    middle = base + 0.45 * ahead
    corners = np.stack([base, middle + across + up, base + ahead, middle - across + up], axis=1)
    first = 4 * np.arange(len(base), dtype=np.int64)[:, None]
    faces = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])
    uv = np.tile(np.array([[0.5, 0.0], [1.0, 0.45], [0.5, 1.0], [0.0, 0.45]]), (len(base), 1))
    return prints.spread(
        Shape(corners.reshape(-1, 3), faces, uv), rng.integers(0, prints.count, len(base)).repeat(4)
    )


def broadleaf(
    seed: int, bark: Finish, foliage: Prints, *, height: float = 8.0, clear: float = 0.28, detail: float = 1.0
) -> Model:
    """A tree with a round crown above `clear` of its height (lime, maple, oak).

    A `detail` below 1 makes fewer and larger leaves, for trees far away (1: 45 000 triangles).
    """
    rng = np.random.default_rng((seed, 81))
    stem = trunk(rng, 0.85 * height, 0.024 * height)
    long = (0.38 * height, 0.16 * height)
    limbs = sprout(rng, stem, 11, length=long, share=(clear, 1.0), angle_deg=(40, 70), thickness=0.5)
    boughs = sprout(rng, limbs, 6, length=(0.19 * height, 0.09 * height), thickness=0.6, knots=5)
    twigs = sprout(rng, boughs, 5, length=(0.09 * height, 0.05 * height), lift=0.1, thickness=0.6, knots=4)
    crown = leaves(rng, twigs, foliage, 52, 0.105, detail=detail)
    wood = _wood([(stem, 12, 0.0), (limbs, 7, 0.0), (boughs, 4, 0.1), (twigs, 3, 0.4)], detail)
    return wood.of(bark) + crown


def birch(seed: int, bark: Finish, foliage: Prints, *, height: float = 10.0, detail: float = 1.0) -> Model:
    """A slender white stem with thin hanging twigs and small leaves; `detail` as for `broadleaf`."""
    rng = np.random.default_rng((seed, 82))
    stem = trunk(rng, height, 0.013 * height, sway=0.05)
    long = (0.22 * height, 0.06 * height)
    limbs = sprout(rng, stem, 26, length=long, share=(0.3, 1.0), angle_deg=(30, 55), thickness=0.4)
    twigs = sprout(rng, limbs, 8, length=(0.10 * height, 0.05 * height), lift=-0.55, thickness=0.5, knots=5)
    crown = leaves(rng, twigs, foliage, 34, 0.07, width=0.7, droop=0.8, detail=detail)
    return _wood([(stem, 12, 0.0), (limbs, 4, 0.0), (twigs, 3, 0.4)], detail).of(bark) + crown


def spruce(seed: int, bark: Finish, foliage: Prints, *, height: float = 11.0, detail: float = 1.0) -> Model:
    """A conifer: whorls of drooping boughs, long below, short on top; `detail` as for `broadleaf`."""
    rng = np.random.default_rng((seed, 83))
    stem = trunk(rng, height, 0.017 * height, sway=0.008)
    boughs = sprout(
        rng, stem, 64, length=(0.25 * height, 0.02 * height), share=(0.13, 0.99), angle_deg=(78, 100),
        lift=-0.12, thickness=0.22,
    )  # fmt: skip
    twigs = sprout(
        rng, boughs, 12, length=(0.055 * height, 0.025 * height), lift=-0.3, angle_deg=(40, 60), knots=3
    )
    crown = leaves(rng, twigs, foliage, 16, 0.10, width=0.2, droop=0.3, share=(0.0, 1.0), detail=detail)
    return _wood([(stem, 12, 0.0), (boughs, 4, 0.1)], detail).of(bark) + crown


def _wood(orders: list[tuple[Branches, int, float]], detail: float) -> Shape:
    """Tubes of (branches, sides), those left out whose least detail is not reached."""
    return join(
        branches.wood(sides if detail > 0.2 else 4) for branches, sides, least in orders if detail >= least
    )


def bare_tree(seed: int, bark: Finish, *, height: float = 5.0) -> Model:
    """Dead wood and saplings: twigs and nothing on them."""
    rng = np.random.default_rng((seed, 84))
    stem = trunk(rng, height, 0.012 * height, sway=0.06)
    limbs = sprout(rng, stem, 12, length=(0.32 * height, 0.14 * height), share=(0.2, 1.0), thickness=0.5)
    twigs = sprout(rng, limbs, 6, length=(0.13 * height, 0.06 * height), thickness=0.5, knots=5)
    tips = sprout(rng, twigs, 3, length=(0.05 * height, 0.03 * height), thickness=0.6, knots=3)
    return join([stem.wood(8), limbs.wood(6), twigs.wood(4), tips.wood(3)]).of(bark)


def bush(seed: int, bark: Finish, foliage: Prints, *, height: float = 1.2, leaf: float = 0.06) -> Model:
    """Many stems from one root, leaved from the ground up."""
    rng = np.random.default_rng((seed, 85))
    ground = Branches(np.array([[[0.0, 0.0, -0.1], [0.0, 0.0, 0.15]]]), np.array([[0.03, 0.02]]))
    stems = sprout(rng, ground, 11, length=(height, height), share=(0.0, 1.0), angle_deg=(8, 55), lift=0.15)
    twigs = sprout(rng, stems, 9, length=(0.34 * height, 0.2 * height), share=(0.15, 1.0), knots=4)
    return join([stems.wood(5), twigs.wood(3)]).of(bark) + leaves(rng, twigs, foliage, 14, leaf)


def hedge(seed: int, bark: Finish, foliage: Prints, *, length: float = 2.0, height: float = 1.3) -> Model:
    """A clipped hedge along x: a shell of leaves over twigs, 60 cm thick."""
    rng = np.random.default_rng((seed, 86))
    count = round(420 * length * height)
    half = np.array([length / 2, 0.3, height / 2])
    place = rng.uniform(-1.0, 1.0, (count, 3))
    depth = rng.uniform(0.78, 1.0, count)
    face = rng.choice([0, 1, 2], count, p=[0.1, 0.6, 0.3])
    place[np.arange(count), face] = np.sign(place[np.arange(count), face]) * depth
    root = place * half * 1.02 + [0.0, 0.0, half[2]]
    twigs = np.stack([root - 0.12 * _unit(place), root + 0.05 * _unit(place)], axis=1)
    shoots = Branches(twigs, np.full((count, 2), 0.003))
    return shoots.wood(3).of(bark) + leaves(rng, shoots, foliage, 5, 0.085, width=0.7, droop=0.0)


def blades(
    rng: np.random.Generator,
    prints: Prints,
    roots: FloatArray,
    ahead: FloatArray,
    length: FloatArray,
    width: FloatArray,
    bend: float = 0.5,
    knots: int = 4,
) -> Model:
    """Curved strips from `roots` [N, 3] along unit `ahead` [N, 3], tapered, bending down by `bend`."""
    count = len(roots)
    t = np.linspace(0.0, 1.0, knots)[None, :, None]
    spine = roots[:, None] + length[:, None, None] * (
        t * ahead[:, None] - bend * t**2 * np.array([0.0, 0.0, 0.5])
    )
    across = _unit(np.cross(ahead, (0.0, 0.0, 1.0)) + rng.normal(0.0, 0.2, (count, 3)))[:, None]
    half = 0.5 * width[:, None, None] * (np.sin(np.pi * (0.18 + 0.80 * t)) + 0.02)
    edges = np.stack([spine - half * across, spine + half * across], axis=2)
    row = 2 * np.arange(knots - 1)[:, None] + 2 * knots * np.arange(count)[:, None, None]
    faces = np.concatenate([row + np.array([0, 1, 3]), row + np.array([0, 3, 2])], axis=1)
    uv = np.stack(np.meshgrid([0.1, 0.9], np.linspace(0.0, 1.0, knots)), axis=-1).reshape(1, -1, 2)
    shape = Shape(edges.reshape(-1, 3), faces.reshape(-1, 3), np.tile(uv, (count, 1, 1)).reshape(-1, 2))
    return prints.spread(shape, rng.integers(0, prints.count, count).repeat(2 * knots))


def grass_tuft(
    seed: int, prints: Prints, *, height: float = 0.18, radius: float = 0.22, count: int = 90
) -> Model:
    """A tuft of grass blades."""
    rng = np.random.default_rng((seed, 87))
    angle, away = rng.uniform(0.0, 2 * np.pi, count), radius * np.sqrt(rng.uniform(0.0, 1.0, count))
    roots = np.stack([away * np.cos(angle), away * np.sin(angle), np.full(count, -0.02)], axis=1)
    ahead = _unit(rng.normal(0.0, 0.35, (count, 3)) + UP)
    size = height * rng.uniform(0.4, 1.4, count)
    return blades(rng, prints, roots, ahead, size, rng.uniform(0.004, 0.009, count))


def fern(seed: int, prints: Prints, *, reach: float = 0.7) -> Model:
    """Arching fronds with rows of leaflets."""
    rng = np.random.default_rng((seed, 88))
    crown = Branches(np.array([[[0.0, 0.0, -0.05], [0.0, 0.0, 0.05]]]), np.array([[0.004, 0.004]]))
    fronds = sprout(
        rng, crown, 13, length=(reach, reach), share=(0.0, 1.0), angle_deg=(15, 45), lift=-0.55, knots=9
    )
    position = np.tile(np.linspace(0.12, 1.0, 26).repeat(2), 13)
    base, along, _ = fronds.points(np.arange(13).repeat(52), position)
    side = np.tile([1.0, -1.0], 13 * 26)[:, None] * _unit(np.cross(along, (0.0, 0.0, 1.0)))
    size = 0.26 * reach * np.sin(np.pi * (0.15 + 0.83 * position)) + 0.01
    ahead = _unit(side + 0.35 * along + rng.normal(0.0, 0.06, side.shape))
    return blades(rng, prints, base, ahead, size, 0.22 * size + 0.004, bend=0.25, knots=2)


def potted_plant(
    seed: int, pot: Finish, soil: Finish, prints: Prints, *, height: float = 1.0, count: int = 26
) -> Model:
    """A house plant with long arching leaves in a clay pot."""
    rng = np.random.default_rng((seed, 89))
    wide = 0.19 * np.sqrt(height)
    vessel = turned([
        (0.0, 0.0), (0.7 * wide, 0.0), (wide, 1.6 * wide), (1.08 * wide, 1.6 * wide),
        (1.08 * wide, 1.8 * wide), (0.9 * wide, 1.8 * wide), (0.88 * wide, 1.65 * wide),
    ])  # fmt: skip
    earth = turned([(0.9 * wide, 1.66 * wide), (0.0, 1.7 * wide)])
    angle = GOLDEN_ANGLE * np.arange(count)
    out = np.stack([np.cos(angle), np.sin(angle), np.zeros(count)], axis=1)
    ahead = _unit(out * rng.uniform(0.25, 0.95, (count, 1)) + [0.0, 0.0, 1.0])
    length = height * rng.uniform(0.55, 1.0, count)
    roots = 0.25 * wide * out + [0.0, 0.0, 1.66 * wide]
    crown = blades(rng, prints, roots, ahead, length, 0.11 * length + 0.02, bend=0.7, knots=7)
    return vessel.of(pot) + earth.of(soil) + crown


def log(seed: int, bark: Finish, *, length: float = 3.0, radius: float = 0.2) -> Model:
    """A fallen trunk along x with stubs of branches."""
    rng = np.random.default_rng((seed, 90))
    x = np.linspace(-length / 2, length / 2, 9)
    path = np.stack([x, 0.15 * radius * rng.standard_normal(9), np.full(9, 0.85 * radius)], axis=1)
    stem = Branches(path[None], radius * np.linspace(1.1, 0.8, 9)[None])
    stubs = sprout(rng, stem, 7, length=(0.35, 0.7), angle_deg=(40, 80), thickness=0.25, lift=0.1)
    ends = [loft(np.stack([np.broadcast_to(ring.mean(0), ring.shape), ring])) for ring in _end_rings(stem)]
    return join([stem.wood(14), stubs.wood(6), *ends]).of(bark)


def _end_rings(stem: Branches) -> tuple[FloatArray, FloatArray]:
    rings = stem.wood(14).vertices.reshape(-1, 15, 3)
    return rings[0, :-1], rings[-1, :-1]


def posy(seed: int, prints: Prints, *, height: float = 0.3, count: int = 24) -> Model:
    """Cut stems and leaves for a vase, from z = 0 up."""
    rng = np.random.default_rng((seed, 91))
    ahead = _unit(rng.normal(0.0, 0.45, (count, 3)) + 1.2 * UP)
    length = height * rng.uniform(0.6, 1.2, count)
    return blades(rng, prints, np.zeros((count, 3)), ahead, length, 0.14 * length, bend=0.6, knots=6)
