"""The verb that renders a pair."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def render(
    scene: Annotated[
        str, typer.Argument(metavar="SCENE", help="A scene's name, or a .py or Mitsuba .xml file.")
    ],
    rig: Annotated[str, typer.Argument(metavar="RIG", help="A rig's name, or a calibration file.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for images, truth and rig.")] = Path(
        "rendered"
    ),
    motion: Annotated[str, typer.Option(help="How the right camera stands to the left.")] = "as-calibrated",
    seed: Annotated[int, typer.Option(help="Of scene, motion and noise.")] = 0,
    spp: Annotated[int, typer.Option(help="Samples a pixel, a power of two.")] = 64,
    quality: Annotated[str, typer.Option(help="path or fast.")] = "path",
    width: Annotated[int | None, typer.Option(help="Scale the rig to this image width, pixels.")] = None,
) -> None:
    """Render a rig in a scene: left.png, right.png, truth.npz, truth EXRs and rig.yaml."""
    from rectbench import api
    from rectbench.runs.record import check_writable

    check_writable(out)
    pair, truth = api.render(scene, rig, motion, seed, spp, quality, width)
    pair.save(out)
    truth.save(out / "truth.npz")
    truth.save_exr(out)
    truth.rig.save(out / "rig.yaml")
    print(out)
