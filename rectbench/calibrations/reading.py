"""`load_rig`: a calibration of any format that is read here, or a rig that ships with rectbench."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rectbench.calibrations import pose_file
from rectbench.calibrations.assembling import assembled, rig_of_posed
from rectbench.calibrations.built_in_rigs import built_in_rig, may_be_rig_name
from rectbench.calibrations.checks.plausibility import tell_implausible
from rectbench.calibrations.checks.unknown import unknown_format
from rectbench.calibrations.checks.unread import tell_unread
from rectbench.calibrations.contract import CameraFormat, Given, RigFormat
from rectbench.calibrations.documents import Source, checked_size, one_line, shown, tell, telling
from rectbench.calibrations.documents.sources import is_folder, sources_in
from rectbench.calibrations.recognising import camera_format, formats, is_known
from rectbench.errors import InvalidInput, argument
from rectbench.rigs.rig import Rig

RigSource = str | os.PathLike[str]


def load_rig(
    source: RigSource | Sequence[RigSource],
    size: tuple[int, int] | None = None,
    unit: str | None = None,
    cameras: Sequence[str] | None = None,
) -> Rig:
    """The rig in calibration files, recognised by their content, or the built-in rig of that name.

    Parameters
    ----------
    source : a path; or the name of a built-in rig (see `rig_names`; a file of that name is reached as
        `./name`); or a folder that holds one rig's files; or several paths: files that complete each
        other, such as `["intrinsics.yml", "extrinsics.yml"]`, or the left camera's, the right camera's
        and, where these do not tell how they stand, a third with `R_right_left` and `t_right_left`
        (or OpenCV's R and T).
    size : (width, height) in pixels, for files that leave the image size out, as OpenCV's samples do.
    unit : what translations are in, "m", "cm", "mm", "in" or "ft", for files that do not tell; metres
        where left out, and then a baseline beyond 10 m is an error.
    cameras : names of the left and the right camera in a file with more than two: `["cam0", "cam3"]` of a
        Kalibr chain or a Basalt calibration, two images of a COLMAP model. A file with more than two is asked
        about where they are left out, but for KITTI's, COLMAP's and OAK's, which have a first pair.

    Formats: see `calibration_formats`; each has a module in `rectbench.calibrations.formats` that says what
    it reads. The first camera of a file, or of a list, is the left one; cameras are never swapped, and a
    right camera on the left is logged as a warning. So are, in one line each, what looks like part of a lens
    or a pose and was not read, what was assumed where a file leaves it open, statements that contradict each
    other, and what is improbable.

    Raises UnknownName for a name that no rig has, and InvalidInput in one line that names file, key
    and what was expected for files that hold no rig.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> rig.name, rig.left.model, rig.left.size
    ('t265', 'kannala-brandt', (848, 800))
    """
    given = Given(None if size is None else checked_size(size), unit, _checked_cameras(cameras))
    if isinstance(source, list | tuple) and len(source) == 1:
        (source,) = source
    if isinstance(source, str) and may_be_rig_name(source):
        return built_in_rig(source)
    paths = [source] if isinstance(source, str | os.PathLike) else []
    paths = list(source) if not paths and isinstance(source, Sequence) else paths
    if not paths or not all(isinstance(path, str | os.PathLike) for path in paths):
        raise InvalidInput("a rig's files are an empty list or hold no paths; expected a list of paths")
    with telling():
        return _checked_order(_read(paths, given))


def load_rig_of_images(
    source: RigSource | Sequence[RigSource],
    size: tuple[int, int],
    unit: str | None = None,
    cameras: Sequence[str] | None = None,
) -> Rig:
    """`load_rig`, with the images' size for files that leave it out, and for these alone.

    The two cameras of other files may differ in size; whether an image fits is looked at image by image.
    """
    try:
        return load_rig(source, unit=unit, cameras=cameras)
    except InvalidInput as reason:
        try:
            return load_rig(source, size=size, unit=unit, cameras=cameras)
        except InvalidInput as error:
            raise (error if f"`{argument('size')}`" in str(reason) else reason) from None


def _read(paths: list[RigSource], given: Given) -> Rig:
    if len(paths) > 1 or not is_folder(paths[0]):
        return _read_sources([Source.read(path) for path in paths], given)
    folder = Path(paths[0])
    sources = [source for source in sources_in(folder) if is_known(source)]
    if not sources:
        raise InvalidInput(
            f"{folder}: holds no calibration known here; expected one of those that `rectbench list formats` "
            "names"
        )
    rig = _read_sources(sources, given)
    return replace(rig, name=one_line(folder.resolve().name) or rig.name)


def _read_sources(sources: list[Source], given: Given) -> Rig:
    for format in formats():
        if any(format.recognises(source) for source in sources):
            for source in sources:
                source.forget()
            rig = _read_by(format, sources, given)
            tell_unread(sources, rig)
            tell_implausible(rig)
            return rig
    raise unknown_format(sources, formats(), given)


def _read_by(format: RigFormat | CameraFormat, sources: list[Source], given: Given) -> Rig:
    if isinstance(format, CameraFormat):
        return _read_cameras(sources, given)
    _check_choice(sources[0], format, given)
    return format.read(sources, given)


def _checked_order(rig: Rig) -> Rig:
    """The rig as it is, with a warning in the log where its right camera stands on the left."""
    if rig.is_right_first:
        tell(
            f"{rig.name}: the right camera stands {-rig.centre_right_in_left[0]:.3g} m to the left of the "
            "left one; kept as the calibration has it, to be named in the other order if that is not meant"
        )
    return rig


def _checked_cameras(cameras: Sequence[str] | None) -> tuple[str, str] | None:
    if cameras is None:
        return None
    names = [] if isinstance(cameras, str) else list(cameras)
    if len(names) != 2 or not all(isinstance(name, str) for name in names):
        raise InvalidInput(
            f"{argument('cameras')} is {shown(cameras)}; expected two names, the left and the right camera's"
        )
    return names[0], names[1]


def _check_choice(source: Source, format: RigFormat, given: Given) -> None:
    if given.cameras and not format.has_many:
        raise InvalidInput(
            f"{source.path}: is {format.name}, of two cameras; expected no `{argument('cameras')}` "
            f"{shown(given.cameras)}"
        )


def _read_cameras(sources: list[Source], given: Given) -> Rig:
    """The rig of two files of a camera each and, perhaps, a third with their pose."""
    posed = [format.read(source, given) for source in sources if (format := camera_format(source))]
    others = [source for source in sources if not camera_format(source)]
    if len(posed) != 2:
        _ = [other.document for other in others]  # what is damaged says so itself
        files = "a file" if len(posed) == 1 else f"one of {len(posed)} files"
        raise InvalidInput(
            f"{posed[0].where}: is {files} with one camera; expected two of them, left and right"
        )
    if len(others) > 1 or not all(pose_file.recognises(other) for other in others):
        raise InvalidInput(
            f"{others[0].path}: is no pose; expected one file with R_right_left and t_right_left, or with "
            "OpenCV's R and T, beside the files of two cameras"
        )
    left, right = posed
    name = sources[0].name
    if not others:
        return rig_of_posed(posed, given, name)
    T_right_left = pose_file.read(others[0])
    return assembled(left.camera, right.camera, T_right_left, given, others[0].path, name)
