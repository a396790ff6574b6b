"""Dense disparity of a rectified pair: matched both ways, checked, smoothed where it is sure."""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

import rectbench.matching.dense.matchers  # noqa: F401  (shapes what is found, and belongs to the key of it)
from rectbench.cameras.projection import as_points
from rectbench.errors import InvalidInput, InvalidResult, Unavailable, argument
from rectbench.images.reading import grey8
from rectbench.matching.dense.correlation import FloatMap
from rectbench.matching.dense.matcher import USUAL_MATCHER, Image, Match, Matcher, matcher_named
from rectbench.types import BoolArray, FloatArray
from rectbench.warps import Rectification

log = logging.getLogger("rectbench.matching")

PIXELS = 1e6
"""A larger rectified image is made smaller first, to about this many pixels."""
NEAREST_BASELINES = 4.0
"""Nothing nearer to the left camera is sought, in baselines."""
WIDEST_SEARCH_PX = 512.0
FARTHEST_SHIFT_PX = 1900.0
"""A search that is wider, or further off, is done on a smaller image: OpenCV's 16 bits end at 2047."""
SEARCH_SLACK_PX = 2.0
"""Beyond infinity and the nearest depth: the pose may be a little off."""
SEARCH_CELLS, SEARCH_DEPTHS = 64, 12
"""Left pixels each way, and depths on each of their rays, that the search range is found from."""

AGREEMENT_PX = 2.0
"""The disparities of the two images may differ by this, and the smoothed one from the matched one.

What is not confirmed both ways is given up, not filled: filled in by the filter, the reconstruction
of a room has 1.5 to 3 times as many outliers. With 1 px instead of 2 the pixels that
remain are hardly better, and 2 % of the good ones are gone.
"""
SMOOTHING, GREY_SIGMA = 300.0, 1.5
"""λ and σ of the filter. OpenCV's advice for its WLS filter, λ = 8000, carries errors over whole walls."""
SURE_DEVIATION_PX = 1.0
SURE_RADIUS = 3
"""A disparity counts less the more those around it deviate from each other, as in that filter."""
SPECKLE_PX = 100
"""A connected patch of fewer pixels is taken for noise."""


@dataclass(frozen=True, eq=False)
class Disparity:
    """û_left - û_right at the pixels of the rectified left image."""

    rect: Rectification
    """The rectification that was matched: the given one, or the same at a smaller size."""
    px: FloatMap
    """[H, W] pixels of that rectified image; NaN where nothing was found, or it was not confirmed."""
    image: Image = field(repr=False)
    """[H, W, 3] the rectified left image, RGB."""
    searched_px: tuple[int, int] = (0, 0)
    """Lowest and highest disparity that was sought."""

    def __post_init__(self) -> None:
        width, height = self.rect.size
        for name, shape in (("px", (height, width)), ("image", (height, width, 3))):
            if (found := np.shape(getattr(self, name))) != shape:
                raise InvalidInput(f"{name} of a disparity has shape {found}; expected {shape}")

    def at(self, px_rect: ArrayLike) -> FloatArray:
        """Disparities [...] at pixels [..., 2] of the rectified left image; NaN where there is none.

        Bilinear where the four pixels around are of one surface, else that of the nearest pixel.
        """
        place = as_points(px_rect, 2, "px_rect")
        height, width = self.px.shape
        inside: BoolArray = np.all((place >= -0.5) & (place <= (width - 0.5, height - 0.5)), axis=-1)
        place = np.where(inside[..., None], np.clip(place, 0, (width - 1, height - 1)), 0.0)
        u, v = np.moveaxis(np.floor(place).astype(int), -1, 0)
        right, below = np.minimum(u + 1, width - 1), np.minimum(v + 1, height - 1)
        across, down = np.moveaxis(place - np.stack([u, v], axis=-1), -1, 0)
        corners = np.stack([self.px[y, x] for y in (v, below) for x in (u, right)]).astype(np.float64)
        weights = [(1 - down) * (1 - across), (1 - down) * across, down * (1 - across), down * across]
        blended = sum(w * corner for w, corner in zip(weights, corners, strict=True))
        nearest = np.where(down < 0.5, *(np.where(across < 0.5, *corners[i : i + 2]) for i in (0, 2)))
        one_surface = corners.max(axis=0) - corners.min(axis=0) <= AGREEMENT_PX
        return np.where(inside, np.where(one_surface, blended, nearest), np.nan)


