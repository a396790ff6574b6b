"""Photographs of a rig, rectified: tables once, images pair by pair, measured by what they show."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from rectbench.applications.choosing import Choice, best_method, uncalibrated_methods
from rectbench.applications.rectified_files import (
    SIDES,
    SUFFIXES,
    TABLES,
    Files,
    description_files,
    image_file,
    mask_files,
    preview_file,
)
from rectbench.errors import InvalidInput, PoseNotFound, UnknownName
from rectbench.images.reading import read_images
from rectbench.matching.boards.corners import board_matches
from rectbench.matching.pose.consistent import consistent_matches
from rectbench.metrics import RowError, frame_costs, row_error
from rectbench.pairs.finding.names import FilePair, LeftOut, Pairing
from rectbench.plugins.defaults import DEFAULT_METHOD
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.rectifier import METHODS, pose_problem
from rectbench.progress import Progress
from rectbench.registry import registry
from rectbench.rigs import Rig
from rectbench.types import Images, Matches
from rectbench.warps import Framing, Rectification, framed
from rectbench.warps.lookup.resampling import Filter, Resampler
from rectbench.writing import write_atomically

BEST = "best"
MEASURED_PAIRS = 5
"""Pairs whose rows are measured, spread over all: features of one take half a second."""
Image = NDArray[np.generic]


@dataclass(frozen=True)
class Wanted:
    """What is to be made."""

    method: str = DEFAULT_METHOD
    options: Mapping[str, Any] = field(default_factory=dict)
    framing: Framing = field(default_factory=Framing)
    tables: tuple[str, ...] = tuple(TABLES)
    """Kinds of lookup tables, names of `TABLES`."""
    filter: Filter = "point"
    """How images are resampled, see `Resampler`."""
    measured_pairs: int = MEASURED_PAIRS
    seed: int = 0
    without_calibration: bool = False
    """Whether the rig only stands in for one, see `uncalibrated`, and methods must not work from its pose."""

    def __post_init__(self) -> None:
        for name in self.tables:
            if name not in TABLES:
                raise UnknownName("kind of tables", name, TABLES)
        if self.method == BEST and self.options:
            raise InvalidInput("options are given for method best; expected them for a method by its name")


@dataclass(frozen=True, eq=False)
class PairResult:
    """How one pair fared."""

    pair: FilePair
    reason: str = ""
    """Why it was left out; empty where it was rectified."""
    features: RowError | None = None
    """Row errors of feature matches that agree with one another."""
    board: RowError | None = None
    """Row errors of the corners of a calibration board, the measure to trust."""
    note: str = ""
    """The kind of board, or why nothing could be measured."""

    @property
    def columns(self) -> dict[str, Any]:
        """The row of this pair in `pairs.csv`."""
        status = "left out" if self.reason else "ok"
        files = {"left": str(self.pair.left), "right": str(self.pair.right)}
        about = {"pair": self.pair.name, **files, "status": status, "reason": self.reason, "note": self.note}
        return about | _row_columns("features", self.features) | _row_columns("board", self.board)


@dataclass(frozen=True, eq=False)
class RectifiedImages:
    """What was made of the photographs of a rig."""

    method: str
    rectification: Rectification
    costs: Mapping[str, float]
    """Of the frame, see `frame_costs`."""
    own_costs: Mapping[str, float] | None
    """Of the frame that the method makes by itself; None where that is the frame."""
    choice: Choice | None
    """How the method was chosen, where it was."""
    pairs: tuple[PairResult, ...]
    lonely: tuple[LeftOut, ...]
    """Images without a partner."""
    files: tuple[Path, ...]

    @property
    def left_out(self) -> tuple[str, ...]:
        """Why pairs and images were left out, one line each."""
        unpaired = tuple(f"{image.path}: {image.reason}" for image in self.lonely)
        return tuple(result.reason for result in self.pairs if result.reason) + unpaired

    @property
    def rows(self) -> dict[str, float]:
        """Row errors over all measured pairs: `row_error_board_*` and `row_error_features_*`."""
        rows: dict[str, float] = {}
        for kind in ("board", "features"):
            found = [error for result in self.pairs if (error := getattr(result, kind)) is not None]
            pooled = RowError(
                np.concatenate([error.rectified_px for error in found] or [np.empty(0)]),
                np.concatenate([error.source_px for error in found] or [np.empty(0)]),
            )
            if np.isfinite(pooled.rectified_px).any():
                rows |= _row_columns(kind, pooled)
        return rows

    @property
    def warning(self) -> str:
        """That images and calibration do not belong together, where the rows say so; else nothing."""
        known = [self.rows.get(f"row_error_{kind}_source_median_px") for kind in ("board", "features")]
        off = next((error for error in known if error is not None), 0.0)  # a board's word goes first
        if off <= ELSEWHERE_PX:
            return ""
        return (
            f"rows are {off:.0f} source pixels off in the median: these images are not of this "
            "calibration, or left and right are swapped"
        )


ELSEWHERE_PX = 5.0
"""Rows farther off than this, source pixels, are no matter of a calibration's accuracy."""


