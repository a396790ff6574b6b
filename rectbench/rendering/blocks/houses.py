"""Houses: walls with recessed windows and doors, sills, roofs, chimneys.

A house stands with the middle of its front at the origin and faces south (-y).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from rectbench.rendering.blocks.prints import Prints
from rectbench.rendering.blocks.shape import Finish, Model, Shape, join, together
from rectbench.rendering.blocks.solids import box, boxes, cards, quads, rod, turned
from rectbench.types import FloatArray

STOREY_M = 3.0
PLINTH_M = 0.45
"""Height of the stone base of a wall, and so of the ground floor above the street."""
REVEAL_M = 0.18
"""How far windows and doors stand back behind the face of the wall."""
WINDOW_M = (1.15, 1.60)
DOOR_M = (1.0, 2.1)
FANLIGHT_M = 0.35
"""Height of the pane above a door."""


@dataclass(frozen=True)
class HouseFinishes:
    """What a house is made of."""

    wall: Finish
    trim: Finish
    """Frames, gutters and bargeboards."""
    stone: Finish
    """Sills, lintels, plinth and steps."""
    roof: Finish
    door: Finish
    panes: Prints


@dataclass(frozen=True)
class Opening:
    """A hole in a wall, metres: x from `left` to `right`, z from `bottom` to `top`."""

    left: float
    right: float
    bottom: float
    top: float


def pierced_wall(width: float, height: float, openings: Sequence[Opening]) -> Shape:
    """A wall in the plane y = 0, centred on x = 0, with openings and their reveals."""
    x = np.unique([-width / 2, width / 2, *(e for o in openings for e in (o.left, o.right))])
    z = np.unique([0.0, height, *(e for o in openings for e in (o.bottom, o.top))])
    faces = []
    for a, b in pairwise(x):
        for c, d in pairwise(z):
            if not any(o.left <= a and b <= o.right and o.bottom <= c and d <= o.top for o in openings):
                faces.append([(a, 0, c), (b, 0, c), (b, 0, d), (a, 0, d)])
    return quads(faces + [side for o in openings for side in _reveal(o)])


def _reveal(o: Opening) -> list[list[tuple[float, float, float]]]:
    a, b, c, d, y = o.left, o.right, o.bottom, o.top, REVEAL_M + 0.02
    return [
        [(a, 0, c), (a, y, c), (a, y, d), (a, 0, d)],
        [(b, y, c), (b, 0, c), (b, 0, d), (b, y, d)],
        [(a, 0, c), (b, 0, c), (b, y, c), (a, y, c)],
        [(a, y, d), (b, y, d), (b, 0, d), (a, 0, d)],
    ]


def window(o: Opening, finishes: HouseFinishes, picture: int, bars: tuple[int, int] = (2, 2)) -> Model:
    """Frame, glazing bars, panes, sill and lintel of an opening; `bars` are panes across and up."""
    back, front = REVEAL_M + 0.01, REVEAL_M - 0.06
    edge = 0.06
    low, high = [], []
    for k in range(bars[0] + 1):
        x = o.left + (o.right - o.left) * k / bars[0]
        half = edge if k in (0, bars[0]) else 0.025
        low.append((max(x - half, o.left), front, o.bottom))
        high.append((min(x + half, o.right), back, o.top))
    for k in range(bars[1] + 1):
        z = o.bottom + (o.top - o.bottom) * k / bars[1]
        half = edge if k in (0, bars[1]) else 0.025
        low.append((o.left, front - 0.005, max(z - half, o.bottom)))
        high.append((o.right, back, min(z + half, o.top)))
    frame = boxes(low, high).of(finishes.trim)
    y = REVEAL_M - 0.01
    glass = cards([[(o.left, y, o.bottom), (o.right, y, o.bottom), (o.right, y, o.top), (o.left, y, o.top)]])
    ledges = boxes(
        [(o.left - 0.08, -0.07, o.bottom - 0.07), (o.left - 0.14, -0.025, o.top)],
        [(o.right + 0.08, REVEAL_M, o.bottom), (o.right + 0.14, REVEAL_M, o.top + 0.21)],
    )
    return frame + finishes.panes.on(glass, picture) + ledges.of(finishes.stone)


def front_door(o: Opening, finishes: HouseFinishes, picture: int) -> Model:
    """Panelled leaf with knob and letter box, fanlight above, frame, steps down to the street."""
    y, top, half = REVEAL_M - 0.02, o.bottom + DOOR_M[1], o.bottom / 2
    leaf_low, leaf_high = [(o.left, y, o.bottom)], [(o.right, y + 0.04, top)]
    for x in (o.left + 0.14, (o.left + o.right) / 2 + 0.05):
        for z, height in ((0.2, 0.65), (1.05, 0.85)):
            leaf_low.append((x, y - 0.025, o.bottom + z))
            leaf_high.append((x + 0.31, y, o.bottom + z + height))
    leaf = boxes(leaf_low, leaf_high).of(finishes.door)
    bar = 0.06
    frame = boxes(
        [(o.left, y - 0.06, o.bottom), (o.right - bar, y - 0.06, o.bottom), (o.left, y - 0.06, top)],
        [(o.left + bar, y + 0.02, o.top), (o.right, y + 0.02, o.top), (o.right, y + 0.02, top + bar)],
    )
    brass = box(0.3, 0.02, 0.05).at((o.left + o.right) / 2, y - 0.03, o.bottom + 0.95)
    glass = cards([[(o.left, y, top), (o.right, y, top), (o.right, y, o.top), (o.left, y, o.top)]])
    steps = boxes(
        [(o.left - 0.35, -0.55, -0.05), (o.left - 0.2, -0.28, -0.05), (o.left - 0.16, -0.06, o.top)],
        [(o.right + 0.35, 0, half), (o.right + 0.2, REVEAL_M, o.bottom), (o.right + 0.16, 0.1, o.top + 0.24)],
    )
    metal_and_wood = (frame + brass).of(finishes.trim)
    return leaf + metal_and_wood + finishes.panes.on(glass, picture) + steps.of(finishes.stone)


def gabled_roof(width: float, depth: float, eaves: float, rise: float, finishes: HouseFinishes) -> Model:
    """A roof with its ridge along x over a house from y = 0 to `depth`, with gables and gutters."""
    a, b, over = -width / 2, width / 2, 0.35
    slope = rise / (depth / 2)
    low, ridge = eaves - over * slope, eaves + rise
    foot, crown, left, right = low + 0.05, ridge + 0.05, a - 0.15, b + 0.15
    top = [(right, depth / 2, crown), (left, depth / 2, crown)]
    slopes = quads([[(left, y, foot), (right, y, foot), *top] for y in (-over, depth + over)])
    gables = quads([
        [(a, depth, eaves), (a, 0, eaves), (a, depth / 2, ridge), (a, depth / 2, ridge)],
        [(b, 0, eaves), (b, depth, eaves), (b, depth / 2, ridge), (b, depth / 2, ridge)],
    ])  # fmt: skip
    soffit = boxes([(a - 0.12, -over, low - 0.03)], [(b + 0.12, 0.0, low + 0.03)])
    gutter = rod((a - 0.15, -over - 0.06, low), (b + 0.15, -over - 0.06, low), 0.07)
    pipe = rod((b - 0.25, -0.06, 0.0), (b - 0.25, -0.06, low), 0.045)
    crest = rod((a - 0.15, depth / 2, ridge + 0.06), (b + 0.15, depth / 2, ridge + 0.06), 0.11)
    trim = (soffit + gutter + pipe).of(finishes.trim)
    return (slopes + crest).of(finishes.roof) + gables.of(finishes.wall) + trim


def chimney(finishes: HouseFinishes, pots: int = 2) -> Model:
    """A stack of 2.6 m with clay pots, standing on z = 0."""
    stack = box(0.55 * pots, 0.62, 2.4) + box(0.55 * pots + 0.14, 0.76, 0.16).at(z=2.2)
    clay = turned([(0.15, 0.0), (0.12, 0.5), (0.16, 0.52), (0.16, 0.6), (0.0, 0.6)], 12)
    rows = [clay.at((k - (pots - 1) / 2) * 0.5, 0, 2.4) for k in range(pots)]
    return stack.of(finishes.wall) + join(rows).of(finishes.roof)


def house(
    rng: np.random.Generator, finishes: HouseFinishes, *, width: float, depth: float = 9.0, storeys: int = 2
) -> Model:
    """A brick house: door and windows in bays, plinth, string courses, roof and chimneys."""
    height = PLINTH_M + STOREY_M * storeys + 0.25
    bays = max(2, int(width // 2.45))
    centres = (np.arange(bays) + 0.5) * width / bays - width / 2
    door_bay = int(rng.integers(0, bays))
    doorway, windows = _openings(centres, door_bay, storeys)
    shell = _shell(width, depth, height)
    front = pierced_wall(width, height, [doorway, *windows])
    bars = ((2, 2), (2, 3), (3, 2))[int(rng.integers(3))]
    glazing = together(window(o, finishes, int(rng.integers(64)), bars) for o in windows)
    bands = _bands(width, doorway, storeys)
    stacks = together(
        chimney(finishes, int(rng.integers(2, 4))).at(side * (width / 2 - 0.9), 0.36 * depth, height + 1.6)
        for side in (-1, 1)
    )
    roof = gabled_roof(width, depth, height, rng.uniform(0.30, 0.42) * depth, finishes)
    walls = (shell + front).of(finishes.wall) + bands.of(finishes.stone)
    return walls + glazing + front_door(doorway, finishes, int(rng.integers(64))) + roof + stacks


def _openings(centres: FloatArray, door_bay: int, storeys: int) -> tuple[Opening, list[Opening]]:
    half_door, half = DOOR_M[0] / 2, WINDOW_M[0] / 2
    x = float(centres[door_bay])
    doorway = Opening(x - half_door, x + half_door, PLINTH_M, PLINTH_M + DOOR_M[1] + FANLIGHT_M)
    windows = []
    for storey in range(storeys):
        bottom = PLINTH_M + STOREY_M * storey + 0.85
        top = bottom + WINDOW_M[1] * (0.88 if storey == storeys - 1 and storey > 1 else 1.0)
        for bay, centre in enumerate(map(float, centres)):
            if storey or bay != door_bay:
                windows.append(Opening(centre - half, centre + half, bottom, top))
    return doorway, windows


def _shell(width: float, depth: float, height: float) -> Shape:
    """The sides and the back."""
    a, b = -width / 2, width / 2
    return quads([
        [(a, depth, 0), (a, 0, 0), (a, 0, height), (a, depth, height)],
        [(b, 0, 0), (b, depth, 0), (b, depth, height), (b, 0, height)],
        [(b, depth, 0), (a, depth, 0), (a, depth, height), (b, depth, height)],
    ])  # fmt: skip


def _bands(width: float, doorway: Opening, storeys: int) -> Shape:
    """The plinth on both sides of the door, a course between storeys, a cornice under the eaves."""
    low = [(-width / 2, -0.05, -0.2), (doorway.right, -0.05, -0.2)]
    high = [(doorway.left, 0.0, PLINTH_M), (width / 2, 0.0, PLINTH_M)]
    for storey in range(1, storeys + 1):
        z = PLINTH_M + STOREY_M * storey
        low.append((-width / 2, -0.085 if storey == storeys else -0.035, z - 0.07))
        high.append((width / 2, 0.0, z + 0.07))
    return boxes(low, high)