def dense_disparity(
    rect: Rectification,
    left: NDArray[np.generic],
    right: NDArray[np.generic],
    *,
    matcher: str | Path | Match = USUAL_MATCHER,
    pixels: float = PIXELS,
    nearest_baselines: float = NEAREST_BASELINES,
) -> Disparity:
    """Dense disparity of a pair.

    Parameters
    ----------
    rect : a rectification of the pair's rig, by any method.
    left, right : the photographs, [H, W] or [H, W, 1 to 4 channels] (RGB, alpha last), of their
        cameras' sizes, 8 or 16 bits or float.
    matcher : the name of one or the path of its file, see `matcher`, or a function, see `Match`.
    pixels : a rectified image of more pixels is made smaller; smaller still where the search would
        be too wide (`Disparity.rect` tells the size).
    nearest_baselines : nearest distance from the left camera at which things are sought, in
        baselines; the farthest is infinity. Both follow from the warps, whatever their columns are.

    What a matcher finds counts where the right image agrees (left-right check) in pixels that
    both images really show. It is then smoothed along the image's edges, by weighted least squares,
    and kept where that hardly changes it. A pair whose views share nothing has no disparity at all.

    Raises InvalidInput for images that are not the rig's, UnknownName for a matcher nobody knows,
    InvalidResult for one that answers with something else than disparities, Unavailable where this
    OpenCV has no WLS filter.
    """
    match = matcher_named(matcher)
    for name, number in (("pixels", pixels), ("nearest_baselines", nearest_baselines)):
        if not (isinstance(number, int | float | np.number) and 0 < number < math.inf):
            raise InvalidInput(f"{argument(name)} is {number!r}; expected a number above 0")
    span = shared_disparities(rect, nearest_baselines)
    factor = _working_factor(rect, span, pixels)
    images = [rgb8(image, side) for image, side in ((left, "left"), (right, "right"))]
    shown: list[Any] = list(rect.remap(images[0], images[1]))
    if factor < 1:
        rect = rect.scaled(factor)
        shown = [cv2.resize(image, rect.size, interpolation=cv2.INTER_AREA) for image in shown]
    if span is None:
        return Disparity(rect, np.full(shown[0].shape[:2], np.nan, np.float32), shown[0])
    lowest = math.floor(span[0] * factor - SEARCH_SLACK_PX)
    highest = math.ceil(span[1] * factor + SEARCH_SLACK_PX)
    valid = rect.valid("left"), rect.valid("right")
    extended = [_extended(image, mask) for image, mask in zip(shown, valid, strict=True)]
    forth, back = _both_ways(match, extended[0], extended[1], lowest, highest)
    forth[~valid[0]] = np.nan
    back[~valid[1]] = np.nan
    found = settled(_agreeing(forth, back), grey8(extended[0]))
    return Disparity(rect, found, shown[0], (lowest, highest))


def rgb8(image: NDArray[np.generic], side: str = "") -> Image:
    """An image as `grey8` takes them, as uint8 RGB [H, W, 3]; all channels are stretched alike."""
    pixels = np.asarray(image)
    grey = grey8(pixels, side)  # says what is wrong with an array that is no image
    channels = pixels.shape[2] if pixels.ndim == 3 else 1
    if channels < 3:
        return np.repeat(grey[..., None], 3, axis=2)
    colours = pixels[..., :3]
    if colours.dtype == np.uint8:
        return np.ascontiguousarray(colours)
    return grey8(colours.reshape(len(colours), -1), side).reshape(colours.shape)


def shared_disparities(rect: Rectification, nearest_baselines: float) -> tuple[float, float] | None:
    """Least and greatest disparity, px, of points from `nearest_baselines` to infinity that both see.

    From the warps themselves, so that it holds for columns of any kind, for homographies and for the
    cameras in either order. None where the views share nothing.
    """
    width, height = rect.size
    u, v = np.linspace(0, width - 1, SEARCH_CELLS), np.linspace(0, height - 1, SEARCH_CELLS)
    grid = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    grid = grid[rect.left.source.contains(rect.left.inverse(grid))]
    rays = rect.left.target.unproject(grid)[0] @ rect.R_rect_left
    nearness = np.linspace(0, 1 / (nearest_baselines * rect.rig.baseline_m), SEARCH_DEPTHS)
    points = (rays @ rect.rig.R_right_left.T)[:, None] + nearness[:, None] * rect.rig.t_right_left
    seen = rect.right.source.contains(rect.right.source.project(points)[0])
    columns, rows = np.moveaxis(rect.right.target.project(points @ rect.R_rect_right.T)[0], -1, 0)
    shared = seen & (columns >= 0) & (columns <= width - 1) & (rows >= 0) & (rows <= height - 1)
    disparities = (grid[:, None, 0] - columns)[shared]
    return (float(disparities.min()), float(disparities.max())) if disparities.size else None


def _working_factor(rect: Rectification, span: tuple[float, float] | None, pixels: float) -> float:
    width, height = rect.size
    factor = min(1.0, math.sqrt(pixels / (width * height)))
    if span is None:
        return factor
    wide, far = span[1] - span[0], max(map(abs, span))
    searchable = min(WIDEST_SEARCH_PX / max(wide, 1.0), FARTHEST_SHIFT_PX / max(far, 1.0))
    if searchable < factor:
        log.warning(
            "disparities of %.0f to %.0f px are too many to search: the pair is matched at %.2g of its size",
            *span,
            searchable,
        )
    return min(factor, searchable)


