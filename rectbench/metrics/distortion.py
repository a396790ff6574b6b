"""Resampling distortion: the paper's L under three protocols.

Zhou, Dai and Li, section III-D. L is 1 for an image shrunk to nothing, and log distortion, its
scale-free companion, has no such optimum; so the protocols stand side by side.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar

from rectbench.errors import InvalidInput
from rectbench.plugins.metric import Case, Column, Metric, Tolerance
from rectbench.rigs import Rig
from rectbench.types import FloatArray
from rectbench.warps import Rectification
from rectbench.warps.jacobians import Jacobians, entries, losses

Protocol = Literal["native", "rescaled", "stretched"]
WEIGHTS = np.sqrt([1.0, 0.5, 0.5])
"""Roots of the weights of area, ratio and skew: the paper's α1 = α2 = 0.5."""


STRETCH_PIXELS = (500, 4_000)
"""Pixels on which the best stretch is looked for and found: L is flat about its minimum, and 4,000 of 20,000
pixels move it by a few thousandths at the most."""
ELONGATIONS = tuple(np.linspace(-3.0, 3.0, 13).tolist())
"""Logarithms of how much longer û may be than v̂ is, and shorter, that are tried."""


class Distortion(float):
    """Mean distortion L per pixel over both images; a float, with its parts.

    NaN where the rectification maps none of the pixels.
    """

    protocol: str
    scales: tuple[float, float]
    """(s_u, s_v) by which the rectified image was scaled under the protocol."""
    terms: Mapping[str, float]
    """Means of `area`, `ratio` and `skew`, weights included: they sum to L."""
    per_pixel: Mapping[str, FloatArray]
    """L of each pixel by side, `left` [N] and `right` [M]; NaN where a pixel is not mapped."""
    valid_share: float
    """Share of the pixels that the rectification maps."""
    weights: FloatArray
    """[K], of the mapped pixels, left then right."""

    @property
    def mean(self) -> float:
        """The value itself."""
        return float(self)

    @property
    def median(self) -> float:
        """Median over the mapped pixels of both images."""
        return self._quantile(0.5)

    @property
    def p95(self) -> float:
        """95th percentile over the mapped pixels of both images."""
        return self._quantile(0.95)

    def _quantile(self, share: float) -> float:
        values = np.concatenate([self.per_pixel["left"], self.per_pixel["right"]])
        values = values[~np.isnan(values)]
        if not values.size:
            return math.nan
        return float(np.quantile(values, share, weights=self.weights, method="inverted_cdf"))


def distortion(
    rect: Rectification, rig: Rig, pixels: ArrayLike | None = None, protocol: Protocol = "native"
) -> Distortion:
    """Mean of (S-1)² + ½(|w1|-|w2|)² + ½(w1·w2)² over pixels of both images.

    Parameters
    ----------
    rect : the rectification to score.
    rig : the rig whose images it warps; only its cameras matter, and they must be the warps' own.
    pixels : [N, 2] source pixels, used for both images; None means each image's ~500. They count wherever
        they are mapped to; the rows of a run count what the rectified images show.
    protocol : `native` as the method scales it; `rescaled` by the single factor with the least L;
        `stretched` by the factors of û and of v̂ with the least L.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> found = distortion(rb.rectify(rig, method="abraham"), rig, protocol="rescaled")
    >>> sorted(found.terms), round(float(found - sum(found.terms.values())), 9)
    (['area', 'ratio', 'skew'], 0.0)
    """
    if (rig.left.size, rig.right.size) != (rect.left.source.size, rect.right.source.size):
        raise InvalidInput(f"the rectification is not one of rig {rig.name}: their image sizes differ")
    return distortion_of(Jacobians.at(rect, pixels), protocol)


def no_scale(J: FloatArray, weights: FloatArray | None = None) -> tuple[float, float]:
    """The scales of the native protocol."""
    return 1.0, 1.0


def distortion_of(jacobians: Jacobians, protocol: Protocol = "native") -> Distortion:
    """The distortion of Jacobians already computed; see `distortion`."""
    if protocol not in PROTOCOLS:
        raise InvalidInput(f"protocol is {protocol!r}; expected one of {', '.join(PROTOCOLS)}")
    scales = PROTOCOLS[protocol](jacobians.both, jacobians.weights)
    scaled = (J * np.array(scales)[:, None] for J in (jacobians.left, jacobians.right))
    per_pixel = dict(zip(("left", "right"), map(_terms, scaled), strict=True))
    means = np.full(3, math.nan)
    if len(jacobians.both):
        terms = np.concatenate(list(per_pixel.values()), axis=1)[:, jacobians.exist]
        means = terms @ jacobians.weights / jacobians.weights.sum()
    score = Distortion(means.sum())
    score.protocol, score.scales, score.valid_share = protocol, scales, jacobians.valid_share
    score.terms = dict(zip(("area", "ratio", "skew"), map(float, means), strict=True))
    score.per_pixel = {side: values.sum(axis=0) for side, values in per_pixel.items()}
    score.weights = jacobians.weights
    return score


def _terms(J: FloatArray) -> FloatArray:
    """Weighted area, ratio and skew losses [3, N] of Jacobians [N, 2, 2]."""
    return _residuals(J) ** 2


def _residuals(J: FloatArray) -> FloatArray:
    weighted: FloatArray = WEIGHTS[:, None] * losses(*entries(J), np)
    return weighted


