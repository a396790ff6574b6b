"""Pairs of photographs and calibrations in a folder: what belongs to what, and what is left out and why."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import cv2

from rectbench.bench.data_manifest import MANIFEST, Manifest, StatedRig, read_manifest
from rectbench.bench.image_circle import angle_of_mask_deg, angle_of_rim_deg
from rectbench.bench.pairing import FilePair, LeftOut, paired_files, words_in
from rectbench.errors import InvalidInput
from rectbench.matching.images import Grey, grey8, read_image
from rectbench.rigs import Rig, is_calibration, load_rig

IMAGE_SUFFIXES = frozenset(
    {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm", ".ppm", ".pnm", ".webp", ".jp2", ".exr"}
)
CALIBRATION_SUFFIXES = frozenset(
    {".yaml", ".yml", ".xml", ".json", ".txt", ".bin", ".cameramodel", ".cfg", ".conf"}
)
TOLD_SUFFIXES = CALIBRATION_SUFFIXES - {".txt", ".bin"}
"""Of files that look like a calibration: others are notes as often."""
NO_PHOTOGRAPHS = frozenset(
    {"disp", "disparity", "depth", "flow", "seg", "semantic", "label", "labels", "nocc", "occ"}
)
"""Words in the names of what data sets have beside photographs."""
MASK = "mask"
RIM_IMAGES = 8
"""Pairs of a rig that the rim of its lenses is looked for in."""
UNSTATED_UNIT = "mm"
"""What a baseline is in that is too long for metres and has no unit: no number of the report hangs on it."""


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
    remarks: tuple[str, ...] = field(default=(), compare=False)
    """What a reader of the report has to know about it."""

    def rig(self) -> Rig:
        """The rig in the files; raises InvalidInput where they hold none."""
        rig = load_rig([str(file) for file in self.files], size=self.size, unit=self.unit)
        rig = replace(rig, name=self.name)
        return rig if self.max_angle_deg is None else rig.within(self.max_angle_deg)


@dataclass(frozen=True)
class PhotoPair:
    """Two photographs of one moment, and the calibration they belong to."""

    name: str
    left: Path
    right: Path
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


def find_photographs(folder: str | Path) -> Photographs:
    """The pairs in a folder and all below it, each with the calibration nearest above it.

    A manifest, see `data_manifest`, may state what cannot be found. A pair below several calibrations of
    one folder is there once for each. Raises InvalidInput where there is no pair with a calibration, with
    the first reasons, and for a manifest that cannot be used.
    """
    root = Path(folder)
    if not root.is_dir():
        raise InvalidInput(f"{root}: no such folder; expected one with pairs of images and their calibration")
    root = root.resolve()
    manifest, left_out = read_manifest(root), list[LeftOut]()
    files = [file for file in _files_in(root) if file.name != MANIFEST]
    images, masks = _images(files, left_out)
    named, pairs = _pairs(root, images, manifest, left_out)
    calibrations = list(_calibrations(root, files, pairs, manifest, left_out))
    served = _served(root, pairs, named, calibrations, left_out)
    lens = {
        one: _with_circle(one, [p for p in served if p.calibration == one], masks) for one in calibrations
    }
    used = {pair.calibration for pair in served}
    left_out += [
        LeftOut(one.files[0], "no pair of images is beside or below it") for one in lens if one not in used
    ]
    left_out += [LeftOut(mask, "a mask, no photograph") for mask in masks]
    if not served:
        reasons = "; ".join(f"{_below(root, out.path)}: {out.reason}" for out in left_out[:3])
        raise InvalidInput(f"{root}: holds no pair of images with a calibration ({reasons or 'it is empty'})")
    found = tuple(replace(pair, calibration=lens[pair.calibration]) for pair in served)
    return Photographs(root, found, tuple(sorted(left_out, key=lambda out: out.path)))


def _files_in(root: Path) -> Iterator[Path]:
    for place, folders, files in os.walk(root):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        yield from (Path(place) / name for name in sorted(files) if not name.startswith("."))


def _images(files: Iterable[Path], left_out: list[LeftOut]) -> tuple[list[Path], list[Path]]:
    """The photographs and the masks among the files."""
    images, masks = [], []
    for file in files:
        if file.suffix.lower() not in IMAGE_SUFFIXES:
            continue
        words = set(words_in(file.stem))
        if not cv2.haveImageReader(str(file)):
            left_out.append(LeftOut(file, "not an image that OpenCV can read"))
        elif MASK in words:
            masks.append(file)
        elif kind := words & NO_PHOTOGRAPHS:
            left_out.append(LeftOut(file, f"no photograph, by the word '{min(kind)}' in its name"))
        else:
            images.append(file)
    return images, masks


def _pairs(
    root: Path, images: list[Path], manifest: Manifest, left_out: list[LeftOut]
) -> tuple[dict[FilePair, str], list[FilePair]]:
    """All pairs, and the rigs of those whose rig is stated."""
    stated = {
        FilePair(
            pair.name or Path(pair.left).stem, (root / pair.left).resolve(), (root / pair.right).resolve()
        ): pair.rig
        for pair in manifest.pairs
    }
    taken = {file for pair in stated for file in (pair.left, pair.right)}
    pairing = paired_files([file for file in images if file not in taken], root)
    left_out += pairing.left_out
    return {pair: rig for pair, rig in stated.items() if rig is not None}, [*stated, *pairing.pairs]


def _calibrations(
    root: Path, files: list[Path], pairs: Sequence[FilePair], manifest: Manifest, left_out: list[LeftOut]
) -> Iterator[Calibration]:
    """The calibrations by their content: whole files, then files that complete each other."""
    stated = {(root / file).resolve() for rig in manifest.rigs.values() for file in rig.files}
    for name, rig in manifest.rigs.items():
        yield _stated(root, name, rig, pairs)
    may_be = [f for f in files if f.suffix.lower() in CALIBRATION_SUFFIXES and f not in stated]
    known = [file for file in may_be if is_calibration(file)]
    left_out += [
        LeftOut(file, "no calibration of a format known here")
        for file in may_be
        if file not in known and file.suffix.lower() in TOLD_SUFFIXES
    ]
    found, parts = list[Calibration](), list[LeftOut]()
    for file in known:
        _take([file], pairs, found, parts)
    rest = [part.path for part in parts]
    # Files of one camera each stand in one folder, or in a folder for each camera.
    groups = [[pair.left, pair.right] for pair in paired_files(rest, root).pairs]
    paired = {file for group in groups for file in group}
    groups += [
        g
        for home in {f.parent for f in rest}
        if len(g := [f for f in rest if f.parent == home and f not in paired]) > 1
    ]
    for group in groups:
        pose = [f for f in rest if f.parent == _home(group) and f not in paired]
        if _take(group, pairs, found, []) or (pose and _take([*group, *pose], pairs, found, [])):
            done = {file for one in found for file in one.files}
            parts = [part for part in parts if part.path not in done]
    left_out += parts
    counts = Counter(one.home for one in found)
    for one in found:
        name = one.home.name or "rig"
        yield replace(one, name=name if counts[one.home] == 1 else f"{name}-{one.files[0].stem}")


def _take(
    files: list[Path], pairs: Sequence[FilePair], found: list[Calibration], failed: list[LeftOut]
) -> bool:
    """Whether the files are a calibration; if so it is among the found ones."""
    try:
        found.append(_readable(Calibration("rig", tuple(files), _home(files)), pairs))
    except InvalidInput as error:
        failed += [LeftOut(file, str(error)) for file in files]
        return False
    return True


def _home(files: Sequence[Path]) -> Path:
    return Path(os.path.commonpath([file.parent for file in files]))


def _stated(root: Path, name: str, rig: StatedRig, pairs: Sequence[FilePair]) -> Calibration:
    files = tuple((root / file).resolve() for file in rig.files)
    one = Calibration(name, files, _home(files), unit=rig.unit, max_angle_deg=rig.max_angle_deg)
    return _readable(one, pairs)


def _readable(one: Calibration, pairs: Sequence[FilePair]) -> Calibration:
    """The calibration with what its files leave open: the images' size, the unit of a long baseline.

    Raises InvalidInput, with what is wrong with the files as they are, where that does not help.
    """
    try:
        one.rig()
    except InvalidInput as error:
        size = next((_size(pair.left) for pair in pairs if pair.left.is_relative_to(one.home)), None)
        for guess in _completed(one, size):
            try:
                guess.rig()
            except InvalidInput:
                continue
            return guess
        raise error from None
    return one


def _completed(one: Calibration, size: tuple[int, int] | None) -> Iterator[Calibration]:
    told = "its baseline, whose unit the file leaves open, is taken to be in mm"
    sized = None
    if size is not None:
        sized = replace(
            one,
            size=size,
            remarks=(f"its image size, which the file leaves out, is the images' {size[0]}x{size[1]}",),
        )
        yield sized
    if one.unit is None:
        for base in (one, sized):
            if base is not None:
                yield replace(base, unit=UNSTATED_UNIT, remarks=(*base.remarks, told))


def _size(image: Path) -> tuple[int, int] | None:
    pixels = _read_grey(image)
    return None if pixels is None else (pixels.shape[1], pixels.shape[0])


def _served(
    root: Path,
    pairs: Sequence[FilePair],
    stated: dict[FilePair, str],
    calibrations: Sequence[Calibration],
    left_out: list[LeftOut],
) -> list[PhotoPair]:
    served = []
    for pair in pairs:
        name = stated.get(pair)
        near = [c for c in calibrations if c.name == name] if name else _nearest(pair, root, calibrations)
        if not near:
            left_out += [
                LeftOut(file, "no calibration is beside or above it") for file in (pair.left, pair.right)
            ]
        served += [
            PhotoPair(pair.name or _home([pair.left, pair.right]).name, pair.left, pair.right, one)
            for one in near
        ]
    return _distinctly_named(root, served)


def _nearest(pair: FilePair, root: Path, calibrations: Sequence[Calibration]) -> list[Calibration]:
    place = _home([pair.left, pair.right])
    while place.is_relative_to(root):
        near = [one for one in calibrations if one.home == place]
        if near:
            return near
        place = place.parent
    return []


def _distinctly_named(root: Path, pairs: list[PhotoPair]) -> list[PhotoPair]:
    """The pairs, those that share their name and calibration named after their folder, too."""
    counts = Counter((pair.name, pair.calibration.name) for pair in pairs)
    named, used = [], Counter[tuple[str, str]]()
    for pair in pairs:
        name = pair.name
        if counts[name, pair.calibration.name] > 1:
            folder = _home([pair.left, pair.right]).relative_to(root)
            name = "-".join([*folder.parts, name])
        used[name, pair.calibration.name] += 1
        again = used[name, pair.calibration.name]
        named.append(replace(pair, name=name if again == 1 else f"{name}-{again}"))
    return named


def _with_circle(one: Calibration, pairs: Sequence[PhotoPair], masks: Sequence[Path]) -> Calibration:
    """The calibration with the image circle that a mask beside the images, or their black rim, shows."""
    rig = one.rig()
    if one.max_angle_deg is not None or rig.left.max_angle_deg is not None or not pairs:
        return one
    cameras = rig.left, rig.right
    for mask in masks:
        if not mask.is_relative_to(one.home):
            continue
        shown = _read_grey(mask)
        if shown is None or any(shown.shape != (c.height, c.width) for c in cameras):
            continue
        ends = [angle_of_mask_deg(camera, shown) for camera in cameras]
        if None not in ends:
            return _within(one, min(filter(None, ends)), f"by {mask.name}")
    images = [_fitting(pair, rig) for pair in pairs[:RIM_IMAGES]]
    sides = list(zip(*filter(None, images), strict=True))
    ends = [angle_of_rim_deg(camera, shown) for camera, shown in zip(cameras, sides, strict=False)]
    if not ends or None in ends:
        return one
    return _within(one, min(filter(None, ends)), "by the black rim of its images")


def _within(one: Calibration, angle_deg: float, evidence: str) -> Calibration:
    told = f"its lenses are taken to show nothing beyond {angle_deg:.0f}° from their axes, {evidence}"
    return replace(one, max_angle_deg=angle_deg, remarks=(*one.remarks, told))


def _fitting(pair: PhotoPair, rig: Rig) -> tuple[Grey, Grey] | None:
    """Both images of a pair, if they can be read and have their cameras' sizes."""
    shown = _read_grey(pair.left), _read_grey(pair.right)
    sizes = [None if image is None else image.shape[::-1] for image in shown]
    if sizes != [rig.left.size, rig.right.size]:
        return None
    left, right = shown
    return None if left is None or right is None else (left, right)


def _read_grey(path: Path) -> Grey | None:
    try:
        return grey8(read_image(path))
    except InvalidInput:
        return None


def _below(root: Path, path: Path) -> str:
    return str(path.relative_to(root))
