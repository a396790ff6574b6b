"""Fields that several verbs share: the rig, the method, a folder, a seed."""

from __future__ import annotations

from numbers import Integral, Real
from typing import Annotated, Any

from pydantic import BeforeValidator

from rectbench.applications.requests.request import Request, number, of_text, word
from rectbench.applications.requests.words import options_in, size_in
from rectbench.plugins.defaults import DEFAULT_METHOD

Seed = Annotated[int, number(Integral, "a whole number from 0 on", lambda n: n >= 0, "seed")]
Positive = Annotated[float, number(Real, "a number above 0", lambda x: 0 < x < float("inf"))]
ImageWidth = Annotated[int, number(Integral, "a width in pixels", lambda n: n >= 1)]
Text = Annotated[str, BeforeValidator(str)]
"""A name or a path."""

OUT = ("--out", "-o")
METHOD = ("--method", "-m")
METHOD_SEED = "Of the method's random choices."
CALIBRATION = "The rig's calibration file or folder, or a rig's name; repeatable where files are several."


class RigRequest(Request):
    """Whose calibration: the same words in every verb that takes one."""

    rig: Any = word(CALIBRATION, default=..., metavar="CALIB", takes_rest=True)
    """A `Rig`, or what `load_rig` takes."""
    max_angle_deg: float | None = word("The image circle: the lenses show nothing beyond this angle.")
    unit: str | None = word("What the calibration's translations are in, if not metres: mm, cm, in or ft.")
    cameras: Any = word(
        "Two cameras of a calibration that holds more, by its names.", metavar="LEFT,RIGHT", has_commas=True
    )


class SizedRigRequest(RigRequest):
    """A rig without images that would tell their size."""

    size: tuple[int, int] | None = word(
        "The images' size, where the calibration does not tell.", metavar="WxH", parse=of_text(size_in)
    )


class OptionsRequest(Request):
    """How a method is set."""

    options: dict[str, Any] = word(
        "An option of the method; repeatable.", "--option", default={}, metavar="NAME=VALUE", parse=options_in
    )


class MethodRequest(OptionsRequest):
    """Which method, and how it is set."""

    method: Text = word("A method's name, or a file.", *METHOD, default=DEFAULT_METHOD)


class SeededMethodRequest(MethodRequest):
    """The same where one seed is enough."""

    seed: Seed = word(METHOD_SEED, default=0)
