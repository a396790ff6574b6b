"""Profiles that a third party writes in the language of formulas pass every check of a rectifier."""

from __future__ import annotations

from pathlib import Path

import pytest

from rectbench.applications.check_method import check_method
from rectbench.plugins.rectifier import METHODS
from rectbench.registry import registry

MERCATOR = '''
"""Rows after Mercator: v̂ = f asinh(tan β), conformal on a cylinder about the baseline."""

import math
from dataclasses import dataclass

import rectbench as rb


@dataclass(frozen=True)
class Mercator(rb.Profile):
    """f asinh(tan θ)."""

    focal_px: float
    low: float = -1.55
    high: float = 1.55

    @property
    def constants(self):
        return {"focal": self.focal_px, "low": self.low, "high": self.high}

    def value(self, c, angle, xp: rb.Formulas):
        return c.focal * xp.asinh(xp.tan(angle))

    def angle(self, c, value, xp: rb.Formulas):
        return xp.atan(xp.sinh(value / c.focal))


class MercatorColumns(rb.Rectifier):
    """û after Mercator, v̂ = f β."""

    name = "mercator"

    def fit(self, problem, options):
        rb.refuse_epipole_in_view(problem.rig)
        f = rb.centre_resolution_px(problem.rig)
        u, v = Mercator(f), rb.Radial("equidistant", f, 0.0)
        return rb.Rectification.from_profiles(problem.rig, u, u, v)
'''

SPLINE = '''
"""û and v̂ by monotone cubic splines through a few points, as a fitted profile would be."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

import rectbench as rb


@dataclass(frozen=True)
class Spline(rb.Profile):
    """A piecewise cubic, and one for its inverse that a Newton step sharpens."""

    knots: tuple[float, ...]
    pieces: tuple[tuple[float, ...], ...]
    values: tuple[float, ...]

    @classmethod
    def through(cls, angles, values):
        curve = PchipInterpolator(angles, values)
        pieces = tuple(tuple(map(float, row)) for row in curve.c[::-1].T)
        return cls(tuple(map(float, angles)), pieces, tuple(map(float, values)))

    @property
    def low(self):
        return self.knots[0]

    @property
    def high(self):
        return self.knots[-1]

    @property
    def constants(self):
        lines = [
            (a, (b - a) / (w - v))
            for a, b, v, w in zip(self.knots, self.knots[1:], self.values, self.values[1:])
        ]
        slopes = tuple(tuple(k * c for k, c in enumerate(piece))[1:] for piece in self.pieces)
        return {"knots": self.knots, "pieces": self.pieces, "slopes": slopes, "values": self.values,
                "lines": tuple(lines), "low": self.low, "high": self.high}

    def value(self, c, angle, xp: rb.Formulas):
        return xp.spline(c.knots, c.pieces, angle)

    def angle(self, c, value, xp: rb.Formulas):
        angle = xp.spline(c.values, c.lines, value)
        for _ in range(8):
            miss = self.value(c, angle, xp) - value
            angle = angle - miss / xp.spline(c.knots, c.slopes, angle)
        return angle


class SplineRectifier(rb.Rectifier):
    """û and v̂ by splines."""

    name = "spline"

    def fit(self, problem, options):
        rb.refuse_epipole_in_view(problem.rig)
        f, view = rb.centre_resolution_px(problem.rig), rb.view_angles(problem.rig)

        def profile(span):
            angles = np.linspace(span.low, span.high, 9)
            return Spline.through(angles, f * 1.2 * np.arcsinh(angles / 1.2))

        u, v = profile(view.gamma), profile(view.beta)
        return rb.Rectification.from_profiles(problem.rig, u, u, v)
'''


@pytest.mark.parametrize("source", [MERCATOR, SPLINE], ids=["Mercator", "spline"])
def test_a_profile_of_ones_own_passes_every_check(tmp_path: Path, source: str) -> None:
    file = tmp_path / "mine.py"
    file.write_text(source)
    findings = list(check_method(registry(METHODS).get(file)))
    assert [finding for finding in findings if finding.result == "failed"] == []
    assert sum(finding.result == "passed" for finding in findings) > 25
