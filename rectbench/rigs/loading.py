"""`load_rig`: a calibration file of any kind that is read here, or a rig that ships with rectbench."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from rectbench.errors import InvalidInput, Unavailable, UnknownName
from rectbench.rigs.documents import checked_size, read_text
from rectbench.rigs.kalibr import read_kalibr
from rectbench.rigs.native import read_native
from rectbench.rigs.opencv import read_opencv
from rectbench.rigs.rig import Rig

RigSource = str | os.PathLike[str]


def load_rig(source: RigSource | Sequence[RigSource], size: tuple[int, int] | None = None) -> Rig:
    """The rig in a calibration file, recognised by its content, or the built-in rig of that name.

    Parameters
    ----------
    source : a path; or the name of a built-in rig (see `rig_names`; a file of that name is reached as
        `./name`); or several paths of OpenCV files that complete each other, such as
        `["intrinsics.yml", "extrinsics.yml"]`.
    size : (width, height) in pixels, for files that leave the image size out, as OpenCV's samples do.

    Formats: the project's own YAML (`rectbench.rigs.native`), Kalibr's camchain (`.kalibr`), OpenCV's
    YAML, XML and JSON (`.opencv`). Translations are taken to be metres.

    Raises UnknownName for a name that no rig has, and InvalidInput in one line that names file, key
    and what was expected for a file that holds no rig.
    """
    size = None if size is None else checked_size(size)
    if isinstance(source, str | os.PathLike):
        if isinstance(source, str) and _may_be_name(source):
            return _built_in(source)
        return _read([source], size)
    paths = list(source) if isinstance(source, Sequence) else []
    if not paths or not all(isinstance(path, str | os.PathLike) for path in paths):
        raise InvalidInput("a rig's files are an empty list or hold no paths; expected a list of paths")
    return _read(paths, size)


def rig_names() -> tuple[str, ...]:
    """The names of the rigs that ship with rectbench, sorted."""
    return tuple(sorted(_built_in_files()))


def _read(paths: list[RigSource], size: tuple[int, int] | None) -> Rig:
    documents = [(os.fspath(path), read_text(path)) for path in paths]
    kinds = {_kind(path, text) for path, text in documents}
    if kinds == {"opencv"}:
        return read_opencv(documents, size)
    path, text = documents[0]
    if len(documents) > 1:
        raise InvalidInput(
            f"{path}: is read together with {documents[1][0]}; expected OpenCV files where there are several"
        )
    return read_native(path, text, size) if kinds == {"native"} else read_kalibr(path, text, size)


def _kind(path: str, text: str) -> str:
    if re.search(r"^[\s{]*[\"']?rectbench_rig[\"']?\s*:", text, re.MULTILINE):
        return "native"
    if re.search(r"^[\s{]*[\"']?cam[0-9][\"']?\s*:", text, re.MULTILINE):
        return "kalibr"
    if text.lstrip().startswith(("%YAML", "<?xml", "<opencv_storage", "{")):
        return "opencv"
    raise InvalidInput(
        f"{path}: is no calibration known here; expected the key rectbench_rig, Kalibr's cam0, "
        "or OpenCV's %YAML:1.0, <?xml or { at the start"
    )


def _may_be_name(source: str) -> bool:
    """Whether a string names a built-in rig; a path has a folder or a suffix, or exists as a file."""
    if Path(source).name != source or Path(source).suffix:
        return False
    return source in _built_in_files() or not Path(source).exists()


def _built_in(name: str) -> Rig:
    files = _built_in_files()
    if name not in files:
        raise UnknownName("rig", name, files)
    return read_native(f"{name}.yaml", files[name].read_text(encoding="utf-8"))


def _built_in_files() -> dict[str, Traversable]:
    try:
        folder = resources.files("rectbench_scenes") / "rigs"
    except ModuleNotFoundError:
        raise Unavailable(
            "the built-in rigs are not installed; expected the package rectbench_scenes"
        ) from None
    return {Path(file.name).stem: file for file in folder.iterdir() if file.name.endswith(".yaml")}
