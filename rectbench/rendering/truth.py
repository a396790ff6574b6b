"""The ground truth of a rendered rig: depth, points, visibility and correspondences.

Only the depth comes from the renderer. A point is its pixel's float64 ray times that depth, so it
projects back onto the pixel's centre, and its projection into the other camera obeys the epipolar
geometry to rounding, however coarse the depth.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from rectbench.calibrations.formats.native import read_native, rig_fields
from rectbench.cameras import Camera
from rectbench.cameras.projection import BoolArray
from rectbench.errors import InvalidInput
from rectbench.rendering.variant import mitsuba
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray
from rectbench.yaml_text import yaml_text

SIDES = ("left", "right")


@dataclass(frozen=True, eq=False)
class Truth:
    """Depth and visibility at the pixel centres of both cameras, and all that follows from them.

    Raises InvalidInput for arrays that are not of the cameras' sizes.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> camera = rb.Camera("pinhole", (160, 120), {"fx": 120, "fy": 120, "cx": 79.5, "cy": 59.5})
    >>> rig = rb.Rig(camera, camera, np.eye(3), [-0.1, 0, 0])
    >>> depth, seen = np.full((120, 160), 2.0), np.ones((120, 160), bool)
    >>> truth = rb.Truth(rig, depth, depth, seen, seen)
    >>> px_left, px_right = truth.matches(100)
    >>> px_left.shape, bool(np.allclose(px_left[:, 1], px_right[:, 1]))
    ((100, 2), True)
    """

    rig: Rig
    """The true rig."""
    depth_left: NDArray[np.float32]
    """[H, W] distance along the ray, metres; NaN where the left camera sees nothing, or the sky."""
    depth_right: NDArray[np.float32]
    """[H, W] the same of the right camera."""
    visible_left: BoolArray
    """[H, W] where the right camera sees the point of this pixel of the left one too."""
    visible_right: BoolArray
    """[H, W] where the left camera sees the point of this pixel of the right one too."""

    def __post_init__(self) -> None:
        for side, camera in zip(SIDES, (self.rig.left, self.rig.right), strict=True):
            for name, dtype in ((f"depth_{side}", np.float32), (f"visible_{side}", np.bool_)):
                array = np.asarray(getattr(self, name), dtype=dtype)
                if array.shape != (camera.height, camera.width):
                    raise InvalidInput(
                        f"{name} has shape {array.shape}; expected {(camera.height, camera.width)}"
                    )
                object.__setattr__(self, name, array)

    @cached_property
    def points_left(self) -> FloatArray:
        """[H, W, 3] points that the left camera sees, in its own frame, metres; NaN where none."""
        return _points(self.rig.left, self.rig.left.pixel_grid(), self.depth_left)

    @cached_property
    def points_right(self) -> FloatArray:
        """[H, W, 3] points that the right camera sees, in its own frame, metres; NaN where none."""
        return _points(self.rig.right, self.rig.right.pixel_grid(), self.depth_right)

    @cached_property
    def px_right_of_left(self) -> FloatArray:
        """[H, W, 2] right pixels of the points of the left ones; NaN where off the right image.

        Whether something stands in the way is for `visible_left` to tell.
        """
        return _on_image(self.rig.right, self.rig.right_from_left(self.points_left))

    @cached_property
    def px_left_of_right(self) -> FloatArray:
        """[H, W, 2] left pixels of the points of the right ones; NaN where off the left image."""
        return _on_image(self.rig.left, _left_from_right(self.rig, self.points_right))

    def matches(self, n: int = 4000, seed: int = 0, noise_px: float = 0.0) -> tuple[FloatArray, FloatArray]:
        """Up to `n` corresponding pixels (px_left [N, 2], px_right [N, 2]) that both cameras see.

        The left pixels are pixel centres, one drawn from each cell of an even grid before a second
        is drawn from any. `noise_px` is the standard deviation of Gaussian noise on each coordinate
        of both images. Raises InvalidInput where no point is seen by both cameras.
        """
        if n < 1 or not 0 <= noise_px < np.inf:
            raise InvalidInput(
                f"matches: n is {n} and noise_px {noise_px}; expected n from 1 and noise_px from 0"
            )
        v, u = np.nonzero(self.visible_left)
        if len(u) == 0:
            raise InvalidInput(
                f"rig {self.rig.name}: no point is seen by both cameras, so there are no matches"
            )
        rng = np.random.default_rng([seed, n])
        chosen = _spread(u, v, self.rig.left.size, n, rng)
        u, v = u[chosen], v[chosen]
        px_left = np.stack([u, v], axis=-1).astype(np.float64)
        px_right = self.right_pixels(u, v)
        if noise_px > 0:
            px_left = px_left + rng.normal(0.0, noise_px, px_left.shape)
            px_right = px_right + rng.normal(0.0, noise_px, px_right.shape)
        return px_left, px_right

    def right_pixels(self, u: NDArray[np.integer[Any]], v: NDArray[np.integer[Any]]) -> FloatArray:
        """Pixels [N, 2] of the right camera's plane where the points of left pixels (u, v) [N] lie."""
        px_left = np.stack([u, v], axis=-1).astype(np.float64)
        points = _points(self.rig.left, px_left, self.depth_left[v, u])
        return self.rig.right.project(self.rig.right_from_left(points))[0]

    def save(self, path: str | Path, *, derived: bool = True) -> None:
        """Write an .npz: depth, points, correspondences (float32) and visibility of both, and the rig.

        Without the `derived` points and correspondences, which `load` makes anew, it is a fifth as large.
        """
        arrays: dict[str, Any] = {}
        for side in SIDES:
            arrays |= {f"{name}_{side}": getattr(self, f"{name}_{side}") for name in ("depth", "visible")}
        if derived:
            arrays |= {f"{name}_{side}": a for side, layers in self._layers() for name, a in layers.items()}
        with Path(path).open("wb") as file:
            np.savez(file, rig=np.array(yaml_text(rig_fields(self.rig))), **arrays)

    @classmethod
    def load(cls, path: str | Path) -> Truth:
        """Read what `save` wrote; points and correspondences are made anew, in float64."""
        try:
            with np.load(path, allow_pickle=False) as file:
                rig = read_native(path, str(file["rig"]))
                return cls(rig, *(file[f"{name}_{side}"] for name in ("depth", "visible") for side in SIDES))
        except (OSError, KeyError, ValueError, EOFError, BadZipFile) as error:
            if isinstance(error, InvalidInput):
                raise
            raise InvalidInput(f"{path}: not a truth file (.npz): {' '.join(str(error).split())}") from None

    def save_exr(self, folder: str | Path) -> None:
        """Write left.exr and right.exr: float32 channels depth, point.x y z, px.u v, visible.

        `px` is the pixel in the other image; NaN where there is none, `visible` 0 or 1.
        """
        mi = mitsuba()
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        names = ["depth", "point.x", "point.y", "point.z", "px.u", "px.v", "visible"]
        for side, layers in self._layers():
            stacked = np.concatenate(
                [np.atleast_3d(layer) for layer in layers.values()], axis=-1, dtype=np.float32
            )
            bitmap = mi.Bitmap(stacked, mi.Bitmap.PixelFormat.MultiChannel, names)
            bitmap.write(str(folder / f"{side}.exr"))

    def _layers(self) -> Iterator[tuple[str, dict[str, NDArray[np.float32 | np.bool_]]]]:
        """By side: depth, point, px in the other image, visible; float32 and bool."""
        both = (
            (self.depth_left, self.points_left, self.px_right_of_left, self.visible_left),
            (self.depth_right, self.points_right, self.px_left_of_right, self.visible_right),
        )
        for side, (depth, points, px, visible) in zip(SIDES, both, strict=True):
            single = {"points": points.astype(np.float32), "px_other": px.astype(np.float32)}
            yield side, {"depth": depth, **single, "visible": visible}


