"""Calibrations in a folder: whole files, files that complete each other, and what they leave open."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from rectbench.calibrations import CamerasNotChosen, holds_many, is_calibration, load_rig
from rectbench.errors import InvalidInput
from rectbench.images.reading import Grey, grey8, read_image
from rectbench.pairs.finding.image_circle import angle_of_mask_deg, angle_of_rim_deg
from rectbench.pairs.finding.manifest import Manifest
from rectbench.pairs.finding.names import FilePair, LeftOut, camera_numbers, paired_files
from rectbench.rigs import Rig

SUFFIXES = frozenset({".yaml", ".yml", ".xml", ".json", ".txt", ".bin", ".cameramodel", ".cfg", ".conf"})
TOLD_SUFFIXES = SUFFIXES - {".txt", ".bin"}
"""Those of files that look like a calibration; others are notes as often."""
RIM_IMAGES = 8
"""Pairs of a rig that the rim of its lenses is looked for in."""
UNSTATED_UNIT = "mm"
"""What a baseline is in that is too long for metres and has no unit; no number of a report depends on it."""


@dataclass(frozen=True)
class Calibration:
    """A rig's calibration files, and how they are read."""

    name: str
    files: tuple[Path, ...]
    home: Path
    """The folder whose images, and those below, it serves."""
    size: tuple[int, int] | None = None
    """That of the images, where the files do not tell it."""
    unit: str | None = None
    max_angle_deg: float | None = None
    """The lenses' image circle, where the files do not tell it."""
    cameras: tuple[str, str] | None = None
    """The left and the right one, by the file's names, where it holds more than two."""
    is_first_pair: bool = False
    """Whether these are the file's first two, since nobody said which."""
    remarks: tuple[str, ...] = field(default=(), compare=False)
    """What a reader of the report has to know about it."""

    def rig(self) -> Rig:
        """The rig in the files; raises InvalidInput where they hold none."""
        files = [str(file) for file in self.files]
        rig = load_rig(files, size=self.size, unit=self.unit, cameras=self.cameras)
        rig = replace(rig, name=self.name)
        return rig if self.max_angle_deg is None else rig.within(self.max_angle_deg)


def home_of(files: Sequence[Path]) -> Path:
    """The folder that holds all the files, in itself or below."""
    return Path(os.path.commonpath([file.parent for file in files]))


def stated_calibrations(manifest: Manifest, pairs: Sequence[FilePair]) -> list[Calibration]:
    """The calibrations that a manifest states; raises InvalidInput for files that hold none."""
    rigs = manifest.rigs.items()
    stated = (Calibration(name, home=home_of(rig.files), **dict(rig)) for name, rig in rigs)
    return [_completed(one, pairs) for one in stated]


def found_calibrations(
    root: Path, files: Iterable[Path], pairs: Sequence[FilePair], stated: Iterable[str] = ()
) -> tuple[list[Calibration], list[LeftOut]]:
    """The calibrations among the files, recognised by their content, and the files that are none.

    None is called as one that is `stated`.

    A file that holds a rig is one. Of files that do not, two whose names differ in the side are one rig,
    together with a file of their pose beside them; and what else is in one folder.
    """
    found, failed, left_out = list[Calibration](), dict[Path, str](), list[LeftOut]()
    for file in files:
        if file.suffix.lower() in SUFFIXES and is_calibration(file):
            try:
                found.append(_read([file], pairs))
            except InvalidInput as error:
                failed[file] = str(error)
        elif file.suffix.lower() in TOLD_SUFFIXES:
            left_out.append(LeftOut(file, "no calibration of a format known here"))
    for group in _groups(root, list(failed)):
        try:
            one = _read(group, pairs)
        except InvalidInput:
            continue  # each of its files has its own reason
        if failed.keys() >= set(one.files):
            found.append(one)
            for file in one.files:
                del failed[file]
    left_out += [LeftOut(file, reason) for file, reason in failed.items()]
    return _distinctly_named(root, found, stated), left_out


def _groups(root: Path, files: list[Path]) -> Iterator[list[Path]]:
    """Files that may be one rig together, the left camera's first."""
    sides = [[pair.left, pair.right] for pair in paired_files(files, root).pairs]
    alone = [file for file in files if not any(file in group for group in sides)]
    for group in sides:
        yield group
        yield [*group, *(file for file in alone if file.parent == home_of(group))]
    for home in dict.fromkeys(file.parent for file in alone):
        yield [file for file in alone if file.parent == home]


def _read(files: Sequence[Path], pairs: Sequence[FilePair]) -> Calibration:
    return _completed(Calibration("rig", tuple(files), home_of(files)), pairs)


