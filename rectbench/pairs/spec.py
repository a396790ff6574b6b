"""Which pair is meant, as plain values that travel to other processes and into run.json."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field

AS_CALIBRATED = "as-calibrated"
"""The motion of photographs: the rig is what it is."""
NO_SCENE: Literal["none"] = "none"
"""The scene of a pair of lenses, for which nothing is rendered."""


class _Spec(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    scene: str
    """The scene, or what the photographs are called."""
    rig: str
    motion: str
    seed: int
    margin_deg: float | None = None
    """How near to its epipoles its view is trimmed; the usual margin where left out."""

    @property
    def demands(self) -> frozenset[str]:
        """What is to be made of it: `truth`, `images`, or nothing, as of photographs, which are there."""
        return frozenset()

    def demanding(self, demands: Collection[str]) -> Self:
        """The same pair with other demands."""
        return self


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
    max_angle_deg: float | None = None
    """The lenses' image circle, in the place of the rig's own."""

    @property
    def demands(self) -> frozenset[str]:
        return frozenset(name for name in ("truth", "images") if getattr(self, name))

    def demanding(self, demands: Collection[str]) -> Self:
        return self.model_copy(update={name: name in demands for name in ("truth", "images")})


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


class LensSpec(_Spec):
    """A rig and how its cameras stand, without a scene."""

    kind: Literal["lenses"] = "lenses"
    scene: Literal["none"] = NO_SCENE
    rig_source: str
    """The rig's name, or the absolute path of its file."""
    image_width: int | None
    max_angle_deg: float | None = None
    """The lenses' image circle, in the place of the rig's own."""


PairSpec = Annotated[RenderedSpec | PhotographedSpec | LensSpec, Field(discriminator="kind")]

ESTIMATED = "estimated"
"""The pose that is estimated from the images themselves."""
CALIBRATED = "calibrated"
"""The pose as a calibration states it, of which nobody knows how exact it is: that of photographs."""
