"""Pairs of photographs and calibrations in a folder: what belongs to what, and what is left out and why."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2

from rectbench.calibrations import telling
from rectbench.errors import InvalidInput
from rectbench.images.reading import IMAGE_SUFFIXES
from rectbench.pairs.finding.calibrations import (
    Calibration,
    found_calibrations,
    home_of,
    stated_calibrations,
    with_cameras_of,
    within_circle,
)
from rectbench.pairs.finding.manifest import MANIFEST, read_manifest
from rectbench.pairs.finding.names import FilePair, LeftOut, paired_files, words_in

NO_PHOTOGRAPHS = frozenset(
    {"disp", "disparity", "depth", "flow", "seg", "semantic", "label", "labels", "nocc", "occ"}
)
"""Words in the names of what data sets have beside photographs."""
MASK = "mask"
UNREADABLE = "not an image that OpenCV can read"


@dataclass(frozen=True)
class PhotoPair(FilePair):
    """Two photographs of one moment, and the calibration they belong to."""

    calibration: Calibration


@dataclass(frozen=True)
class Photographs:
    """What a folder holds."""

    folder: Path
    pairs: tuple[PhotoPair, ...]
    left_out: tuple[LeftOut, ...]

    @property
    def calibrations(self) -> tuple[Calibration, ...]:
        """The calibrations of the pairs, each once."""
        return tuple(dict.fromkeys(pair.calibration for pair in self.pairs))

    def below(self, path: Path) -> str:
        """A path as it is seen from the folder."""
        return path.relative_to(self.folder).as_posix() if path.is_relative_to(self.folder) else str(path)


@telling()
def find_photographs(folder: str | Path) -> Photographs:
    """The pairs in a folder and all below it, each with the calibration nearest above it.

    A manifest, see `manifest`, may state what cannot be found. A pair below several calibrations of
    one folder is there once for each. Raises InvalidInput where there is no pair with a calibration, with
    the first reasons, and for a manifest that cannot be used.
    """
    root = Path(folder)
    if not root.is_dir():
        raise InvalidInput(f"{root}: no such folder; expected one with pairs of images and their calibration")
    root = root.resolve()
    manifest = read_manifest(root)
    stated = {FilePair(p.name or p.left.stem, p.left, p.right): p.rig for p in manifest.pairs}
    named_files = manifest.files | {root / MANIFEST}
    files = [file for file in _files_in(root) if file not in named_files]
    images, masks, no_images = _images(files)
    pairing = paired_files(images, root)
    pairs = [*stated, *pairing.pairs]
    named = stated_calibrations(manifest, pairs)
    found, no_calibrations = found_calibrations(root, files, pairs, [one.name for one in named])

    served = {one: list[FilePair]() for one in (*named, *found)}
    unpaired = list[LeftOut]()
    for pair in pairs:
        near = _calibrations_of(pair, stated.get(pair), root, [*named, *found])
        own = [chosen for one in near if (chosen := with_cameras_of(one, pair))]
        for one in own:
            served.setdefault(one, []).append(pair)
        if not own:
            reason = "no calibration is beside or above it"
            if near:
                reason = f"{near[0].files[0].name} has many cameras, and which took it is not told"
            unpaired += [LeftOut(pair.left, reason), LeftOut(pair.right, reason)]
    used = {file for one, its in served.items() if its for file in one.files}
    unused = [one.files[0] for one in (*named, *found) if used.isdisjoint(one.files)]
    unpaired += [LeftOut(file, "no pair of images is beside or below it") for file in unused]
    left_out = [*no_images, *pairing.left_out, *no_calibrations, *unpaired]
    left_out += [LeftOut(mask, "a mask, no photograph") for mask in masks]
    photographs = Photographs(
        root,
        tuple(_distinctly_named(root, [*_photo_pairs(served, pairs, masks)])),
        tuple(sorted(left_out, key=lambda out: out.path)),
    )
    if not photographs.pairs:
        told = [f"{photographs.below(out.path)}: {out.reason}" for out in photographs.left_out]
        reasons = "; ".join(told[:3]) or "it is empty"
        raise InvalidInput(f"{root}: holds no pair of images with a calibration ({reasons})")
    return photographs


def _files_in(root: Path) -> Iterator[Path]:
    """All files but hidden ones, by name."""
    for place, folders, files in os.walk(root):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        yield from (Path(place) / name for name in sorted(files) if not name.startswith("."))


def _images(files: Iterable[Path]) -> tuple[list[Path], list[Path], list[LeftOut]]:
    """The photographs and the masks among the files, and the images that are neither."""
    images, masks, left_out = list[Path](), list[Path](), list[LeftOut]()
    for file in files:
        if file.suffix.lower() not in IMAGE_SUFFIXES:
            continue
        words = set(words_in(file.stem))
        if not cv2.haveImageReader(str(file)):
            left_out.append(LeftOut(file, UNREADABLE))
        elif MASK in words:
            masks.append(file)
        elif kind := words & NO_PHOTOGRAPHS:
            left_out.append(LeftOut(file, f"no photograph, by the word '{min(kind)}' in its name"))
        else:
            images.append(file)
    return images, masks, left_out


def _calibrations_of(
    pair: FilePair, name: str | None, root: Path, calibrations: Sequence[Calibration]
) -> list[Calibration]:
    """The calibration of this name; without a name those of the nearest folder that has any."""
    if name is not None:
        return [one for one in calibrations if one.name == name][:1]
    place = home_of(pair.files)
    while place.is_relative_to(root):
        if near := [one for one in calibrations if one.home == place]:
            return near
        place = place.parent
    return []


def _photo_pairs(
    served: dict[Calibration, list[FilePair]], pairs: Sequence[FilePair], masks: Sequence[Path]
) -> Iterator[PhotoPair]:
    """The pairs in their order, once for each of their calibrations, these with their image circles."""
    circled = {one: within_circle(one, its, masks) for one, its in served.items() if its}
    members = {one: set(its) for one, its in served.items()}
    for pair in pairs:
        for one, its in members.items():
            if pair in its:
                name = pair.name or home_of(pair.files).name
                yield PhotoPair(name, pair.left, pair.right, circled[one])


def _distinctly_named(root: Path, pairs: list[PhotoPair]) -> Iterator[PhotoPair]:
    """The pairs; those that share name and rig are named after their folders, too, and at last by number."""
    counts = Counter((pair.name, pair.calibration.name) for pair in pairs)
    used = Counter[tuple[str, str]]()
    for pair in pairs:
        name, rig = pair.name, pair.calibration.name
        if counts[name, rig] > 1:
            home = home_of(pair.files)
            name = "-".join([*(home.relative_to(root).parts if home.is_relative_to(root) else ()), name])
        used[name, rig] += 1
        yield replace(pair, name=name if used[name, rig] == 1 else f"{name}-{used[name, rig]}")
