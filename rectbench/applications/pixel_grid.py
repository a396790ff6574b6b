"""Pictures of a rig without photographs: what each lens sees, drawn on its sensor as squared paper."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench.applications.rectification_files import GAP_PX, PREVIEW_WIDTH_PX, SIDES, side_by_side
from rectbench.cameras import Camera
from rectbench.images.reading import Rgb, encoded
from rectbench.rigs import Rig
from rectbench.types import FloatArray
from rectbench.warps import Rectification

Colour = tuple[int, int, int]

PAPER_RGB: Colour = (252, 252, 250)
BLIND_RGB: Colour = (205, 208, 212)
"""Where a lens, or a rectified image, shows nothing."""
INK_RGB: dict[str, tuple[Colour, Colour]] = {
    "left": ((130, 165, 225), (30, 80, 170)),
    "right": ((235, 165, 120), (180, 70, 10)),
}
"""Of the fine lines and of the strong ones, by side."""
RING_RGB: Colour = (120, 120, 120)
AXIS_RGB: Colour = (20, 20, 20)
FAR_RGB: Colour = (200, 0, 140)
PITCHES_PX = tuple(round(digit * 10.0**power) for power in range(5) for digit in (1, 2, 5))
MOST_LINES = 24
"""Of the grid, along an image's longer side."""
STRONG = 5
"""Each so manieth line is strong, and has its pixel written beside it."""
LABELLED_AT = 0.35
"""Of the image's width and height, where pixels are written: beside the middle, which is full of marks."""
RING_STEPS_DEG = (5, 10, 15, 20, 30)
MOST_RINGS = 5
SPOKES = 12
"""Far points on each ring."""
FINENESS = 1.5
"""Pixels of the drawing for one of the preview, so that thin lines stay smooth."""
SHIFT = 4
"""Fractional bits of the coordinates that OpenCV draws at."""
FONT = cv2.FONT_HERSHEY_SIMPLEX
CAPTION_PX, LEAST_CAPTION_PX = 13, 6
"""Height of the letters above the pictures, and the least that anybody reads."""


def grid_preview(rect: Rectification) -> bytes:
    """A PNG of both rectified images of `grid_image`, with scan lines across them.

    Dots that mark the same far points stand on one line in both.
    """
    shown = []
    longer_side_px = round(FINENESS * min(max(rect.size), PREVIEW_WIDTH_PX / 2))
    for side in SIDES:
        factor = longer_side_px / max(rect.warp(side).source.size)
        map_x, map_y = (factor * table + np.float32((factor - 1) / 2) for table in rect.maps(side))
        image = cv2.remap(grid_image(rect.rig, side, longer_side_px), map_x, map_y, cv2.INTER_LINEAR)
        image[~rect.valid(side)] = BLIND_RGB
        shown.append(image)
    both = side_by_side(*shown)
    return encoded(np.concatenate([_caption(rect.rig, both.shape[1]), both]))


def grid_image(rig: Rig, side: str, longer_side_px: int) -> Rgb:
    """The sensor of one side as squared paper, uint8 [H, W, 3], its longer side of so many pixels.

    Lines every so many source pixels, every fifth with its pixel; circles of equal angle from the optical
    axis, which a cross marks; the rim of what the lens shows. Dots are far points, the same in both images:
    directions on the left lens's circles.
    """
    camera: Camera = getattr(rig, side)
    paper = _Paper(camera, longer_side_px)
    fine, strong = INK_RGB[side]
    pitch = pitch_px(camera)
    for colour, every, width in ((fine, pitch, 2), (strong, STRONG * pitch, 3)):
        for axis in (0, 1):
            for place in range(0, camera.size[axis], every):
                ends = np.zeros((2, 2))
                ends[:, axis], ends[1, 1 - axis] = place, camera.size[1 - axis] - 1
                paper.line(ends, colour, width)
    step = ring_step_deg(rig.left)
    directions = far_directions(rig.left, step)
    for ring_deg in range(step, 181, step):
        circle = _ring(ring_deg, np.linspace(0, 2 * math.pi, 361))
        pixels, shown = camera.project(circle)
        inside = shown & camera.contains(pixels)
        for piece in np.split(np.arange(len(pixels)), np.flatnonzero(~inside) + 1):
            kept = piece[inside[piece]]
            paper.line(pixels[kept], RING_RGB, 2)
        if inside[45] and camera.project(_ring(ring_deg + step / 4, np.array([math.pi / 4])))[1][0]:
            paper.write(str(ring_deg), pixels[45], pitch, RING_RGB)
    for axis in (0, 1):
        for place in range(STRONG * pitch, camera.size[axis], STRONG * pitch):
            at = LABELLED_AT * np.array(camera.size)
            at[axis] = place
            paper.write(str(place), at, pitch, strong)
    R = np.eye(3) if side == "left" else rig.R_right_left
    dots, shown = camera.project(directions @ R.T)
    for dot in dots[shown & camera.contains(dots)]:
        paper.dot(dot, pitch / 10, FAR_RGB)
    centre, _ = camera.project(np.array([0.0, 0.0, 1.0]))
    paper.cross(centre, pitch, AXIS_RGB)
    paper.rim(strong)
    return paper.image


