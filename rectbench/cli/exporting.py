"""The verb that renders a dataset for other tools."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rectbench.cli.app import Method, MethodOptions
from rectbench.cli.number_texts import whole_numbers
from rectbench.plugins.defaults import DEFAULT_METHOD


def export(
    scene: Annotated[
        str, typer.Argument(metavar="SCENE", help="A scene's name, or a .py or Mitsuba .xml file.")
    ],
    rig: Annotated[str, typer.Argument(metavar="RIG", help="A rig's name, or a calibration file.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="The dataset's folder.")] = Path("dataset"),
    motion: Annotated[str, typer.Option(help="How the right camera stands to the left.")] = "as-calibrated",
    seeds: Annotated[str, typer.Option(metavar="NUMBERS", help="A pair each, such as 0,1,2.")] = "0",
    spp: Annotated[int, typer.Option(help="Samples a pixel, a power of two.")] = 64,
    quality: Annotated[str, typer.Option(help="path or fast.")] = "path",
    width: Annotated[int | None, typer.Option(help="Scale the rig to this image width, pixels.")] = None,
    method: Method = DEFAULT_METHOD,
    option: MethodOptions = None,
) -> None:
    """Render a dataset: images, depth, flow, rectified pairs with disparity, masks and calibrations.

    README.md in the folder says what each file is and how it is read. An export that was cut off goes on
    where it was; one with more seeds adds pairs.
    """
    from rectbench import api
    from rectbench.cli.configuring import read_method_options

    made = api.export_dataset(
        scene,
        rig,
        out,
        motion=motion,
        seeds=whole_numbers("seeds", [seeds]) or [],
        spp=spp,
        quality=quality,
        image_width=width,
        method=method,
        options=read_method_options(option),
    )
    print(f"{made.folder}: {len(made.rendered)} pairs rendered, {len(made.kept)} there already")
