"""The paper's Theorems 1 and 2 as pictures: which transformations of rectified rays leave rows alone.

Zhou, Dai and Li, section II-A. Rays b and b' of one point in the two rectified frames satisfy b'ᵀ [e]× b = 0
with e = (1, 0, 0): they lie in one plane through the baseline. A and A' may follow if A'ᵀ [e]× A = [e]×, up
to scale.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from rectbench.plugins.figure import Drawing, Figure, FigureData
from rectbench.reporting.style import INK, PAGE_INCHES
from rectbench.types import FloatArray

if TYPE_CHECKING:
    import matplotlib.figure
    from matplotlib.axes import Axes

PLANES, POINTS = 7, 9
"""Epipolar planes, and points in each."""
ACROSS_DEG, ALONG_DEG = 45.0, 50.0
"""How far planes, and points within them, lie from the axis."""
NEAREST_BASELINES, FARTHEST_BASELINES = 3.0, 30.0
CROSS = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""[e]×, e = (1, 0, 0)."""


@dataclass(frozen=True, eq=False)
class Rays:
    """Rays of the same points in both rectified frames, plane by plane."""

    left: FloatArray
    """[planes, points, 3]"""
    right: FloatArray
    """[planes, points, 3]"""


def point_rays(seed: int = 0) -> Rays:
    """Points spread over the view at several depths; the same for one seed."""
    rng = np.random.default_rng(seed)
    beta, gamma = np.meshgrid(
        np.radians(np.linspace(-ACROSS_DEG, ACROSS_DEG, PLANES)),
        np.radians(np.linspace(-ALONG_DEG, ALONG_DEG, POINTS)),
        indexing="ij",
    )
    left = np.stack([np.sin(gamma), np.cos(gamma) * np.sin(beta), np.cos(gamma) * np.cos(beta)], axis=-1)
    depth = rng.uniform(NEAREST_BASELINES, FARTHEST_BASELINES, beta.shape)
    right = left - np.array([1.0, 0.0, 0.0]) / depth[..., None]
    return Rays(left, right / np.linalg.norm(right, axis=-1, keepdims=True))


def image_of(A: FloatArray, rays: FloatArray) -> FloatArray:
    """(û, v̂) [..., 2] of rays [..., 3]: (û, v̂, 1) ~ A b, A [3, 3] or one a ray."""
    moved = np.einsum("...ij,...j->...i", A, rays)
    return np.asarray(moved[..., :2] / moved[..., 2:])


def keeps_planes(A: FloatArray, A_right: FloatArray) -> bool:
    """Whether A'ᵀ [e]× A is [e]×, up to scale, for non-singular A [3, 3] and A' [3, 3]."""
    product = A_right.T @ CROSS @ A
    scale = product[2, 1]
    return bool(scale and np.allclose(product, scale * CROSS, atol=1e-12 * abs(scale)))


def theorem_1(
    first: FloatArray, first_right: FloatArray, block: FloatArray, factor: FloatArray | float = 1.0
) -> tuple[FloatArray, FloatArray]:
    """A and A' [..., 3, 3]: first rows [..., 3] of their own, and a 2x2 block that is one up to a factor."""
    factor = np.asarray(factor)[..., None, None]
    return _assembled(first, block), _assembled(first_right, factor * block)


def _assembled(first: FloatArray, block: FloatArray) -> FloatArray:
    shape = np.broadcast_shapes(first.shape[:-1], block.shape[:-2])
    A = np.zeros((*shape, 3, 3))
    A[..., 0, :], A[..., 1:, 1:] = first, block
    return A


@dataclass(frozen=True, eq=False)
class Example:
    """A choice of A and A', and where it takes the points."""

    title: str
    left: FloatArray = field(repr=False)
    """[planes, points, 2]"""
    right: FloatArray = field(repr=False)

    @property
    def row_error(self) -> float:
        """The largest |v̂ - v̂'|, as a share of the image's height."""
        rows = np.concatenate([self.left[..., 1].ravel(), self.right[..., 1].ravel()])
        return float(np.abs(self.left[..., 1] - self.right[..., 1]).max() / np.ptp(rows))


