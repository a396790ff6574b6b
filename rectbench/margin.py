"""How near to the epipoles a view is trimmed.

Rows meet at the epipoles: across rows an image is stretched by 1/cos γ there. What lies within the margin of
them, |γ| > 90° - margin, is handed to no method. What a margin costs, and what it buys, on twelve wide rigs
(185° to 250°; six of them see both epipoles in both images, under motions of all kinds), `abraham`, means
over the rigs:

| margin | stretch | pixels trimmed | log distortion at 95 % | at 100 % | largest row error, perturbed |
|---|---|---|---|---|---|
| 3° | 19.1 | 0.2 % | 0.47 | 0.49 | 8.5 px |
| 5° | 11.5 | 0.6 % | 0.46 | 0.48 | 6.1 px |
| 7° | 8.2 | 1.1 % | 0.45 | 0.46 | 4.6 px |
| 10° | 5.7 | 2.2 % | 0.43 | 0.45 | 3.9 px |
| 12° | 4.8 | 3.2 % | 0.42 | 0.43 | 3.3 px |

From 3° to 7° each degree trims 0.2 % of the pixels and lowers the largest row error by 1 px; from there on it
trims 0.4 % and lowers it by 0.25 px. `local-homography` has the same knee. Perturbed: a pose off by 0.05° in
rotation and 0.3° in the baseline's direction.
"""

from __future__ import annotations

from numbers import Real
from typing import Any

from rectbench.errors import InvalidInput, argument

MARGIN_DEG = 7.0
"""The margin where nobody states one."""
WIDEST_MARGIN_DEG = 45.0
"""At this a view has lost all that lies farther from the middle than it is wide."""


def checked_margin(margin_deg: Any) -> float:
    """The margin as a float; InvalidInput for what is no angle above 0 and up to 45 degrees.

    >>> checked_margin(5)
    5.0
    >>> checked_margin(60)
    Traceback (most recent call last):
    rectbench.errors.InvalidInput: margin_deg is 60; expected degrees above 0, at most 45
    """
    is_real = isinstance(margin_deg, Real) and not isinstance(margin_deg, bool)
    if not is_real or not 0 < margin_deg <= WIDEST_MARGIN_DEG:
        name = argument("margin_deg")
        raise InvalidInput(
            f"{name} is {margin_deg!r}; expected degrees above 0, at most {WIDEST_MARGIN_DEG:g}"
        )
    return float(margin_deg)
