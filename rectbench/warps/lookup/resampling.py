"""Images resampled into the rectified frame: point samples, or averages where the warp shrinks them."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol, get_args

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench.errors import InvalidInput
from rectbench.warps.lookup.footprints import Footprints, Patch
from rectbench.warps.lookup.tables import FloatMap
from rectbench.warps.warp import Warp

Side = Literal["left", "right"]
SIDES: tuple[Side, Side] = ("left", "right")
Filter = Literal["point", "area"]
REMAPPED_TYPES = tuple(map(np.dtype, ("uint8", "uint16", "int16", "float32", "float64")))
"""What `cv2.remap` resamples."""


class Rectified(Protocol):
    """What resampling needs of a `Rectification`."""

    def warp(self, side: Side) -> Warp:
        """The warp of one side."""
        ...

    def maps(self, side: Side) -> tuple[FloatMap, FloatMap]:
        """(map_x, map_y) of one side, source pixels."""
        ...


@dataclass(frozen=True, eq=False)
class Resampler:
    """One side of a rectification, ready for any number of that camera's images.

    The filter "point" is `cv2.remap`: each rectified pixel is one sample, so that where the warp
    shrinks the image, detail finer than a rectified pixel comes back as false patterns. "area"
    averages samples over what each pixel covers there (see `Footprints`), and is the same to the bit
    where the warp does not shrink. It comes closest to the scene with `cv2.INTER_CUBIC`: linear
    interpolation blurs for a second time what is averaged. Labels want points and
    `cv2.INTER_NEAREST`.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> resample = rb.Resampler.of(rb.rectify(rig, method="abraham"), "left", filter="area")
    >>> resample(np.zeros((rig.left.height, rig.left.width, 3), np.uint8)).shape
    (800, 800, 3)
    """

    side: Side
    source_size: tuple[int, int]
    """(width, height) of the images it takes, pixels."""
    maps: tuple[FloatMap, FloatMap] = field(repr=False)
    """(map_x, map_y) [height, width], see `Rectification.maps`."""
    interpolation: int
    """OpenCV's, for each sample."""
    footprints: Footprints | None
    """What rectified pixels cover; None for point samples."""

    @classmethod
    def of(
        cls,
        rect: Rectified,
        side: Side,
        filter: Filter = "point",
        interpolation: int = cv2.INTER_LINEAR,
    ) -> Resampler:
        """The tables of one side, "left" or "right". Raises InvalidInput for another side or filter."""
        if filter not in get_args(Filter):
            raise InvalidInput(f"filter is {filter!r}; expected 'point' or 'area'")
        warp, maps = rect.warp(side), rect.maps(side)
        footprints = Footprints.of(warp, maps) if filter == "area" else None
        return cls(side, warp.source.size, maps, interpolation, footprints)

    def __call__(self, image: NDArray[np.generic]) -> NDArray[np.generic]:
        """[H, W] or [H, W, C], resampled, of the same type; black where the source shows nothing.

        Raises InvalidInput for an image that is not of the camera's size or of a type OpenCV resamples.
        """
        image = self._checked(image)
        resampled: NDArray[np.generic] = cv2.remap(
            image, *self.maps, self.interpolation, borderMode=cv2.BORDER_CONSTANT
        )
        if self.footprints is None or not self.footprints.patches:
            return resampled
        halved = _halved_images(image, self.footprints.levels)

        def average(patch: Patch) -> None:
            means = _rounded(self._means(patch, halved[patch.level]), resampled.dtype)
            # np.copyto would take 50 times as long.
            cv2.copyTo(means, patch.mask.view(np.uint8), resampled[patch.place])

        with ThreadPoolExecutor(max(1, cv2.getNumThreads())) as threads:
            list(threads.map(average, self.footprints.patches))  # raises what a thread raised
        return resampled

    def _checked(self, image: NDArray[np.generic]) -> NDArray[np.generic]:
        image = np.asarray(image)
        if image.dtype not in REMAPPED_TYPES:
            names = ", ".join(map(str, REMAPPED_TYPES))
            raise InvalidInput(f"the {self.side} image holds {image.dtype}; expected one of {names}")
        width, height = self.source_size
        if image.shape[:2] != (height, width):
            raise InvalidInput(
                f"the {self.side} image is {image.shape[1]}x{image.shape[0]} px; "
                f"its camera has {width}x{height}"
            )
        return image

    def _means(self, patch: Patch, image: NDArray[Any]) -> NDArray[Any]:
        """[h, w, ...], the mean of each pixel's samples; beyond the source's edge its last pixel goes on."""
        read = cv2.remap(image, *patch.maps(), self.interpolation, borderMode=cv2.BORDER_REPLICATE)
        samples = read.reshape(len(patch.samples), *patch.mask.shape, *read.shape[2:])
        means: NDArray[Any] = samples.mean(axis=0)
        return means


def _halved_images(image: NDArray[Any], levels: int) -> Sequence[NDArray[Any]]:
    """The image in floating point, and halved up to `levels` times.

    Pixel x of one image covers the pixels 2x and 2x + 1 of the one before, whose last pixel is
    repeated where their number is odd.
    """
    images = [image if image.dtype == np.float64 else image.astype(np.float32)]
    for _ in range(levels):
        last = images[-1]
        height, width = last.shape[:2]
        even = cv2.copyMakeBorder(last, 0, height % 2, 0, width % 2, cv2.BORDER_REPLICATE)
        half = even.shape[1] // 2, even.shape[0] // 2
        images.append(cv2.resize(even, half, interpolation=cv2.INTER_AREA))
    return images


def _rounded(values: NDArray[Any], dtype: np.dtype[Any]) -> NDArray[Any]:
    if dtype.kind == "f":
        return values.astype(dtype, copy=False)
    limits = np.iinfo(dtype)
    rounded: NDArray[Any] = np.clip(np.rint(values), limits.min, limits.max).astype(dtype)
    return rounded
