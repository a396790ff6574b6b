"""Levels of matches, by names as those of the pose have them: where a method's matches come from."""

from __future__ import annotations

import re

from rectbench.errors import InvalidInput

FROM_IMAGES = "images"
"""SIFT matches of the images, freed of wrong ones by the pose that the images themselves tell."""
_TRUE = re.compile(r"true(?: *\+ *(\d+(?:\.\d*)?|\.\d+) *px)?")


def match_level(stated: str) -> str:
    """A level in its one spelling: `images`, `true`, or `true + N px`, the truth with noise of N pixels.

    Raises InvalidInput for what is none.

    >>> match_level("true+0.10px")
    'true + 0.1 px'
    """
    if stated == FROM_IMAGES:
        return stated
    found = _TRUE.fullmatch(stated)
    if found is None:
        raise InvalidInput(f"matches are '{stated}'; expected images, true, or true + N px with a number N")
    noise_px = float(found[1] or 0)
    return f"true + {noise_px:g} px" if noise_px else "true"


def true_noise_px(level: str) -> float | None:
    """Standard deviation of the noise on true matches, pixels; None of a level that is not the truth.

    >>> true_noise_px("true + 0.1 px"), true_noise_px("true"), true_noise_px("images")
    (0.1, 0.0, None)
    """
    found = _TRUE.fullmatch(level)
    return None if found is None else float(found[1] or 0)


def marked(method: str, level: str, *said: str) -> str:
    """What a method is called with what is `said` of it: true matches never go unsaid.

    >>> marked("hartley", "true + 0.1 px"), marked("hartley", "images"), marked("fusiello", "true", "f=1")
    ('hartley (true matches + 0.1 px)', 'hartley', 'fusiello (f=1, true matches)')
    """
    told = [*said, *([level.replace("true", "true matches")] if true_noise_px(level) is not None else [])]
    return f"{method} ({', '.join(told)})" if told else method
