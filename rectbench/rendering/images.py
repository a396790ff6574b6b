"""Radiance to pictures."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rectbench.images.stereo_pair import Image
from rectbench.rendering.variant import drjit, mitsuba

SAMPLES_AT_ONCE = 1 << 23
"""Samples in flight: the radiance of no more than these is kept, whatever the image's size."""


def radiance(
    scene: Any, sensor: Any, integrator: Any, *, spp: int, seed: int, brightest: float = np.inf
) -> NDArray[np.float32]:
    """Mean radiance [H, W, 3] of `spp` samples a pixel, box-filtered, each sample held to `brightest`.

    Bands of whole rows are rendered one after another, so the memory is bounded; each pixel adds
    its samples in a fixed order, so the same call gives the same bits on any number of threads.
    `spp` is a power of two.
    """
    mi, dr = mitsuba(), drjit()
    width, height = (int(n) for n in sensor.film().size())
    rows = max(1, SAMPLES_AT_ONCE // (width * spp))
    image = np.empty((height, width, 3), dtype=np.float32)
    # Stratified in every pair of dimensions: as clean as twice the independent samples, at their cost.
    # The sampler wants a square number, so a pixel of 32 samples holds two patterns of 16.
    pattern = 1 << (spp.bit_length() - 1) // 2 * 2
    sampler = mi.load_dict({"type": "multijitter", "sample_count": pattern})
    sampler.set_samples_per_wavefront(pattern)
    for top in range(0, height, rows):
        bottom = min(top + rows, height)
        count = (bottom - top) * width * spp
        # As literals, these numbers would be baked into the kernel: every size would compile anew.
        columns, first = dr.opaque(mi.UInt32, width), dr.opaque(mi.UInt32, top * width)
        ceiling = dr.opaque(mi.Float, brightest)
        sampler.seed(dr.opaque(mi.UInt32, _band_seed(seed, top)), count)
        pixel = first + dr.arange(mi.UInt32, count) // dr.opaque(mi.UInt32, spp)
        row = pixel // columns
        corner = mi.Point2f(pixel - row * columns, row)
        position = (corner + sampler.next_2d()) / dr.opaque(mi.Vector2f, (width, height))
        ray, weight = sensor.sample_ray_differential(mi.Float(0.0), mi.Float(0.5), position, mi.Point2f(0.5))
        colour, _, _ = integrator.sample(scene, sampler, ray)
        colour = dr.select(dr.all(dr.isfinite(colour)), weight * dr.minimum(colour, ceiling), 0.0)
        dr.eval(colour)
        sums = [dr.block_sum(channel, spp).numpy() for channel in colour]
        image[top:bottom] = np.stack(sums, axis=-1).reshape(bottom - top, width, 3) / spp
    return image


def _band_seed(seed: int, top: int) -> int:
    return int(np.random.SeedSequence([seed, top]).generate_state(1)[0])


def srgb8(linear: NDArray[Any], exposure: float = 1.0) -> Image:
    """Linear radiance as 8-bit sRGB (IEC 61966-2-1); radiance 1 / exposure is white."""
    x = np.clip(np.asarray(linear, dtype=np.float32) * exposure, 0.0, 1.0)
    y = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    image: Image = (y * 255.0 + 0.5).astype(np.uint8)
    return image
