"""What a calibration's uncertainty does to rows and depth: covariance propagated to first order.

A left source pixel p shows a point at the distance d. The true rig differs from the believed one by
δθ ~ N(0, Σ), so the point appears in the right image at p'(θ), and the believed rectification puts it
at (û', v̂'). The left pixel's place (û, v̂) is fixed, hence

    row error  σ² = g Σ gᵀ with g = ∂v̂'/∂θ,    1/d  σ² = h Σ hᵀ with h = (∂û'/∂θ) / (∂û'/∂(1/d)),

with exact derivatives of the same formulas that project and rectify. Inverse distance is what a
disparity tells: its error is finite for a point at infinity, and that of d is d σ(1/d) of d.
A normal δθ makes E|row error| = sqrt(2/π) σ, what a report's `row_error_mean_px` measures.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from rectbench.cameras.projection import as_points
from rectbench.errors import InvalidInput, argument
from rectbench.metrics.analyses.propagation import GROUPS, Propagation
from rectbench.rigs import Rig
from rectbench.rigs.covariance import RigCovariance
from rectbench.scored import dense_pixels
from rectbench.types import FloatArray
from rectbench.warps import Rectification
from rectbench.warps.jacobians import finite

MEAN_OF_ABSOLUTE = math.sqrt(2 / math.pi)
"""E|x| of a normal x with σ = 1."""
DEPTHS_IN_BASELINES = (10.0, 100.0, math.inf)
"""Where points are taken to be unless the caller says."""
BLOCK = 1 << 18
"""Pixels propagated at once."""


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """σ of row error and of distance at left source pixels, for points at K distances.

    NaN where a pixel's point lands not in both images, source and rectified.
    """

    pixels: FloatArray
    """[..., 2], left source pixels."""
    depth_m: tuple[float, ...]
    """The K distances from the left camera, metres; may be infinite."""
    matching_px: float
    """σ of a match's disparity, and of its row difference, in rectified pixels."""
    row_error_sigma_px: FloatArray
    """[K, ...], rectified pixels, by the calibration alone."""
    inverse_depth_sigma_per_m: FloatArray
    """[K, ...], of 1/d, by the calibration alone."""
    matched_inverse_depth_sigma_per_m: FloatArray
    """[K, ...], of 1/d, with the noise of matching."""
    row_error_shares: Mapping[str, FloatArray] = field(repr=False)
    """[K] by group of parameters: its share of the variance, summed over the pixels."""
    depth_shares: Mapping[str, FloatArray] = field(repr=False)
    """[K] by group of parameters: its share of the variance at a pixel, the mean over the pixels."""

    @property
    def depth_sigma_share(self) -> FloatArray:
        """[K, ...], σ of the distance as a share of it, by the calibration alone; NaN at infinity."""
        return self._of_distance(self.inverse_depth_sigma_per_m)

    @property
    def matched_depth_sigma_share(self) -> FloatArray:
        """[K, ...], σ of the distance as a share of it, with the noise of matching; NaN at infinity."""
        return self._of_distance(self.matched_inverse_depth_sigma_per_m)

    @property
    def matched_row_error_sigma_px(self) -> FloatArray:
        """[K, ...], σ of the row difference of a match, rectified pixels."""
        total: FloatArray = np.hypot(self.row_error_sigma_px, self.matching_px)
        return total

    def numbers(self) -> tuple[dict[str, float], ...]:
        """The map's numbers for each distance, by name with unit; NaN where no pixel tells."""
        return tuple(self._numbers(k) for k in range(len(self.depth_m)))

    def _numbers(self, k: int) -> dict[str, float]:
        sigma, matched = finite(self.row_error_sigma_px[k]), finite(self.matched_row_error_sigma_px[k])
        inverse = finite(self.inverse_depth_sigma_per_m[k])
        depth, matched_depth = self.depth_sigma_share[k], self.matched_depth_sigma_share[k]
        return {
            "depth_m": self.depth_m[k],
            "pixels_share": sigma.size / max(1, self.row_error_sigma_px[k].size),
            "row_error_sigma_rms_px": _over(sigma, lambda s: np.sqrt(np.square(s).mean())),
            "row_error_sigma_p95_px": _quantile(sigma, 0.95),
            "row_error_sigma_max_px": _over(sigma, np.max),
            "row_error_expected_mean_px": MEAN_OF_ABSOLUTE * _over(sigma, np.mean),
            "row_error_expected_mean_matched_px": MEAN_OF_ABSOLUTE * _over(matched, np.mean),
            "depth_sigma_median_share": _quantile(finite(depth), 0.5),
            "depth_sigma_p95_share": _quantile(finite(depth), 0.95),
            "depth_sigma_median_matched_share": _quantile(finite(matched_depth), 0.5),
            "depth_sigma_p95_matched_share": _quantile(finite(matched_depth), 0.95),
            "inverse_depth_sigma_median_per_m": _quantile(inverse, 0.5),
            **{
                f"row_error_share_{_word(g)}": float(shares[k]) for g, shares in self.row_error_shares.items()
            },
            **{f"depth_share_{_word(g)}": float(shares[k]) for g, shares in self.depth_shares.items()},
        }

    def _of_distance(self, of_inverse: FloatArray) -> FloatArray:
        distance = np.array([d if math.isfinite(d) else math.nan for d in self.depth_m])
        shares: FloatArray = of_inverse * distance.reshape(-1, *[1] * (of_inverse.ndim - 1))
        return shares


