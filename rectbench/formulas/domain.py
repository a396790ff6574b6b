"""Where a lens stops: the edge of the domain on which a projection model can be inverted."""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial import Polynomial

LEAST_SLOPE = 1e-5
"""A model ends where its slope has fallen to this share of its mean slope since the axis, or of that there.

The fold itself, where the slope is 0, lies some 1e-5 rad further. In between, the last digit of a
pixel coordinate is worth more than 1e-9 rad.
"""
RAY_SLACK = 4e-15
PIXEL_SLACK = 1e-11
"""Rounding let through at the edge, for rays (radians) and on the lens plane (relative); the second
is the larger, so that a ray on the very edge comes back."""
FARTHEST = 1e3
"""Tangent of the angle where a distorted pinhole ends that never folds (89.94°)."""


def first_root(polynomial: Polynomial) -> float:
    """The least positive root of a polynomial that is not 0 at 0; infinity without one.

    Found as the greatest root in 1/x: that is accurate, and leading coefficients may vanish.
    """
    reciprocals = Polynomial(polynomial.coef[::-1]).roots()
    # A double root that rounding has pushed off the real line still counts.
    real = reciprocals.real[np.abs(reciprocals.imag) <= 1e-7 * np.abs(reciprocals)]
    greatest = float(real.max(initial=0.0))
    return 1.0 / greatest if greatest > 0.0 else math.inf
