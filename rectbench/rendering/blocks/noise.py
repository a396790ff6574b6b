"""Seamless random fields that textures are made from.

While a texture is being mixed its colours are planes [3, H, W]: several times faster than texels.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

Field = NDArray[np.float32]

LEAST_REFLECTANCE, GREATEST_REFLECTANCE = 0.02, 0.95
"""No real surface is blacker than soot or whiter than fresh snow."""


def fractal(rng: np.random.Generator, height: int, width: int, slope: float) -> Field:
    """Noise [height, width] of mean 0 and deviation 1 that repeats without a seam.

    Its power falls with spatial frequency f as f^-slope: 0 is white, 2 clouds, 3 hills.
    """
    size = max(height, width)
    return _shaped(rng, height, width, _amplitude(height, width, size, size, slope))


def streaks(rng: np.random.Generator, height: int, width: int, aspect: float, slope: float = 2.0) -> Field:
    """`fractal` noise drawn out along the rows: `aspect` times as long as it is high."""
    return _shaped(rng, height, width, _amplitude(height, width, height, width * aspect, slope))


def _shaped(rng: np.random.Generator, height: int, width: int, amplitude: Field) -> Field:
    # A pixel adds so many frequencies that it is normal even where they are drawn uniformly, and
    # that takes a third of the time.
    drawn = rng.random((*amplitude.shape, 2), dtype=np.float32)
    drawn -= 0.5
    spectrum = drawn.view(np.complex64)[..., 0]
    spectrum *= amplitude
    field = np.fft.irfft2(spectrum, s=(height, width)).astype(np.float32, copy=False)
    field *= 1.0 / field.std()
    return field


@lru_cache(maxsize=24)
def _amplitude(height: int, width: int, scale_y: float, scale_x: float, slope: float) -> Field:
    """f^(-slope/2) over the half plane of frequencies; 0 at frequency 0."""
    fy = (np.fft.fftfreq(height) * scale_y).astype(np.float32)[:, None]
    fx = (np.fft.rfftfreq(width) * scale_x).astype(np.float32)
    square = fy * fy + fx * fx
    square[0, 0] = np.inf
    return square ** np.float32(-slope / 4)


def clouds(rng: np.random.Generator, height: int, width: int, slope: float = 2.5) -> Field:
    """`fractal` noise without its finest octave, which is faint at such slopes and half the cost."""
    return fractal(rng, -(-height // 2), -(-width // 2), slope).repeat(2, 0).repeat(2, 1)[:height, :width]


def spots(
    rng: np.random.Generator, height: int, width: int, count: int, radius_px: float
) -> tuple[Field, Field]:
    """`count` round spots at random places, of 0.6 to 1.3 times `radius_px`; later ones cover earlier.

    Returns [height, width] the distance to the spot's centre in radii, infinite outside of all, and
    a random number in [0, 1) of each spot.
    """
    reach = int(np.ceil(1.3 * radius_px))
    offset = np.arange(-reach, reach + 1)
    x, y = rng.integers(0, width, count), rng.integers(0, height, count)
    size = radius_px * rng.uniform(0.6, 1.3, count).astype(np.float32)
    away = np.hypot(offset[:, None], offset).astype(np.float32) / size[:, None, None]
    inside = away < 1.0
    rows = np.broadcast_to((y[:, None] + offset) % height * width, (count, offset.size))
    columns = (x[:, None] + offset) % width
    place = (rows[:, :, None] + columns[:, None, :])[inside]
    distance = np.full(height * width, np.inf, dtype=np.float32)
    kind = np.zeros(height * width, dtype=np.float32)
    distance[place] = away[inside]
    kind[place] = np.broadcast_to(rng.random((count, 1, 1), dtype=np.float32), away.shape)[inside]
    return distance.reshape(height, width), kind.reshape(height, width)


@dataclass(frozen=True, eq=False)
class Noise:
    """The fields [height, width] that one texture is mixed from, drawn one after the other."""

    rng: np.random.Generator
    height: int
    width: int

    @classmethod
    def of(cls, seed: int, texture: int, height: int, width: int | None = None) -> Noise:
        """Those of a texture, by its number, for a seed; square where the width is left out."""
        return cls(np.random.default_rng((seed, texture)), height, width or height)

    def fractal(self, slope: float) -> Field:
        """See `fractal`."""
        return fractal(self.rng, self.height, self.width, slope)

    def clouds(self, slope: float = 2.5) -> Field:
        """See `clouds`."""
        return clouds(self.rng, self.height, self.width, slope)

    def streaks(self, aspect: float, slope: float = 2.0) -> Field:
        """See `streaks`."""
        return streaks(self.rng, self.height, self.width, aspect, slope)

    def spots(self, count: int, radius_px: float) -> tuple[Field, Field]:
        """See `spots`."""
        return spots(self.rng, self.height, self.width, count, radius_px)


def planes(colour: ArrayLike) -> Field:
    """A colour (3,) as planes [3, 1, 1]; planes [3, H, W] stay as they are."""
    values = np.asarray(colour, dtype=np.float32)
    return values[:, None, None] if values.ndim == 1 else values


def blend(a: ArrayLike, b: ArrayLike, share: Field | NDArray[np.bool_]) -> Field:
    """Planes [3, H, W] from `a` to `b`, colours or planes, by `share` [H, W] in 0..1."""
    first, second = planes(a), planes(b)
    return first + (second - first) * np.clip(share.astype(np.float32), 0.0, 1.0)


def smoothstep(low: float, high: float, values: Field) -> Field:
    """0 below `low`, 1 above `high`, a smooth rise between."""
    t = np.clip((values - low) / (high - low), 0.0, 1.0)
    rise: Field = t * t * (3.0 - 2.0 * t)
    return rise


def reflectance(colour: Field) -> Field:
    """Planes [3, H, W] as the texels [H, W, 3] of a material, within what surfaces reflect."""
    clipped = np.clip(colour, LEAST_REFLECTANCE, GREATEST_REFLECTANCE)
    return np.ascontiguousarray(clipped.transpose(1, 2, 0), dtype=np.float32)
