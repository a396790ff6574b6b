"""What tells a pose from an accident: points ahead of both cameras, chance, and a turn alone."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import gammaln
from scipy.stats import binom

from rectbench.cameras.arrays import BoolArray, FloatArray
from rectbench.errors import PoseNotFound
from rectbench.matching.epipolar import Pose, RayMatches, essential, meeting, sampson_px
from rectbench.matching.robust import SAMPLE

SIGNIFICANT_LOG10 = -3.0
"""A consensus that wrong matches would reach in one of a thousand image pairs is believed."""
CELLS = 8
"""Cells along the longer side of what the matches cover, of which each is one witness."""
MISMATCHES = 20
"""Mismatched pairs made for each match, to measure how often a mismatch fits by chance."""
NEIGHBOURS = 8
SIMILAR = 0.15
"""Relative difference of the distances of two points on one surface."""
TURN_STEPS = 10
AHEAD_BY_CHANCE = 2 / 3
"""Share of points ahead, at most, where noise alone places them: the pose is fitted to that noise."""
BELIEVED = 1e-3
MOST_BEHIND = 0.12
"""Share of points behind a camera up to which they count as accidents; of true poses 1 % is usual."""


def possible(pose: Pose, matches: RayMatches, limit_px: float) -> BoolArray:
    """Whether each match [N] may be a point ahead of both cameras, one too far to tell included."""
    meets = meeting(pose, matches)
    mask: BoolArray = meets.ahead | (meets.alike & (meets.parallax <= limit_px * _rad_per_px(matches)))
    return mask


def refuse_chance(pose: Pose, matches: RayMatches, limit_px: float) -> None:
    """Raise PoseNotFound where wrong matches alone would often reach as large a consensus.

    The number of false alarms of Moisan and Stival (IJCV 2004). The chance of a single wrong match to
    fit is measured, on pairs made of the left pixel of one match and the right pixel of another: features
    gather where there is texture, and fit more often than pixels spread evenly. Neighbours err together,
    so of each cell of a grid only the clearest match counts.
    """
    matches, matrix = matches[_one_a_cell(matches.pixels.left)], essential(pose)

    def fitting(some: RayMatches) -> int:
        return int((np.abs(sampson_px(some.terms(), matrix)) <= limit_px).sum())

    count, agreeing = len(matches), fitting(matches)
    shifts = range(1, min(MISMATCHES + 1, count))
    by_chance = max(sum(fitting(matches.mismatched(shift)) for shift in shifts), 1) / len(shifts) / count
    log_alarms = np.log(10.0 * max(count - SAMPLE, 1)) + _log_choices(count, agreeing)
    log_alarms += _log_choices(agreeing, SAMPLE) + (agreeing - SAMPLE) * np.log(by_chance)
    if agreeing <= SAMPLE or log_alarms > SIGNIFICANT_LOG10 * np.log(10):
        raise PoseNotFound(
            f"no pose stands out: the best explains {agreeing} of {count} matches in different places, which "
            "wrong matches may do too; do the images overlap?"
        )


def refuse_turn(pose: Pose, matches: RayMatches, limit_px: float) -> None:
    """Raise PoseNotFound where a turn of the camera alone explains the matches [N] that fit the pose.

    A turn leaves each match off by its parallax. Where that rises above the noise for a minority only,
    these have to lie ahead of both cameras, as parallax does and noise does not.
    """
    moved = _off_after_turn(pose.R, matches, limit_px) > np.sqrt(2) * limit_px
    if 2 * moved.sum() > len(matches):
        return
    ahead = int((meeting(pose, matches).ahead & moved).sum())
    if binom.sf(ahead - 1, moved.sum(), AHEAD_BY_CHANCE) > BELIEVED:
        raise PoseNotFound(
            f"a turn alone explains {(~moved).sum()} of {len(matches)} matches; "
            "expected photographs from two places, of things near enough to shift between them"
        )


def refuse_behind(pose: Pose, matches: RayMatches, limit_px: float) -> None:
    """Raise PoseNotFound where many of the matches that fit the pose would lie behind a camera."""
    behind = int((~possible(pose, matches, limit_px)).sum())
    if behind > MOST_BEHIND * len(matches):
        raise PoseNotFound(
            f"no pose stands out: of {len(matches)} matches that fit the best, {behind} would lie behind a "
            "camera; do the images overlap?"
        )


def _off_after_turn(R: FloatArray, matches: RayMatches, limit_px: float) -> FloatArray:
    """Distances [N], px of the right image, that the turn which explains most matches leaves."""
    J = matches.per_pixel_right
    transposed = np.swapaxes(J, 1, 2)
    to_px = np.linalg.solve(transposed @ J, transposed)
    for _ in range(TURN_STEPS):
        off = (to_px @ (matches.left @ R.T - matches.right)[..., None])[..., 0]
        off_px: FloatArray = np.linalg.norm(off, axis=-1)
        weights = 1 / (1 + (off_px / limit_px) ** 2)
        # The turn that lays the weighted left rays on the right ones (Kabsch 1976).
        U, _, Vt = np.linalg.svd((weights[:, None] * matches.right).T @ matches.left)
        R = U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt
    return off_px


def _one_a_cell(pixels: FloatArray) -> BoolArray:
    """The first of the pixels [N, 2] in each cell of a grid [N]."""
    cells = np.floor(pixels / (np.ptp(pixels, axis=0).max() / CELLS + 1e-9))
    _, first = np.unique(cells, axis=0, return_index=True)
    mask = np.zeros(len(pixels), bool)
    mask[first] = True
    return mask


def _log_choices(count: int, chosen: int) -> float:
    """log of the binomial coefficient; 0 where there is none."""
    if chosen > count:
        return 0.0
    return float(gammaln(count + 1) - gammaln(chosen + 1) - gammaln(count - chosen + 1))


def accompanied(pose: Pose, matches: RayMatches, limit_px: float) -> BoolArray:
    """Whether one of the 8 nearest matches [N] in the left image lies at a similar distance.

    Of surfaces most do. A wrong match that happens to lie on its epipolar line does not, and epipolar
    geometry alone would never tell. All are kept where fewer than half have company.
    """
    if len(matches) <= NEIGHBOURS:
        return np.ones(len(matches), bool)
    inverse = meeting(pose, matches).inverse_distance
    near = np.asarray(cKDTree(matches.left).query(matches.left, NEIGHBOURS + 1)[1])
    tolerance = SIMILAR * np.abs(inverse) + limit_px * _rad_per_px(matches)
    differences = np.abs(inverse[near[:, 1:]] - inverse[:, None])
    similar: BoolArray = np.any(differences <= tolerance[:, None], axis=1)
    return similar if 2 * similar.sum() >= len(matches) else np.ones(len(matches), bool)


def _rad_per_px(matches: RayMatches) -> FloatArray:
    """What a pixel of the right image spans [N], the root mean square over its directions."""
    span: FloatArray = np.linalg.norm(matches.per_pixel_right, axis=(1, 2)) / np.sqrt(2)
    return span