def _points(camera: Camera, pixels: FloatArray, depth: NDArray[np.float32]) -> FloatArray:
    rays, _ = camera.unproject(pixels)
    return rays * depth[..., None].astype(np.float64)


def _on_image(camera: Camera, points: FloatArray) -> FloatArray:
    pixels, _ = camera.project(points)
    pixels[~camera.contains(pixels)] = np.nan
    return pixels


def _left_from_right(rig: Rig, points_right: FloatArray) -> FloatArray:
    return (points_right - rig.t_right_left) @ rig.R_right_left


def _spread(
    u: NDArray[np.int64], v: NDArray[np.int64], size: tuple[int, int], n: int, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Indices of up to `n` of the pixels (u, v), drawn in turns from the cells of an even grid."""
    side = max(1.0, (size[0] * size[1] / n) ** 0.5)
    columns = int(size[0] // side) + 1
    cell = (v // side).astype(np.int64) * columns + (u // side).astype(np.int64)
    cell = cell.astype(np.min_scalar_type(int(cell.max())))  # 16 bits are sorted by radix, ten times as fast
    shuffled = rng.permutation(len(u))
    order = shuffled[np.argsort(cell[shuffled], kind="stable")]
    counts = np.bincount(cell)
    counts = counts[counts > 0]
    turn = np.arange(len(order)) - np.repeat(np.cumsum(counts) - counts, counts)
    # Within a turn the cells come in random order, so that a cut-off last turn is spread as well.
    lots = rng.random(len(order))
    last = np.searchsorted(np.cumsum(np.bincount(turn)), n)  # no later turn is drawn from
    able = np.flatnonzero(turn <= last)
    draw = able[np.lexsort((lots[able], turn[able]))[:n]]
    return np.sort(order[draw])
