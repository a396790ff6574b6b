"""The tables of what not every run measures: poses, rows, depth, the energy and its starts, time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from rectbench.metrics.catalogue import DEPTH_KEYS, POSE_KEYS, ROW_KEYS, STAGES, column
from rectbench.plugins.metric import Column
from rectbench.reporting.asked import methods_part, wanted_figures
from rectbench.reporting.charts.starts import SAME_MINIMUM, Starts, start_study, study_method
from rectbench.reporting.names import named
from rectbench.reporting.tables.claims_tables import claims_tables
from rectbench.reporting.tables.labels import one_line, pair_labels
from rectbench.reporting.tables.numbers import MISSING, three_digits
from rectbench.reporting.tables.photograph_tables import photograph_tables
from rectbench.reporting.tables.table import Entry, Heading, Section, Table, number, whole, words
from rectbench.reporting.tables.tabulation import (
    distortion_table,
    failures_table,
    heading,
    is_ranked,
    main_tables,
    methods_table,
    pair_tables,
    titled,
)
from rectbench.runs.rows import Row
from rectbench.runs.run import Run
from rectbench.types import FloatArray

ENERGY_KEYS = ("distortion_native", "energy_convex_share")
_EXCESSES = {"least": 0.0, "median": 0.5, "largest": 1.0}
_SAME_PLACE = 1e-6
"""A start that ends this little off another's L, relatively, ends in the same place."""


def all_tables(run: Run) -> Iterator[Table]:
    """Every table of the run: claims, then part by part, then what failed."""
    yield from claims_tables(run)
    yield from photograph_tables(run)
    for part in run.parts:
        if methods := methods_part(part):
            yield from _methods_tables(methods)
        if "starts" in wanted_figures(part) and (study := start_study(part, run)):
            yield starts_table(part, study)
    if run.failures:
        yield failures_table(run)


def _methods_tables(part: Run) -> Iterator[Table]:
    if is_ranked(part):
        yield from main_tables(part)
        yield distortion_table(part)
    if not part.has_truth and _measures(part, ROW_KEYS):
        yield from photographs_row_tables(part)
    elif part.group and _measures(part, ROW_KEYS):
        yield rows_table(part)
    if _measures(part, POSE_KEYS):
        yield pose_table(part)
    if _measures(part, DEPTH_KEYS):
        yield depth_table(part)
    if "energy_convex_share" in part.metrics:
        yield energy_table(part)
    if "timing" in wanted_figures(part) and _measures(part, tuple(STAGES)):
        yield timing_table(part)
    yield from pair_tables(part)


def _measures(run: Run, keys: Sequence[str]) -> bool:
    return any(key in run.metrics for key in keys)


def rows_table(run: Run) -> Table:
    """Row error in the images and against the truth, over all pairs and on each."""
    return replace(
        _by_pair(run, ROW_KEYS, run.noisy_poses[0]),
        kind="rows",
        name=named(run, "row-error"),
        title=titled(run, "Row error"),
        caption="Of SIFT matches within 3 px of the pose's epipolar planes, and of true correspondences; "
        f"{run.noisy_poses[0]} pose, averages over seeds.",
    )


def photographs_row_tables(run: Run) -> Iterator[Table]:
    """Row error under each pose, of what was found in the images, over all pairs and on each."""
    for pose in run.poses:
        yield replace(
            _by_pair(run, ROW_KEYS, pose),
            kind="rows",
            name=named(run, "row-error", pose),
            title=titled(run, f"Row error under the {pose} pose"),
            caption="Of the corners of a calibration board, the measure to trust, where both images show "
            "one; and of SIFT matches that agree with one another on the pose in the images, whatever the "
            "calibration says.",
        )


def depth_table(run: Run) -> Table:
    """Dense matching through each method's rectification, over all pairs and on each."""
    return replace(
        _by_pair(run, DEPTH_KEYS, run.noisy_poses[0]),
        kind="depth",
        name=named(run, "reconstruction"),
        title=titled(run, "Reconstruction"),
        caption="Depth from dense matching on the rectified pair, counted at the pixels of the left source "
        "image that both cameras see; what gets no depth counts as bad.",
    )


def energy_table(run: Run) -> Table:
    """How convex the energy is about each fit, of the methods that have one."""
    with_energy = run.only(r for r in run.results if "energy_convex_share" in r.metrics)
    return replace(
        _by_pair(with_energy, ENERGY_KEYS, run.noisy_poses[0]),
        kind="energy",
        name=named(run, "energy"),
        title=titled(run, "The energy about the fit"),
        caption="The least L, and the share of its slices over two coefficients on which it is convex.",
    )


