"""What a calibration format is: how its files are told from others, what is read, and what is written."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np

from rectbench.calibrations.documents.documents import blaming, shown
from rectbench.calibrations.documents.sources import Source
from rectbench.cameras import Camera
from rectbench.cameras.equivalents import equal_cameras
from rectbench.cameras.lens import lens_named
from rectbench.errors import InvalidInput, UnknownName
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""Metres in what a file's translations may be in."""

LONGEST_BASELINE_M = 10.0
"""A longer baseline is rather one in millimetres; it is believed where the unit is stated."""

MAX_NAMES = 20
"""Of a file's cameras, as many are named in an error."""

POSE_FILE = (
    "a third file with the pose, `R_right_left: [[...], ...]` and `t_right_left: [x, y, z]`, or "
    "OpenCV's R and T"
)


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
class View:
    """A camera of a file, and how it stands in a frame that it shares with the other camera's file.

    X_shared = T_shared_camera X_camera, a 4x4 rigid transformation in the file's unit; None where
    the file does not tell. `where` is the file, and the key, for errors.
    """

    where: str
    camera: Camera
    T_shared_camera: FloatArray | None = field(default=None, repr=False)


class NotHeld(InvalidInput):
    """A format has no words for a camera; the message says which one, and what of it."""


def lost_angles(rig: Rig) -> list[str]:
    """What a format without a place for `max_angle_deg` leaves out of a rig, a line a camera."""
    return [
        f"leaves out the {side} camera's max_angle_deg = {camera.max_angle_deg:g}"
        for side, camera in (("left", rig.left), ("right", rig.right))
        if camera.max_angle_deg is not None
    ]


@dataclass(frozen=True)
class Writing:
    """How a format is written.

    `texts` gives the content of each file by its name, of a rig and the name that the user gave; it
    writes nothing, so that a rig is refused (NotHeld) before a file is touched. Where `in_folder`, the
    files stand in a folder of that name, which `load_rig` reads as one rig. `losses` gives, a line each,
    what of a rig that is not refused is not in the files, the lenses not being among it.
    """

    texts: Callable[[Rig, str], Mapping[str, str]]
    in_folder: bool = False
    losses: Callable[[Rig], list[str]] = lost_angles


@dataclass(frozen=True)
class RigFormat:
    """A format whose file, or set of files, holds both cameras and their pose.

    `recognises` must not raise; `read` gets every file that the user gave, the one recognised
    among them, and raises InvalidInput in one line that names file, key and expectation. Where
    `has_many`, a file may hold more than two cameras, and `read` heeds `Given.cameras`. `write` is
    None for a format that is only read.
    """

    name: str
    title: str
    recognises: Callable[[Source], bool]
    read: Callable[[Sequence[Source], Given], Rig]
    has_many: bool = False
    write: Writing | None = None


@dataclass(frozen=True)
class CameraFormat:
    """A format whose file holds one camera; two files, and a third for the pose if need be, make a rig."""

    name: str
    title: str
    recognises: Callable[[Source], bool]
    read: Callable[[Source, Given], View]
    write: Writing | None = None


def assembled(
    left: Camera,
    right: Camera,
    T_right_left: Any,
    given: Given,
    where: str,
    name: str,
    unit: str | None = None,
) -> Rig:
    """The rig of two cameras and the pose [4, 4] between them, in metres.

    `unit` is what the file itself says its translations are in, None where it leaves that open.
    Raises InvalidInput where caller and file disagree about the unit, where the pose is none, and
    where a baseline beyond `LONGEST_BASELINE_M` suggests millimetres that nobody has stated.
    """
    if None not in (unit, given.unit) and unit != given.unit:
        raise InvalidInput(f"{where}: is in {unit}; expected unit={given.unit!r} as given beside the file")
    stated = unit or given.unit
    T = np.asarray(T_right_left, dtype=np.float64)
    with blaming(where):
        rig = Rig(left, right, T[:3, :3], UNITS[stated or "m"] * T[:3, 3], name=name)
    if stated is None and rig.baseline_m > LONGEST_BASELINE_M:
        raise InvalidInput(
            f"{where}: the baseline is {rig.baseline_m:.6g} m; expected at most {LONGEST_BASELINE_M:g} m, "
            "or unit='mm' (or cm, in, ft, m) stating what the file's translations are in"
        )
    return rig


