"""Fields that several verbs share: the rig, the method, a folder, a seed."""

from __future__ import annotations

from numbers import Integral, Real
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from rectbench.applications.requests.request import LISTED, Request, Word, number, positional
from rectbench.applications.requests.words import options_in, size_in

Out = Annotated[Path, Word(("--out", "-o"))]
Seed = Annotated[int, number(Integral, "a whole number from 0 on", lambda n: n >= 0)]
MethodSeed = Annotated[Seed, Field(description="Of the method's random choices.")]
Positive = Annotated[float, number(Real, "a number above 0", lambda x: 0 < x < float("inf"))]
ImageWidth = Annotated[
    int | None,
    number(Integral, "a width in pixels", lambda n: n >= 1),
    Word(("--width",)),
    Field(description="Scale the rig to this image width, pixels."),
]
Text = Annotated[str, BeforeValidator(str)]
"""A name or a path."""
Names = Annotated[list[Text] | None, LISTED, Word(metavar="NAMES", has_commas=True)]
LeftImage = Annotated[Path, positional("LEFT"), Field(description="The left image.")]
RightImage = Annotated[Path, positional("RIGHT"), Field(description="The right image.")]


class RigRequest(Request):
    """Whose calibration: the same words in every verb that takes one."""

    rig: Annotated[
        Any,
        Word(metavar="CALIB", takes_rest=True),
        Field(
            description="The rig's calibration file or folder, or a rig's name; repeatable where files are "
            "several."
        ),
    ]
    """A `Rig`, or what `load_rig` takes."""
    max_angle_deg: float | None = Field(
        None, description="The image circle: the lenses show nothing beyond this angle."
    )
    unit: str | None = Field(
        None, description="What the calibration's translations are in, if not metres: mm, cm, in or ft."
    )
    cameras: Annotated[Any, Word(metavar="LEFT,RIGHT", has_commas=True)] = Field(
        None, description="Two cameras of a calibration that holds more, by its names."
    )


class SizedRigRequest(RigRequest):
    """A rig without images that would tell their size."""

    size: Annotated[tuple[int, int] | None, BeforeValidator(size_in), Word(metavar="WxH")] = Field(
        None, description="The images' size, where the calibration does not tell."
    )


class OptionsRequest(Request):
    """How a method is set."""

    options: Annotated[
        dict[str, Any], BeforeValidator(options_in), Word(("--option",), metavar="NAME=VALUE")
    ] = Field({}, description="An option of the method; repeatable.")


class MethodRequest(OptionsRequest):
    """Which method, and how it is set."""

    method: Annotated[Text, Word(("--method", "-m"))] = Field(
        "local-homography", description="A method's name, or a file."
    )


class SeededMethodRequest(MethodRequest):
    """The same where one seed is enough."""

    seed: MethodSeed = 0
