"""Which image of the left camera belongs to which of the right: by their names, never by a guess."""

from __future__ import annotations

import logging
import re
from collections.abc import Sequence
from dataclasses import dataclass
from glob import glob, has_magic
from pathlib import Path

from rectbench.errors import InvalidInput

SUFFIXES = {".bmp", ".hdr", ".jp2", ".jpe", ".jpeg", ".jpg", ".pbm", ".pfm", ".pgm", ".png", ".pnm", ".ppm"}
SUFFIXES |= {".tif", ".tiff", ".webp"}
"""Files of a folder that are taken for images; a file that is named is one whatever it is called."""

_SIDE = re.compile(
    r"(?:^|(?<=[\W_\d]))(?:left|right|cam(?:era)?[ _-]?[01]|image[ _-]?0?[0-3]|[lr](?=$|[\W_\d]))",
    re.IGNORECASE,
)
"""What says in a name which camera took the image."""

log = logging.getLogger("rectbench")


@dataclass(frozen=True)
class ImagePair:
    """The two image files of a pair, and what it is called."""

    name: str
    left: Path
    right: Path


def image_pairs(left: str, right: str) -> list[ImagePair]:
    """The pairs of two files, two folders or two patterns such as `left/*.png`, by name.

    Two files are a pair. Of several, two are one if their names are equal, or equal but for the words that
    say which camera took them: left and right, l and r, cam0 and cam1, image_02 and image_03. Where no two
    names correspond and there are as many left as right, they are paired in the order of their names, and
    the log says so. Raises InvalidInput where a file has no partner, naming it.
    """
    files = _files(left, "left"), _files(right, "right")
    if len(files[0]) == len(files[1]) == 1:
        return [_pair(files[0][0], files[1][0])]
    keys = [_by_key(paths) for paths in files]
    common = keys[0].keys() & keys[1].keys()
    if not common and len(files[0]) == len(files[1]):
        log.warning("no names of %s and %s correspond; the images are paired in their order", left, right)
        return [_pair(*both) for both in zip(*files, strict=True)]
    lonely = [paths[key] for paths in keys for key in sorted(paths.keys() - common)]
    if lonely:
        more = f", nor have {len(lonely) - 1} more files" if len(lonely) > 1 else ""
        raise InvalidInput(f"{lonely[0]}: has no partner of that name on the other side{more}")
    return [_pair(path, keys[1][key]) for key, path in keys[0].items()]


def _pair(left: Path, right: Path) -> ImagePair:
    return ImagePair(_without_side(left) or left.stem, left, right)


def _files(place: str, side: str) -> list[Path]:
    path = Path(place)
    if path.is_dir():
        files = sorted(file for file in path.iterdir() if file.suffix.lower() in SUFFIXES)
    elif path.exists() or not has_magic(place):
        return [path]
    else:
        found = map(Path, glob(place, recursive=True))  # noqa: PTH207  a pattern may be absolute
        files = sorted(file for file in found if file.is_file())
    if not files:
        raise InvalidInput(
            f"{place}: holds no {side} image; expected a file, a folder of images or a pattern"
        )
    return files


def _without_side(path: Path) -> str:
    return re.sub(r"[\W_]+", "_", _SIDE.sub("", path.stem)).strip("_")


def _by_key(paths: Sequence[Path]) -> dict[str, Path]:
    """The paths by their names without the words for a side."""
    keyed: dict[str, Path] = {}
    for path in paths:
        key = _without_side(path).lower()
        other = keyed.setdefault(key, path)
        if other is not path:
            raise InvalidInput(f"{path}: cannot be told from {other.name} by its name; expected one a pair")
    return keyed
