"""Photographs of a rig, rectified: tables once, images pair by pair, measured by what they show."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from rectbench.applications import rectification_files as encode
from rectbench.applications.choose_method import Choice, best_method, uncalibrated_methods
from rectbench.applications.one_rig import circle_of, rig_of
from rectbench.applications.photographs.rectified import (
    OwnMatches,
    PairResult,
    RectifiedImages,
    summary_files,
)
from rectbench.applications.pixel_grid import grid_preview
from rectbench.applications.rectification_files import SIDES, Files
from rectbench.applications.requests.photographs import BEST, FramingRequest, RectifyRequest
from rectbench.calibrations import holds_many
from rectbench.errors import InvalidInput, UnknownName, argument
from rectbench.images.reading import read_images
from rectbench.images.stereo_pair import check_size
from rectbench.matching.pose.uncalibrated import uncalibrated
from rectbench.metrics import frame_costs
from rectbench.pairs.finding.image_pairs import image_pairs
from rectbench.pairs.finding.names import FilePair, camera_numbers
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.rectifier import METHODS, pose_problem
from rectbench.progress import progress_for
from rectbench.registry import registry
from rectbench.rigs import Rig
from rectbench.types import Images, Matches
from rectbench.warps import Framing, Rectification, framed
from rectbench.warps.lookup.resampling import Resampler
from rectbench.writing import check_writable, write_atomically


def rectify_photographs(request: RectifyRequest, progress: bool | None = None) -> RectifiedImages:
    """Rectify photographs of one rig into a folder; without any, write all but the images.

    Written are the rectification (`rectified.yaml`, `opencv.yml` where OpenCV has a form for it), masks,
    lookup tables, `preview.png`, `metrics.json`; and `left.png`, `right.png` of a single pair, or
    `left/NAME.png`, `right/NAME.png` and `pairs.csv` of several. Images keep their depth and channels.
    An image circle that neither rig nor request states is read from masks or black rims, see
    `pairs.finding.image_circle`. `progress` is a bar on stderr, where there are several pairs; on a terminal
    by default.

    A pair that cannot be read, or has not the rig's size, is left out, with the reason. Raises InvalidInput
    where that is so of all, and for a wrong method, option or frame; Unsupported where no method that is
    asked for can serve the rig. Nothing is written then.
    """
    for kind in request.tables:
        if kind not in encode.TABLES:
            raise UnknownName("kind of tables", kind, encode.TABLES)
    check_writable(request.out)
    if request.left is None or request.right is None:
        return _tables_alone(request)
    found = image_pairs(request.left, request.right)
    pairs = found.pairs
    rig, matches = _calibration(request, pairs)
    circle = circle_of(request, rig, pairs) if request.rig is not None else None
    if circle is not None:
        rig = rig.within(circle.angle_deg)
    _refuse_overwriting(pairs, circle.masks if circle else (), request.out)
    readable, first = _first_readable(pairs, rig)
    known = OwnMatches.of(first, rig, request.seed) if request.measured_pairs else OwnMatches()
    choice, own, rect = _rectification(rig, request, first, matches, known.best)
    resamplers = [Resampler.of(rect, side, "area" if request.antialias else "point") for side in SIDES]
    made = RectifiedImages(
        method=_method(request, choice),
        rectification=rect,
        costs=frame_costs(rect, rig) | _averaging(resamplers),
        own_costs=None if own is None else frame_costs(own, rig),
        choice=choice,
        unpaired=found.left_out,
        circle=circle,
    )
    contents = _rig_files(made, request)
    shown = [resample(image) for resample, image in zip(resamplers, first, strict=True)]
    contents["preview.png"] = encode.preview_file(*shown)
    _remove_earlier(request.out, contents)
    files = _written(contents, request.out)

    measured = {round(place) for place in np.linspace(0, len(pairs) - 1, request.measured_pairs)}
    results: list[PairResult] = []
    with progress_for(False if len(pairs) == 1 else progress).stage("pairs", len(pairs)) as advance:
        for place, pair in enumerate(pairs):
            try:
                both = first if pair is readable else _images_of(pair, rig)
            except InvalidInput as error:
                results.append(PairResult(pair, reason=str(error)))
            else:
                stem = f"{{side}}/{pair.name}" if len(pairs) > 1 else "{side}"
                files += _written(_image_files(both, resamplers, stem), request.out)
                own_matches = known if pair is readable else OwnMatches()
                if place in measured and pair is not readable:
                    own_matches = OwnMatches.of(both, rig, request.seed)
                results.append(own_matches.measured(pair, rect))
            advance()
    made = replace(made, pairs=tuple(results))
    return replace(made, files=(*files, *_written(summary_files(made), request.out)))


def _tables_alone(request: RectifyRequest) -> RectifiedImages:
    """All that needs no photographs, with a pixel grid as the preview."""
    rig = rig_of(request)
    choice, own, rect = _rectification(rig, request)
    made = RectifiedImages(
        method=_method(request, choice),
        rectification=rect,
        costs=frame_costs(rect, rig),
        own_costs=None if own is None else frame_costs(own, rig),
        choice=choice,
    )
    contents = _rig_files(made, request) | {"preview.png": grid_preview(rect)} | summary_files(made)
    _remove_earlier(request.out, contents)
    return replace(made, files=tuple(_written(contents, request.out)))


def _method(request: RectifyRequest, choice: Choice | None) -> str:
    return choice.best.method if choice else registry(METHODS).get(request.method_name).name


def _calibration(request: RectifyRequest, pairs: Sequence[FilePair]) -> tuple[Rig, Matches | None]:
    """The rig of a request; without one, one that is assumed, and the matches that methods work from."""
    _, images = _first_readable(pairs)
    if request.rig is not None:
        if request.cameras is None:
            _refuse_guessed_cameras(request.rig, pairs[0])
        return rig_of(request, images), None
    rig, matches = uncalibrated(images, seed=request.seed)
    return rig_of(request.model_copy(update={"rig": rig})), matches


def _refuse_guessed_cameras(rig: Any, pair: FilePair) -> None:
    """Raise InvalidInput for images numbered as others than the first two cameras of a file of many."""
    numbers = camera_numbers(pair)
    files = [] if isinstance(rig, Rig) else [rig] if isinstance(rig, str | os.PathLike) else list(rig)
    if numbers is not None and any(map(holds_many, files)):
        raise InvalidInput(
            f"{pair.left} is of camera {numbers[0]}, and {files[0]} may hold many; expected the names of two "
            f"({argument('cameras')})"
        )


def _rectification(
    rig: Rig,
    request: RectifyRequest,
    images: Images | None = None,
    matches: Matches | None = None,
    trusted: Matches | None = None,
) -> tuple[Choice | None, Rectification | None, Rectification]:
    """How it was chosen, if it was; the method's own frame, if it is another; and the one that is wanted."""
    framing = Framing(**{name: getattr(request, name) for name in FramingRequest.model_fields})
    without_calibration = request.rig is None
    given: dict[str, Any] = {"images": images, "matches": matches, "seed": request.seed}
    given["margin_deg"] = request.margin_deg
    if request.method == BEST:
        methods = uncalibrated_methods() if without_calibration else None
        choice = best_method(rig, framing=framing, trusted=trusted, methods=methods, **given)
        return choice, None, choice.rectification
    plugin = registry(METHODS).get(request.method_name)
    if without_calibration and "pose" in plugin.value.needs:
        instead = " or ".join(uncalibrated_methods())
        raise InvalidInput(f"{plugin.name} needs a calibrated rig; expected one, or the method {instead}")
    options = checked_options(plugin, request.options)
    own = fit(plugin, pose_problem(rig, **given), options)
    rect = framed(own, framing)
    return None, None if rect is own else own, rect