def best_scale(J: FloatArray, weights: FloatArray | None = None) -> tuple[float, float]:
    """The single scale s with the least L, twice."""
    if not len(J):
        return 1.0, 1.0
    gain, cost = _by_scale(J, weights)
    scale = math.sqrt(max(0.0, gain / cost))
    return scale, scale


def best_stretch(J: FloatArray, weights: FloatArray | None = None) -> tuple[float, float]:
    """The scales (s_u, s_v) with the least L, the same for both images.

    Of an elongation t, s_u = s eᵗ and s_v = s e⁻ᵗ, the scale s is in closed form. L has several minima in t.
    """
    if not len(J):
        return 1.0, 1.0
    few, most = (slice(None, None, max(1, len(J) // count)) for count in STRETCH_PIXELS)
    near = min(ELONGATIONS, key=lambda t: _least_loss(t, J[few], _part(weights, few)))
    step = ELONGATIONS[1] - ELONGATIONS[0]
    sampled = J[most], _part(weights, most)
    best = minimize_scalar(_least_loss, bounds=(near - step, near + step), args=sampled, method="bounded").x
    scale, _ = best_scale(_elongated(best, sampled[0]), sampled[1])
    return scale * math.exp(best), scale * math.exp(-best)


def _by_scale(J: FloatArray, weights: FloatArray | None) -> tuple[float, float]:
    """(g, c) of L(s) = mean[(s² S - 1)² + s² r + s⁴ k] = 1 - 2 g s² + c s⁴, a parabola in s²."""
    S = losses(*entries(J), np)[0] + 1
    _, ratio, skew = _terms(J)
    gain, cost = (float(np.average(x, weights=weights)) for x in (S - ratio / 2, np.square(S) + skew))
    return gain, cost


def _least_loss(elongation: float, J: FloatArray, weights: FloatArray | None) -> float:
    """L at the best scale."""
    gain, cost = _by_scale(_elongated(elongation, J), weights)
    return 1 - max(0.0, gain) ** 2 / cost


def _elongated(elongation: float, J: FloatArray) -> FloatArray:
    return J * np.exp([elongation, -elongation])[:, None]


def _part(weights: FloatArray | None, part: slice) -> FloatArray | None:
    return None if weights is None else weights[part]


PROTOCOLS: Mapping[Protocol, Callable[[FloatArray, FloatArray], tuple[float, float]]] = {
    "native": no_scale,
    "rescaled": best_scale,
    "stretched": best_stretch,
}


SCALED: tuple[Protocol, ...] = ("rescaled", "stretched")


def distortion_column(key: str, heading: str, meaning: str, **more: Any) -> Column:
    """A distortion: better the smaller it is, without bound above, and rounding below 10⁻⁶."""
    return Column(key, heading, "", "lower", meaning, average="geometric", floor=1e-6, **more)


class DistortionMetric(Metric):
    """Distortion L over all that is shown, under each protocol."""

    name, topic = "distortion", "Distortion"
    columns = tuple(
        distortion_column(
            f"distortion_{protocol}",
            f"distortion, {protocol}",
            meaning,
            tolerance=Tolerance(0.01, 1e-6),
            shown=shown,
            promised=True,
            panel=f"{protocol}: {how}",
        )
        for protocol, shown, how, meaning in (
            (
                "native",
                "page",
                "as its authors scale it",
                "The paper's mean L per source pixel that is shown, at the scale each method's authors "
                "choose. An image shrunk to nothing has L = 1.",
            ),
            ("rescaled", "topic", "best single scale", "L after the one scale that is best for it."),
            (
                "stretched",
                "topic",
                "best width and height",
                "L after the best scales of width and of height.",
            ),
        )
    )

    def compute(self, case: Case) -> dict[str, float]:
        """L of both images together, by their lookup tables."""
        shown = case.delivered.shown
        scaled = {f"distortion_{name}": float(distortion_of(shown, name)) for name in SCALED}
        return {"distortion_native": float(case.once(_native)), **scaled}


class DistortionDetail(Metric):
    """Median, 95th percentile and terms of native distortion, and what it is at the pixels a method knows."""

    name, topic = "distortion_detail", "Distortion"
    columns = (
        distortion_column(
            "distortion_native_median", "distortion, median", "Median of native L over the pixels."
        ),
        distortion_column(
            "distortion_native_p95", "distortion, p95", "95th percentile of native L over the pixels."
        ),
        *(
            distortion_column(f"distortion_native_{term}", f"distortion, {term} term", meaning, shown="pairs")
            for term, meaning in (
                ("area", "The part of native L from (S − 1)²."),
                ("ratio", "The part from ½(|w1| − |w2|)²."),
                ("skew", "The part from ½(w1·w2)²."),
            )
        ),
        distortion_column(
            "distortion_native_grid",
            "distortion, known pixels",
            "Native L by the stated Jacobian at the ~500 pixels that the method was given, shown or not.",
            shown="pairs",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Of both images together."""
        native = case.once(_native)
        return {
            "distortion_native_median": native.median,
            "distortion_native_p95": native.p95,
            "distortion_native_grid": float(distortion_of(Jacobians.at(case.rect))),
            **{f"distortion_native_{term}": value for term, value in native.terms.items()},
        }


def _native(case: Case) -> Distortion:
    return distortion_of(case.delivered.shown)
