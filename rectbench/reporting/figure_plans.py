"""Which figures a run has: what each shows, what it hangs on, how it is drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING

from rectbench.metrics.catalogue import column
from rectbench.reporting.charts.bars import BarChart, bar_chart, draw_bars, pair_chart, stage_chart
from rectbench.reporting.charts.energy_curves import draw_energy
from rectbench.reporting.charts.scatter import draw_scatter, scatter
from rectbench.reporting.charts.squares import draw_squares
from rectbench.reporting.charts.starts import draw_starts, start_study, study_method
from rectbench.reporting.figures import Plan
from rectbench.reporting.page.run_facts import stated_seconds, wanted_kinds
from rectbench.reporting.pictures.clouds import DPI, draw_clouds
from rectbench.reporting.pictures.distortion_maps import draw_distortion_maps
from rectbench.reporting.pictures.rectified import PIXELS_PER_INCH, draw_rectified
from rectbench.reporting.sources import Sources
from rectbench.reporting.tables.tabulation import methods_part, named, slug
from rectbench.runs.rows import Row
from rectbench.runs.run import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_BOUNDED = ("distortion_rescaled", "distortion_stretched")
"""Never far above 1, as every image may be shrunk: a logarithmic axis would hide a third more or less."""


def planned_figures(run: Run, sources: Sources) -> list[Plan]:
    """The figures of each part of the run that it asks for and has data for."""
    return [plan for part in run.parts for plan in _part_plans(part, run, sources)]


def _part_plans(part: Run, run: Run, sources: Sources) -> Iterator[Plan]:
    kinds = wanted_kinds(part)
    if methods := methods_part(part):
        for kind in dict.fromkeys(kinds):
            yield from _CHARTS[kind](methods) if kind in _CHARTS else ()
        for rig in methods.rigs:
            for picture in PICTURES:
                if picture.kind in kinds and (results := _representative(methods, rig)):
                    yield picture.plan(methods, sources, results)
    if "starts" in kinds:
        yield from _starts_plans(part, run)


def _bar_plans(run: Run) -> Iterator[Plan]:
    if run.group or not run.has_truth:
        yield from _pair_bar_plans(run)
        return
    if "row_error_mean_px" in run.metrics:
        for pose in run.noisy_poses:
            chart = bar_chart(run, "row_error_mean_px", pose, reference=1.0)
            caption = "Mean row error of true correspondences on each pair."
            yield _bars(run, chart, slug("row-error", pose), f"Row error, {pose} pose", caption)
    for key, caption in (
        ("log_distortion", "Log distortion on each pair: free of scale, and what methods are ranked by."),
        (
            "distortion_native",
            "The paper's distortion L on each pair, each method at its authors' own scale.",
        ),
        ("distortion_rescaled", "The same after the one scale of the image that is best for each method."),
    ):
        if key in run.metrics:
            chart = bar_chart(run, key, run.geometric_pose)
            yield _bars(run, chart, slug(key), column(key).heading.capitalize(), caption)


def _pair_bar_plans(run: Run) -> Iterator[Plan]:
    """Of a part: all ways to measure a thing side by side, its pairs along the axis."""
    row_errors = run.catalogue.panels("Row error")
    if any(key in run.metrics for key in row_errors):
        for pose in run.noisy_poses:
            chart = pair_chart(run, "row error [px]", row_errors, pose, reference=1.0)
            name = named(run, "row-error", pose if len(run.noisy_poses) > 1 else "")
            caption = "Mean row error on each pair, measured in the images" + (
                " and against the truth." if run.has_truth else "."
            )
            yield _bars(run, chart, name, f"Row error, {pose} pose", caption)
    pose = run.geometric_pose
    protocols = run.catalogue.panels("Distortion")
    if any(key in run.metrics for key in protocols):
        chart = pair_chart(run, "distortion L", protocols, pose, bounded=_BOUNDED)
        caption = "The paper's distortion L on each pair, under each protocol."
        if chart.linear:
            caption += " Rescaled and stretched have a linear axis from 0."
        yield _bars(run, chart, named(run, "distortion"), "Distortion by protocol", caption)
    if "log_distortion" in run.metrics:
        chart = pair_chart(run, "log distortion", {"log_distortion": ""}, pose)
        caption = "Log distortion on each pair: free of scale, and what methods are ranked by."
        yield _bars(run, chart, named(run, "log-distortion"), "Log distortion", caption)


def _bars(run: Run, chart: BarChart, name: str, title: str, caption: str) -> Plan:
    words = [caption]
    if chart.reference is not None:
        words.append(f"The dashed line is at {chart.reference:g} px.")
    if len({r.seed for r in run.results}) > 1:
        words.append("Bars are means over seeds, thin lines their range.")
    if run.failures:
        words.append("A cross marks a method that could not be measured there.")
    return Plan(name, "bars", title, " ".join(words), chart, lambda: draw_bars(chart), part=run.group)


def _scatter_plans(run: Run) -> Iterator[Plan]:
    coverage = next((k for k in ("coverage_solid_angle", "coverage_pixels") if k in run.metrics), None)
    measures = tuple(k for k in ("log_distortion", "distortion_rescaled") if k in run.metrics)
    if coverage and measures:
        data = scatter(run, coverage, measures)
        yield Plan(
            named(run, "distortion-coverage"),
            "scatter",
            "Distortion against coverage",
            "Small: a pair. Large: the method's mean. Best is low and to the right: little distortion, and "
            "the whole field of view kept.",
            data,
            lambda: draw_scatter(data),
            part=run.group,
        )


def _timing_plans(run: Run) -> Iterator[Plan]:
    stages = run.catalogue.panels("Time")
    if not any(key in run.metrics for key in stages):
        return
    stated = stated_seconds(run)
    if stated:
        stated["total"] = sum(stated.values())
    chart = stage_chart(run, stages, stated)
    caption = "Seconds of each stage, tables being part of the warp" + (
        "; the lines are stated, not measured here." if stated else "."
    )
    yield replace(_bars(run, chart, named(run, "timing"), "Time", caption), kind="timing")


def _starts_plans(part: Run, run: Run) -> Iterator[Plan]:
    study = start_study(part, run)
    if study:
        method = study_method(part)
        yield Plan(
            named(part, "starts"),
            "starts",
            "Random starts",
            f"Where {method} ends from random starts: its distortion L there, relative to the one from its "
            "default start. Above each pair: how many end at most 1 % above it. At the foot of the axis "
            "stand those within 10⁻⁶ of it, and those below it.",
            study,
            lambda: draw_starts(study, method),
            part=part.group,
        )


@dataclass(frozen=True)
class Picture:
    """A figure that is made once a rig, from one representative pair."""

    kind: str
    stem: str
    title: str
    caption: str
    draw: Callable[[Sources, tuple[Row, ...], Run], Figure]
    dpi: int = 160
    of_photographs: str = ""
    """The caption where the pair is photographs, if it is another one."""
    shown_as: str = "png"

    def plan(self, run: Run, sources: Sources, results: tuple[Row, ...]) -> Plan:
        """Its figure of the pair that the results are of."""
        pair = results[0]
        return Plan(
            named(run, self.stem, pair.rig),
            self.kind,
            f"{self.title}, {pair.rig}",
            f"{_pair_words(run, pair)}, {pair.pose} pose. {self._caption(run)}",
            [list(map(asdict, results)), sources.version(pair)],
            lambda: self.draw(sources, results, run),
            dpi=self.dpi,
            shown_as=self.shown_as,
            part=run.group,
        )

    def _caption(self, run: Run) -> str:
        return self.caption if run.has_truth else self.of_photographs or self.caption


def _pair_words(run: Run, pair: Row) -> str:
    """What the picture's pair is called."""
    motion = f", {pair.motion}" if run.has_truth else ""
    return f"{run.pair_source.scene_word.capitalize()} {pair.scene}, rig {pair.rig}{motion}"


