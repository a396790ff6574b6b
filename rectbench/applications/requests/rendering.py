"""What the verbs that render take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Self

from pydantic import BeforeValidator, Field, model_validator

from rectbench.applications.requests.request import LISTED, Word, positional
from rectbench.applications.requests.shared import (
    ImageWidth,
    MethodRequest,
    Out,
    Seed,
    SizedRigRequest,
    Text,
)
from rectbench.applications.requests.words import whole_numbers_in
from rectbench.errors import InvalidInput


class StageRequest(SizedRigRequest):
    """A rig in a scene, and how it is rendered."""

    scene: Annotated[
        Text, positional("SCENE"), Field(description="A scene's name, or a .py or Mitsuba .xml file.")
    ]
    motion: str = Field("as-calibrated", description="How the right camera stands to the left.")
    spp: int = Field(64, description="Samples a pixel, a power of two.")
    quality: str = Field("path", description="path or fast.")
    image_width: ImageWidth = None


class RenderRequest(StageRequest):
    """One pair."""

    out: Out = Field(Path("rendered"), description="Folder for images, truth and rig.")
    seed: Seed = Field(0, description="Of scene, motion and noise.")


class ExportRequest(MethodRequest, StageRequest):
    """A dataset: a pair a seed, rectified by a method."""

    out: Out = Field(Path("dataset"), description="The dataset's folder.")
    seeds: Annotated[
        list[Seed], BeforeValidator(whole_numbers_in), LISTED, Word(metavar="NUMBERS", has_commas=True)
    ] = Field([0], description="A pair each, such as 0,1,2.")

    @model_validator(mode="after")
    def _checked(self) -> Self:
        if not self.seeds:
            raise InvalidInput("seeds are empty; expected whole numbers from 0 on, a pair each")
        return self
