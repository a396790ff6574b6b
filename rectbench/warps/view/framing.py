"""How a rectified pair is framed: which part of the view it shows, and with how many pixels.

A method decides where things are in relation to each other; what is cut off and how large the image is
are the user's choice. Both images get the same frame, so that rows and disparities stay what they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from rectbench.errors import InvalidInput, Unsupported
from rectbench.types import FloatArray
from rectbench.warps.frame import angles, centre_resolution_px, rectifying_rotations
from rectbench.warps.rectification import LARGEST_SIDE_PX, Rectification
from rectbench.warps.targets import Perspective
from rectbench.warps.view.extent import centre_rays
from rectbench.warps.view.inscribed import largest_rectangle
from rectbench.warps.view.sampling import evaluation_pixels, outline_pixels
from rectbench.warps.warp import Warp

COVERAGE_PIXELS = 40_000
"""Source pixels an image by which coverage is counted."""
LARGEST_PIXELS = 200e6
"""A larger rectified image is refused: its lookup tables alone would take gigabytes."""
WRAPPED_SHARE = 10 / 360
"""Of the rows that go all around, as many are repeated beyond either end of them."""
VALID_INSET_PX = 0.501
FORWARD = np.array([0.0, 0.0, 1.0])


class Window(NamedTuple):
    """A part of a rectified image, by its edges in pixels; the whole image begins at -0.5."""

    left: float
    top: float
    right: float
    bottom: float

    @property
    def centre(self) -> FloatArray:
        """[2]"""
        return np.array([self.left + self.right, self.top + self.bottom]) / 2

    @property
    def extent(self) -> FloatArray:
        """Width and height [2]."""
        return np.array([self.right - self.left, self.bottom - self.top])


@dataclass(frozen=True)
class Framing:
    """What of a rectified pair is shown, and how large; by default what the method makes of it.

    At most one of these says what is shown:

    crop : "valid", the largest rectangle in which both images show source pixels alone; or a rectangle
        (left, top, width, height) in pixels of the method's own image.
    fov_deg : (horizontal, vertical) angles about the middle of the view: the first along the epipolar
        line through it, the second across these lines.
    coverage : the smallest frame about the middle that keeps this share of the source pixels, the mean
        of both images; as many are cut off at the left as at the right, at the top as at the bottom.

    And these say how large it is:

    size : (width, height) in pixels. What is shown is fitted into it, in the middle; the valid crop fills
        it. With `focal_px` beside it, as much is shown as then fits.
    focal_px : pixels per radian where the rectified frame's own axis is, the focal length of a
        perspective image; or "source", that of the source images at their centres.
    pixels : a budget: an image of more pixels is made smaller.

    And where the rows go all around the baseline, as of a view that holds an epipole:

    seam : "cut", the image ends at β = ±180°; or "wrap", a thirty-sixth of the rows is repeated beyond
        either end, so that what lies at the seam is there in one piece too. Elsewhere both are the same.

    Raises InvalidInput for values that are none, or that contradict each other.

    >>> import rectbench as rb
    >>> rb.Framing(crop="valid", pixels=1e6).is_resized
    True
    """

    crop: Literal["valid"] | tuple[float, float, float, float] | None = None
    fov_deg: tuple[float, float] | None = None
    coverage: float | None = None
    size: tuple[int, int] | None = None
    focal_px: float | Literal["source"] | None = None
    pixels: float | None = None
    seam: Literal["cut", "wrap"] = "cut"

    def __post_init__(self) -> None:
        stated = [name for name in ("crop", "fov_deg", "coverage") if getattr(self, name) is not None]
        if len(stated) > 1:
            raise InvalidInput(f"{stated[0]} and {stated[1]} both say what is shown; expected one of them")
        if self.pixels is not None and self.size is not None:
            raise InvalidInput("size and pixels both say how large the image is; expected one of them")
        if self.crop != "valid":
            _check_numbers("crop", self.crop, 4, "valid, or left, top, width, height in pixels")
        _check_numbers("fov_deg", self.fov_deg, 2, "two angles in degrees, between 0 and 360", 0, 360)
        sides = f"width and height from 1 to {LARGEST_SIDE_PX} px"
        _check_numbers("size", self.size, 2, sides, 0, LARGEST_SIDE_PX + 1)
        if self.size is not None and any(side != int(side) for side in self.size):
            raise InvalidInput(f"size is {self.size!r}; expected whole pixels")
        if self.focal_px != "source":
            _check_numbers("focal_px", self.focal_px, 1, "a number of pixels above 0, or source", 0)
        _check_numbers("pixels", self.pixels, 1, "a number of pixels above 1", 1)
        if self.seam not in ("cut", "wrap"):
            raise InvalidInput(f"seam is {self.seam!r}; expected cut or wrap")
        if self.seam == "wrap" and stated:
            raise InvalidInput(f"seam wrap stands beside {stated[0]}; expected it where all is shown")
        if self.coverage is not None and not (_is_number(self.coverage) and 0 < self.coverage <= 1):
            raise InvalidInput(f"coverage is {self.coverage!r}; expected a share above 0, at most 1")

    @property
    def is_resized(self) -> bool:
        """Whether it says how large the image is."""
        return (self.size, self.focal_px, self.pixels) != (None, None, None)

    @property
    def is_own(self) -> bool:
        """Whether nothing is asked, and the method's own frame stands."""
        return self == Framing()


