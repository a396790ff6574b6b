"""NVIDIA's f-theta camera in any of its files: two polynomials, of which one is the reference, and a stretch.

u - centre = [c d; e 1] (x', y'), where (x', y') lies at the distance ρ from the centre, pixels, in the
direction of the ray. The reference is ρ by the powers of the angle θ, or θ by those of ρ; the other one is
a fit to it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.polynomial import Polynomial

from rectbench.calibrations.assembling import camera_of
from rectbench.calibrations.documents import errors_at
from rectbench.calibrations.formats.toolboxes.ocamcalib import stretched
from rectbench.cameras import Camera
from rectbench.cameras.models.in_pixels.stretched import AFFINE_PARAMETERS
from rectbench.errors import InvalidInput

ABOUT_90_DEG = Polynomial([0.5 * np.pi, 1.0])
"""θ by OCamCalib's t = θ - π/2."""


def f_theta_camera(
    where: str,
    size: tuple[int, int],
    centre: tuple[float, float],
    poly: Sequence[float],
    by_distance: bool,
    linear: Sequence[float] = (1.0, 0.0, 0.0),
    max_angle_deg: float | None = None,
) -> Camera:
    """The camera of a reference polynomial, constant term first, and c, d, e.

    `centre` is in rectbench's pixels. Where `by_distance`, θ is a polynomial in ρ, and the camera an
    `f-theta`; else ρ is one in θ, and the camera an `ocam` by its `inverse_poly`, that polynomial about 90°.
    Raises InvalidInput, at `where`, for a polynomial that is not 0 at 0 and for numbers that make no camera.
    """
    constant, *rest = poly or (0.0,)
    if constant != 0:
        raise InvalidInput(f"{where} has a polynomial of {constant:g} at its centre; expected 0")
    c, d, e = linear
    stretch = ((c, d), (e, 1.0))
    with errors_at(where):
        inverse_poly = () if by_distance else tuple(Polynomial([0.0, *rest])(ABOUT_90_DEG).coef.tolist())
    params = stretched(stretch, centre, (), inverse_poly, where)
    if not by_distance:
        return camera_of(where, "ocam", size, params, max_angle_deg)
    affine = {key: params[key] for key in AFFINE_PARAMETERS}
    with errors_at(where):
        angle_poly = [a / c**power for power, a in enumerate(rest, 1)]
    return camera_of(where, "f-theta", size, affine | {"angle_poly": angle_poly}, max_angle_deg)
