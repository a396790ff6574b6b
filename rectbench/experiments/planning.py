"""A report becomes a plan: every name looked up and every option checked before anything runs."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rectbench.errors import InvalidInput, argument
from rectbench.experiments.naming import plugins_named
from rectbench.experiments.pair_sources import PairSource, StatedPart
from rectbench.experiments.selecting import OwnNames, Selection, own_names, selected, selects_all
from rectbench.experiments.spec import REPORTS, Report
from rectbench.experiments.tasks import CellTask
from rectbench.margin import checked_margin
from rectbench.matching import matcher_named
from rectbench.metrics.scoring import metrics_of, needs_of
from rectbench.pairs.finding.photographs import Photographs
from rectbench.pairs.spec import ESTIMATED, PairSpec
from rectbench.plugins.cell import Cell
from rectbench.plugins.figure import FIGURES, usual_figures
from rectbench.plugins.fitting import checked_options
from rectbench.plugins.matches import FROM_IMAGES
from rectbench.plugins.metric import Metric
from rectbench.plugins.rectifier import METHODS, Rectifier
from rectbench.registry import Plugin, registry
from rectbench.store.keys import canonical_json


@dataclass(frozen=True)
class Plan:
    """The cells of a report in the order of its table."""

    report: Report
    selection: Selection
    tasks: tuple[CellTask, ...]
    is_whole: bool
    """Whether every cell of the report is in the plan, under the report's own options."""
    photographs: Photographs | None = None
    """What was found in the folder, for a report of photographs."""

    @property
    def pairs(self) -> tuple[PairSpec, ...]:
        """The pairs the cells stand on, each once."""
        return tuple(dict.fromkeys(task.pair for task in self.tasks))


def find_report(report: Report | str | Path) -> Report:
    """A report by name, by path, or as it is."""
    return report if isinstance(report, Report) else registry(REPORTS).get(report).value


def make_plan(report: Report, selection: Selection | None = None, data: str | Path | None = None) -> Plan:
    """The cells of a report, or of the selected part of it.

    A selected name need not be one of the report's: `methods=["mine.py"]` runs a method of one's own
    on the report's pairs. `data` is the folder that a report of photographs takes them from. Raises
    UnknownName or InvalidInput for a name or option that does not exist, for what the pairs of a part have
    not, and for a folder without pairs.
    """
    chosen = selection or Selection()
    if chosen.margin_deg is not None:
        report = report.model_copy(update={"margin_deg": checked_margin(chosen.margin_deg)})
    matcher_named(report.matcher)  # a wrong name is told before anything runs
    sources = [source.located(report.name, data) for source in report.sources]
    if chosen.scenes is not None and not any("scenes" in source.selects for source in sources):
        lenses = f"report {report.name} is of lenses without a scene"
        raise InvalidInput(f"{lenses}; expected no {argument('scenes')}")
    own = [own_names(source, sources) for source in sources]
    tasks: dict[Cell, CellTask] = {}
    for source, names in zip(sources, own, strict=True):
        for task in _tasks_of(source, report, names, chosen):
            rival = tasks.setdefault(task.cell, task)
            if rival is not task:
                cell = f"{task.cell.method} on {task.cell.scene}, {task.cell.rig}"
                raise InvalidInput(f"{cell} stands in two groups, {rival.group} and {source.part.name}")
    if not tasks:
        raise InvalidInput(f"no cell of report {report.name} is selected; expected some of its names")
    stated = [name for source in sources for name in source.part.options]
    _check_option_names((*stated, *chosen.options), {cell.method for cell in tasks})
    is_whole = all(selects_all(chosen, names) for names in own)
    found = next((source.found for source in sources), None)
    return Plan(report, chosen, tuple(_sharing_pairs(tasks.values())), is_whole, found)


def _tasks_of(source: PairSource, report: Report, own: OwnNames, chosen: Selection) -> Iterator[CellTask]:
    """The cells of one part of a report, pair by pair."""
    part = selected(source, own, chosen)
    source.require_poses()
    methods = _servable(part, source)
    if not methods:
        return
    option_sets = _option_sets(part.options, chosen, [plugin for plugin, _ in methods])
    levels = {plugin.name: source.match_levels(plugin.value.needs) for plugin, _ in methods}
    metrics = tuple(_measurable(part, source))
    demanding = _demanding(part, source, levels, [plugin.value for plugin, _ in methods])
    for pair in (_with_view(spec, report) for spec in source.specs(demanding)):
        for pose, (method, method_source) in itertools.product(part.poses, methods):
            for matches, options in itertools.product(levels[method.name], option_sets[method.name]):
                if not source.has_cell(part, pair.seed, pose, matches):
                    continue
                cell = Cell(
                    report=report.name,
                    scene=pair.scene,
                    rig=pair.rig,
                    motion=pair.motion,
                    pose=pose,
                    matches=matches,
                    method=method.name,
                    options=canonical_json(options),
                    seed=pair.seed,
                )
                yield CellTask(
                    cell=cell,
                    pair=pair,
                    method_source=method_source,
                    options=options,
                    metrics=metrics,
                    match_count=report.match_count,
                    matcher=report.matcher,
                    group=part.name,
                    alone=part.alone,
                )