def framed(rect: Rectification, framing: Framing) -> Rectification:
    """The same rectification in another frame.

    Scales are the same along rows and columns, so that no frame adds distortion to the method's. Raises
    InvalidInput for a frame that would be empty or of more than 200 megapixels, Unsupported where the
    method cannot show what is asked.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> rb.framed(rb.rectify(rig, method="abraham"), rb.Framing(fov_deg=(100, 80))).size
    (499, 399)
    """
    if framing.is_own:
        return rect
    window = _window(rect, framing)
    if not (np.isfinite(window).all() and (window.extent > 0).all()):
        raise Unsupported("nothing is left in that frame; expected a larger crop, fov_deg or coverage")
    if framing.crop == "valid" and framing.is_resized:
        # Samples beyond the centres of the outermost valid pixels would not be valid themselves.
        window = Window(*(np.array(window) + VALID_INSET_PX * np.array([1, 1, -1, -1])))
    scale = _scale(rect, framing, window)
    wanted = framing.size or tuple(scale * window.extent)
    size = _checked_size(wanted, math.floor if framing.is_resized else round)
    # Whole pixels: the window gives way by the fraction of one, its middle stays.
    corner, extent = window.centre - np.array(size) / (2 * scale), np.array(size) / scale
    return rect.windowed((corner[0], corner[1]), (extent[0], extent[1]), size)


def focal_px(rect: Rectification) -> float:
    """Pixels per radian on the rectified frame's axis, the mean of both images: a perspective image's focal.

    Where the axis is not in the view, at the middle of the view.
    """
    densities = [_density_px(warp, FORWARD) for warp in (rect.left, rect.right)]
    if not np.isfinite(densities).all():
        seen = zip(_sides(rect), centre_rays(rect.rig), strict=True)
        densities = [_density_px(warp, R_warp_epi @ ray) for (warp, R_warp_epi), ray in seen]
    return float(np.mean(densities))


def _density_px(warp: Warp, ray: FloatArray) -> float:
    """√|det| of d(rectified pixel)/d(ray across itself), at a unit ray in the warp's rectified frame."""
    J = warp.target.project_jacobian(ray)
    return float(np.sqrt(np.sqrt(np.abs(np.linalg.det(J @ J.T)))))


def _sides(rect: Rectification) -> list[tuple[Warp, FloatArray]]:
    """Both warps, each with the rotation into its rectified frame from the rig's epipolar one.

    The two frames are one for a calibrated method; a homography's has a turn of its own.
    """
    R_epi_left, R_epi_right = rectifying_rotations(rect.rig)
    return [(rect.left, rect.R_rect_left @ R_epi_left.T), (rect.right, rect.R_rect_right @ R_epi_right.T)]


def _scale(rect: Rectification, framing: Framing, window: Window) -> float:
    if framing.focal_px is not None:
        wanted = centre_resolution_px(rect.rig) if framing.focal_px == "source" else float(framing.focal_px)
        scale = wanted / focal_px(rect)
    elif framing.size is not None:
        scales = np.array(framing.size) / window.extent
        # What is to be valid throughout fills the image; all else fits into it.
        scale = float(scales.max() if framing.crop == "valid" else scales.min())
    else:
        scale = 1.0
    if framing.pixels is not None:
        scale = min(scale, math.sqrt(framing.pixels / float(np.prod(window.extent))))
    return scale


def _window(rect: Rectification, framing: Framing) -> Window:
    if framing.crop == "valid":
        return _valid_window(rect)
    if framing.crop is not None:
        left, top, width, height = framing.crop
        return Window(left - 0.5, top - 0.5, left + width - 0.5, top + height - 0.5)
    if framing.fov_deg is not None:
        return _window_of_view(rect, *np.radians(framing.fov_deg))
    if framing.coverage is not None:
        return _covering_window(rect, framing.coverage)
    width, height = rect.size
    beyond = _rows_beyond_seam(rect) if framing.seam == "wrap" else 0.0
    return Window(-0.5, -0.5 - beyond, width - 0.5, height - 0.5 + beyond)


def _rows_beyond_seam(rect: Rectification) -> float:
    """How many rows are repeated at either end; 0 where the rows do not go all around the baseline."""
    if isinstance(rect.left.target, Perspective):
        raise InvalidInput(
            "seam is 'wrap', but a perspective image has none: it shows one half of space; expected cut"
        )
    return WRAPPED_SHARE * (rect.turn_px or 0.0)