def pitch_px(camera: Camera) -> int:
    """Source pixels between two lines: the least round number that leaves few enough lines."""
    longest = max(camera.size)
    return next(pitch for pitch in PITCHES_PX if longest / pitch <= MOST_LINES)


def ring_step_deg(camera: Camera) -> int:
    """Degrees from one circle about the axis to the next."""
    rays, seen = camera.unproject(camera.pixel_grid()[::4, ::4])
    widest = math.degrees(math.acos(float(np.clip(rays[seen][:, 2].min(), -1, 1))))
    return next((step for step in RING_STEPS_DEG if widest / step <= MOST_RINGS), RING_STEPS_DEG[-1])


def far_directions(camera: Camera, step_deg: int) -> FloatArray:
    """Unit rays [N, 3] of a camera: its axis, and points spread evenly on its circles."""
    azimuths = np.arange(SPOKES) * 2 * math.pi / SPOKES
    rings = [_ring(ring_deg, azimuths) for ring_deg in range(step_deg, 180, step_deg)]
    return np.concatenate([np.array([[0.0, 0.0, 1.0]]), *rings])


def _ring(angle_deg: float, azimuths: FloatArray) -> FloatArray:
    angle = math.radians(angle_deg)
    flat = math.sin(angle) * np.stack([np.cos(azimuths), np.sin(azimuths)], axis=-1)
    return np.concatenate([flat, np.full((len(azimuths), 1), math.cos(angle))], axis=-1)


def _caption(rig: Rig, width: int) -> Rgb:
    """A strip [H, width, 3] that says what is drawn; empty above images too narrow for words."""
    texts = {
        "left": f"left: a line every {pitch_px(rig.left)} px, a circle every {ring_step_deg(rig.left)} deg",
        "right": f"right: a line every {pitch_px(rig.right)} px; the same far points as dots in both",
    }
    half = (width - GAP_PX) // 2
    longest, height = map(max, zip(*(cv2.getTextSize(t, FONT, 1, 1)[0] for t in texts.values()), strict=True))
    scale = min(CAPTION_PX / height, (half - 2 * GAP_PX) / longest)
    if scale * height < LEAST_CAPTION_PX:
        return np.zeros((0, width, 3), np.uint8)
    strip: Rgb = np.full((3 * CAPTION_PX, width, 3), 255, np.uint8)
    for place, side in enumerate(SIDES):
        at = (place * (half + GAP_PX) + GAP_PX, 2 * CAPTION_PX)
        cv2.putText(strip, texts[side], at, FONT, scale, INK_RGB[side][1], 1, cv2.LINE_AA)
    return strip


class _Paper:
    """An image of a camera at another scale, drawn on at source pixels."""

    def __init__(self, camera: Camera, longer_side_px: int) -> None:
        self.camera = camera
        self.factor = longer_side_px / max(camera.size)
        width, height = (max(1, math.ceil(self.factor * side)) for side in camera.size)
        self.image: Rgb = np.full((height, width, 3), PAPER_RGB, np.uint8)

    def line(self, pixels: FloatArray, colour: Colour, width: int) -> None:
        if len(pixels) > 1:
            cv2.polylines(self.image, [self._places(pixels)], False, colour, width, cv2.LINE_AA, SHIFT)

    def dot(self, pixel: FloatArray, radius_px: float, colour: Colour) -> None:
        x, y = map(int, self._places(pixel))
        radius = round(radius_px * self.factor * 2**SHIFT)
        cv2.circle(self.image, (x, y), radius, colour, cv2.FILLED, cv2.LINE_AA, SHIFT)

    def cross(self, pixel: FloatArray, arm_px: float, colour: Colour) -> None:
        for arm in (np.array([arm_px, 0.0]), np.array([0.0, arm_px])):
            self.line(np.stack([pixel - arm, pixel + arm]), colour, 3)

    def write(self, text: str, pixel: FloatArray, height_px: float, colour: Colour) -> None:
        """A text about a third as high as `height_px`, with its lower left corner beside the pixel."""
        scale = 0.35 * height_px * self.factor / cv2.getTextSize("0", FONT, 1, 1)[0][1]
        x, y = (round(place / 2**SHIFT) for place in map(int, self._places(pixel)))
        for ink, width in ((PAPER_RGB, 4), (colour, 2)):
            cv2.putText(
                self.image, text, (x + GAP_PX // 2, y - GAP_PX // 2), FONT, scale, ink, width, cv2.LINE_AA
            )

    def rim(self, colour: Colour) -> None:
        """Blind where the lens shows nothing, and a strong line about what it shows."""
        rows, columns = np.indices(self.image.shape[:2])
        places = (np.stack([columns, rows], axis=-1) + 0.5) / self.factor - 0.5
        seen = self.camera.unproject(places)[1]
        self.image[~seen] = BLIND_RGB
        framed = cv2.copyMakeBorder(seen.astype(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
        outlines, _ = cv2.findContours(framed, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE, offset=(-1, -1))
        cv2.drawContours(self.image, outlines, -1, colour, 6, cv2.LINE_AA)

    def _places(self, pixels: FloatArray) -> NDArray[np.int32]:
        """Source pixels where they are drawn, in OpenCV's fractions of a pixel."""
        places = self.factor * np.asarray(pixels) + (self.factor - 1) / 2
        rounded: NDArray[np.int32] = np.round(places * 2**SHIFT).astype(np.int32)
        return rounded
