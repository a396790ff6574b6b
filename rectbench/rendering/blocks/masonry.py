"""Finishes of walls, roofs and other things laid in courses.

Every function takes a seed and gives a seamless `Finish`; colours are linear reflectances.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rectbench.rendering.blocks.noise import Field, Noise, blend, planes, reflectance, smoothstep
from rectbench.rendering.blocks.shape import Finish
from rectbench.rendering.world import Colour, Material

RED_BRICK: Colour = (0.37, 0.125, 0.068)
YELLOW_BRICK: Colour = (0.50, 0.34, 0.17)
BROWN_BRICK: Colour = (0.25, 0.13, 0.08)
MORTAR: Colour = (0.36, 0.32, 0.26)
BRICK_M = (0.24, 0.07)
"""Length and height of a brick with its joint, metres."""
PAVING_M = 0.40
"""Edge of a paving slab with its joint, metres."""


@dataclass(frozen=True, eq=False)
class Courses:
    """Equal blocks laid in rows, as texels."""

    count: int
    block: NDArray[np.int64]
    """[H, W] number of the block at each texel."""
    edge_px: Field
    """[H, W] distance to the block's nearest edge, pixels."""

    def each(self, values: Field) -> Field:
        """Values [count] or [3, count] of the blocks, spread over their texels."""
        return values[..., self.block]

    def tone(self, rng: np.random.Generator) -> Field:
        """A normal random number of each block, over its texels."""
        return self.each(rng.standard_normal(self.count, dtype=np.float32))


def courses(rows: int, columns: int, block_px: tuple[int, int], shift: float = 0.5) -> Courses:
    """Blocks of (height, width) pixels in rows, every other row moved by `shift` of a block."""
    height, width = block_px
    block = np.arange(rows * columns).reshape(rows, columns).repeat(height, 0).repeat(width, 1)
    y, x = np.arange(height, dtype=np.float32) + 0.5, np.arange(width, dtype=np.float32) + 0.5
    one = np.minimum(np.minimum(y, height - y)[:, None], np.minimum(x, width - x))
    edge = np.tile(one, (rows, columns))
    for texels in (block, edge):
        odd = texels.reshape(rows, height, -1)[1::2]
        odd[:] = np.roll(odd, round(shift * width), axis=-1)
    return Courses(rows * columns, block, edge)


def brick(
    seed: int, colour: Colour = RED_BRICK, mortar: Colour = MORTAR, *, rows: int = 96, columns: int = 64
) -> Finish:
    """Brickwork: bricks of 24 x 7 cm with joints, each burnt its own shade, weathered as a whole."""
    wall = courses(rows, columns, (8, 26))
    noise = Noise.of(seed, 1, *wall.block.shape)
    grain, weather = noise.fractal(0.9), noise.clouds()
    burnt, pale, tone = noise.rng.standard_normal((3, 1, wall.count), dtype=np.float32)
    fired = np.array(colour, dtype=np.float32)[:, None] * (1.0 + 0.19 * tone)
    fired = fired * np.where(burnt > 1.3, [[0.48], [0.55], [0.75]], 1.0)
    fired = fired * np.where(pale > 1.4, [[1.30], [1.60], [1.50]], 1.0)
    face = wall.each(fired.astype(np.float32)) * (1.0 + 0.10 * grain)
    joint = planes(mortar) * (1.0 + 0.12 * grain)
    laid = blend(joint, face, smoothstep(0.3, 1.1, wall.edge_px + 0.2 * grain))
    texels = reflectance(laid * (1.0 + 0.12 * weather))
    return Finish("brick", Material(texels), (columns * BRICK_M[0], rows * BRICK_M[1]))


def plaster(seed: int, colour: Colour) -> Finish:
    """Painted render: a rough coat, stains of rain, flaws and hairline cracks."""
    noise = Noise.of(seed, 2, 768)
    fine, middle, coarse = noise.fractal(0.5), noise.fractal(1.6), noise.clouds()
    crack = 1.0 - smoothstep(0.0, 0.02, np.abs(noise.fractal(3.3) - 0.4))
    flaw = smoothstep(1.3, 2.2, noise.fractal(1.8))
    tone = 1.0 + 0.06 * fine + 0.07 * middle + 0.07 * coarse - 0.35 * crack - 0.28 * flaw
    texels = (planes(colour) + planes((0.015, 0.0, -0.015)) * coarse) * tone
    return Finish("plaster", Material(reflectance(texels)), (5.0, 5.0))


def concrete(seed: int, colour: Colour = (0.36, 0.345, 0.32)) -> Finish:
    """Cast stone: speckled, with pores and stains."""
    noise = Noise.of(seed, 3, 512)
    fine, coarse = noise.fractal(0.6), noise.fractal(2.0)
    distance, kind = noise.spots(1500, 4.0)
    pore = (1.0 - smoothstep(0.4, 1.0, distance)) * (0.2 + 0.4 * kind)
    texels = planes(colour) * (1.0 + 0.11 * fine + 0.14 * coarse - pore)
    return Finish("concrete", Material(reflectance(texels)), (1.5, 1.5))


def roof_tiles(seed: int, colour: Colour = (0.27, 0.10, 0.06)) -> Finish:
    """Overlapping clay tiles of 25 x 20 cm with lichen; v runs up the slope."""
    tiles = courses(32, 32, (16, 16))
    noise = Noise.of(seed, 4, *tiles.block.shape)
    rise = np.tile(np.linspace(1.12, 0.5, 16, dtype=np.float32), 32)[:, None]
    lichen = smoothstep(0.9, 1.9, noise.fractal(1.7))
    tone = rise * (1.0 + 0.20 * tiles.tone(noise.rng) + 0.09 * noise.fractal(0.7) + 0.10 * noise.clouds())
    tone = tone * (0.55 + 0.45 * smoothstep(0.0, 1.6, tiles.edge_px))
    texels = blend(planes(colour) * tone, (0.30, 0.30, 0.20), 0.55 * lichen)
    return Finish("roof-tiles", Material(reflectance(texels)), (8.0, 6.4))


