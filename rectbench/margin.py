"""How near to the epipoles a view is trimmed.

Rows meet at the epipoles: across rows an image is stretched by 1/cos γ there. What lies within the margin of
them, |γ| > 90° - margin, is handed to no method. What a margin costs and what it buys, `abraham`, means over
eleven wide rigs that see epipoles, in motions of all kinds:

| margin | stretch | pixels trimmed | log distortion at 95 % | at 100 % | largest row error, pose perturbed |
|---|---|---|---|---|---|
| 3° | 19.1 | 0.2 % | 0.488 | 0.506 | 8.7 px |
| 5° | 11.5 | 0.6 % | 0.477 | 0.494 | 5.8 px |
| 7° | 8.2 | 1.2 % | 0.466 | 0.481 | 4.7 px |
| 8° | 7.2 | 1.6 % | 0.460 | 0.475 | 4.4 px |
| 10° | 5.8 | 2.5 % | 0.448 | 0.463 | 3.7 px |
| 12° | 4.8 | 3.5 % | 0.437 | 0.452 | 3.2 px |

Up to 7° a degree costs 0.25 % of the pixels and takes 1 px off the largest row error (a pose off by 0.05° in
rotation and 0.3° in the baseline's direction); beyond, it costs 0.4 % and more, and takes off 0.3 px.
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
