"""`Rig.save`: a rig as a calibration of any format that is written, whole or not at all."""

from __future__ import annotations

import logging
import os
from collections.abc import Mapping
from pathlib import Path

from rectbench.errors import InvalidInput, UnknownName
from rectbench.registry import registry
from rectbench.rigs.file_formats import FORMATS, CannotHold, Writing
from rectbench.rigs.rig import Rig
from rectbench.writing import make_folder, replace_files

log = logging.getLogger("rectbench.rigs")


def save_rig(rig: Rig, path: str | os.PathLike[str], format: str) -> tuple[Path, ...]:
    """Write `rig` to `path`, see `Rig.save`; what was there before stays until all of it is written."""
    writing, target = _writing(format), Path(path)
    texts = calibration_texts(rig, target.name, format)
    folder = target if writing.in_folder else target.parent
    if writing.in_folder:
        make_folder(folder, InvalidInput)
    files = {folder / name: text for name, text in texts.items()}
    replace_files(files, InvalidInput)
    for loss in writing.losses(rig):
        log.warning("%s: %s %s", target, format, loss)
    return tuple(files)


def calibration_texts(rig: Rig, name: str, format: str) -> Mapping[str, str]:
    """The content of each file of a calibration by its name, as `Rig.save` writes it to a path of that name.

    Raises UnknownName and InvalidInput as `Rig.save` does.
    """
    try:
        return _writing(format).texts(rig, name)
    except CannotHold as reason:
        raise InvalidInput(f"{reason}; expected one of the formats that have: {_holders(rig)}") from None


def written_formats() -> dict[str, bool]:
    """The formats that rigs are written in: name, and whether it takes a folder."""
    return {name: writing.in_folder for name, writing in _writings().items()}


def _writings() -> dict[str, Writing]:
    formats = (plugin.value for plugin in registry(FORMATS).plugins())
    return {format.name: format.write for format in formats if format.write is not None}


def _writing(format: str) -> Writing:
    writings = _writings()
    if format not in writings:
        raise UnknownName("format that is written", str(format), writings)
    return writings[format]


def _holders(rig: Rig) -> str:
    """The formats that hold a rig, the default one first."""
    names = []
    for name, writing in _writings().items():
        try:
            writing.texts(rig, "rig.yml")
        except CannotHold:
            continue
        names.append(name)
    return ", ".join(sorted(names, key=lambda name: name != "native"))


Rig.writer = save_rig