def examples(rays: Rays) -> tuple[Example, ...]:
    """Rotation alone; one A for all pixels; an A a pixel that rows share; an A a pixel that they do not."""
    still = np.eye(3)
    shear = np.array([1.0, 0.25, -0.1]), np.array([1.2, -0.3, 0.2])
    block = np.array([[1.0, 0.15], [0.2, 1.1]])
    one, one_right = theorem_1(*shear, block, 1.7)
    per_pixel, per_pixel_right = _pixel_variant(rays.left), _pixel_variant(rays.right)
    # The block follows each image's own columns: nothing ties it to the other's.
    loose, loose_right = _column_variant(rays.left), _column_variant(rays.right)
    return (
        Example("R alone\nA = A′ = I", image_of(still, rays.left), image_of(still, rays.right)),
        Example("one A, one A′\nof Theorem 1", image_of(one, rays.left), image_of(one_right, rays.right)),
        Example(
            "an A a pixel, the 2×2 block\na function of β alone",
            image_of(per_pixel, rays.left),
            image_of(per_pixel_right, rays.right),
        ),
        Example(
            "an A a pixel, the block\nchosen freely: rows are lost",
            image_of(loose, rays.left),
            image_of(loose_right, rays.right),
        ),
    )


def _pixel_variant(rays: FloatArray) -> FloatArray:
    """û = γ, v̂ = β, an equidistant epipolar image, as an A a ray: Theorem 2 lets both be chosen apart."""
    x, y, z = np.moveaxis(rays, -1, 0)
    gamma, beta = np.arctan2(x, np.hypot(y, z)), np.arctan2(y, z)
    ones, zeros = np.ones_like(x), np.zeros_like(x)
    first = np.stack([ones, zeros, gamma - x / z], axis=-1)
    block = np.stack([np.stack([ones, beta - y / z], axis=-1), np.stack([zeros, ones], axis=-1)], axis=-2)
    return _assembled(first, block)


def _column_variant(rays: FloatArray) -> FloatArray:
    """The same but for the block, which turns with γ."""
    A = _pixel_variant(rays)
    A[..., 1, 2] += 0.5 * np.sin(3 * np.arctan2(rays[..., 0], np.hypot(rays[..., 1], rays[..., 2])))
    return A


class Theorems(Figure):
    """Which transformations leave rows alone: Theorems 1 and 2 of the paper."""

    name, topic = "theorems", "Theorems"

    def drawings(self, given: FigureData) -> Iterator[Drawing]:
        """One, the same for every rig."""
        shown = examples(point_rays())
        yield Drawing(
            stem="theorems",
            title="Rows and columns: what may be chosen, and what may not",
            caption=(
                "The same points in the left and right rectified image, a colour for each epipolar plane, "
                "under four choices of A and A′. Theorem 1: the first rows of A and A′ are free, so that "
                "columns are; the 2×2 blocks that make the rows are one, up to a factor. Theorem 2: so û and "
                "v̂ may be chosen apart, and at each pixel anew, as long as v̂ is a function of the plane. "
                "Chosen freely at each pixel, as the sentence after Theorem 1 can be read, the block loses "
                "the rows."
            ),
            made_from=[(e.title, e.left.tolist(), e.right.tolist()) for e in shown],
            draw=lambda: _draw(shown),
        )


def _draw(shown: tuple[Example, ...]) -> matplotlib.figure.Figure:
    from matplotlib.figure import Figure as Canvas

    figure = Canvas(figsize=(PAGE_INCHES, 2.6), layout="constrained")
    cells: Any = figure.subfigures(1, len(shown))
    for cell, example in zip(cells, shown, strict=True):
        cell.suptitle(f"{example.title}\nlargest row error {100 * example.row_error:.1f} %", fontsize=6.5)
        left, right = cell.subplots(1, 2, sharey=True)
        _draw_image(left, example.left, "left")
        _draw_image(right, example.right, "right")
    return figure


def _draw_image(ax: Axes, places: FloatArray, side: str) -> None:
    from matplotlib import colormaps

    shades = colormaps["viridis"](np.linspace(0, 0.9, PLANES))
    for plane, shade in zip(places, shades, strict=True):
        ax.plot(*plane.T, "o-", color=shade, markersize=2, linewidth=0.7)
    if not ax.yaxis_inverted():
        ax.invert_yaxis()
    ax.set_xlabel(side, fontsize=6, color=INK)
    ax.set_xticks([])
    ax.set_yticks([])
    ax.margins(0.08)
