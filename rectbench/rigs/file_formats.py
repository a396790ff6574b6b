"""What rigs know of the formats of calibration files: their names, and how a rig is written in each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from rectbench.errors import InvalidInput
from rectbench.registry.kind import Described, Kind
from rectbench.rigs.rig import Rig


class CannotHold(InvalidInput):
    """A format cannot represent a camera; the message names the camera, and what of it has no place."""


def lost_angles(rig: Rig) -> list[str]:
    """What a format without a place for `max_angle_deg` and `blind` leaves out of a rig, a line for each."""
    lost = []
    for side, camera in (("left", rig.left), ("right", rig.right)):
        if camera.max_angle_deg is not None:
            lost.append(f"leaves out the {side} camera's max_angle_deg = {camera.max_angle_deg:g}")
        if camera.blind is not None:
            cones = f"{camera.blind.within_deg:g} degrees about a line"
            lost.append(f"leaves out that the {side} camera is blind within {cones}")
    return lost


@dataclass(frozen=True)
class Writing:
    """How a format is written.

    `texts` gives the content of each file by its name, of a rig and the name that the user gave; it
    writes nothing, so that a rig is refused (CannotHold) before a file is touched. Where `in_folder`, the
    files stand in a folder of that name, which `load_rig` reads as one rig. `losses` gives, a line each,
    what of a rig that is not refused is not in the files, the lenses not being among it.
    """

    texts: Callable[[Rig, str], Mapping[str, str]]
    in_folder: bool = False
    losses: Callable[[Rig], list[str]] = lost_angles


@dataclass(frozen=True)
class FileFormat:
    """A format of calibration files; its subclasses in `rectbench.calibrations.contract` add how it is read.

    `write` is None for a format that is only read.
    """

    name: str
    title: str
    write: Writing | None = field(default=None, kw_only=True)

    @property
    def summary(self) -> str:
        """Its title, and whether rigs are written in it too."""
        if self.write is None:
            return self.title
        return f"{self.title}; read and written{', as a folder' if self.write.in_folder else ''}"


def _described(value: Any) -> Described[FileFormat] | None:
    return Described(value.name, value.summary, value) if isinstance(value, FileFormat) else None


FORMATS: Kind[FileFormat] = Kind(
    name="formats",
    singular="format",
    expected="a RigFormat or a CameraFormat of rectbench.calibrations.contract",
    packages=("rectbench.calibrations.formats",),
    described=_described,
    is_shared=True,
)