def _rig_files(made: RectifiedImages, request: RectifyRequest) -> Files:
    """What holds for all pairs: description, masks and lookup tables."""
    facts: dict[str, Any] = {"method": made.method, "options": dict(request.options)}
    if made.choice:
        facts["chosen"] = made.choice.why
    if made.circle:
        facts["image_circle"] = made.circle.told
    if request.rig is None:
        facts["calibrated"] = "no: the rig below is assumed, and its baseline is 1 of an unknown unit"
    contents = encode.description_files(made.rectification, **facts) | encode.mask_files(made.rectification)
    for kind in request.tables:
        contents |= encode.TABLES[kind](made.rectification)
    return contents


def _first_readable(pairs: Sequence[FilePair], rig: Rig | None = None) -> tuple[FilePair, Images]:
    """The first pair that can be read and, where a rig is given, has its size, with its images.

    Raises InvalidInput with the first reason where there is none.
    """
    reasons = []
    for pair in pairs:
        try:
            return pair, _images_of(pair, rig)
        except InvalidInput as error:
            reasons.append(str(error))
    more = f"; and {len(reasons) - 1} more pairs cannot be used" if len(reasons) > 1 else ""
    raise InvalidInput(f"{reasons[0]}{more}")


def _images_of(pair: FilePair, rig: Rig | None) -> Images:
    images = read_images(pair.left, pair.right)
    for path, image, camera in zip(pair.files, images, (rig.left, rig.right) if rig else (), strict=False):
        check_size(image, camera, f"{path}:", "its camera")
    return images


def _averaging(resamplers: Sequence[Resampler]) -> dict[str, float]:
    """Of the rectified pixels, the share that averages several source pixels; and the longest footprint."""
    found = [resampler.footprints for resampler in resamplers if resampler.footprints]
    if not found:
        return {}
    share = float(np.mean([footprints.shrunk_share for footprints in found]))
    return {"averaged_share": share, "longest_footprint_px": max(one.largest_px for one in found)}


def _image_files(images: Images, resamplers: Sequence[Resampler], stem: str) -> Files:
    """Both rectified images, encoded; `stem` is their path with {side} in it."""
    with ThreadPoolExecutor(2) as threads:
        rectified = threads.map(lambda image, resample: resample(image), images, resamplers)
        encoded = threads.map(encode.image_file, rectified)
        names = (stem.format(side=side) for side in SIDES)
        return {name + suffix: data for name, (suffix, data) in zip(names, encoded, strict=True)}


def _refuse_overwriting(pairs: Sequence[FilePair], masks: Sequence[Path], out: Path) -> None:
    """Raise InvalidInput where an image would be written over a photograph, or over a mask of its lenses."""
    names = [f"{side}/{pair.name}" for pair in pairs for side in SIDES] if len(pairs) > 1 else SIDES
    written = {(out / (name + suffix)).resolve() for name in names for suffix in encode.SUFFIXES}
    written |= {(out / f"{side}_mask.png").resolve() for side in SIDES}
    for given in (*(path for pair in pairs for path in pair.files), *masks):
        if given.resolve() in written:
            raise InvalidInput(f"{given} would be overwritten; expected another folder than {out}")


OWN_FILES = ("opencv.yml", "maps.npz", "maps.yml.gz", "maps_fixed.yml.gz", "pairs.csv", "metrics.json")
"""What another rectification may have left in the folder, and must not lie beside this one's."""


def _remove_earlier(folder: Path, contents: Files) -> None:
    for name in OWN_FILES:
        if name not in contents:
            (folder / name).unlink(missing_ok=True)


def _written(contents: Files, folder: Path) -> list[Path]:
    for name, content in contents.items():
        write_atomically(folder / name, content)
    return [folder / name for name in contents]
