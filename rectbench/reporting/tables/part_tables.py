"""The tables of what not every run measures: poses, rows, depth, the energy and its starts, time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rectbench.pairs.spec import NO_SCENE
from rectbench.plugins.metric import Column
from rectbench.plugins.result import Result
from rectbench.reporting.asked import methods_part, wanted_figures
from rectbench.reporting.charts.starts import SAME_MINIMUM, Starts, start_study, study_method
from rectbench.reporting.names import named, one_line, pair_labels, slug
from rectbench.reporting.survey import NAME as SURVEY
from rectbench.reporting.tables.belief_table import belief_table
from rectbench.reporting.tables.captions import averages_text, capitalised
from rectbench.reporting.tables.claims_tables import claims_tables
from rectbench.reporting.tables.main_tables import is_ranked, main_tables
from rectbench.reporting.tables.numbers import MISSING, three_digits
from rectbench.reporting.tables.pair_tables import pair_tables
from rectbench.reporting.tables.rig_tables import distortion_tables, rig_table
from rectbench.reporting.tables.run_tables import failures_table, photograph_tables
from rectbench.reporting.tables.survey_table import survey_table
from rectbench.reporting.tables.table import (
    Entry,
    Heading,
    Section,
    Table,
    number,
    text_heading,
    whole,
    words,
)
from rectbench.reporting.tables.tabulation import (
    ALL_RIGS,
    heading,
    measured,
    methods_table,
    titled,
    topic_columns,
    view_text,
)
from rectbench.runs.run import Run
from rectbench.types import FloatArray

_EXCESSES = {"least": 0.0, "median": 0.5, "largest": 1.0}
_MOST_PAIRS = 8
"""Tables of more have a section a rig."""
_SAME_PLACE = 1e-6
"""A start that ends this little off another's L, relatively, ends in the same place."""


def all_tables(run: Run) -> Iterator[Table]:
    """Every table of the run: claims, then part by part, then what failed."""
    yield from claims_tables(run)
    yield from photograph_tables(run)
    for part in run.parts:
        if methods := methods_part(part):
            if SURVEY in wanted_figures(part) and (survey := survey_table(run, methods)):
                yield survey
            yield from _methods_tables(methods)
        if "starts" in wanted_figures(part) and (study := start_study(part, run)):
            yield starts_table(part, study)
    if run.failures:
        yield failures_table(run)


def _methods_tables(part: Run) -> Iterator[Table]:
    if is_ranked(part):
        yield from main_tables(part)
        yield from filter(None, [rig_table(part), belief_table(part)])
    for topic in part.catalogue.topics:
        yield from _topic_tables(part, topic)
    yield from pair_tables(part)


def _topic_tables(part: Run, topic: str) -> Iterator[Table]:
    columns = topic_columns(part, topic)
    if topic == "Distortion":
        yield from distortion_tables(part) if is_ranked(part) else []
    elif topic == "Poses":
        yield from [pose_table(part)] if columns else []
    elif topic == "Time":
        yield from [timing_table(part)] if "timing" in wanted_figures(part) and columns else []
    elif any(column.shown == "topic" for column in columns):
        yield from pairwise_tables(part, topic)


@dataclass(frozen=True)
class _Wording:
    """How the table of a topic is called, and what stands below its title."""

    kind: str
    stem: str
    title: str
    caption: str
    of_photographs: str = ""
    beside: tuple[str, ...] = ()
    """Columns of other topics that it shows as well."""


_WORDINGS = {
    "Row error": _Wording(
        "rows",
        "row-error",
        "Row error",
        "Of SIFT matches within 3 px of the pose's epipolar planes, and of true correspondences; {pose} "
        "pose.",
        "Of the corners of a calibration board, the measure to trust, where both images show one; and of "
        "SIFT matches that agree with one another on the pose in the images, whatever the calibration says.",
    ),
    "Reconstruction": _Wording(
        "depth",
        "reconstruction",
        "Reconstruction",
        "Depth from dense matching on the rectified pair, counted at the pixels of the left source image "
        "that both cameras see; what gets no depth counts as bad.",
    ),
    "Energy": _Wording(
        "energy",
        "energy",
        "The energy about the fit",
        "The least L, and the share of its slices over two coefficients on which it is convex.",
        beside=("distortion_native",),
    ),
}


