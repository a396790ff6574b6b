"""The boundary of what a lens shows, as curves, and the extremes of a map on it."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from rectbench.cameras import Camera
from rectbench.types import FloatArray

CURVE_POINTS = 1024
"""On each curve, the image's corners among them."""
ZOOMS, ZOOM_POINTS, ZOOM = 4, 33, 16
"""How often the surroundings of an extreme are looked at, by so many points, so many times as close."""
RIM_POINTS = 257
"""On each side of an image, of which the lens shows all where it shows these."""
HALVINGS = 40
"""Of an angle from the axis, to find how far a lens sees where its model ends."""

Curve = Callable[[FloatArray], FloatArray]
"""From shares [...] of the way around, of period 1, to unit rays [..., 3]; NaN where it bounds no view."""


def extremes(camera: Camera, of_rays: Callable[[FloatArray], FloatArray]) -> tuple[FloatArray, FloatArray]:
    """The least and the greatest [K] of functions of what the camera shows; ∓∞ where it shows nothing.

    `of_rays` takes unit rays [..., 3] of its frame to values [K, ...] that are continuous on the view and
    have no extreme within it, such as angles about a line that it does not see. Where they have it is found
    to a millionth of the boundary's length, at the ends of its curves too.
    """
    low, high = [], []
    for curve in _boundary(camera):
        shares = np.arange(CURVE_POINTS) / CURVE_POINTS
        values = of_rays(curve(shares))
        found = _signed(values)
        kinds = np.arange(len(found))
        step = 1 / CURVE_POINTS
        for _ in range(ZOOMS):
            best = found.argmax(axis=-1)
            near = np.broadcast_to(shares, found.shape)[kinds, best]
            shares = near[:, None] + step * np.linspace(-1, 1, ZOOM_POINTS)
            found = _signed(of_rays(curve(shares)))[kinds, kinds]
            step /= ZOOM
        greatest = found.max(axis=-1)
        low.append(-greatest[: len(values)])
        high.append(greatest[len(values) :])
    return np.min(low, axis=0), np.max(high, axis=0)


def _signed(values: FloatArray) -> FloatArray:
    """-values and values [2 K, ...], least where they are unknown."""
    both = np.concatenate([-values, values])
    return np.where(np.isnan(both), -np.inf, both)


def _boundary(camera: Camera) -> list[Curve]:
    curves: list[Curve] = [partial(_image_rim, camera)]
    if not camera.whole.unproject(camera.rim(RIM_POINTS))[1].all():
        curves.append(partial(_lens_edge, camera))
    if camera.blind is not None:
        curves += [partial(_cone_rim, camera, sign) for sign in (1.0, -1.0)]
    return curves


def _image_rim(camera: Camera, shares: FloatArray) -> FloatArray:
    """Clockwise from the top left corner, half a pixel out."""
    side, along = np.divmod(4 * (shares % 1.0), 1.0)
    across = np.select([side == 0, side == 1, side == 2], [along, 1.0, 1 - along], 0.0)
    down = np.select([side == 0, side == 1, side == 2], [0.0, along, 1.0], 1 - along)
    pixels = np.stack([across, down], axis=-1) * np.array(camera.size) - 0.5
    return camera.unproject(pixels)[0]


def _lens_edge(camera: Camera, shares: FloatArray) -> FloatArray:
    """About the axis, where the image circle or the model's own domain ends."""
    azimuth = 2 * math.pi * shares
    sees = camera.whole.project

    def ray(theta: FloatArray) -> FloatArray:
        return np.stack(
            [np.sin(theta) * np.cos(azimuth), np.sin(theta) * np.sin(azimuth), np.cos(theta)], axis=-1
        )

    edge = np.full(azimuth.shape, math.radians(camera.max_angle_deg or 180.0))
    if not sees(ray(edge))[1].all():
        inner, outer = np.zeros_like(edge), edge
        for _ in range(HALVINGS):
            middle = (inner + outer) / 2
            seen = sees(ray(middle))[1]
            inner, outer = np.where(seen, middle, inner), np.where(seen, outer, middle)
        edge = inner
    return _shown(camera, ray(edge))


def _cone_rim(camera: Camera, sign: float, shares: FloatArray) -> FloatArray:
    """About one of the cones where the camera is blind."""
    assert camera.blind is not None
    return _shown(camera, sign * camera.blind.rim(2 * math.pi * shares))


def _shown(camera: Camera, rays: FloatArray) -> FloatArray:
    rays[~camera.sees(rays)] = np.nan
    return rays
