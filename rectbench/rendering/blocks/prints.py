"""Sheets of many small pictures: posters, book spines, window panes, parcels, leaves.

One texture holds a grid of different pictures, so that a hundred books need one material.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rectbench.rendering.blocks.noise import Field, blend, fractal, planes, reflectance, smoothstep
from rectbench.rendering.blocks.shape import Finish, Model, Shape
from rectbench.rendering.world import Colour, Material

MARGIN = 0.01
"""Share of a cell kept clear at its rim, so that no neighbour bleeds in when it is filtered."""
INKS: tuple[Colour, ...] = (
    (0.40, 0.06, 0.045), (0.26, 0.035, 0.04), (0.50, 0.20, 0.05), (0.52, 0.36, 0.09), (0.06, 0.10, 0.24),
    (0.10, 0.22, 0.36), (0.05, 0.15, 0.09), (0.16, 0.26, 0.13), (0.055, 0.05, 0.055), (0.22, 0.12, 0.06),
    (0.52, 0.47, 0.36), (0.30, 0.33, 0.34), (0.12, 0.26, 0.27), (0.42, 0.24, 0.22),
)  # fmt: skip
"""Colours of printers and bookbinders, linear."""
INK: Colour = (0.05, 0.05, 0.07)
PAPER: Colour = (0.60, 0.59, 0.54)


@dataclass(frozen=True, eq=False)
class Prints:
    """A finish whose texture is a grid of pictures."""

    finish: Finish
    rows: int
    columns: int

    @property
    def count(self) -> int:
        """How many pictures there are."""
        return self.rows * self.columns

    def on(self, shape: Shape, index: int) -> Model:
        """`shape`, whose uv run 0..1, showing picture `index` (modulo their number)."""
        return self.spread(shape, np.full(len(shape.uv), index))

    def spread(self, shape: Shape, index: np.ndarray[tuple[int], np.dtype[np.int64]]) -> Model:
        """`shape`, whose uv run 0..1, showing at each vertex the picture of its `index` [V]."""
        row, column = np.divmod(np.asarray(index) % self.count, self.columns)
        inner = MARGIN + np.clip(shape.uv, 0.0, 1.0) * (1.0 - 2.0 * MARGIN)
        uv = (inner + np.stack([column, row], axis=-1)) / (self.columns, self.rows)
        return Shape(shape.vertices, shape.faces, uv).of(self.finish)


def sheet(name: str, pictures: Field, columns: int, *, glossy: bool = False) -> Prints:
    """Prints from pictures [N, 3, h, w], each with its first row at the top, in rows of `columns`."""
    count, _, height, width = pictures.shape
    rows = count // columns
    upright = pictures[:, :, ::-1].reshape(rows, columns, 3, height, width)
    grid = upright.transpose(2, 0, 3, 1, 4).reshape(3, rows * height, columns * width)
    finish = Finish(name, Material(reflectance(grid), glossy), seamless=False)
    return Prints(finish, rows, columns)


def posters(seed: int) -> Prints:
    """24 pictures, 3 : 4: landscapes, abstract paintings and printed notices in turn."""
    rng = np.random.default_rng((seed, 61))
    height, width = 192, 144
    painters = (_landscape, _abstract, _notice)
    pictures = np.stack([painters[k % 3](rng, height, width) for k in range(24)])
    frame = np.ones((height, width), dtype=bool)
    frame[4:-4, 4:-4] = False
    pictures[:, :, frame] = 0.06
    return sheet("posters", pictures, 6)


def _colour(rng: np.random.Generator, lightness: float = 1.0) -> Field:
    """An ink from the palette (3,), a little off."""
    ink = np.array(INKS[int(rng.integers(len(INKS)))]) * lightness * rng.uniform(0.8, 1.2, 3)
    return ink.clip(0.03, 0.8).astype(np.float32)


def _landscape(rng: np.random.Generator, height: int, width: int) -> Field:
    """Ridges behind one another under a cloudy sky."""
    sky = blend(
        (0.20, 0.32, 0.46), (0.72, 0.66, 0.55), smoothstep(0.0, 1.6, fractal(rng, height, width, 2.3))
    )
    y = np.arange(height, dtype=np.float32)[:, None]
    texture = fractal(rng, height, width, 1.2)
    for distance in np.linspace(1.0, 0.0, 4):
        crest = 10.0 * fractal(rng, 1, width, 2.4)[0] + height * (0.85 - 0.5 * distance)
        hill = planes(_colour(rng, 0.45 + 0.6 * distance)) * (1.0 + 0.25 * texture)
        sky = blend(sky, hill, y > crest)
    return sky


def _abstract(rng: np.random.Generator, height: int, width: int) -> Field:
    """Overlapping discs and bars on a painted ground."""
    y, x = np.mgrid[:height, :width].astype(np.float32)
    picture = planes(_colour(rng, 1.4)) * (1.0 + 0.12 * fractal(rng, height, width, 1.2))
    for reach in np.geomspace(45.0, 4.0, 22):
        cx, cy, size = rng.uniform(0, width), rng.uniform(0, height), reach * rng.uniform(0.6, 1.3)
        disc = np.hypot(x - cx, y - cy) < size
        bar = (np.abs(x - cx) < size) & (np.abs(y - cy) < 0.4 * size)
        picture = blend(picture, _colour(rng), 0.9 * (disc if rng.random() < 0.5 else bar))
    strokes: Field = 1.0 + 0.10 * fractal(rng, height, width, 1.5)
    return np.asarray(picture * strokes)


def _notice(rng: np.random.Generator, height: int, width: int) -> Field:
    """A heading, a picture and lines of words on paper."""
    picture = np.broadcast_to(planes(PAPER), (3, height, width)).copy()
    inner, split = width - 20, int(rng.integers(60, 110))
    picture[:, 12:34, 10:-10] = blend(_colour(rng), PAPER, _words(rng, 22, inner, 16))
    art = smoothstep(-0.4, 0.4, fractal(rng, split - 40, inner, 2.0))
    picture[:, 40:split, 10:-10] = blend(_colour(rng), _colour(rng), art)
    picture[:, split + 8 : height - 10, 10:-10] = blend(
        PAPER, INK, _words(rng, height - split - 18, inner, 8)
    )
    return picture


def _words(rng: np.random.Generator, height: int, width: int, line: int) -> Field:
    """Ink of text-like strokes [height, width], rows of letters `line` pixels apart."""
    rows = -(-height // line)
    letters = (rng.random((rows, width // 3 + 1)) < 0.62).repeat(3, axis=1)[:, :width]
    body = letters.repeat(line, axis=0)[:height]
    x_height = (np.arange(height) % line) < 0.55 * line
    broken = rng.random((height, width)) < 0.8
    return (body & x_height[:, None] & broken).astype(np.float32)


def book_spines(seed: int) -> Prints:
    """64 spines: cloth of all colours, bands, titles."""
    rng = np.random.default_rng((seed, 62))
    height, width = 160, 32
    spines = np.empty((64, 3, height, width), dtype=np.float32)
    wear = fractal(rng, height, width * 64, 0.9).reshape(height, 64, width)
    for k in range(64):
        hue = _colour(rng, 0.85)
        spines[k] = planes(hue) * (1.0 + 0.12 * wear[:, k])
        ink = planes(PAPER if hue.mean() < 0.2 else INK)
        for band in rng.integers(6, height - 10, rng.integers(1, 4)):
            spines[k, :, band : band + rng.integers(2, 7)] = ink
        start, length = int(rng.integers(18, 50)), int(rng.integers(40, 90))
        title = np.ascontiguousarray(_words(rng, 18, length, 9).T)
        place = spines[k, :, start : start + length, 7:25]
        place[:] = blend(place, ink, title)
    return sheet("book-spines", spines, 16)


def window_panes(seed: int) -> Prints:
    """16 panes by day: dim rooms behind curtains and blinds, and the sky's reflection."""
    rng = np.random.default_rng((seed, 63))
    height, width = 160, 128
    y, x = np.mgrid[:height, :width].astype(np.float32) / height
    panes = np.empty((16, 3, height, width), dtype=np.float32)
    for k in range(16):
        cloud = fractal(rng, height, width, 3.4)
        sky = planes((0.72, 0.88, 1.0)) * (0.15 + 0.12 * (1.0 - y) + 0.035 * cloud)
        room = planes((1.1, 0.95, 0.8)) * (0.055 + 0.02 * fractal(rng, height, width, 2.8))
        pane = blend(room, sky, smoothstep(-1.5, 1.5, cloud + 1.6 * (0.45 - y)))
        side = np.minimum(x, width / height - x) + 0.012 * fractal(rng, height, width, 2.4)
        folds = 1.0 + 0.22 * np.sin(x * rng.uniform(90, 150) + 1.5 * np.sin(6.0 * y))
        curtain = 0.25 * planes(_colour(rng)) + planes((0.27, 0.25, 0.21))
        pane = blend(pane, curtain * folds, smoothstep(0.0, 0.01, rng.uniform(0.05, 0.28) - side))
        if k % 4 == 1:
            slats = smoothstep(-0.2, 0.3, np.sin(170.0 * y)) * (y < rng.uniform(0.3, 0.8))
            pane = blend(pane, (0.42, 0.40, 0.36), slats)
        panes[k] = pane
    return sheet("window-panes", panes, 8, glossy=True)


