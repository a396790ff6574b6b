"""Pinhole images side by side, whose planes stand around the baseline as the sides of a prism."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from rectbench.errors import InvalidInput
from rectbench.formulas.evaluation import namespaced
from rectbench.formulas.namespaces import NUMPY
from rectbench.formulas.protocol import Formulas
from rectbench.types import Constants, FloatArray
from rectbench.warps.profiles import ANGLE_SLACK_RAD
from rectbench.warps.targets import Axis, Target


@dataclass(frozen=True)
class Prism(Target):
    """û = cx + f tan γ / cos δ, v̂ = cy + k h + f tan δ in piece k, δ = β - first_rad - k piece_rad.

    Each piece is a pinhole image of height h = 2 f tan(piece_rad / 2) that looks towards β = first_rad +
    k piece_rad; its plane holds the baseline, so that its rows are epipolar planes. One hangs on the next:
    the image is continuous, its slope is not.

    >>> import rectbench as rb
    >>> import numpy as np
    >>> target = rb.Prism(100.0, 0.0, 0.0, first_rad=-np.pi / 4, piece_rad=np.pi / 2, pieces=2)
    >>> target.project([[0.0, -1.0, 1.0], [0.5, 1.0, 1.0], [0.5, 0.0, 1.0]])[0].round(1) + 0.0
    array([[  0. ,   0. ],
           [ 35.4, 200. ],
           [ 70.7, 100. ]])
    """

    focal_px: float
    cx: float
    cy: float
    """The row of the middle of the first piece."""
    first_rad: float
    """Where that piece looks, β."""
    piece_rad: float
    """The angle of each about the baseline."""
    pieces: int

    def __post_init__(self) -> None:
        if not 0 < self.piece_rad < math.pi:
            raise InvalidInput(f"piece_rad is {self.piece_rad:g}; expected an angle above 0 and below π")
        if self.pieces != int(self.pieces) or self.pieces < 1:
            raise InvalidInput(f"pieces is {self.pieces!r}; expected 1 or more")
        object.__setattr__(self, "pieces", int(self.pieces))

    @property
    def height_px(self) -> float:
        """Of a piece."""
        return 2 * self.focal_px * math.tan(self.piece_rad / 2)

    @property
    def constants(self) -> Constants:
        return {
            "focal": self.focal_px,
            "cx": self.cx,
            "cy": self.cy,
            "first": self.first_rad,
            "piece": self.piece_rad,
            "last": self.pieces - 1.0,
            "height": self.height_px,
            "half": self.piece_rad / 2 + ANGLE_SLACK_RAD,
        }

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        beta = xp.atan2(y, z) - c.first
        piece = _nearest(beta / c.piece, c.last, xp)
        off = beta - piece * c.piece
        u = c.cx + c.focal * x / (xp.hypot(y, z) * xp.cos(off))
        return u, c.cy + piece * c.height + c.focal * xp.tan(off), xp.abs(off) <= c.half

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        return self.ray_formula(c, ((u - c.cx) / c.focal,), self._row(c, v, xp), xp)

    def axis_tables(self, columns: FloatArray, rows: FloatArray) -> tuple[Axis, Axis]:
        c = namespaced(self.constants)
        return ((columns - c.cx) / c.focal,), tuple(np.asarray(a) for a in self._row(c, rows, NUMPY))

    def ray_formula(self, c: Any, column: Any, row: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        (slope,), (off, sin_beta, cos_beta) = column, row
        along = slope * xp.cos(off)  # tan γ
        length = xp.sqrt(1.0 + along * along)
        return along / length, sin_beta / length, cos_beta / length, xp.abs(off) <= c.half

    def _row(self, c: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        """δ, sin β and cos β of a row."""
        below = v - c.cy
        piece = _nearest(below / c.height, c.last, xp)
        off = xp.atan((below - piece * c.height) / c.focal)
        beta = c.first + piece * c.piece + off
        return off, xp.sin(beta), xp.cos(beta)


def _nearest(place: Any, last: Any, xp: Formulas) -> Any:
    """The whole number from 0 to `last` that is nearest to a place."""
    return xp.minimum(xp.maximum(xp.floor(place + 0.5), 0.0), last)