def rectify_images(
    images: Pairing,
    rig: Rig,
    wanted: Wanted,
    out: Path,
    *,
    matches: Matches | None = None,
    progress: Progress | None = None,
) -> RectifiedImages:
    """Rectify photographs of one rig into a folder.

    Written are the rectification (`rectified.yaml`, `opencv.yml` where OpenCV has a form for it), masks,
    lookup tables, `preview.png`, `metrics.json`; and `left.png`, `right.png` of a single pair, or
    `left/NAME.png`, `right/NAME.png` and `pairs.csv` of several. Images keep their depth and channels.
    `matches` are for methods that work from them; made from the rig's pose where left out.

    A pair that cannot be read, or has not the rig's size, is left out, with the reason. Raises InvalidInput
    where that is so of all, and for a wrong method, option or frame; Unsupported where no method that is
    asked for can serve the rig. Nothing is written then.
    """
    pairs = images.pairs
    _refuse_overwriting(pairs, out)
    readable, first = first_readable(pairs, rig)
    trusted = _Trusted.of(first, rig, wanted.seed) if wanted.measured_pairs else _Trusted()
    choice, own, rect = _rectification(rig, wanted, first, matches, trusted)
    costs = frame_costs(rect, rig)
    own_costs = None if own is None else frame_costs(own, rig)
    method = choice.best.method if choice else registry(METHODS).get(wanted.method).name
    facts = {"method": method, "options": dict(wanted.options)} | ({"chosen": choice.why} if choice else {})
    if wanted.without_calibration:
        facts["calibrated"] = "no: the rig below is assumed, and its baseline is 1 of an unknown unit"
    contents = description_files(rect, **facts) | mask_files(rect)
    for kind in wanted.tables:
        contents |= TABLES[kind](rect)
    resamplers = [Resampler.of(rect, side, wanted.filter) for side in SIDES]
    costs |= _averaging(resamplers)
    contents["preview.png"] = preview_file(*_resampled(first, resamplers))
    _remove_earlier(out, contents)
    files = _written(contents, out)

    measured = {round(place) for place in np.linspace(0, len(pairs) - 1, wanted.measured_pairs)}
    results: list[PairResult] = []
    with (progress or Progress()).stage("pairs", len(pairs)) as advance:
        for place, pair in enumerate(pairs):
            try:
                both = first if pair is readable else _images_of(pair, rig)
            except InvalidInput as error:
                results.append(PairResult(pair, reason=str(error)))
            else:
                stem = f"{{side}}/{pair.name}" if len(pairs) > 1 else "{side}"
                files += _written(_image_files(both, resamplers, stem), out)
                known = trusted if pair is readable else _Trusted()
                if place in measured and pair is not readable:
                    known = _Trusted.of(both, rig, wanted.seed)
                results.append(known.measured(pair, rect))
            advance()
    made = RectifiedImages(
        method, rect, costs, own_costs, choice, tuple(results), images.left_out, tuple(files)
    )
    return replace(made, files=(*files, *_written(_summary_files(made), out)))


@dataclass(frozen=True, eq=False)
class _Trusted:
    """Correspondences that a pair's own images tell, without any calibrated pose."""

    features: Matches | None = None
    board: Matches | None = None
    note: str = ""

    @staticmethod
    def of(images: Images, rig: Rig, seed: int) -> _Trusted:
        found = board_matches(*images)
        board, note = (found.matches, found.kind) if found else (None, "")
        try:
            features = consistent_matches(rig.left, rig.right, images, seed=seed)
        except (PoseNotFound, InvalidInput) as reason:
            return _Trusted(None, board, note or str(reason))
        return _Trusted(features, board, note)

    @property
    def best(self) -> Matches | None:
        """The board's, where there is one."""
        return self.board or self.features

    def measured(self, pair: FilePair, rect: Rectification) -> PairResult:
        """The pair with the row errors of these correspondences."""
        features, board = (m and row_error(rect, *m) for m in (self.features, self.board))
        return PairResult(pair, features=features, board=board, note=self.note)


