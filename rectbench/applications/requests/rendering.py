"""What the verbs that render take."""

from __future__ import annotations

from pathlib import Path
from typing import Self

from pydantic import model_validator

from rectbench.applications.requests.request import (
    OUT,
    ImageWidth,
    MethodRequest,
    Seed,
    SizedRigRequest,
    Text,
    positional,
    word,
)
from rectbench.applications.requests.words import whole_numbers_in
from rectbench.errors import InvalidInput, argument


class StageRequest(SizedRigRequest):
    """A rig in a scene, and how it is rendered."""

    scene: Text = positional("SCENE", "A scene's name, or a .py or Mitsuba .xml file.")
    motion: str = word("How the right camera stands to the left.", default="as-calibrated")
    spp: int = word("Samples a pixel, a power of two.", default=64)
    quality: str = word("path or fast.", default="path")
    image_width: ImageWidth | None = word("Scale the rig to this image width, pixels.", "--width")


class RenderRequest(StageRequest):
    """One pair."""

    out: Path = word("Folder for images, truth and rig.", *OUT, default=Path("rendered"))
    seed: Seed = word("Of scene, motion and noise.", default=0)


class ExportRequest(MethodRequest, StageRequest):
    """A dataset: a pair a seed, rectified by a method."""

    out: Path = word("The dataset's folder.", *OUT, default=Path("dataset"))
    seeds: list[Seed] = word(
        "A pair each, such as 0,1,2.", default=[0], metavar="NUMBERS", parse=whole_numbers_in, has_commas=True
    )

    @model_validator(mode="after")
    def _checked(self) -> Self:
        if not self.seeds:
            raise InvalidInput(f"{argument('seeds')} is empty; expected whole numbers from 0 on, a pair each")
        return self
