"""Finishes of things indoors: timber, textiles, paint and paper.

Every function takes a seed and gives a `Finish`; colours are linear reflectances.
"""

from __future__ import annotations

import numpy as np

from rectbench.rendering.blocks.masonry import courses
from rectbench.rendering.blocks.noise import Field, Noise, blend, planes, reflectance, smoothstep
from rectbench.rendering.blocks.shape import Finish
from rectbench.rendering.world import Colour, Material

OAK: Colour = (0.40, 0.235, 0.11)
WALNUT: Colour = (0.19, 0.10, 0.052)
PINE: Colour = (0.52, 0.345, 0.17)


def timber(seed: int, colour: Colour = OAK, *, glossy: bool = False) -> Finish:
    """Sawn wood with grain along u, knots and pores."""
    noise = Noise.of(seed, 41, 320, 640)
    texels = planes(colour) * _grain(noise)
    distance, kind = noise.spots(26, 9.0)
    ring = 0.6 + 0.3 * np.sin(9.0 * distance, where=distance < 1.0, out=np.zeros_like(distance))
    texels = blend(texels, texels * 0.45 * ring, (1.0 - smoothstep(0.4, 1.0, distance)) * (0.4 + 0.6 * kind))
    return Finish("timber", Material(reflectance(texels), glossy), (1.9, 0.7))


def _grain(noise: Noise) -> Field:
    """Brightness of wood [height, width] around 1, grain along the rows."""
    rings = np.sin(9.0 * noise.streaks(7.0, 2.8))
    pores = noise.streaks(14.0, 0.9)
    grain: Field = 1.0 + 0.17 * rings + 0.13 * pores + 0.10 * noise.clouds(2.2)
    return grain


def floorboards(seed: int, colour: Colour = OAK) -> Finish:
    """Boards of 12 x 120 cm along u, laid in shifted rows."""
    boards = courses(24, 3, (36, 300), shift=0.41)
    noise = Noise.of(seed, 42, *boards.block.shape)
    tone = _grain(noise) * (1.0 + 0.18 * boards.tone(noise.rng))
    tone = tone + 0.07 * noise.fractal(0.9)
    face = (planes(colour) + planes((0.022, 0.002, -0.020)) * boards.tone(noise.rng)) * tone
    texels = blend((0.05, 0.03, 0.02), face, smoothstep(0.2, 1.4, boards.edge_px))
    return Finish("floorboards", Material(reflectance(texels)), (3.6, 2.88))


def wall_paint(seed: int, colour: Colour) -> Finish:
    """Limewash put on by sponge: clouded, with filled holes, scuffs and the print of hands."""
    noise = Noise.of(seed, 43, 1024)
    fine, middle = noise.fractal(0.6), noise.fractal(1.7)
    distance, kind = noise.spots(700, 7.0)
    filled = (1.0 - smoothstep(0.4, 1.0, distance)) * (kind - 0.65)
    scuff = smoothstep(1.9, 2.7, noise.streaks(4.0, 1.7))
    grime = smoothstep(0.7, 2.0, noise.fractal(1.9))
    sponge = smoothstep(-0.2, 0.5, noise.fractal(1.3))
    tone = 0.90 + 0.05 * fine + 0.075 * middle + 0.05 * noise.clouds() + 0.14 * sponge
    tone = tone + 0.40 * filled - 0.35 * scuff - 0.24 * grime
    return Finish("wall-paint", Material(reflectance(planes(colour) * tone)), (3.4, 3.4))