_LINES = (
    "on a rectified pair both rings lie on the line, and both boxes between the dashed ones. Each pair is "
    "fitted to its panel: sizes do not compare from one method to the next."
)

PICTURES = (
    Picture(
        "pairs",
        "rectified",
        "Rectified pairs",
        f"Scan lines run through true correspondences (rings): {_LINES}",
        lambda sources, results, run: draw_rectified(sources, results, run.methods),
        dpi=PIXELS_PER_INCH,
        of_photographs="Scan lines run through matches found in the images and corners of a board, if they "
        f"show one (rings): {_LINES}",
    ),
    Picture(
        "maps",
        "distortion-map",
        "Distortion maps",
        "Native L of every pixel of both source images, one scale for all methods. The number is L over "
        "the 500 pixels that the tables measure it at.",
        lambda sources, results, run: draw_distortion_maps(sources, results, run.methods),
    ),
    Picture(
        "squares",
        "squares",
        "Unit squares",
        "Small squares of the left source image, and what each method makes of them where they land on its "
        "output; the colour is the change of area S. Each output is fitted to its panel: compare sizes by "
        "colour, not by eye.",
        lambda sources, results, run: draw_squares(sources, results, run.methods),
        shown_as="svg",
    ),
    Picture(
        "energy",
        "energy",
        "Energy about the fit",
        "L over two coefficients with the others held (the left image's Ψᵤ, and Ψᵥ of both), and over each "
        "alone, where the steepest leave the panel. A change of 100 % turns the slope at the far end of the "
        "range by the mean slope. Hatched: not convex; grey: rows or columns would change places.",
        lambda sources, results, run: draw_energy(sources, results),
        shown_as="svg",
    ),
    Picture(
        "clouds",
        "clouds",
        "Reconstruction",
        "Dense matches on the rectified pair, triangulated, in the left image's colours: the same two views "
        "of all. The one from above leaves out what is well above the cameras.",
        lambda sources, results, run: draw_clouds(sources, results, run.methods),
        dpi=DPI,
    ),
)

_CHARTS: dict[str, Callable[[Run], Iterator[Plan]]] = {
    "bars": _bar_plans,
    "scatter": _scatter_plans,
    "timing": _timing_plans,
}


def _representative(run: Run, rig: str) -> tuple[Row, ...]:
    """The results of the first pair of a rig that was measured at all."""
    pose = run.noisy_poses[0]
    candidates = run.select(rig=rig, pose=pose)
    for pair in dict.fromkeys(r.pair for r in candidates):
        results = run.select(candidates, pair=pair)
        if any(r.ok for r in results):
            return results
    return ()