def _by_pair(run: Run, keys: Sequence[str], pose: str) -> Table:
    results, labels = run.select(pose=pose), pair_labels(run)
    by_pair = {one_line(label): run.select(results, place=place) for place, label in labels.items()}
    return methods_table(run, keys, {"all pairs": results, **by_pair} if len(labels) > 1 else by_pair)


def pose_table(run: Run) -> Table:
    """The estimated poses, a row a pair; all methods of a pair share them."""
    keys = [key for key in POSE_KEYS if key in run.metrics]
    rows = [
        _pose_row(one_line(label), _poses(run.select(place=place), keys), keys, np.mean)
        for place, label in pair_labels(run).items()
    ]
    if len(rows) > 1:
        rows.append(_pose_row("median", _poses(run.results, keys), keys, np.median))
    return Table(
        kind="pose",
        part=run.group,
        name=named(run, "pose"),
        title=titled(run, "Poses estimated from the images"),
        caption=("Against the true pose" if run.has_truth else "Against the calibration")
        + "; averages over seeds, and the median over all. σ is what the estimate believes.",
        headings=(
            Heading("pair", "pair", numeric=False),
            Heading("poses", "poses", meaning="How many were estimated."),
            *map(heading, keys),
        ),
        sections=(Section("", tuple(rows)),),
    )


def _poses(results: Sequence[Row], keys: Sequence[str]) -> list[list[float]]:
    """The columns of each estimate, once."""
    estimates = {(r.pair, r.pose): r for r in results if r.ok and keys[0] in r.metrics}
    return [[r.metrics.get(key, math.nan) for key in keys] for r in estimates.values()]


def _pose_row(
    label: str, poses: list[list[float]], keys: Sequence[str], average: Callable[..., FloatArray]
) -> tuple[Entry, ...]:
    values = average(np.array(poses), axis=0).tolist() if poses else [None] * len(keys)
    count = Entry(str(len(poses)), float(len(poses)), failed=not poses)
    return Entry(label, label), count, *map(number, values, map(column, keys))


def timing_table(run: Run) -> Table:
    """Seconds of each stage beside those somebody else stated."""
    stages = [key for key in STAGES if key in run.metrics]
    stated = run.stated_seconds
    sections = []
    for rig in run.rigs:
        rows = [_timing_row(run.select(rig=rig, method=m), m, stages) for m in run.methods]
        if stated:
            times = {**stated, "total": sum(stated.values())}
            rows.append((words("as stated"), *(_seconds(times.get(STAGES[key])) for key in stages)))
        sections.append(Section(rig, tuple(rows)))
    return Table(
        kind="time",
        part=run.group,
        name=named(run, "timing"),
        title=titled(run, "Time"),
        caption="Seconds a pair, averages over its runs; tables are part of the warp.",
        headings=(
            Heading("method", "method", numeric=False),
            *(Heading(f"{STAGES[key]} [s]", key, meaning=column(key).meaning) for key in stages),
        ),
        sections=tuple(sections),
    )


def _timing_row(results: Sequence[Row], method: str, stages: Sequence[str]) -> tuple[Entry, ...]:
    found = [[r.metrics[key] for r in results if key in r.metrics] for key in stages]
    return words(method), *(_seconds(sum(values) / len(values) if values else None) for values in found)


def _seconds(value: float | None) -> Entry:
    return number(value, Column("", ""))


def starts_table(part: Run, study: Sequence[Starts]) -> Table:
    """Where the random starts of each pair end."""
    rows = tuple(
        (
            words(one_line(starts.label)),
            whole(starts.count),
            whole(starts.same),
            whole(starts.failed),
            *(_excess(starts, share) for share in _EXCESSES.values()),
        )
        for starts in study
    )
    excess = "L over the default start's, less 1"
    return Table(
        kind="starts",
        part=part.group,
        name=named(part, "starts"),
        title=titled(part, "Random starts"),
        caption=f"Random starts of {study_method(part)}; at most {100 * SAME_MINIMUM:g} % above the default "
        "start's L is the same minimum.",
        headings=(
            Heading("pair", "pair", numeric=False),
            Heading("starts", "starts"),
            Heading("same minimum", "same"),
            Heading("failed", "failed", meaning="They gave no rectification."),
            *(Heading(f"{which} excess", f"excess_{which}", meaning=excess) for which in _EXCESSES),
        ),
        sections=(Section("", rows),),
    )


def _excess(starts: Starts, share: float) -> Entry:
    if not starts.ratios:
        return Entry(MISSING)
    value = float(np.quantile(starts.ratios, share)) - 1
    return Entry("0" if abs(value) < _SAME_PLACE else three_digits(value), value)