def _extended(image: Image, valid: BoolArray) -> Image:
    """The image with its nearest valid pixel wherever it shows nothing.

    Black there would be matched with black: up to 3 % of the pixels, those by the rim, would be lost.
    """
    if valid.all() or not valid.any():
        return image
    _, label = cv2.distanceTransformWithLabels(
        (~valid).astype(np.uint8), cv2.DIST_L2, 3, labelType=cv2.DIST_LABEL_PIXEL
    )
    colours = np.zeros((label.max() + 1, 3), np.uint8)
    colours[label[valid]] = image[valid]
    extended: Image = colours[label]
    return extended


def _both_ways(
    match: Matcher, left: Image, right: Image, lowest: int, highest: int
) -> tuple[FloatMap, FloatMap]:
    """Disparities at the pixels of the left image, and at those of the right."""

    def mirrored(image: NDArray[Any]) -> Any:
        return np.ascontiguousarray(image[:, ::-1])

    def answer(first: Image, second: Image) -> FloatMap:
        found = np.array(match(first, second, lowest, highest))
        if found.shape != first.shape[:2] or found.dtype.kind not in "uif":
            raise InvalidResult(
                f"the matcher gave {found.dtype} of shape {found.shape}; "
                f"expected disparities {first.shape[:2]}, NaN where none"
            )
        disparities: FloatMap = found.astype(np.float32)
        disparities[~((disparities >= lowest) & (disparities <= highest))] = np.nan
        return disparities

    jobs = ((left, right), (mirrored(right), mirrored(left)))
    if not match.is_reentrant:
        forth, back = (answer(*job) for job in jobs)
    else:
        with ThreadPoolExecutor(2) as threads:
            forth, back = threads.map(lambda job: answer(*job), jobs)
    return forth, mirrored(back)


def _agreeing(forth: FloatMap, back: FloatMap) -> FloatMap:
    """`forth` where the pixel of the right image that it leads to leads back."""
    width = forth.shape[1]
    target = np.arange(width, dtype=np.float32) - forth
    inside = (target > -0.5) & (target < width - 0.5)
    column = np.where(inside, np.rint(target), 0).astype(np.int32)
    answer = np.take_along_axis(back, column, axis=1)
    return np.where(inside & (np.abs(answer - forth) <= AGREEMENT_PX), forth, np.float32(np.nan))


def settled(confirmed: FloatMap, guide: Image) -> FloatMap:
    """Confirmed disparities [H, W], px, smoothed along edges of `guide` where that hardly changes them."""
    smooth = _smoothed(confirmed, guide)
    return _without_speckles(np.where(np.abs(smooth - confirmed) <= AGREEMENT_PX, smooth, np.float32(np.nan)))


def _smoothed(disparity: FloatMap, guide: Image) -> FloatMap:
    """Weighted least squares along the edges of `guide` (Min et al. 2014), in floating point.

    The weights are those of OpenCV's `DisparityWLSFilter`: none where there is no disparity, little
    where those around deviate. That filter itself keeps sixteenths of a pixel only.
    """
    if not hasattr(cv2, "ximgproc"):
        raise Unavailable("the WLS filter needs the package opencv-contrib-python-headless")
    known = np.isfinite(disparity).astype(np.float32)
    values = np.nan_to_num(disparity)
    window = (2 * SURE_RADIUS + 1, 2 * SURE_RADIUS + 1)
    count, total, squares = (cv2.blur(term, window) for term in (known, values, values * values))
    count = np.maximum(count, 1e-6)
    variance = np.maximum(squares / count - np.square(total / count), 0)
    weight = known * np.exp(-variance / SURE_DEVIATION_PX**2)
    with _in_one_piece():
        solver = cv2.ximgproc.createFastGlobalSmootherFilter(guide, SMOOTHING, GREY_SIGMA)
    smooth: FloatMap = solver.filter(values * weight) / np.maximum(solver.filter(weight), 1e-6)
    return smooth


@contextmanager
def _in_one_piece() -> Iterator[None]:
    """A smoother made here does not split the image by the number of threads, which its last digits tell."""
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(threads)


def _without_speckles(disparity: FloatMap) -> FloatMap:
    absent = -(1 << 15)
    steps = np.where(np.isfinite(disparity), np.rint(disparity * 16), absent).astype(np.int16)
    cv2.filterSpeckles(steps, absent, SPECKLE_PX, round(16 * AGREEMENT_PX))
    return np.where(steps == absent, np.float32(np.nan), disparity)