def _valid_window(rect: Rectification) -> Window:
    box = largest_rectangle(rect.valid("left") & rect.valid("right"))
    if not box.area:
        raise Unsupported("the two rectified images have no valid pixel in common; expected another crop")
    return Window(*(edge - 0.5 for edge in box))


def _window_of_view(rect: Rectification, across: float, down: float) -> Window:
    """About the middle of both views: `across` along the epipolar line, `down` across the lines, radians."""
    gamma, beta = (float(np.mean(values)) for values in angles(centre_rays(rect.rig)))
    steps = np.array([[-across / 2, 0], [across / 2, 0], [0, -down / 2], [0, down / 2]])
    reached = np.array([gamma, beta]) + steps
    if np.abs(reached[:, 0]).max() >= math.pi / 2:
        raise Unsupported(
            f"a horizontal view of {math.degrees(across):g}° reaches the epipoles; expected a smaller one"
        )
    cos_gamma = np.cos(reached[:, 0])
    rays = np.stack(
        [np.sin(reached[:, 0]), cos_gamma * np.sin(reached[:, 1]), cos_gamma * np.cos(reached[:, 1])], axis=-1
    )
    edges = []
    for warp, R_warp_epi in _sides(rect):
        pixels, shown = warp.target.project(rays @ R_warp_epi.T)
        if not shown.all():
            view = f"{math.degrees(across):g}x{math.degrees(down):g}°"
            raise Unsupported(f"the method's image does not reach {view}; expected a smaller fov_deg")
        edges.append([pixels[0, 0], pixels[2, 1], pixels[1, 0], pixels[3, 1]])
    (left, top), (right, bottom) = np.min(edges, axis=0)[:2], np.max(edges, axis=0)[2:]
    return Window(float(left), float(top), float(right), float(bottom))


def _covering_window(rect: Rectification, share: float) -> Window:
    """Between equal quantiles of the columns, and of the rows, at which the source pixels arrive."""
    sides = (rect.left, rect.right)
    mapped = [warp.forward(evaluation_pixels(warp.source, COVERAGE_PIXELS)) for warp in sides]
    weights = np.concatenate([np.full(len(px), 0.5 / len(px)) for px in mapped])
    pixels = np.concatenate(mapped)
    exist = np.isfinite(pixels).all(axis=1)
    rim = np.concatenate([warp.forward(outline_pixels(warp.source)[0]) for warp in sides])
    rim = rim[np.isfinite(rim).all(axis=1)]
    pixels, weights = pixels[exist], weights[exist]
    if weights.sum() < share * (1 - 1e-9):
        raise Unsupported(
            f"the method's image can keep {weights.sum():.1%} of the source pixels; expected a coverage below"
        )

    def window(cut: float) -> Window:
        if not cut:
            reached = np.concatenate([pixels, rim])
            return Window(*(float(edge) for edge in (*reached.min(axis=0), *reached.max(axis=0))))
        low, high = np.quantile(pixels, [cut, 1 - cut], axis=0)
        return Window(*(float(edge) for edge in (*low, *high)))

    def kept(cut: float) -> float:
        left, top, right, bottom = window(cut)
        u, v = pixels.T
        return float(weights[(u >= left) & (u <= right) & (v >= top) & (v <= bottom)].sum())

    least, most = 0.0, 0.5
    for _ in range(40):
        middle = (least + most) / 2
        least, most = (middle, most) if kept(middle) >= share else (least, middle)
    return window(least if least > 1e-9 else 0.0)


def _checked_size(size: tuple[float, ...], whole: Callable[[float], int]) -> tuple[int, int]:
    sides = [float(side) for side in size]
    width, height = (max(1.0, whole(side + 1e-9)) if np.isfinite(side) else math.inf for side in sides)
    if max(width, height) > LARGEST_SIDE_PX or width * height > LARGEST_PIXELS:
        raise InvalidInput(
            f"the rectified image would be {width:.0f}x{height:.0f} px; expected at most {LARGEST_SIDE_PX} a "
            f"side and {LARGEST_PIXELS / 1e6:.0f} megapixels: state a budget of pixels, or show less"
        )
    return int(width), int(height)


def _is_number(value: Any) -> bool:
    is_real = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    return is_real and math.isfinite(value)


def _check_numbers(
    name: str, value: Any, count: int, expected: str, above: float = -math.inf, below: float = math.inf
) -> None:
    """Raise InvalidInput unless `value` is None or that many numbers between the two."""
    if value is None:
        return
    values = list(value) if isinstance(value, tuple | list) else [value]
    if len(values) != count or not all(_is_number(v) and above < v < below for v in values):
        raise InvalidInput(f"{name} is {value!r}; expected {expected}")