def paving(seed: int, colour: Colour = (0.37, 0.34, 0.295)) -> Finish:
    """Pavement of 40 cm slabs in shifted rows, each cast differently, with sandy joints."""
    slabs = courses(14, 14, (64, 64), shift=0.37)
    noise = Noise.of(seed, 5, *slabs.block.shape)
    fine, coarse = noise.fractal(0.6), noise.clouds()
    stain = smoothstep(1.1, 2.2, noise.fractal(1.9))
    tone = 1.0 + 0.11 * slabs.tone(noise.rng) + 0.09 * fine + 0.08 * coarse - 0.30 * stain
    face = (planes(colour) + planes((0.016, 0.0, -0.016)) * slabs.tone(noise.rng)) * tone
    joint = planes((0.13, 0.125, 0.10)) * (1.0 + 0.2 * fine)
    texels = blend(joint, face, smoothstep(0.6, 2.0, slabs.edge_px + 0.35 * fine))
    return Finish("paving", Material(reflectance(texels)), (14 * PAVING_M, 14 * PAVING_M))


def stone_wall(seed: int, colour: Colour = (0.33, 0.30, 0.25)) -> Finish:
    """Rubble of grey and ochre stones with mossy joints."""
    stones = courses(16, 10, (32, 52), shift=0.43)
    noise = Noise.of(seed, 6, *stones.block.shape)
    fine, coarse = noise.fractal(1.0), noise.clouds()
    tone = 1.0 + 0.22 * stones.tone(noise.rng) + 0.15 * fine + 0.1 * coarse
    face = (planes(colour) + planes((0.035, 0.007, -0.028)) * stones.tone(noise.rng)) * tone
    joint = blend((0.10, 0.09, 0.07), (0.07, 0.10, 0.03), smoothstep(0.0, 1.0, coarse))
    texels = blend(joint, face, smoothstep(1.0, 3.5, stones.edge_px + 1.4 * fine))
    return Finish("stone-wall", Material(reflectance(texels)), (2.6, 2.56))


def terrazzo(seed: int, colour: Colour = (0.40, 0.37, 0.32)) -> Finish:
    """Floor tiles of 40 cm with chips of stone in them and worn joints."""
    tiles = courses(10, 10, (96, 96), shift=0.0)
    noise = Noise.of(seed, 7, *tiles.block.shape)
    fine, coarse = noise.fractal(0.7), noise.clouds()
    texels = planes(colour) * (1.0 + 0.12 * tiles.tone(noise.rng) + 0.07 * fine + 0.09 * coarse)
    for count, radius in ((9000, 2.8), (2600, 6.0)):
        distance, kind = noise.spots(count, radius)
        chip = blend((0.09, 0.08, 0.07), (0.64, 0.57, 0.46), kind)
        chip = blend(chip, (0.38, 0.15, 0.09), smoothstep(0.80, 0.82, kind))
        texels = blend(texels, chip, 0.85 * (1.0 - smoothstep(0.6, 1.0, distance)))
    texels = blend((0.12, 0.11, 0.10), texels, smoothstep(0.6, 1.8, tiles.edge_px))
    return Finish("terrazzo", Material(reflectance(texels)), (4.0, 4.0))


def glazed_tiles(seed: int, colour: Colour = (0.16, 0.26, 0.23)) -> Finish:
    """Wall tiles of 20 x 10 cm in hand-made shades."""
    tiles = courses(24, 14, (24, 48))
    noise = Noise.of(seed, 8, *tiles.block.shape)
    fine, coarse = noise.fractal(1.0), noise.clouds()
    tint = planes((-0.02, 0.006, 0.018)) * tiles.tone(noise.rng)
    crazing = smoothstep(1.2, 1.9, noise.fractal(1.7))
    face = (planes(colour) + tint) * (
        1.0 + 0.26 * tiles.tone(noise.rng) + 0.12 * fine + 0.10 * coarse - 0.3 * crazing
    )
    texels = blend((0.48, 0.46, 0.41), face, smoothstep(0.5, 1.8, tiles.edge_px))
    return Finish("glazed-tiles", Material(reflectance(texels), glossy=True), (2.8, 2.4))


def ceiling_board(seed: int, colour: Colour = (0.64, 0.63, 0.59)) -> Finish:
    """Mineral fibre panels of 60 cm: wormholes, pinholes, water stains, a metal grid."""
    panels = courses(6, 6, (150, 150), shift=0.0)
    noise = Noise.of(seed, 9, *panels.block.shape)
    fine = noise.fractal(0.6)
    worm = smoothstep(0.9, 1.4, noise.fractal(1.6))
    stain = smoothstep(1.1, 2.2, noise.clouds(2.9))
    tone = 1.0 + 0.06 * panels.tone(noise.rng) + 0.05 * fine + 0.06 * noise.clouds() - 0.52 * worm
    face = blend(planes(colour) * tone, planes((0.50, 0.40, 0.27)) * tone, 0.55 * stain)
    texels = blend((0.40, 0.40, 0.39), face, smoothstep(2.2, 3.6, panels.edge_px))
    return Finish("ceiling-board", Material(reflectance(texels)), (3.6, 3.6))
