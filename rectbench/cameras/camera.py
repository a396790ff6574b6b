"""A calibrated camera: a projection model, its numbers, and the image's size."""

from __future__ import annotations

import math
import operator
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType, SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import rectbench.cameras.models  # noqa: F401  (registers the projection models)
from rectbench.cameras.cones import Cones, outside
from rectbench.cameras.lens import lens_named
from rectbench.cameras.parameters import checked_parameters
from rectbench.cameras.projection import Projection, as_points
from rectbench.errors import InvalidInput
from rectbench.formulas.domain import PIXEL_SLACK, RAY_SLACK
from rectbench.formulas.protocol import Formulas
from rectbench.types import BoolArray, Constants, FloatArray

_RIM_POINTS, _HALVINGS = 33, 34
"""On each side of an image, to find how far a lens sees; and steps from its centre to where it ends."""
_AZIMUTHS = 720
"""About the axis, at which a lens is asked whether it sees as far as an angle."""


@dataclass(frozen=True, repr=False)
class Camera(Projection):
    """Pixels and rays of one lens on one image.

    Parameters
    ----------
    model : name of the projection model, see `rectbench.cameras.lens.LENSES`.
    size : (width, height) of the image in pixels.
    params : the model's parameters by name; what is left out is 0 (ocam's `c`: 1). `fx fy cx cy` in
        pixels, pixel (0, 0) being the centre of the top-left pixel; ocam's `poly` and `inverse_poly`
        are sequences.
    max_angle_deg : angle from the axis beyond which the lens shows nothing (the image circle);
        None where the model's own domain is the only bound.
    blind : a part of the view of which the lens is to show nothing, such as what lies about the epipoles of
        a rig (see `Rig.trimmed`); None where there is none.

    Raises InvalidInput for a size, parameter or angle that makes no camera.

    >>> import rectbench as rb
    >>> centre = {"cx": 319.5, "cy": 239.5}
    >>> camera = rb.Camera("equidistant", (640, 480), {"fx": 200, "fy": 200, **centre}, max_angle_deg=95)
    >>> pixels, seen = camera.project([[0, 0, 1], [1, 0, 0], [0, 0, -1]])  # ahead, to the right, behind
    >>> pixels.round(2)
    array([[319.5 , 239.5 ], [633.66, 239.5 ], [   nan,    nan]])
    >>> seen
    array([ True,  True, False])
    """

    model: str
    size: tuple[int, int]
    params: Mapping[str, Any] = field(hash=False)
    max_angle_deg: float | None = None
    blind: Cones | None = None

    def __post_init__(self) -> None:
        lens = lens_named(self.model)
        object.__setattr__(self, "size", _checked_size(self.size))
        object.__setattr__(self, "params", MappingProxyType(checked_parameters(lens, self.params)))
        object.__setattr__(self, "max_angle_deg", _checked_angle(self.max_angle_deg))
        if not isinstance(self.blind, Cones | None):
            raise InvalidInput(f"blind is {type(self.blind).__name__}; expected Cones, or None")
        _ = self.constants  # a lens that cannot be derived fails here, not at its first use

    def __repr__(self) -> str:
        limit = "" if self.max_angle_deg is None else f", max_angle_deg={self.max_angle_deg!r}"
        blind = "" if self.blind is None else f", blind={self.blind!r}"
        return f"Camera({self.model!r}, {self.size!r}, {dict(self.params)!r}{limit}{blind})"

    def __reduce__(self) -> tuple[Any, ...]:
        return Camera, (self.model, self.size, dict(self.params), self.max_angle_deg, self.blind)

    @cached_property
    def constants(self) -> Constants:
        """Parameters and what the model derives from them, the edge of its domain included."""
        derived = lens_named(self.model).derive(SimpleNamespace(**self.params))
        limit = 180.0 if self.max_angle_deg is None else self.max_angle_deg
        blind = {} if self.blind is None else {"blind": self.blind.constants}
        return {**self.params, **derived, "cos_max_angle": math.cos(math.radians(limit)), **blind}

    @property
    def width(self) -> int:
        """Image width, pixels."""
        return self.size[0]

    @property
    def height(self) -> int:
        """Image height, pixels."""
        return self.size[1]

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        u, v, ok = lens_named(self.model).project(c, x, y, z, xp)
        ok = ok & (z >= (c.cos_max_angle - RAY_SLACK) * xp.sqrt(x * x + y * y + z * z))
        return u, v, ok if self.blind is None else ok & outside(c.blind, x, y, z, RAY_SLACK)

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        x, y, z, ok = lens_named(self.model).unproject(c, u, v, xp)
        ok = ok & (z >= c.cos_max_angle - PIXEL_SLACK)
        return x, y, z, ok if self.blind is None else ok & outside(c.blind, x, y, z, PIXEL_SLACK)

    @cached_property
    def whole(self) -> Camera:
        """The camera with its blind part seen, see `blind`; itself where there is none."""
        return self if self.blind is None else replace(self, blind=None)

    def contains(self, pixels: ArrayLike) -> BoolArray:
        """Mask [...] of the pixels [..., 2] that lie on the image, its outer half pixels included."""
        pixels = as_points(pixels, 2, "pixels")
        u, v = pixels[..., 0], pixels[..., 1]
        with np.errstate(invalid="ignore"):
            inside: BoolArray = (u >= -0.5) & (u <= self.width - 0.5) & (v >= -0.5) & (v <= self.height - 0.5)
        return inside

    def sees(self, rays: ArrayLike) -> BoolArray:
        """Mask [...] of the rays [..., 3] that land on the image."""
        pixels, ok = self.project(rays)
        return ok & self.contains(pixels)

    def rim(self, points: int) -> FloatArray:
        """Pixels [4 points, 2] along the image's edge, half a pixel out, its corners among them."""
        right, bottom = self.width - 0.5, self.height - 0.5
        u, v = np.linspace(-0.5, right, points), np.linspace(-0.5, bottom, points)
        sides = ((u, -0.5), (u, bottom), (-0.5, v), (right, v))
        return np.concatenate([np.stack(np.broadcast_arrays(*side), axis=-1) for side in sides])

    def reaches(self, angle_deg: float) -> bool:
        """Whether the image shows anything as far from the axis as this, blind parts aside.

        >>> import rectbench as rb
        >>> lens = rb.load_rig("t265").left
        >>> lens.reaches(79), lens.reaches(81)
        (True, False)
        """
        rays, seen = self.whole.unproject(self.rim(_RIM_POINTS))
        if (rays[seen, 2] <= math.cos(math.radians(angle_deg))).any():
            return True
        azimuth = np.linspace(0.0, 2 * math.pi, _AZIMUTHS, endpoint=False)
        around = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1) * math.sin(math.radians(angle_deg))
        along = np.full((_AZIMUTHS, 1), math.cos(math.radians(angle_deg)))
        return bool(self.whole.sees(np.concatenate([around, along], axis=-1)).any())

    @property
    def fov_deg(self) -> float:
        """Field of view, degrees: twice the largest angle from the axis at which the image shows anything.

        That of the whole lens, its blind part included.

        >>> import rectbench as rb
        >>> round(rb.load_rig("bumblebee2").left.fov_deg), round(rb.load_rig("t265").left.fov_deg)
        (88, 160)
        """
        (centre,), _ = self.whole.project([[0.0, 0.0, 1.0]])
        rim = self.rim(_RIM_POINTS)
        rays, ok = self.whole.unproject(rim)
        if not ok.all():  # the image circle ends before the rim does; its edge is found by halving
            outer, inner = rim[~ok], np.broadcast_to(centre, rim[~ok].shape)
            for _ in range(_HALVINGS):
                middle = (outer + inner) / 2
                seen = self.whole.unproject(middle)[1][:, None]
                outer, inner = np.where(seen, outer, middle), np.where(seen, middle, inner)
            rays = np.concatenate([rays[ok], self.whole.unproject(inner)[0]])
        x, y, z = rays.T
        return round(float(2 * np.degrees(np.arctan2(np.hypot(x, y), z).max())), 6)

    def pixel_grid(self) -> FloatArray:
        """The centres of all pixels, [height, width, 2]."""
        u, v = np.meshgrid(np.arange(self.width, dtype=float), np.arange(self.height, dtype=float))
        return np.stack([u, v], axis=-1)

    def scaled(self, factor: float) -> Camera:
        """The same lens on an image `factor` times as large (sizes rounded to whole pixels).

        The image's corners stay where they are: with pixel centres at whole numbers, a coordinate
        u becomes (u + 0.5) s - 0.5.
        """
        if not 0 < factor < math.inf:
            raise InvalidInput(f"a camera was scaled by {factor!r}; expected a finite number above 0")
        size = (max(1, round(self.width * factor)), max(1, round(self.height * factor)))
        sx, sy = size[0] / self.width, size[1] / self.height
        return replace(self, size=size, params=lens_named(self.model).scaled(self.params, sx, sy))


def _checked_size(size: Any) -> tuple[int, int]:
    try:
        width, height = (operator.index(value) for value in size)
    except (TypeError, ValueError):
        raise InvalidInput(f"camera size is {size!r}; expected (width, height) in whole pixels") from None
    if width < 1 or height < 1:
        raise InvalidInput(f"camera size is {width}x{height}; expected at least 1x1 pixels")
    return width, height


def _checked_angle(angle_deg: Any) -> float | None:
    if angle_deg is None:
        return None
    if not isinstance(angle_deg, int | float | np.number) or not 0 < angle_deg <= 180:
        raise InvalidInput(f"max_angle_deg is {angle_deg!r}; expected a number in (0, 180]")
    return float(angle_deg)
