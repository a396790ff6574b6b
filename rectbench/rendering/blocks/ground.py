"""Finishes of what lies on the ground and grows out of it.

Every function takes a seed and gives a seamless `Finish`; colours are linear reflectances.
"""

from __future__ import annotations

import numpy as np

from rectbench.rendering.blocks.noise import Noise, blend, planes, reflectance, smoothstep
from rectbench.rendering.blocks.shape import Finish
from rectbench.rendering.world import Colour, Material


def asphalt(seed: int) -> Finish:
    """A worn road: stones in tar, darker repairs, cracks, stains of oil."""
    noise = Noise.of(seed, 21, 1024)
    fine, middle = noise.fractal(0.4), noise.fractal(1.5)
    distance, kind = noise.spots(16000, 2.6)
    stone = (1.0 - smoothstep(0.6, 1.0, distance)) * kind
    crack = 1.0 - smoothstep(0.0, 0.012, np.abs(noise.fractal(2.9) + 0.2))
    oil = smoothstep(1.2, 2.4, noise.clouds(3.0))
    tone = 0.150 + 0.026 * fine + 0.022 * middle + 0.13 * stone - 0.07 * crack - 0.05 * oil
    texels = planes((1.04, 1.0, 0.94)) * (tone + 0.018 * noise.clouds())
    return Finish("asphalt", Material(reflectance(texels)), (5.0, 5.0))


def lawn(seed: int, colour: Colour = (0.115, 0.19, 0.042)) -> Finish:
    """Grass seen from above: blades of light and shade, drier patches, clover and daisies."""
    noise = Noise.of(seed, 22, 1024)
    blades, tufts = noise.fractal(0.4), noise.fractal(1.5)
    green = planes(colour) * (1.0 + 0.28 * blades + 0.24 * tufts)
    texels = blend(green, (0.27, 0.24, 0.085), 0.35 * smoothstep(-0.5, 2.2, noise.clouds()))
    distance, kind = noise.spots(900, 9.0)
    clover = planes((0.06, 0.14, 0.045)) * (1.0 + 0.3 * blades)
    texels = blend(texels, clover, 0.7 * (1.0 - smoothstep(0.3, 1.0, distance)) * (0.5 + kind))
    distance, kind = noise.spots(260, 2.6)
    texels = blend(texels, blend((0.72, 0.71, 0.62), (0.62, 0.48, 0.05), kind > 0.6), distance < 0.9)
    return Finish("lawn", Material(reflectance(texels)), (5.0, 5.0))


def forest_floor(seed: int) -> Finish:
    """Soil under fallen leaves and needles, with moss."""
    noise = Noise.of(seed, 23, 1024)
    fine, middle, coarse = noise.fractal(0.5), noise.fractal(1.5), noise.clouds()
    soil = planes((0.155, 0.105, 0.060)) * (1.0 + 0.24 * fine + 0.20 * middle)
    moss = planes((0.095, 0.135, 0.038)) * (1.0 + 0.30 * fine + 0.2 * middle)
    texels = blend(soil, moss, 0.9 * smoothstep(-0.5, 0.9, coarse + 0.5 * middle))
    for count, radius in ((3600, 5.0), (1200, 8.0)):
        distance, kind = noise.spots(count, radius)
        leaf = blend((0.29, 0.165, 0.07), (0.16, 0.085, 0.04), kind)
        leaf = blend(leaf, (0.38, 0.29, 0.12), smoothstep(0.75, 0.95, kind)) * (1.0 + 0.18 * fine)
        texels = blend(texels, leaf, 0.9 * (1.0 - smoothstep(0.75, 1.0, distance + 0.12 * middle)))
    return Finish("forest-floor", Material(reflectance(texels)), (4.0, 4.0))


def gravel(seed: int, colour: Colour = (0.29, 0.24, 0.175)) -> Finish:
    """A path of trodden grit with pebbles."""
    noise = Noise.of(seed, 24, 1024)
    fine, middle = noise.fractal(0.4), noise.fractal(1.5)
    texels = planes(colour) * (1.0 + 0.14 * fine + 0.14 * middle + 0.10 * noise.clouds())
    for count, radius in ((12000, 3.0), (2500, 6.0)):
        distance, kind = noise.spots(count, radius)
        pebble = planes((0.36, 0.33, 0.29)) * (0.5 + kind)
        texels = blend(texels, pebble, 1.0 - smoothstep(0.7, 1.0, distance))
    return Finish("gravel", Material(reflectance(texels)), (3.2, 3.2))


def bark(seed: int, colour: Colour = (0.17, 0.125, 0.085)) -> Finish:
    """Furrowed bark, furrows along v, with lichen."""
    noise = Noise.of(seed, 25, 512)
    furrow = noise.streaks(5.0, 1.9).T
    fine, coarse = noise.fractal(0.8), noise.clouds(2.2)
    lichen = smoothstep(1.0, 1.9, noise.fractal(1.8))
    tone = 1.0 + 0.36 * np.tanh(1.5 * furrow) + 0.13 * fine + 0.13 * coarse
    texels = blend(planes(colour) * tone, planes((0.22, 0.24, 0.13)) * (1.0 + 0.2 * fine), 0.6 * lichen)
    return Finish("bark", Material(reflectance(texels)), (1.0, 1.2))


def birch_bark(seed: int) -> Finish:
    """White bark with dark horizontal scars."""
    noise = Noise.of(seed, 26, 512)
    scar = smoothstep(1.0, 1.5, noise.streaks(6.0, 1.7))
    tone = 1.0 + 0.10 * noise.fractal(0.8) + 0.13 * noise.clouds(2.2)
    texels = blend(planes((0.50, 0.47, 0.41)) * tone, (0.05, 0.045, 0.04), 0.9 * scar)
    return Finish("birch-bark", Material(reflectance(texels)), (1.0, 1.2))