def wallpaper(seed: int, ground: Colour = (0.50, 0.46, 0.36), print_: Colour = (0.13, 0.23, 0.18)) -> Finish:
    """Paper with a printed thicket of vines, leaves and berries that never comes back the same."""
    noise = Noise.of(seed, 44, 1024)
    texels = planes(ground) * (1.0 + 0.06 * noise.fractal(0.7))
    contour = np.abs((2.2 * noise.fractal(4.2)) % 1.0 - 0.5)
    texels = blend(texels, print_, 0.8 * (1.0 - smoothstep(0.03, 0.06, contour)))
    ragged = 0.16 * noise.fractal(1.8)
    for count, radius, colour in (
        (1500, 10.0, print_),
        (600, 7.0, (0.24, 0.34, 0.20)),
        (500, 5.0, (0.48, 0.17, 0.10)),
    ):
        distance, kind = noise.spots(count, radius)
        leaf = planes(colour) * (0.7 + 0.6 * kind)
        texels = blend(texels, leaf, 1.0 - smoothstep(0.7, 0.9, distance + ragged))
    return Finish("wallpaper", Material(reflectance(texels * (1.0 + 0.05 * noise.clouds()))), (3.0, 3.0))


def cloth(seed: int, colour: Colour, second: Colour | None = None) -> Finish:
    """Woven wool, mottled, with threads of a second colour."""
    noise = Noise.of(seed, 45, 320)
    thread = np.sin(np.arange(noise.width, dtype=np.float32) * (2 * np.pi * 60 / noise.width))
    weave = thread[:, None] * thread
    tone = 1.0 + 0.11 * noise.fractal(0.5) + 0.13 * noise.clouds(1.9) + 0.10 * weave
    fleck = smoothstep(0.8, 1.5, noise.fractal(1.4))
    other = second or (1.8 * colour[0], 1.8 * colour[1], 1.8 * colour[2])
    texels = blend(planes(colour), planes(other), 0.8 * fleck) * tone
    return Finish("cloth", Material(reflectance(texels)), (0.8, 0.8))


def enamel(seed: int, colour: Colour, *, glossy: bool = True, wear: float = 1.0) -> Finish:
    """Painted metal with dust, chips and scratches in proportion to `wear`."""
    noise = Noise.of(seed, 46, 320)
    scratch = smoothstep(2.0, 2.8, noise.streaks(9.0, 1.3))
    chip = smoothstep(1.7, 2.0, noise.fractal(1.6))
    tone = 1.0 + wear * (0.09 * noise.fractal(1.0) + 0.13 * noise.fractal(1.9) + 0.6 * scratch)
    texels = blend(planes(colour) * tone, (0.13, 0.10, 0.08), 0.85 * wear * chip)
    return Finish("enamel", Material(reflectance(texels), glossy), (1.1, 1.1))


def rug(seed: int, ground: Colour = (0.33, 0.075, 0.06), figure: Colour = (0.52, 0.40, 0.24)) -> Finish:
    """A knotted carpet for a card of uv 0..1, 3 : 2: border, medallions, uneven dye."""
    noise = Noise.of(seed, 47, 512, 768)
    height, width = noise.height, noise.width
    y, x = np.mgrid[:height, :width].astype(np.float32)
    edge = np.minimum(np.minimum(x, width - x), np.minimum(y, height - y))
    wander = 6.0 * noise.fractal(3.0)
    rings = np.sin(np.hypot(x - width / 2, y - height / 2) / 15.0)
    petals = np.sin((x + wander) / 19.0) * np.sin((y - wander) / 17.0) + 0.6 * rings
    night = planes((0.05, 0.06, 0.11))
    field = blend(
        blend(ground, figure, smoothstep(0.25, 0.5, petals)), night, smoothstep(0.55, 0.75, -petals)
    )
    zigzag = np.sin((x + y + wander) / 9.0) * np.sin((x - y) / 11.0)
    texels = blend(blend(night, figure, smoothstep(-0.1, 0.25, zigzag)), field, smoothstep(62.0, 66.0, edge))
    texels = blend(texels, figure, (np.abs(edge - 64.0) < 5.0) | (np.abs(edge - 8.0) < 4.0))
    dye = 1.0 + 0.14 * noise.fractal(0.4) + 0.12 * noise.fractal(2.2)
    return Finish("rug", Material(reflectance(texels * dye)), seamless=False)