def _rectification(
    rig: Rig, wanted: Wanted, images: Images, matches: Matches | None, trusted: _Trusted
) -> tuple[Choice | None, Rectification | None, Rectification]:
    """How it was chosen, if it was; the method's own frame, if it is another; and the one that is wanted."""
    if wanted.method == BEST:
        choice = best_method(
            rig,
            framing=wanted.framing,
            images=images,
            matches=matches,
            trusted=trusted.best,
            methods=uncalibrated_methods() if wanted.without_calibration else None,
            seed=wanted.seed,
        )
        return choice, None, choice.rectification
    plugin = registry(METHODS).get(wanted.method)
    if wanted.without_calibration and "pose" in plugin.value.needs:
        instead = " or ".join(uncalibrated_methods())
        raise InvalidInput(f"{plugin.name} needs a calibrated rig; expected one, or the method {instead}")
    options = checked_options(plugin, wanted.options)
    problem = pose_problem(rig, images=images, matches=matches, seed=wanted.seed)
    own = fit(plugin, problem, options)
    rect = framed(own, wanted.framing)
    return None, None if rect is own else own, rect


def first_readable(pairs: Sequence[FilePair], rig: Rig | None = None) -> tuple[FilePair, Images]:
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
    raise InvalidInput(
        f"{reasons[0]}{more}" if reasons else "there are no image pairs; expected at least one"
    )


def _images_of(pair: FilePair, rig: Rig | None) -> Images:
    images = read_images(pair.left, pair.right)
    cameras = () if rig is None else (rig.left, rig.right)
    for path, image, camera in zip((pair.left, pair.right), images, cameras, strict=False):
        if image.shape[1::-1] != camera.size:
            size = "x".join(map(str, image.shape[1::-1]))
            expected = f"{camera.width}x{camera.height}, the size of its camera"
            raise InvalidInput(f"{path}: is {size} px; expected {expected}")
    return images


def _averaging(resamplers: Sequence[Resampler]) -> dict[str, float]:
    """Of the rectified pixels, the share that averages several source pixels; and the longest footprint."""
    footprints = [resampler.footprints for resampler in resamplers if resampler.footprints]
    if not footprints:
        return {}
    shares = [footprint.shrunk_share for footprint in footprints]
    longest_px = max(footprint.largest_px for footprint in footprints)
    return {"averaged_share": float(np.mean(shares)), "longest_footprint_px": longest_px}


def _resampled(images: Images, resamplers: Sequence[Resampler]) -> list[Image]:
    with ThreadPoolExecutor(2) as threads:
        return list(threads.map(lambda image, resampler: resampler(image), images, resamplers))


def _image_files(images: Images, resamplers: Sequence[Resampler], stem: str) -> Files:
    """Both rectified images, encoded; `stem` is their path with {side} in it."""
    with ThreadPoolExecutor(2) as threads:
        encoded = threads.map(lambda image, resampler: image_file(resampler(image)), images, resamplers)
        names = (stem.format(side=side) for side in SIDES)
        return {name + suffix: data for name, (suffix, data) in zip(names, encoded, strict=True)}


def _summary_files(made: RectifiedImages) -> Files:
    """`metrics.json`, and of several pairs `pairs.csv`."""
    metrics: dict[str, Any] = {"method": made.method, "frame": dict(made.costs)}
    if made.own_costs:
        metrics["frame_of_the_method"] = dict(made.own_costs)
    if made.choice:
        metrics["choice"] = {"why": made.choice.why, "methods": made.choice.table.to_dict("records")}
    metrics |= {"rows": made.rows, "pairs": [result.columns for result in made.pairs]}
    metrics["left_out"] = list(made.left_out)
    files = {"metrics.json": (json.dumps(_finite(metrics), indent=1, ensure_ascii=False) + "\n").encode()}
    if len(made.pairs) > 1:
        files["pairs.csv"] = pd.DataFrame([r.columns for r in made.pairs]).to_csv(index=False).encode()
    return files


def _finite(value: Any) -> Any:
    """The same with null for numbers that JSON has not."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value


def _row_columns(kind: str, error: RowError | None) -> dict[str, float]:
    if error is None:
        return {}
    return {name.replace("row_error", f"row_error_{kind}"): value for name, value in error.columns().items()}


def _refuse_overwriting(pairs: Sequence[FilePair], out: Path) -> None:
    """Raise InvalidInput where an image would be written over a photograph."""
    names = [f"{side}/{pair.name}" for pair in pairs for side in SIDES] if len(pairs) > 1 else SIDES
    written = {(out / (name + suffix)).resolve() for name in names for suffix in SUFFIXES}
    for photograph in (path for pair in pairs for path in (pair.left, pair.right)):
        if photograph.resolve() in written:
            raise InvalidInput(f"{photograph} would be overwritten; expected another folder than {out}")


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