def parcels(seed: int) -> Prints:
    """16 sides of boxes: cardboard and painted crates with tape, labels and marks."""
    rng = np.random.default_rng((seed, 64))
    size = 128
    sides = np.empty((16, 3, size, size), dtype=np.float32)
    for k in range(16):
        board = planes((0.40, 0.265, 0.145) if k % 2 else _colour(rng))
        side = board * (1.0 + 0.12 * fractal(rng, size, size, 1.4) + 0.07 * fractal(rng, size, size, 0.4))
        side[:, :, 56:72] = side[:, :, 56:72] * 0.3 + 0.30
        top, left = rng.integers(8, 40, 2)
        side[:, top : top + 44, left : left + 52] = blend(PAPER, INK, _words(rng, 44, 52, 7))
        side[:, 98:118, 54:114] = blend(side[:, 98:118, 54:114], _colour(rng, 0.4), _words(rng, 20, 60, 20))
        sides[k] = side
    return sheet("parcels", sides, 8)


def foliage(seed: int, colour: Colour = (0.10, 0.20, 0.035), variety: float = 1.0) -> Prints:
    """64 leaves, each a little other than `colour`, with a midrib and veins."""
    rng = np.random.default_rng((seed, 65))
    size = 16
    shade = (1.0 + variety * rng.normal(0.0, 0.26, (64, 1, 1, 1))).clip(0.4, 1.8)
    yellow = variety * rng.normal(0.0, 0.035, (64, 1, 1, 1)) * planes((1.0, 0.35, -0.2))
    across = np.abs(np.linspace(-1.0, 1.0, size))
    veins = 1.0 + 0.35 * (across < 0.13) + 0.10 * np.sin(1.6 * np.arange(size)[:, None] + 4.0 * across)
    leaves = (planes(colour) + yellow) * shade * veins * rng.normal(1.0, 0.07, (64, 1, size, size))
    return sheet("foliage", leaves.astype(np.float32), 8)