def uncertainty(
    rect: Rectification,
    rig: Rig,
    covariance: RigCovariance,
    *,
    depth_m: float | Sequence[float] | None = None,
    matching_px: float = 0.0,
    pixels: ArrayLike | None = None,
) -> Uncertainty:
    """σ of row error and of distance along the left image, from the covariance of the calibration.

    Parameters
    ----------
    rect : the rectification of the believed rig.
    rig : the rig about which the truth is spread, as a rule `rect.rig`.
    covariance : of the rig's parameters.
    depth_m : distances of the points seen, metres or infinity; by default 10 and 100 baselines and
        infinity.
    matching_px : σ of a match's disparity and of its row difference, in rectified pixels.
    pixels : left source pixels [..., 2]; by default a regular grid of some 150,000 that the lens sees.

    Raises UnknownName for a parameter of the covariance that the rig has not, InvalidInput for a
    distance or noise that is none.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> unsure = rb.RigCovariance.from_sigmas(rig, rotation_deg=0.1)
    >>> found = uncertainty(rb.rectify(rig, method="abraham"), rig, unsure, pixels=[[400.0, 380.0]])
    >>> found.row_error_sigma_px.shape
    (3, 1)
    """
    covariance.refuse_unknown(rig)
    depths = _checked_depths(depth_m, rig)
    if not 0 <= matching_px < math.inf:
        raise InvalidInput(
            f"{argument('matching_px')} is {matching_px!r}; expected a number of pixels from 0 on"
        )
    grid = dense_pixels(rig.left) if pixels is None else as_points(pixels, 2, "pixels")
    flat = grid.reshape(-1, 2)
    propagation = Propagation(rect, rig, covariance)
    found = [_propagated(propagation, flat, depth, matching_px) for depth in depths]
    shape = (len(depths), *grid.shape[:-1])

    def shares(per_depth: Sequence[FloatArray]) -> Mapping[str, FloatArray]:
        return MappingProxyType(dict(zip(GROUPS, np.stack(per_depth, axis=1), strict=True)))

    return Uncertainty(
        pixels=grid,
        depth_m=depths,
        matching_px=float(matching_px),
        row_error_sigma_px=np.stack([at.row for at in found]).reshape(shape),
        inverse_depth_sigma_per_m=np.stack([at.inverse for at in found]).reshape(shape),
        matched_inverse_depth_sigma_per_m=np.stack([at.matched for at in found]).reshape(shape),
        row_error_shares=shares([at.row_shares for at in found]),
        depth_shares=shares([at.depth_shares for at in found]),
    )


class _AtDistance(NamedTuple):
    """σ of the row, of 1/d and of 1/d with matching [N] each; the groups' shares in row and 1/d [4]."""

    row: FloatArray
    inverse: FloatArray
    matched: FloatArray
    row_shares: FloatArray
    depth_shares: FloatArray


def _propagated(
    propagation: Propagation, pixels: FloatArray, depth_m: float, matching_px: float
) -> _AtDistance:
    row, inverse, matched = (np.full(len(pixels), math.nan) for _ in range(3))
    by_row, by_inverse, counted = np.zeros(len(GROUPS)), np.zeros(len(GROUPS)), 0
    for first in range(0, len(pixels), BLOCK):
        block = slice(first, first + BLOCK)
        of_row, of_inverse, px_per_inverse = propagation.at(pixels[block], 1 / depth_m)
        for sigma, parts in ((row, of_row), (inverse, of_inverse)):
            sigma[block] = np.sqrt(np.maximum(parts.sum(axis=1), 0))  # rounding may be below 0
        with np.errstate(divide="ignore", invalid="ignore"):
            matched[block] = np.hypot(inverse[block], matching_px / np.abs(px_per_inverse))
            share = of_inverse / np.square(inverse[block])[:, None]
        told = np.isfinite(share).all(axis=1)
        by_row += np.nansum(of_row, axis=0)
        by_inverse += share[told].sum(axis=0)
        counted += int(told.sum())
    with np.errstate(invalid="ignore"):
        return _AtDistance(row, inverse, matched, by_row / by_row.sum(), by_inverse / np.float64(counted))


def _checked_depths(depth_m: float | Sequence[float] | None, rig: Rig) -> tuple[float, ...]:
    given = (
        [b * rig.baseline_m for b in DEPTHS_IN_BASELINES] if depth_m is None else np.ravel(depth_m).tolist()
    )
    if not given or not all(isinstance(d, int | float) and d > 0 for d in given):
        raise InvalidInput(
            f"{argument('depth_m')} is {depth_m!r}; expected distances above 0 in metres, or infinity"
        )
    return tuple(map(float, given))


def _over(values: FloatArray, summary: Any) -> float:
    return float(summary(values)) if values.size else math.nan


def _quantile(values: FloatArray, share: float) -> float:
    return _over(values, lambda v: np.quantile(v, share))


def _word(group: str) -> str:
    return group.replace(" ", "_")
