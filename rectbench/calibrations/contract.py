"""What a calibration format is: how its files are recognised, and what is read from them.

What looks like part of a lens or a pose in a `Source`'s document, table or `section`, and was not asked for
while the file was read, is told by the framework (`rectbench.calibrations.checks.unread`). A reader says of
keys that it need not read, such as what follows from the others, that it knows them (`Section.knows`); of
what it assumes, that it does (`documents.tell`).

How one is written is in `rectbench.rigs.file_formats`. A format is one object of these classes in a file of
its own below `rectbench.calibrations.formats`, or in a package's module that is announced as an entry point
of the group `rectbench.formats`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from rectbench.calibrations.documents import Source
from rectbench.cameras import Camera
from rectbench.errors import UnknownName
from rectbench.rigs.file_formats import FileFormat
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""Metres in what a file's translations may be in."""


@dataclass(frozen=True)
class Given:
    """What the caller states beside the files.

    size : (width, height) in pixels, for files that leave the image size out.
    unit : what translations are in, a key of `UNITS`, for files that do not tell.
    cameras : the left and the right camera of a file with more than two, by the file's names.
    """

    size: tuple[int, int] | None = None
    unit: str | None = None
    cameras: tuple[str, str] | None = None

    def __post_init__(self) -> None:
        if self.unit is not None and self.unit not in UNITS:
            raise UnknownName("unit", str(self.unit), UNITS)


@dataclass(frozen=True)
class PosedCamera:
    """A camera of a file, and how it stands in a frame that it shares with the other camera's file.

    X_shared = T_shared_camera X_camera, a 4x4 rigid transformation in the file's unit; None where
    the file does not tell. `where` is the file, and the key, for errors. Where the file tells it by a
    rectification, `projection` is the 3x4 matrix P of that, which may have to be looked at together with the
    other camera's.
    """

    where: str
    camera: Camera
    T_shared_camera: FloatArray | None = field(default=None, repr=False)
    projection: FloatArray | None = field(default=None, repr=False)


@dataclass(frozen=True)
class RigFormat(FileFormat):
    """A format whose file, or set of files, holds both cameras and their pose.

    `recognises` must not raise; `read` gets every file that the user gave, the one recognised among them,
    and raises InvalidInput in one line that names file, key and expectation. Where `has_many`, a file may
    hold more than two cameras, and `read` uses `Given.cameras`. Where `shares_keys`, its files have no mark
    of their own, so that it is asked when no other format knows a file.
    """

    recognises: Callable[[Source], bool]
    read: Callable[[Sequence[Source], Given], Rig]
    has_many: bool = False
    shares_keys: bool = False


@dataclass(frozen=True)
class CameraFormat(FileFormat):
    """A format whose file holds one camera; two files, and a third for the pose if need be, make a rig.

    It is asked after those of whole rigs, whose sets of files may have files of cameras among them.
    """

    recognises: Callable[[Source], bool]
    read: Callable[[Source, Given], PosedCamera]
