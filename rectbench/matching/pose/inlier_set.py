"""The essential matrix that the most matches agree on, of all there are: branch and bound.

Yang, Li and Jia, Optimal Essential Matrix Estimation via Inlier-Set Maximization, ECCV 2014: every
E = [t]× R is a point of a solid ball, the rotation vectors of R, times a solid disk, the half sphere of t. A
box of these is given up where none of its poses can have more inliers than a pose that is known; when no box
is left, that one is the best there is. A match is an inlier where its right ray b is within ε of the plane of
t and R a, its left ray a turned: |t·(R a × b)| ≤ sin ε |t × R a|. The bounds are of Hartley and Kahl's kind:
from the middle of a box no ray turns by more than half the cube's diagonal, nor t by more than half the
square's.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rectbench.matching.pose.epipolar import Pose, RayMatches, essential
from rectbench.matching.pose.robust import consensus
from rectbench.types import BoolArray, FloatArray

Floats = NDArray[np.floating[Any]]
"""Of single precision where they are many."""

WITHIN_DEG = 30.0
"""No further are the cameras taken to be turned against each other: the whole ball takes minutes."""
MOST_MATCHES = 60
"""Drawn of those given; each costs as much as the first, and the pose is fitted to all of them afterwards."""
MOST_BOXES = 3_000_000
"""After so many the search ends, and its bound tells what was left open."""
BATCH = 2048
"""Boxes that are split at once, of those with the highest bound."""
ROUNDING = 1e-6
"""Of squares in single precision; bounds are as much wider."""


class InlierSet(NamedTuple):
    """The best pose that was found, and how good any other can be."""

    pose: Pose
    inliers: int
    bound: int
    """No pose within reach has more inliers; equal to `inliers` where the search came to its end."""


@dataclass(frozen=True, eq=False)
class Boxes:
    """Boxes of poses [K]: cubes of rotation vectors, times squares of the disk."""

    turns: FloatArray
    """Middles [K, 3], rad."""
    half_turns: FloatArray
    """Half of each cube's side [K], rad."""
    places: FloatArray
    """Middles [K, 2]: their length is the angle between t and the z axis, rad."""
    half_places: FloatArray
    """Half of each square's side [K], rad."""

    def __len__(self) -> int:
        return len(self.turns)

    def __getitem__(self, chosen: slice | BoolArray) -> Boxes:
        fields = (self.turns, self.half_turns, self.places, self.half_places)
        return Boxes(*(values[chosen] for values in fields))

    @classmethod
    def all(cls, within_rad: float) -> Boxes:
        """The one box that holds every pose whose rotation is no larger."""
        return cls(np.zeros((1, 3)), np.array([within_rad]), np.zeros((1, 2)), np.array([math.pi / 2]))

    @classmethod
    def joined(cls, boxes: list[Boxes]) -> Boxes:
        """All of these."""
        fields = zip(*((b.turns, b.half_turns, b.places, b.half_places) for b in boxes), strict=True)
        return cls(*map(np.concatenate, fields))

    def turns_split(self) -> Boxes:
        """Each cube's eight."""
        halves = np.repeat(self.half_turns / 2, 8)
        turns = np.repeat(self.turns, 8, axis=0) + halves[:, None] * _corners(3, len(self))
        return Boxes(turns, halves, np.repeat(self.places, 8, axis=0), np.repeat(self.half_places, 8))

    def places_split(self) -> Boxes:
        """Each square's four."""
        halves = np.repeat(self.half_places / 2, 4)
        places = np.repeat(self.places, 4, axis=0) + halves[:, None] * _corners(2, len(self))
        return Boxes(np.repeat(self.turns, 4, axis=0), np.repeat(self.half_turns, 4), places, halves)

    def within(self, within_rad: float) -> Boxes:
        """Those that reach into the ball and into the disk."""
        inside = np.linalg.norm(self.turns, axis=1) <= within_rad + math.sqrt(3) * self.half_turns
        inside &= np.linalg.norm(self.places, axis=1) <= math.pi / 2 + math.sqrt(2) * self.half_places
        return self[inside]

    @property
    def rotations(self) -> FloatArray:
        """Of the middles [K, 3, 3] (Rodrigues)."""
        angles = np.linalg.norm(self.turns, axis=1)[:, None, None]
        skew = _cross_matrices(self.turns)
        half = np.sinc(angles / 2 / np.pi)
        return np.asarray(np.eye(3) + np.sinc(angles / np.pi) * skew + 0.5 * half * half * skew @ skew)

    @property
    def directions(self) -> FloatArray:
        """t of the middles [K, 3], of length 1."""
        angles = np.linalg.norm(self.places, axis=1, keepdims=True)
        return np.hstack([self.places * np.sinc(angles / np.pi), np.cos(angles)])


class Scores(NamedTuple):
    """Of boxes [K]."""

    inliers: NDArray[np.intp]
    """Of the pose in the middle."""
    bounds: NDArray[np.intp]
    """Of any pose in the box."""
    is_turn_coarse: BoolArray
    """Whether the cube makes the bound loose, more than the square does."""