def rig_of_views(views: Sequence[View], given: Given, name: str, unit: str | None = None) -> Rig:
    """The rig of two cameras, left and right, that stand in one frame."""
    left, right = views
    where = f"{left.where} and {right.where}"
    if left.T_shared_camera is None or right.T_shared_camera is None:
        untold = left if left.T_shared_camera is None else right
        raise InvalidInput(f"{untold.where}: does not say where its camera stands; expected {POSE_FILE}")
    if np.array_equal(left.T_shared_camera[:3, 3], right.T_shared_camera[:3, 3]):
        raise InvalidInput(f"{where}: put both cameras at one place; expected two places, or {POSE_FILE}")
    with np.errstate(all="ignore"):  # what is not finite is said below
        T = inverse(right.T_shared_camera) @ left.T_shared_camera
    return assembled(left.camera, right.camera, T, given, where, name, unit)


def inverse(T: FloatArray) -> FloatArray:
    """The inverse [4, 4] of a rigid transformation."""
    R = T[:3, :3].T
    return rigid(R, -R @ T[:3, 3])


def rigid(R: Any, t: Any) -> FloatArray:
    """The transformation [4, 4] with X' = R X + t."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, t
    return T


def chosen(names: Sequence[str], given: Given, file: str) -> tuple[str, str]:
    """The left and the right of a file's cameras: those asked for, or else its first two."""
    for name in given.cameras or ():
        if name not in names:
            known = ", ".join(shown(name) for name in names[:MAX_NAMES])
            raise InvalidInput(f"{file}: has no camera {shown(name)}; expected two of {known}")
    if len(names) < 2:
        raise InvalidInput(f"{file}: holds {len(names)} cameras; expected two at least")
    return given.cameras or (names[0], names[1])


def single(sources: Sequence[Source]) -> Source:
    """The one file of a format that takes no more than one."""
    if len(sources) > 1:
        raise InvalidInput(f"{sources[0].path}: is read together with {sources[1].path}; expected one file")
    return sources[0]


def placed(view: View, T_shared_camera: FloatArray) -> View:
    """The same camera, standing there."""
    return replace(view, T_shared_camera=T_shared_camera)


Key = TypeVar("Key")
Layouts = Mapping[Key, tuple[str, Collection[str]]]
"""A format's names of camera models: the projection model of each, and the parameters it has places for."""


def layout_of(camera: Camera, layouts: Layouts[Key], format: str, side: str) -> tuple[Key, Camera]:
    """Which of a format's layouts holds the camera exactly, and the camera by that layout's model.

    The first of the camera's own model that will do is taken, else the first of a model under which it
    is the same camera (see `equal_cameras`). Raises NotHeld, naming the parameters that have no place.
    """
    for equal in equal_cameras(camera):
        for layout, (model, names) in layouts.items():
            if model == equal.model and not _left_out(equal, names):
                return layout, equal
    who = f"{format} has no place for the {side} camera, {camera.model}"
    places = [names for model, names in layouts.values() if model == camera.model]
    if places:
        fewest = min((_left_out(camera, names) for names in places), key=len)
        who += f" with {', '.join(f'{name} = {camera.params[name]:g}' for name in fewest)}"
    raise NotHeld(who)


def _left_out(camera: Camera, names: Collection[str]) -> list[str]:
    """The parameters that are none of these and not at their default."""
    defaults = lens_named(camera.model).defaults
    return [
        name
        for name, value in camera.params.items()
        if name not in names and value not in ((), defaults.get(name, 0.0))
    ]


def pose_matrix(rig: Rig) -> FloatArray:
    """T_right_left [4, 4], metres."""
    return rigid(rig.R_right_left, rig.t_right_left)
