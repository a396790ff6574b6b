"""`Rig.save`: a rig as a calibration of any format that is written here, whole or not at all."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from rectbench.calibrations.contract import NotHeld, Writing
from rectbench.calibrations.reading import all_formats
from rectbench.errors import InvalidInput, UnknownName
from rectbench.rigs.rig import Rig

log = logging.getLogger("rectbench.calibrations")


def save_rig(rig: Rig, path: str | os.PathLike[str], format: str = "native") -> tuple[Path, ...]:
    """Write `rig` to `path`; what was there before stays until all of it is written.

    Parameters
    ----------
    rig : the rig.
    path : the file; for a format of several files (see `written_formats`) the folder that holds them,
        which is made where there is none. OpenCV's suffix, .yml, .xml or .json, says which language.
    format : a name of `written_formats`.

    Returns the files. `load_rig(path)` gives the rig back to rounding, exactly for `native`; a camera may
    then bear another name for the same lens, such as kannala-brandt for an equidistant one. What a
    format has no place for beside the lenses, `max_angle_deg` above all, is told in the log.

    Raises UnknownName for a format that is not written; InvalidInput in one line for a camera that the
    format cannot hold exactly, with the formats that can, and for a path that cannot be written.
    """
    writing, target = _writing(format), Path(path)
    texts = calibration_texts(rig, target.name, format)
    folder = target if writing.in_folder else target.parent
    if writing.in_folder:
        _make_folder(folder)
    files = {folder / name: text for name, text in texts.items()}
    replace_files(files)
    for loss in writing.losses(rig):
        log.warning("%s: %s %s", target, format, loss)
    return tuple(files)


def calibration_texts(rig: Rig, name: str, format: str) -> Mapping[str, str]:
    """The content of each file of a calibration by its name, as `save_rig` writes it to a path of that name.

    Raises UnknownName and InvalidInput as `save_rig` does.
    """
    try:
        return _writing(format).texts(rig, name)
    except NotHeld as reason:
        raise InvalidInput(f"{reason}; expected one of the formats that have: {_holders(rig)}") from None


def written_formats() -> dict[str, bool]:
    """The formats that `save_rig` writes: name, and whether it takes a folder."""
    return {name: writing.in_folder for name, writing in _writings()}


def _writings() -> Iterator[tuple[str, Writing]]:
    return ((format.name, format.write) for format in all_formats() if format.write is not None)


def _writing(format: str) -> Writing:
    writings = dict(_writings())
    if format not in writings:
        raise UnknownName("format that is written", str(format), writings)
    return writings[format]


def _holders(rig: Rig) -> str:
    """The formats that hold a rig."""
    names = []
    for name, writing in _writings():
        try:
            writing.texts(rig, "rig.yml")
        except NotHeld:
            continue
        names.append(name)
    return ", ".join(names)


def _make_folder(folder: Path) -> None:
    with _telling(folder):
        folder.mkdir(parents=True, exist_ok=True)


def replace_files(texts: Mapping[Path, str]) -> None:
    """Write text files, all of them or none; what was there before stays until all are written."""
    for path in texts:
        if path.is_dir() or not path.name:
            raise InvalidInput(f"{path}: is a folder; expected the path of a file")
    temporaries = {path: path.with_name(f".{path.name}.{os.getpid()}.tmp") for path in texts}
    try:
        for path, text in texts.items():
            with _telling(path), temporaries[path].open("w", encoding="utf-8", newline="\n") as stream:
                stream.write(text)
                stream.flush()
                os.fsync(stream.fileno())
        for path, temporary in temporaries.items():
            with _telling(path):
                temporary.replace(path)
    finally:
        for temporary in temporaries.values():
            temporary.unlink(missing_ok=True)


@contextmanager
def _telling(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InvalidInput(
            f"{path}: cannot be written ({error.strerror}); expected a path in a folder"
        ) from None
