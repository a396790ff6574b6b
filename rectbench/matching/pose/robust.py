"""The pose that most matches agree on: RANSAC over five-point samples with local optimisation.

Fischler and Bolles 1981; the local steps are those of Chum, Matas and Kittler 2003. No single
threshold decides: the cost of a distance grows with its logarithm up to the limit, so that a tight
consensus wins whatever the noise, and the noise is then measured on it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rectbench.matching.pose.epipolar import (
    Pose,
    RayMatches,
    decomposed,
    essential,
    essential_slopes,
    in_front,
    sampson_px,
)
from rectbench.matching.pose.five_point import essential_matrices
from rectbench.types import FloatArray

SAMPLE = 5
BATCH = 64
LEAST_SAMPLES = 256
"""However many agree: a narrow view trades turn for shift, and the first consensus may be off by degrees."""
MOST_SAMPLES = 6000
"""A consensus of a quarter of the matches is then found with 99.7 %."""
CONFIDENCE = 0.9999
FINEST = 0.05
"""Distances below this share of the limit cost next to nothing."""
LEVERAGE_BOUND = 3.0
"""Multiple of the mean leverage, 5 / N in a plain fit, above which a match is weighted down."""
DAMPING = 1e-12
"""Share of a Hessian's trace that is added to its diagonal."""
LOCALLY_OPTIMISED = 3
SOFTNESS: FloatArray = np.geomspace(1.0, FINEST, 8)
MEASURABLE = 30
"""Distances whose median tells the noise although five numbers were fitted to make them small."""
TO_DEVIATION = 1.4826
"""From the median of absolute values to the standard deviation of a normal distribution."""


def consensus(matches: RayMatches, limit_px: float, seed: int) -> Pose:
    """The pose that at least 8 matches agree on best, as points ahead of both cameras.

    `limit_px` is the Sampson distance in source pixels from which a match counts as wrong. Two essential
    matrices fit a plane equally well; of one, many points lie behind a camera as a rule. Where both have
    all of them ahead, as when nearing a plane, only the noise decides.
    """
    terms, rng = matches.terms(), np.random.default_rng(seed)
    best, least, drawn, needed = Pose(np.eye(3), np.array([1.0, 0.0, 0.0])), np.inf, 0, float(LEAST_SAMPLES)
    while drawn < min(needed, MOST_SAMPLES):
        samples = _samples(rng, len(matches))
        candidates, _ = essential_matrices(matches.left[samples], matches.right[samples])
        costs = _cost(sampson_px(terms, candidates), limit_px)
        for i in np.argsort(costs)[:LOCALLY_OPTIMISED]:
            pose = locally_optimised(decomposed(candidates[i])[0], terms, limit_px)
            distances = sampson_px(terms, essential(pose))
            if _cost(distances, limit_px)[0] >= least:
                continue
            poses = decomposed(essential(pose))
            explained = np.where([in_front(one, matches, limit_px) for one in poses], distances, limit_px)
            costs_ahead = _cost(explained, limit_px)
            if costs_ahead.min() < least:
                best, least = poses[costs_ahead.argmin()], float(costs_ahead.min())
                share = float((np.abs(explained[costs_ahead.argmin()]) < limit_px).mean())
                needed = max(LEAST_SAMPLES, np.log1p(-CONFIDENCE) / np.log1p(-min(share**SAMPLE, 1 - 1e-12)))
        drawn += BATCH
    return best


def locally_optimised(pose: Pose, terms: FloatArray, limit_px: float) -> Pose:
    """Gauss-Newton on the Sampson distances within the limit, at first almost plain, at last as the cost.

    Only so gradually does a narrow consensus not keep what a wide one would leave.
    """
    for softness in SOFTNESS:
        residuals, *slopes = (essential(pose).ravel() @ terms.reshape(9, -1)).reshape(5, -1)
        steepness = np.maximum(np.sqrt(sum(slope * slope for slope in slopes)), np.finfo(float).tiny)
        distances = residuals / steepness
        near = np.abs(distances) < limit_px
        if near.sum() < SAMPLE:
            break
        jacobian = (essential_slopes(pose).T @ terms[:, 0, near] / steepness[near]).T
        distances = distances[near]
        weights = mallows_weights(leverages(jacobian)) / ((softness * limit_px) ** 2 + distances * distances)
        weighted = jacobian.T * weights
        step = np.linalg.solve(regular(weighted @ jacobian), -weighted @ distances)
        pose = pose.moved(step)
    return pose


def leverages(jacobian: FloatArray) -> FloatArray:
    """Leverages [N], 0 to 1, of equations [N, 5] in a least-squares fit: the diagonal of the hat matrix."""
    spread = np.linalg.inv(regular(jacobian.T @ jacobian))
    leverage: FloatArray = ((jacobian @ spread) * jacobian).sum(axis=1)
    return leverage


def mallows_weights(leverage: FloatArray) -> FloatArray:
    """Mallows' weights [N], which bound the influence of matches of high leverage.

    A wrong match on the right epipolar line seems very near to the cameras, and would so determine
    the fit: a point of high leverage keeps its residual small. (Hampel et al., Robust Statistics, 1986.)
    """
    bound = LEVERAGE_BOUND * SAMPLE / len(leverage)
    share = bound / np.maximum(leverage, np.finfo(float).tiny)
    weights: FloatArray = np.minimum(1, share) ** 2
    return weights


def regular(hessian: FloatArray) -> FloatArray:
    """A Hessian [5, 5], made invertible where it is not."""
    invertible: FloatArray = hessian + (DAMPING * np.trace(hessian) + np.finfo(float).tiny) * np.eye(5)
    return invertible


def deviation(distances: FloatArray, limit_px: float) -> float:
    """Standard deviation, px, of the distances below the limit, from their median; the limit for a few."""
    near = np.abs(distances[np.abs(distances) < limit_px])
    if near.size < MEASURABLE:
        return limit_px
    return float(TO_DEVIATION * np.median(near) * near.size / (near.size - SAMPLE))


def _samples(rng: np.random.Generator, count: int) -> NDArray[np.intp]:
    """A batch of samples [BATCH, 5] without repetition."""
    return np.argpartition(rng.random((BATCH, count)), SAMPLE, axis=1)[:, :SAMPLE]


def _cost(distances: FloatArray, limit_px: float) -> FloatArray:
    """Mean cost [K], 0 to 1, of distances [K, N]: logarithmic up to the limit, then constant."""
    relative = np.minimum(np.abs(distances), limit_px) / (FINEST * limit_px)
    cost: FloatArray = np.log1p(relative * relative).mean(axis=1) / np.log1p(FINEST**-2)
    return cost