def _completed(one: Calibration, pairs: Sequence[FilePair]) -> Calibration:
    """The calibration with what its files leave open: the images' size, the unit of a long baseline.

    Raises InvalidInput, with what is wrong with the files as they are, where that does not help.
    """
    try:
        one.rig()
    except CamerasNotChosen as error:
        left, right, *_ = error.names
        told = f"of its {len(error.names)} cameras the first two, {left} and {right}, are taken"
        first = replace(one, cameras=(left, right), is_first_pair=True, remarks=(told, *one.remarks))
        return _completed(first, pairs)
    except InvalidInput as error:
        size = next((_size(pair.left) for pair in pairs if pair.left.is_relative_to(one.home)), None)
        for guess in _guesses(one, size):
            try:
                guess.rig()
            except InvalidInput:
                continue
            return guess
        raise error from None
    return one


def _guesses(one: Calibration, size: tuple[int, int] | None) -> Iterator[Calibration]:
    bases = [one]
    if size is not None:
        told = f"its image size, which the file leaves out, is the images' {size[0]}x{size[1]}"
        bases.append(replace(one, size=size, remarks=(*one.remarks, told)))
        yield bases[1]
    if one.unit is None:
        told = f"its baseline, whose unit the file leaves open, is taken to be in {UNSTATED_UNIT}"
        for base in bases:
            yield replace(base, unit=UNSTATED_UNIT, remarks=(*base.remarks, told))


def _distinctly_named(root: Path, found: Sequence[Calibration], stated: Iterable[str]) -> list[Calibration]:
    """Each named after its folder; after its file, too, where the folder has several; at last by its path."""
    homes, taken = Counter(one.home for one in found), set(stated)
    short = [
        one.home.name if homes[one.home] == 1 else f"{one.home.name}-{one.files[0].stem}" for one in found
    ]
    named = []
    for one, brief in zip(found, short, strict=True):
        path = one.files[0].relative_to(root)
        full, whole = "-".join(path.with_suffix("").parts), "-".join(path.parts)
        free = (full, whole) if short.count(brief) > 1 else (brief, full, whole)
        name = next((name for name in free if name not in taken), f"{whole}-{len(taken)}")
        taken.add(name)
        named.append(replace(one, name=name))
    return named


def with_cameras_of(one: Calibration, pair: FilePair) -> Calibration | None:
    """The calibration with the cameras that took a pair, where its file holds more than two.

    Numbers in the images' names, such as image_02 and image_03, say which they are. None where the file has
    none of these numbers: its first two cameras are others.
    """
    numbers = camera_numbers(pair)
    is_stated = one.cameras is not None and not one.is_first_pair
    if numbers is None or is_stated or not holds_many(one.files[0]):
        return one
    left, right = numbers
    for spelled in ("cam{}", "{:02d}", "P{}"):
        names = spelled.format(left), spelled.format(right)
        name, remarks = f"{one.name}-{names[0]}-{names[1]}", one.remarks[one.is_first_pair :]
        chosen = replace(one, name=name, cameras=names, is_first_pair=False, remarks=remarks)
        try:
            chosen.rig()
        except InvalidInput:
            continue
        return chosen
    return None


def within_circle(one: Calibration, pairs: Sequence[FilePair], masks: Sequence[Path]) -> Calibration:
    """The calibration with the image circle that a mask of the images' size, or their black rim, shows.

    One that is stated stands. `pairs` are the calibration's own.
    """
    rig = one.rig()
    if rig.left.max_angle_deg is not None or rig.right.max_angle_deg is not None:
        return one
    for mask in masks:
        if mask.is_relative_to(one.home) and (shown := _fitting(mask, mask, rig)):
            ends = [angle_of_mask_deg(c, m) for c, m in zip((rig.left, rig.right), shown, strict=True)]
            if circle := _smaller(ends):
                return _within(one, circle, f"by {mask.name}")
    images = [shown for pair in pairs[:RIM_IMAGES] if (shown := _fitting(pair.left, pair.right, rig))]
    if images:
        sides = zip((rig.left, rig.right), zip(*images, strict=True), strict=True)
        if circle := _smaller([angle_of_rim_deg(camera, shown) for camera, shown in sides]):
            return _within(one, circle, "by the black rim of its images")
    return one


def _smaller(ends: Sequence[float | None]) -> float | None:
    """The smaller of two angles, if both lenses have one."""
    known = [end for end in ends if end is not None]
    return min(known) if len(known) == len(ends) else None


def _within(one: Calibration, angle_deg: float, evidence: str) -> Calibration:
    told = f"its lenses are taken to show nothing beyond {angle_deg:.0f}° from their axes, {evidence}"
    return replace(one, max_angle_deg=angle_deg, remarks=(*one.remarks, told))


def _fitting(left: Path, right: Path, rig: Rig) -> tuple[Grey, Grey] | None:
    """Both images, if they can be read and have their cameras' sizes."""
    images = _grey(left), _grey(right)
    if images[0] is None or images[1] is None:
        return None
    fits = (images[0].shape[::-1], images[1].shape[::-1]) == (rig.left.size, rig.right.size)
    return (images[0], images[1]) if fits else None


def _size(image: Path) -> tuple[int, int] | None:
    pixels = _grey(image)
    return None if pixels is None else (pixels.shape[1], pixels.shape[0])


def _grey(path: Path) -> Grey | None:
    try:
        return grey8(read_image(path))
    except InvalidInput:
        return None
