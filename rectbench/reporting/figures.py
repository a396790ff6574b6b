"""The figures of a run: which there are, what each hangs on, and drawing only those that changed."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rectbench.bench.progress import Advance
from rectbench.reporting.bars import bar_chart, draw_bars
from rectbench.reporting.columns import column
from rectbench.reporting.distortion_maps import draw_distortion_maps
from rectbench.reporting.rectified import PIXELS_PER_INCH, draw_rectified
from rectbench.reporting.run_folder import Result, Run
from rectbench.reporting.scatter import draw_scatter, scatter
from rectbench.reporting.sources import Sources
from rectbench.reporting.style import STYLE, encode
from rectbench.reporting.tabulation import slug
from rectbench.reporting.writing import write_atomically

if TYPE_CHECKING:
    from matplotlib.figure import Figure

EXTENSIONS = ("pdf", "svg", "png")
GROUPS = ("bars", "scatter", "pairs", "maps")
"""The kinds of figures; a report may ask for some of them."""


@dataclass(frozen=True)
class Plan:
    """A figure to be: its words, what it is made from, how it is drawn."""

    name: str
    group: str
    title: str
    caption: str
    made_from: Any = field(repr=False)
    draw: Callable[[], Figure] = field(repr=False)
    dpi: int = 160
    shown_as: str = "svg"

    @property
    def digest(self) -> str:
        """Changes with whatever changes the picture."""
        text = json.dumps([self.name, self.dpi, self.made_from, _code_digest()], default=repr, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()

    def path(self, extension: str) -> str:
        """Where the figure lies in the run's folder."""
        return f"figures/{self.name}.{extension}"


@dataclass(frozen=True)
class Drawn:
    """A figure on the page: drawn, or not and why, or left there by an earlier report of the folder."""

    plan: Plan
    error: str = ""
    there: bool = True


def planned_figures(run: Run, sources: Sources, groups: tuple[str, ...] = GROUPS) -> list[Plan]:
    """All figures of the run that belong to `groups` and have data."""
    return [plan for plan in _all_plans(run, sources) if plan.group in groups]


def _all_plans(run: Run, sources: Sources) -> Iterator[Plan]:
    if "row_error_mean_px" in run.metrics:
        for pose in run.noisy_poses:
            yield _bars(
                run,
                "row_error_mean_px",
                pose,
                slug("row-error", pose),
                f"Row error, {pose} pose",
                "Mean row error of true correspondences on each pair.",
                reference=1.0,
            )
    for key, caption in (
        ("log_distortion", "Log distortion on each pair: free of scale, and what methods are ranked by."),
        (
            "distortion_native",
            "The paper's distortion L on each pair, each method at its authors' own scale.",
        ),
        ("distortion_rescaled", "The same after the one scale of the image that is best for each method."),
    ):
        if key in run.metrics:
            title = column(key).heading.capitalize()
            yield _bars(run, key, run.geometric_pose, slug(key), title, caption)
    yield from _scatter_plans(run)
    yield from _pair_plans(run, sources)


def _bars(
    run: Run, key: str, pose: str, name: str, title: str, caption: str, reference: float | None = None
) -> Plan:
    chart = bar_chart(run, key, pose, reference)
    words = [caption]
    if chart.reference is not None:
        words.append(f"The dashed line is at {chart.reference:g} {column(key).unit}.")
    if len({r.seed for r in run.results}) > 1:
        words.append("Bars are means over seeds, thin lines their range.")
    if run.failures:
        words.append("A cross marks a method that could not be measured there.")
    return Plan(name, "bars", title, " ".join(words), chart, lambda: draw_bars(chart))


def _scatter_plans(run: Run) -> Iterator[Plan]:
    coverage = next((k for k in ("coverage_solid_angle", "coverage_pixels") if k in run.metrics), None)
    measures = tuple(k for k in ("log_distortion", "distortion_rescaled") if k in run.metrics)
    if coverage and measures:
        data = scatter(run, coverage, measures)
        yield Plan(
            "distortion-coverage",
            "scatter",
            "Distortion against coverage",
            "Small: a pair. Large: the method's mean. Best is low and to the right: little distortion, and "
            "the whole field of view kept.",
            data,
            lambda: draw_scatter(data),
        )


def _pair_plans(run: Run, sources: Sources) -> Iterator[Plan]:
    """One representative pair a rig: the first scene that was measured at all."""
    for rig in run.rigs:
        results = _representative(run, rig)
        if not results:
            continue
        first = results[0]
        made_from = [[dict(r.row) for r in results], sources.version(first)]
        where = f"Scene {first.scene}, rig {rig}, {first.motion}, {first.pose} pose"
        yield Plan(
            slug("rectified", rig),
            "pairs",
            f"Rectified pairs, {rig}",
            f"{where}. Scan lines run through true correspondences (rings): on a rectified pair both rings "
            "lie on the line.",
            made_from,
            lambda results=results: draw_rectified(sources, results, run.methods),  # type: ignore[misc]
            dpi=PIXELS_PER_INCH,
            shown_as="png",
        )
        yield Plan(
            slug("distortion-map", rig),
            "maps",
            f"Distortion maps, {rig}",
            f"{where}. Native L of every pixel of both source images, one scale for all methods.",
            made_from,
            lambda results=results: draw_distortion_maps(sources, results, run.methods),  # type: ignore[misc]
            shown_as="png",
        )


def _representative(run: Run, rig: str) -> tuple[Result, ...]:
    pose = run.noisy_poses[0]
    candidates = run.select(rig=rig, pose=pose)
    for pair in dict.fromkeys(r.pair for r in candidates):
        results = run.select(candidates, pair=pair)
        if any(r.ok for r in results):
            return results
    return ()


def draw_changed(
    run: Run, plans: list[Plan], known: Mapping[str, str], advance: Advance
) -> tuple[list[Drawn], dict[str, str]]:
    """Draw the plans whose digest is not the `known` one, or whose files are gone.

    Returns what the page shows and the digests of what is drawn now. Where a figure cannot be drawn,
    an earlier one stays, and it is tried again next time. `advance` is called after each.
    """
    drawn, digests = [], {}
    for plan in plans:
        digest, error = plan.digest, ""
        there = all((run.folder / plan.path(extension)).is_file() for extension in EXTENSIONS)
        if known.get(plan.name) != digest or not there:
            try:
                _draw(run.folder, plan)
                there = True
            except Exception as failure:  # a lost image must not cost the tables and the other figures
                error = " ".join(f"{type(failure).__name__}: {failure}".split())
        if not error:
            digests[plan.name] = digest
        drawn.append(Drawn(plan, error, there))
        advance()
    return drawn, digests


def _draw(folder: Path, plan: Plan) -> None:
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()  # a user's own matplotlibrc changes nothing here
        matplotlib.rcParams.update(STYLE)
        figure = plan.draw()
        if figure.get_layout_engine() is not None:
            figure.draw_without_rendering()
            figure.set_layout_engine(None)  # laid out once, not again for each file
        for extension in EXTENSIONS:
            write_atomically(folder / plan.path(extension), encode(figure, extension, plan.dpi))


@cache
def _code_digest() -> str:
    """The code that draws, and the version of matplotlib."""
    digest = hashlib.sha256(importlib.metadata.version("matplotlib").encode())
    for file in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(file.read_bytes())
    return digest.hexdigest()
