"""How far from its axis a fisheye lens shows anything: by a mask image, or by the black rim of images."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.images.reading import Grey, grey8, read_image
from rectbench.pairs.finding.names import FilePair, home_of, paired_files
from rectbench.rigs import Rig
from rectbench.types import FloatArray

RING_DEG = 1.0
LOOKED_AT = 200_000
"""Pixels of an image that are looked at."""
LEAST_PIXELS = 100
"""Pixels of a ring that tell anything."""
LEAST_DARK_DEG = 5.0
"""What must be dark beyond an image circle: a dark floor is no rim."""
LIT_SHARE = 90
"""Percentile of a ring that is compared: a lamp's glare leaves the circle, and is to count for little."""
LEAST_CONTRAST = 24.0
"""Grey levels between the picture and its rim."""
FADED = 0.25
"""Of that contrast, what a ring must have to belong to the picture."""
RIM_IMAGES = 8
"""Pairs of a rig that the rim of its lenses is looked for in."""


@dataclass(frozen=True)
class ImageCircle:
    """How far from their axes both lenses of a rig show anything, and what says so."""

    angle_deg: float
    evidence: str
    masks: tuple[Path, ...] = ()
    """The files that it was read from, where these are masks."""

    @property
    def told(self) -> str:
        """What was taken, in words."""
        return (
            f"the lenses are taken to show nothing beyond {self.angle_deg:.0f}° from their axes, "
            f"{self.evidence}"
        )


def image_circle(rig: Rig, pairs: Sequence[FilePair], masks: Iterable[Path]) -> ImageCircle | None:
    """The image circle that a mask of the images' size, or else their black rim, shows.

    None where neither does, and where one is stated, which stands. The smaller of both lenses' counts.
    """
    if rig.left.max_angle_deg is not None or rig.right.max_angle_deg is not None:
        return None
    for files in _by_side(masks):
        if shown := _fitting(files, rig):
            ends = [angle_of_mask_deg(c, m) for c, m in zip((rig.left, rig.right), shown, strict=True)]
            used = tuple(dict.fromkeys(files))
            if angle_deg := _smaller(ends):
                return ImageCircle(angle_deg, f"by {' and '.join(file.name for file in used)}", used)
    images = [shown for pair in pairs[:RIM_IMAGES] if (shown := _fitting(pair.files, rig))]
    if images:
        sides = zip((rig.left, rig.right), zip(*images, strict=True), strict=True)
        if angle_deg := _smaller([angle_of_rim_deg(camera, shown) for camera, shown in sides]):
            return ImageCircle(angle_deg, "by the black rim of its images")
    return None


def _by_side(masks: Iterable[Path]) -> Iterator[tuple[Path, Path]]:
    """The left and the right lens's mask, where their names tell them apart; else one for both."""
    files = [file for file in masks if not _is_of_rectified(file)]
    pairs = paired_files(files, home_of(files)).pairs if files else ()
    yield from (pair.files for pair in pairs)
    yield from ((file, file) for file in files if not any(file in pair.files for pair in pairs))


def _is_of_rectified(mask: Path) -> bool:
    """Whether a mask shows where a rectified image is valid: `rectify` leaves it beside its description."""
    return mask.stem in ("left_mask", "right_mask") and (mask.parent / "rectified.yaml").is_file()


def _smaller(ends: Sequence[float | None]) -> float | None:
    """The smaller of two angles, if both lenses have one."""
    known = [end for end in ends if end is not None]
    return min(known) if len(known) == len(ends) else None


def _fitting(files: tuple[Path, Path], rig: Rig) -> tuple[Grey, Grey] | None:
    """Both images, if they can be read and have their cameras' sizes."""
    left, right = map(grey_of, files)
    if left is None or right is None:
        return None
    return (left, right) if (left.shape[::-1], right.shape[::-1]) == (rig.left.size, rig.right.size) else None


def grey_of(path: Path) -> Grey | None:
    """An image file in 8 bits of grey; None where it is none."""
    try:
        return grey8(read_image(path))
    except InvalidInput:
        return None


def angle_of_mask_deg(camera: Camera, mask: Grey) -> float | None:
    """Angle from the axis, degrees, up to which most pixels of a mask [H, W] are set; None where all are."""
    rings = _rings(camera)
    unset = [float((_at(mask, ring) == 0).mean()) if len(ring) else 0.0 for ring in rings]
    beyond = [i for i, share in enumerate(unset) if share > 0.5]
    return beyond[0] * RING_DEG if beyond and beyond[0] > 0 else None


def angle_of_rim_deg(camera: Camera, images: Sequence[Grey]) -> float | None:
    """Angle from the axis, degrees, beyond which images [H, W] of a camera are dark; None for no black rim.

    Dark are the rings about the axis from there to the corners, none of them less than 5 degrees, and all
    images count at once, so that a dark scene is no rim while another is light.
    """
    brightest = reduce(np.maximum, images)
    rings = _rings(camera)
    if len(rings) * RING_DEG < 2 * LEAST_DARK_DEG:
        return None
    levels = np.array(
        [np.percentile(_at(brightest, ring), LIT_SHARE) if len(ring) else np.nan for ring in rings]
    )
    told = levels[np.isfinite(levels)]
    rim, inside = float(told[-1]), float(np.median(told[: len(told) // 2]))
    lit = np.flatnonzero(levels > rim + FADED * (inside - rim))
    if inside - rim < LEAST_CONTRAST or (len(rings) - 1 - lit[-1]) * RING_DEG < LEAST_DARK_DEG:
        return None
    return float(lit[-1] + 1) * RING_DEG


def _rings(camera: Camera) -> list[NDArray[np.intp]]:
    """Pixels [N, 2] (row, column) of each ring of one degree about the axis, out to the last that tells.

    Of a large image every n-th pixel each way. A ring within that has too few pixels tells nothing, and is
    empty.
    """
    step = max(1, round((camera.width * camera.height / LOOKED_AT) ** 0.5))
    grid = camera.pixel_grid()[::step, ::step].reshape(-1, 2)
    rays, seen = camera.unproject(grid)
    angle: FloatArray = np.degrees(np.arctan2(np.hypot(rays[:, 0], rays[:, 1]), rays[:, 2]))
    index = np.floor(angle[seen] / RING_DEG).astype(np.intp)
    places = grid[seen][np.argsort(index, kind="stable")][:, ::-1].astype(np.intp)
    rings = np.split(places, np.cumsum(np.bincount(index))[:-1])
    least = LEAST_PIXELS / step**2
    while rings and len(rings[-1]) < least:
        rings.pop()
    return [ring if len(ring) >= least else ring[:0] for ring in rings]


def _at(image: Grey, ring: NDArray[np.intp]) -> Grey:
    return image[ring[:, 0], ring[:, 1]]
