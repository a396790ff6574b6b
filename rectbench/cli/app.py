"""The application that the verbs join, and the arguments that several of them take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

WRONG_USAGE, INCOMPLETE = 2, 3

app = typer.Typer(
    help="A bench for stereo rectification: render, rectify, measure, report.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # square brackets in help texts are TOML sections
)

RunFolder = Annotated[Path, typer.Argument(metavar="RUN", help="A run's folder.")]
OptionTexts = Annotated[
    list[str] | None,
    typer.Option("--option", metavar="METHOD.NAME=VALUE", help="An option of a method; repeatable."),
]
LeftImage = Annotated[Path, typer.Argument(metavar="LEFT", help="The left image.")]
RightImage = Annotated[Path, typer.Argument(metavar="RIGHT", help="The right image.")]
RigFiles = Annotated[
    list[str],
    typer.Option(
        metavar="CALIB",
        help="The rig's calibration file or folder, or a rig's name; repeatable where files are several.",
    ),
]
MaxAngle = Annotated[
    float | None, typer.Option(help="The image circle: the lenses show nothing beyond this angle.")
]
Method = Annotated[str, typer.Option("--method", "-m", help="A method's name, or a file.")]
MethodOptions = Annotated[
    list[str] | None,
    typer.Option("--option", metavar="NAME=VALUE", help="An option of the method; repeatable."),
]
MethodSeed = Annotated[int, typer.Option(help="Of the method's random choices.")]
Cameras = Annotated[
    list[str] | None,
    typer.Option(metavar="LEFT,RIGHT", help="Two cameras of a calibration that holds more, by its names."),
]
Unit = Annotated[
    str | None,
    typer.Option(help="What the calibration's translations are in, if not metres: mm, cm, in or ft."),
]


def split_names(names: list[str] | None) -> list[str] | None:
    """Names of repeated options and of comma-separated lists, in one list."""
    if names is None:
        return None
    return [name.strip() for text in names for name in text.split(",") if name.strip()]
