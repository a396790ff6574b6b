"""Which pair is meant, as plain values that travel to other processes and into run.json."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

AS_CALIBRATED = "as-calibrated"
"""The motion of photographs: the rig is what it is."""


class _Spec(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    scene: str
    """The scene, or what the photographs are called."""
    rig: str
    motion: str
    seed: int


class RenderedSpec(_Spec):
    """A pair to be rendered: a rig that stands in a scene."""

    kind: Literal["rendered"] = "rendered"
    scene_source: str
    """The scene's name, or the absolute path of its file."""
    rig_source: str
    image_width: int | None
    quality: Literal["path", "fast"]
    spp: int
    truth: bool
    """Whether anything asks for the truth."""
    images: bool
    """Whether anything asks for the rendered images."""


class PhotographedSpec(_Spec):
    """A pair of photographs, and the calibration of the rig that took them."""

    kind: Literal["photographed"] = "photographed"
    left: str
    """Absolute paths of the images,"""
    right: str
    calibration: tuple[str, ...]
    """and of the calibration's files."""
    size: tuple[int, int] | None
    """Of the images, where these files leave it out."""
    unit: str | None
    max_angle_deg: float | None
    """The lenses' image circle, where these files leave it out."""
    cameras: tuple[str, str] | None = None
    """The two of files that hold more."""


PairSpec = Annotated[RenderedSpec | PhotographedSpec, Field(discriminator="kind")]

ESTIMATED = "estimated"
"""The pose that is estimated from the images themselves."""
CALIBRATED = "calibrated"
"""The pose as a calibration states it, of which nobody knows how exact it is: that of photographs."""
