"""The pairs of images that a command names: two files, two folders, or two patterns."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from glob import glob, has_magic
from pathlib import Path

from rectbench.errors import InvalidInput
from rectbench.images.reading import IMAGE_SUFFIXES
from rectbench.pairs.finding.names import FilePair, Pairing, home_of, is_mask, paired_folders


def image_pairs(left: str, right: str) -> Pairing:
    """The pairs of two files, two folders or two patterns such as `left/*.png`.

    Two files are a pair. Of several, those are whose names differ in a word for the side at the most, see
    `paired_folders`; what has no partner is left out, with the reason. No two pairs have one name. Raises
    InvalidInput where there is no pair at all.
    """
    lefts, rights = _files(left, "left"), _files(right, "right")
    if not (_is_many(left) or _is_many(right)):
        return Pairing((FilePair(lefts[0].stem, lefts[0], rights[0]),), ())
    pairing = paired_folders(home_of(lefts), home_of(rights), lefts, rights)
    if not pairing.pairs:
        first = pairing.left_out[0]
        raise InvalidInput(
            f"no images of {left} and {right} are pairs by their names: {first.path}: {first.reason}"
        )
    return replace(pairing, pairs=_distinctly_named(pairing.pairs))


def masks_beside(pairs: Sequence[FilePair], calibration: Iterable[Path]) -> list[Path]:
    """The mask images in the folders of the pairs' images and of the calibration's files."""
    folders = {file.resolve().parent for pair in pairs for file in pair.files}
    for place in map(Path.resolve, calibration):
        if place.exists():  # a built-in rig's name is no place
            folders.add(place if place.is_dir() else place.parent)
    files = (file for folder in folders if folder.is_dir() for file in folder.iterdir())
    return sorted(file for file in files if file.suffix.lower() in IMAGE_SUFFIXES and is_mask(file))


def _is_many(place: str) -> bool:
    return Path(place).is_dir() or (has_magic(place) and not Path(place).exists())


def _files(place: str, side: str) -> list[Path]:
    if not _is_many(place):
        return [Path(place)]
    if Path(place).is_dir():
        files = [file for file in Path(place).iterdir() if file.suffix.lower() in IMAGE_SUFFIXES]
    else:
        found = map(Path, glob(place, recursive=True))  # noqa: PTH207  a pattern may be absolute
        files = [file for file in found if file.is_file()]
    files = [file for file in files if not is_mask(file)]
    if not files:
        raise InvalidInput(
            f"{place}: holds no {side} image; expected a file, a folder of images or a pattern"
        )
    return sorted(files)


def _distinctly_named(pairs: Sequence[FilePair]) -> tuple[FilePair, ...]:
    """The pairs by what their files' names share; else by the left file's name; else numbered."""
    count = Counter(pair.name for pair in pairs)
    named = [replace(p, name=p.name if p.name and count[p.name] == 1 else p.left.stem) for p in pairs]
    again = Counter(pair.name for pair in named)
    if max(again.values()) > 1:
        named = [replace(pair, name=f"{number:06d}") for number, pair in enumerate(named)]
    return tuple(named)
