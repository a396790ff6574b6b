"""The verb about calibration files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rectbench.cli.app import MaxAngle, Unit, split_names
from rectbench.cli.number_texts import image_size


def convert(
    calibration: Annotated[
        list[str],
        typer.Argument(
            metavar="CALIB",
            help="A calibration file or folder, several that complete each other, or a rig's name.",
        ),
    ],
    out: Annotated[
        Path, typer.Option("--out", "-o", help="The file to write; for some formats a folder of files.")
    ],
    to: Annotated[
        str, typer.Option("--to", metavar="FORMAT", help="See `rectbench list formats`.")
    ] = "native",
    cameras: Annotated[
        str | None,
        typer.Option(metavar="LEFT,RIGHT", help="Two cameras of a file that holds more, by its names."),
    ] = None,
    size: Annotated[
        str | None, typer.Option(metavar="WxH", help="The images' size, where the calibration does not tell.")
    ] = None,
    max_angle_deg: MaxAngle = None,
    unit: Unit = None,
) -> None:
    """Write a calibration in another format, exactly, or tell why that format cannot hold it."""
    from rectbench.calibrations import load_rig

    pair = split_names(None if cameras is None else [cameras])
    rig = load_rig(calibration, image_size(size), unit, pair)
    rig = rig if max_angle_deg is None else rig.within(max_angle_deg)
    for file in rig.save(out, to):
        print(file)