def pairwise_tables(run: Run, topic: str) -> Iterator[Table]:
    """A topic's columns over all rigs and on each pair, of many on each rig; of photographs a table a pose.

    Methods that were measured, and have no number of the topic anywhere, are left out: it is not about them.
    """
    usual = _Wording(slug(topic), slug(topic), topic, "{pose} pose.")
    wording = _WORDINGS.get(topic, usual)
    own = {column.key for column in run.catalogue.topics[topic]}
    unmeasured = {r.method for r in run.results if r.ok} - {
        r.method for r in run.results if own & r.metrics.keys()
    }
    about = run.only(r for r in run.results if r.method not in unmeasured)
    columns = [*measured(about, map(run.catalogue.column, wording.beside)), *topic_columns(about, topic)]
    for pose in run.noisy_poses[:1] if run.has_truth else run.poses:
        results = about.select(pose=pose)
        caption = wording.caption if run.has_truth else wording.of_photographs or wording.caption
        yield replace(
            methods_table(about, columns, _sections(about, pose)),
            kind=wording.kind,
            name=named(run, wording.stem, "" if run.has_truth else pose),
            title=titled(run, wording.title + ("" if run.has_truth else f" under the {pose} pose")),
            caption=" ".join(
                filter(
                    None,
                    [
                        capitalised(caption.format(pose=pose)),
                        averages_text(results, columns),
                        view_text(run, results) if topic == "Coverage" else "",
                    ],
                )
            ),
        )


def _sections(run: Run, pose: str) -> dict[str, tuple[Result, ...]]:
    """The results of all rigs, then of each pair; of each rig where the pairs are many, or have no scene."""
    results, labels = run.select(pose=pose), pair_labels(run)
    if run.scenes == (NO_SCENE,) or len(labels) > _MOST_PAIRS:
        single = {rig: run.select(results, rig=rig) for rig in run.rigs}
    else:
        single = {one_line(label): run.select(results, place=place) for place, label in labels.items()}
    return {ALL_RIGS: results, **single} if len(single) > 1 else single


def pose_table(run: Run) -> Table:
    """The estimated poses, a row a pair; all methods of a pair share them."""
    columns = topic_columns(run, "Poses")
    keys = [column.key for column in columns]
    count = Heading("poses", "poses", meaning="How many were estimated.")
    rows = [
        _pose_row(one_line(label), _poses(run.select(place=place), keys), columns, np.mean)
        for place, label in pair_labels(run).items()
    ]
    if len(rows) > 1:
        rows.append(_pose_row("median", _poses(run.results, keys), columns, np.median))
    return Table(
        kind="pose",
        part=run.group,
        name=named(run, "pose"),
        title=titled(run, "Poses estimated from the images"),
        caption=("Against the true pose" if run.has_truth else "Against the calibration")
        + "; averages over seeds, and the median over all. σ is what the estimate believes.",
        headings=(text_heading("pair"), count, *map(heading, columns)),
        sections=(Section("", tuple(rows)),),
    )


def _poses(results: Sequence[Result], keys: Sequence[str]) -> list[list[float]]:
    """The columns of each estimate, once."""
    estimates = {(r.pair, r.pose): r for r in results if r.ok and keys[0] in r.metrics}
    return [[r.metrics.get(key, math.nan) for key in keys] for r in estimates.values()]


def _pose_row(
    label: str, poses: list[list[float]], columns: Sequence[Column], average: Callable[..., FloatArray]
) -> tuple[Entry, ...]:
    values = average(np.array(poses), axis=0).tolist() if poses else [None] * len(columns)
    count = Entry(str(len(poses)), float(len(poses)), failed=not poses)
    return Entry(label, label), count, *map(number, values, columns)


def timing_table(run: Run) -> Table:
    """Seconds of each stage beside those somebody else stated."""
    stages = {key: name for key, name in run.catalogue.panels("Time").items() if key in run.metrics}
    heads = [Heading(f"{name} [s]", k, meaning=run.catalogue.column(k).meaning) for k, name in stages.items()]
    stated = run.stated_seconds
    sections = []
    for rig in run.rigs:
        rows = [_timing_row(run.select(rig=rig, method=m), m, stages) for m in run.methods]
        if stated:
            times = {**stated, "total": sum(stated.values())}
            rows.append((words("as stated"), *(_seconds(times.get(name)) for name in stages.values())))
        sections.append(Section(rig, tuple(rows)))
    return Table(
        kind="time",
        part=run.group,
        name=named(run, "timing"),
        title=titled(run, "Time"),
        caption="Seconds a pair, averages over its runs; tables are part of the warp.",
        headings=(text_heading("method"), *heads),
        sections=tuple(sections),
    )


def _timing_row(results: Sequence[Result], method: str, stages: Iterable[str]) -> tuple[Entry, ...]:
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
            text_heading("pair"),
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