def _with_view(spec: PairSpec, report: Report) -> PairSpec:
    """The pair with the part of its view that the report looks at."""
    seen: dict[str, float] = {}
    if report.margin_deg is not None:
        seen["margin_deg"] = report.margin_deg
    if spec.rig in report.max_angle_deg:
        seen["max_angle_deg"] = report.max_angle_deg[spec.rig]
    return spec.model_copy(update=seen)


def _servable(part: StatedPart, source: PairSource) -> list[tuple[Plugin[Rectifier], str]]:
    """The methods of a part, with what finds each again.

    One that the run adds and that needs what the pairs have not is left out; raises InvalidInput for one of
    the report's own.
    """
    stated = plugins_named(METHODS, [name for name in part.methods if name in source.part.methods])
    for plugin, _ in stated:
        if lacking := source.lacks(plugin.value.needs):
            raise InvalidInput(f"method {plugin.name} needs {lacking}")
    named = plugins_named(METHODS, part.methods)
    return [(plugin, origin) for plugin, origin in named if not source.lacks(plugin.value.needs)]


def _measurable(part: StatedPart, source: PairSource) -> dict[str, Plugin[Metric]]:
    """The metrics of a part; raises InvalidInput for one that needs what its pairs have not."""
    metrics = metrics_of(part.metrics)
    for plugin in metrics.values():
        if lacking := source.lacks(plugin.value.needs):
            raise InvalidInput(f"metric {plugin.name} needs {lacking}")
    return metrics


def _demanding(
    part: StatedPart, source: PairSource, levels: Mapping[str, tuple[str, ...]], methods: list[Rectifier]
) -> StatedPart:
    """The part with all that is asked of its pairs.

    Raises UnknownName for a figure that does not exist, InvalidInput for one that its pairs cannot serve.
    """
    names = usual_figures(source.offers) if part.figures is None else part.figures
    figures = [registry(FIGURES).get(name) for name in names]
    for plugin in figures:
        if lacking := source.lacks(plugin.value.needs):
            raise InvalidInput(f"figure {plugin.name} needs {lacking}")
    needs = needs_of(part.metrics).union(*(method.needs for method in methods))
    needs = needs.union(*(plugin.value.needs for plugin in figures))
    all_levels = set().union(*levels.values())
    return replace(
        part,
        needs_images=ESTIMATED in part.poses or FROM_IMAGES in all_levels or "images" in needs,
        needs_truth=bool(needs & {"truth", "true_matches"} or all_levels - {"", FROM_IMAGES}),
    )


def _sharing_pairs(tasks: Collection[CellTask]) -> Iterator[CellTask]:
    """The tasks, those of different parts on one pair sharing one task for it, so that it is made once."""
    demands: dict[PairSpec, set[str]] = defaultdict(set)
    for task in tasks:
        demands[task.pair.demanding(())] |= task.pair.demands
    for task in tasks:
        yield task.model_copy(update={"pair": task.pair.demanding(demands[task.pair.demanding(())])})


def _check_option_names(stated: Sequence[str], methods: set[str]) -> None:
    """An option for a method that is left out of this run may stand; one for no method is a slip."""
    for name in dict.fromkeys(stated):
        if name not in methods:
            registry(METHODS).get(name)


def _option_sets(
    own: Mapping[str, tuple[dict[str, Any], ...]], chosen: Selection, methods: list[Plugin[Rectifier]]
) -> dict[str, list[dict[str, Any]]]:
    """The sets of options each method runs with, checked; the default ones where none are given."""
    sets = {}
    for plugin in methods:
        overlaid = chosen.options.get(plugin.name, {})
        given = [{**options, **overlaid} for options in own.get(plugin.name, ({},))]
        for options in given:
            checked_options(plugin, options)
        sets[plugin.name] = [options for i, options in enumerate(given) if options not in given[:i]]
    return sets