def most_inliers(
    matches: RayMatches, limit_px: float, start: Pose, within_deg: float = WITHIN_DEG
) -> InlierSet:
    """The pose with the most matches within `limit_px` of its epipolar planes, in the right image.

    Of all poses whose rotation is no larger than `within_deg`; `start` is a pose that is known, and the
    better it is the sooner the search ends. A pose's four readings, see `decomposed`, have the same inliers.
    """
    terms = Terms.of(matches, limit_px)
    best, within_rad = InlierSet(start, terms.inliers(start), len(matches)), math.radians(within_deg)
    open_boxes: dict[int, list[Boxes]] = defaultdict(list)
    open_boxes[len(matches)].append(Boxes.all(within_rad))
    seen = 0
    while open_boxes and (bound := max(open_boxes)) > best.inliers and seen < MOST_BOXES:
        boxes = Boxes.joined(open_boxes.pop(bound))
        if len(boxes) > BATCH:
            open_boxes[bound].append(boxes[BATCH:])
        for part in _split(boxes[:BATCH], terms, within_rad):
            scores = terms.scores(part)
            seen += len(part)
            middle = int(scores.inliers.argmax())
            pose = Pose(part.rotations[middle], part.directions[middle])
            if scores.inliers[middle] > best.inliers and (count := terms.inliers(pose)) > best.inliers:
                best = InlierSet(pose, count, len(matches))
            for value in np.unique(scores.bounds[scores.bounds > best.inliers]):
                open_boxes[int(value)].append(part[scores.bounds == value])
    return best._replace(bound=max(best.inliers, max(open_boxes, default=0)))


def agreed_by_most(matches: RayMatches, limit_px: float, seed: int) -> Pose:
    """What most matches agree on within 30° of no turn, in the place of `consensus`, from which it starts."""
    start, rng = consensus(matches, limit_px, seed), np.random.default_rng(seed)
    chosen = np.zeros(len(matches), bool)
    chosen[rng.permutation(len(matches))[:MOST_MATCHES]] = True
    return most_inliers(matches[chosen], limit_px, start, WITHIN_DEG).pose


def _split(boxes: Boxes, terms: Terms, within_rad: float) -> Iterator[Boxes]:
    """Their parts, of those sides that make the bounds loose."""
    coarse = terms.scores(boxes).is_turn_coarse
    parts = Boxes.joined([boxes[coarse].turns_split(), boxes[~coarse].places_split()]).within(within_rad)
    for first in range(0, len(parts), BATCH):
        yield parts[first : first + BATCH]


@dataclass(frozen=True, eq=False)
class Terms:
    """What the residuals of matches are linear in, single precision."""

    left: Floats
    """[3, N]"""
    right: Floats
    """[3, N]"""
    products: Floats
    """[9, N], b aᵀ: times vec(R) their cosine, times vec([t]× R) the residual."""
    sines: Floats
    """[N], sin ε."""

    @classmethod
    def of(cls, matches: RayMatches, limit_px: float) -> Terms:
        products = (matches.right[:, :, None] * matches.left[:, None, :]).reshape(-1, 9)
        sines = np.sin(limit_px * matches.rad_per_px)
        return cls(*(a.astype(np.float32) for a in (matches.left.T, matches.right.T, products.T, sines)))

    def inliers(self, pose: Pose) -> int:
        """How many a pose has."""
        residuals = np.abs(essential(pose).ravel() @ self.products)
        reach = np.sqrt(np.maximum(1 - np.square(pose.t @ pose.R @ self.left), 0))
        return int((residuals <= self.sines * reach).sum())

    def scores(self, boxes: Boxes) -> Scores:
        """What R moves of a residual is along b × t, and what t moves of it along R a × b."""
        R, t = boxes.rotations.astype(np.float32), boxes.directions.astype(np.float32)
        residuals = np.abs((_cross_matrices(t) @ R).reshape(-1, 9) @ self.products)
        parallax = _sines(R.reshape(-1, 9) @ self.products)
        reach = _sines(np.einsum("kji,kj->ki", R, t) @ self.left)
        across = _sines(t @ self.right)
        turned, moved = (
            (2 * np.sin(np.minimum(diagonal, math.pi) / 2)).astype(np.float32)[:, None]
            for diagonal in (math.sqrt(3) * boxes.half_turns, math.sqrt(2) * boxes.half_places)
        )
        by_turn, by_move = turned * across, moved * np.minimum(parallax + turned, 1)
        at_most = np.minimum(reach + turned + moved, 1) * self.sines + by_turn + by_move + ROUNDING
        return Scores(
            (residuals <= self.sines * reach).sum(axis=1),
            (residuals <= at_most).sum(axis=1),
            by_turn.sum(axis=1) >= by_move.sum(axis=1),
        )


def _sines(cosines: Floats) -> Floats:
    """Of angles by their cosines, rather too large."""
    return np.asarray(np.sqrt(np.maximum(1 - cosines * cosines, 0) + np.float32(ROUNDING)))


def _cross_matrices(vectors: Floats) -> Floats:
    """[v]× [K, 3, 3]."""
    x, y, z = vectors.T
    o = np.zeros_like(x)
    return np.stack([o, -z, y, z, o, -x, -y, x, o], axis=1).reshape(-1, 3, 3)


def _corners(dimensions: int, count: int) -> FloatArray:
    """The signs of a cube's corners, `count` times [count 2^d, d]."""
    return np.tile(np.array(list(product((-1.0, 1.0), repeat=dimensions))), (count, 1))
