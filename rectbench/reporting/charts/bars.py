"""Row error and distortion as grouped bars: a panel a rig or a metric, a group a scene or a pair."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product

from rectbench.pairs.spec import NO_SCENE
from rectbench.plugins.figure import Drawing, Figure, FigureData
from rectbench.plugins.result import Part, Result
from rectbench.reporting.charts.grouped_bars import NO_VALUE, Bar, BarChart, bar_drawing, bar_of
from rectbench.reporting.names import pair_labels, slug
from rectbench.reporting.shares import share_of

_BOUNDED = ("distortion_rescaled", "distortion_stretched")
"""Never far above 1, as every image may be shrunk: a logarithmic axis would hide a third more or less."""
_ON_COMMON_MATCHES = {
    "row_error_50_mean_px": "of true correspondences in 50 % of the view",
    "row_error_95_mean_px": "of true correspondences in 95 % of the view",
    "row_error_features_50_mean_px": "of SIFT matches in 50 % of the view",
    "row_error_features_95_mean_px": "of SIFT matches in 95 % of the view",
}
"""Row errors on the same matches for all methods, and what stands above their panels."""
_GAPS = " All methods on the same matches; one that shows less of the view has no bar."
_CAPTIONS = {
    "distortion_native": "The paper's distortion L on each pair, each method at its authors' own scale.",
    "distortion_rescaled": "The same after the one scale of the image that is best for each method.",
}


class Bars(Figure):
    """Row error and distortion of each method on each pair, as bars."""

    name = "bars"
    topic = "Charts"
    usual = 1

    def drawings(self, given: FigureData) -> Iterator[Drawing]:
        """A chart a metric; of a part of a report, or of photographs, all ways to measure a thing in one.

        None of pairs without a scene: they are many, and curves tell more of them.
        """
        part = given.part
        if part.scenes == (NO_SCENE,):
            return iter(())
        return _by_pair(given) if part.group or not part.has_truth else _by_scene(given)


def _by_scene(given: FigureData) -> Iterator[Drawing]:
    part = given.part
    for key, of in _ON_COMMON_MATCHES.items():
        if key not in part.metrics or "features" in key:
            continue
        for pose in part.noisy_poses:
            chart = bar_chart(part, key, pose, reference=1.0)
            share = f"{share_of(part.catalogue.column(key))} %"
            title = f"Row error in {share} of the view, {pose} pose"
            caption = f"Mean row error {of} on each pair.{_GAPS}"
            yield bar_drawing(chart, given, slug("row-error", share), title, caption, pose)
    for key, caption in _CAPTIONS.items():
        if key in part.metrics:
            chart = bar_chart(part, key, part.geometric_pose)
            yield bar_drawing(chart, given, key, part.catalogue.column(key).heading.capitalize(), caption)


def _by_pair(given: FigureData) -> Iterator[Drawing]:
    part, pose = given.part, given.part.geometric_pose
    row_errors, protocols = _row_errors(part), part.catalogue.panels("Distortion")
    if any(key in part.metrics for key in row_errors):
        for noisy in part.noisy_poses:
            chart = pair_chart(part, "row error [px]", row_errors, noisy, reference=1.0)
            caption = "Mean row error on each pair, measured in the images" + (
                " and against the truth." if part.has_truth else "."
            )
            caption += _GAPS if any(key in _ON_COMMON_MATCHES for key in row_errors) else ""
            of = noisy if len(part.noisy_poses) > 1 else ""
            yield bar_drawing(chart, given, "row-error", f"Row error, {noisy} pose", caption, of)
    if any(key in part.metrics for key in protocols):
        chart = pair_chart(part, "distortion L", protocols, pose, bounded=_BOUNDED)
        caption = "The paper's distortion L on each pair, under each protocol."
        if chart.linear:
            caption += " Rescaled and stretched have a linear axis from 0."
        yield bar_drawing(chart, given, "distortion", "Distortion by protocol", caption)


def _row_errors(part: Part) -> dict[str, str]:
    """The row errors that a part has, on the matches that are common to all methods where it has these."""
    common = {key: title for key, title in _ON_COMMON_MATCHES.items() if key in part.metrics}
    own = {key: title for key, title in part.catalogue.panels("Row error").items() if key in part.metrics}
    kept = {key: title for key, title in own.items() if _common_of(key) not in map(_common_of, common)}
    return {**common, **kept}


def _common_of(key: str) -> str:
    """The row error without its share of the view."""
    return re.sub(r"_(50|95)(?=_mean_px$)", "", key)


def bar_chart(run: Part, key: str, pose: str, reference: float | None = None) -> BarChart:
    """Collect a metric's bars; `reference` is a value worth a line, in the shown unit."""
    shown_as = run.catalogue.column(key)
    panels: dict[str, dict[str, dict[str, Bar]]] = {}
    for rig, motion in product(run.rigs, run.motions):
        results = run.select(rig=rig, motion=motion, pose=pose)
        title = f"{rig}, {motion}" if len(run.motions) > 1 else rig
        groups = {
            scene: {
                method: _bar(run.select(cells, method=method), key, shown_as.scale)
                for method in run.methods
                if any(r.method == method for r in cells)
            }
            for scene in run.scenes
            if (cells := run.select(results, scene=scene))
        }
        if groups:
            panels[title] = groups
    present = {m for groups in panels.values() for bars in groups.values() for m in bars}
    methods = tuple(m for m in run.methods if m in present)
    values = [b.largest for g in panels.values() for bars in g.values() for b in bars.values() if b.largest]
    if reference is not None and not (values and 0.1 * reference < max(values)):
        reference = None  # far above all bars: a line there would press them to the floor
    return BarChart(shown_as.full_heading, shown_as.floor, reference, methods, panels)


def _bar(results: Sequence[Result], key: str, scale: float) -> Bar:
    """The bar of a method; one that shows too little of the view has not failed."""
    bar = bar_of(results, key, scale)
    return replace(bar, failure="") if key in _ON_COMMON_MATCHES and bar.failure == NO_VALUE else bar


def pair_chart(
    run: Part,
    label: str,
    titles: Mapping[str, str],
    pose: str,
    *,
    reference: float | None = None,
    bounded: Collection[str] = (),
) -> BarChart:
    """The bars of metrics of one kind side by side; `titles` names the panel of each column.

    The panels of `bounded` columns stand last and have a linear axis of their own.
    """
    labels = pair_labels(run)
    results = run.select(pose=pose)
    panels: dict[str, dict[str, dict[str, Bar]]] = {}
    for key, title in sorted(titles.items(), key=lambda item: item[0] in bounded):
        if key in run.metrics:
            scale = run.catalogue.column(key).scale
            panels[title] = {
                label: {
                    method: _bar(run.select(results, place=place, method=method), key, scale)
                    for method in run.methods
                }
                for place, label in labels.items()
                if not _is_not_to_be_had(run.select(results, place=place), key)
            }
    floor = max(run.catalogue.column(key).floor for key in titles)
    linear = tuple(titles[key] for key in bounded if titles[key] in panels)
    if len(linear) == len(panels):
        linear = ()  # no others to set them apart from
    return BarChart(label, floor, reference, run.methods, panels, linear=linear)


def _is_not_to_be_had(results: Sequence[Result], key: str) -> bool:
    """Whether a pair has no such number though nothing failed, as one without a board has no board's."""
    return all(r.ok and key not in r.metrics for r in results)
