"""A report becomes a plan: every name looked up and every option checked before anything runs."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from rectbench.errors import InvalidInput
from rectbench.experiments.naming import plugins_named, require_known
from rectbench.experiments.pair_sources import PairName, PairSource, StatedPart
from rectbench.experiments.spec import REPORTS, Report
from rectbench.experiments.tasks import CellTask
from rectbench.metrics.scoring import metrics_of, needs_of
from rectbench.pairs.finding.photographs import Photographs
from rectbench.pairs.spec import ESTIMATED, PairSpec
from rectbench.plugins.cell import Cell
from rectbench.plugins.figure import FIGURES, usual_figures
from rectbench.plugins.fitting import checked_options
from rectbench.plugins.rectifier import METHODS, Rectifier
from rectbench.plugins.result import distinct
from rectbench.registry import Plugin, registry
from rectbench.rigs.poses import POSES
from rectbench.store.keys import canonical_json


@dataclass(frozen=True)
class Selection:
    """What to run of a report, and with which options; None runs all it names.

    A "+" before a name adds it to the report's own, in whose place the others stand.
    """

    methods: Sequence[str] | None = None
    scenes: Sequence[str] | None = None
    rigs: Sequence[str] | None = None
    seeds: Sequence[int] | None = None
    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """By method; laid over the report's own."""

    def __post_init__(self) -> None:
        for name in ("methods", "scenes", "rigs"):
            if isinstance(given := getattr(self, name), str):  # a list of one, not of its letters
                object.__setattr__(self, name, (given,))


OwnNames = Mapping[str, tuple[Any, ...]]
"""What a report itself names over all its parts, by kind: methods, scenes, rigs and seeds."""


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
    UnknownName or InvalidInput for a name or option that does not exist, and for a folder without pairs.
    """
    chosen = selection or Selection()
    source = report.pair_source.located(report.name, data)
    if source.has_truth:
        require_known("pose", report.poses, (*POSES, ESTIMATED))
    own = _own_names(source.parts)
    tasks: dict[Cell, CellTask] = {}
    for part in source.parts:
        for task in _tasks_of(part, source, report, own, chosen):
            rival = tasks.setdefault(task.cell, task)
            if rival is not task:
                cell = f"{task.cell.method} on {task.cell.scene}, {task.cell.rig}"
                raise InvalidInput(f"{cell} stands in two groups, {rival.group} and {part.name}")
    if not tasks:
        raise InvalidInput(f"no cell of report {report.name} is selected; expected some of its names")
    stated = [name for part in source.parts for name in part.options]
    _check_option_names((*stated, *chosen.options), {cell.method for cell in tasks})
    is_whole = not chosen.options and all(
        set(names) <= set(_chosen_names(getattr(chosen, kind), names)) for kind, names in own.items()
    )
    return Plan(report, chosen, tuple(_sharing_pairs(tasks.values())), is_whole, source.found)


def _own_names(parts: Sequence[StatedPart]) -> OwnNames:
    pairs = [pair for part in parts for pair in part.pairs]
    return {
        "methods": distinct(name for part in parts for name in part.methods),
        "scenes": distinct(scene for scene, _, _ in pairs),
        "rigs": distinct(rig for _, rig, _ in pairs),
        "seeds": distinct(seed for part in parts for seed in part.seeds),
    }


def _tasks_of(
    part: StatedPart, source: PairSource, report: Report, own: OwnNames, chosen: Selection
) -> Iterator[CellTask]:
    """The cells of one part of a report, pair by pair."""
    names = _chosen_methods(part, own, chosen)
    if not names:
        return
    methods = plugins_named(METHODS, names)
    option_sets = _option_sets(part.options, chosen, [plugin for plugin, _ in methods])
    needs = frozenset().union(*(plugin.value.needs for plugin, _ in methods))
    metrics = metrics_of(part.metrics)
    measuring = needs_of(part.metrics)
    for metric in metrics.values():
        if "truth" in metric.value.needs and not source.has_truth:
            raise InvalidInput(f"metric {metric.name} needs the truth, which photographs have not")
    chosen_part = replace(
        part,
        pairs=_chosen_pairs(part, source, own, chosen),
        seeds=_chosen_seeds(part, own, chosen),
        needs_images=part.needs_images or "images" in needs | measuring | _figure_needs(part),
        needs_truth="matches" in needs or "truth" in measuring,
    )
    for pair in source.specs(chosen_part):
        for pose, (method, method_source) in itertools.product(report.poses, methods):
            for options in option_sets[method.name]:
                cell = Cell(
                    report=report.name,
                    scene=pair.scene,
                    rig=pair.rig,
                    motion=pair.motion,
                    pose=pose,
                    method=method.name,
                    options=canonical_json(options),
                    seed=pair.seed,
                )
                yield CellTask(
                    cell=cell,
                    pair=pair,
                    method_source=method_source,
                    options=options,
                    metrics=tuple(metrics),
                    match_count=report.match_count,
                    match_noise_px=report.match_noise_px,
                    group=part.name,
                    alone=part.alone,
                )


def _sharing_pairs(tasks: Collection[CellTask]) -> Iterator[CellTask]:
    """The tasks, those of different parts on one pair sharing one task for it, so that it is made once."""
    demands: dict[PairSpec, set[str]] = defaultdict(set)
    for task in tasks:
        demands[task.pair.demanding(())] |= task.pair.demands
    for task in tasks:
        yield task.model_copy(update={"pair": task.pair.demanding(demands[task.pair.demanding(())])})


def _chosen_names(chosen: Sequence[Any] | None, own: Sequence[Any]) -> list[Any]:
    """What is run in the place of a report's `own` names; a "+" before a name adds it to them."""
    if chosen is None:
        return list(own)
    added = [name[1:] for name in chosen if isinstance(name, str) and name.startswith("+")]
    instead = [name for name in chosen if not (isinstance(name, str) and name.startswith("+"))]
    return [*(instead or (own if added else ())), *added]


def _figure_needs(part: StatedPart) -> frozenset[str]:
    """What the figures of a part need; raises UnknownName or InvalidInput for one that does not exist."""
    names = usual_figures() if part.figures is None else part.figures
    return frozenset().union(*(registry(FIGURES).get(name).value.needs for name in names))


def _chosen_methods(part: StatedPart, own: OwnNames, chosen: Selection) -> list[str]:
    """The methods of a part that a run is to have: its own, and those that no part has."""
    names = _chosen_names(chosen.methods, own["methods"])
    foreign = [name for name in names if name not in own["methods"]]
    return [*(name for name in part.methods if name in names), *(foreign if part.is_open else ())]


def _chosen_pairs(
    part: StatedPart, source: PairSource, own: OwnNames, chosen: Selection
) -> tuple[PairName, ...]:
    """The pairs of a part that a run is to have, in the part's order."""
    pairs = part.pairs
    for place, kind in enumerate(("scenes", "rigs")):
        its_own = own[kind]
        names = _chosen_names(getattr(chosen, kind), its_own)
        if not names:
            raise InvalidInput(f"no {kind} are selected; expected at least one")
        if not source.takes_foreign_names:
            require_known(kind.removesuffix("s"), names, its_own)
        foreign = [name for name in names if name not in its_own]
        kept = [pair for pair in pairs if pair[place] in names]
        # A name of the user's own takes the place of each of the part's.
        added = [_with(pair, place, name) for pair in pairs for name in foreign]
        pairs = tuple(dict.fromkeys([*kept, *added]))
    return pairs


def _with(pair: PairName, place: int, name: str) -> PairName:
    scene, rig, motion = (name if i == place else own for i, own in enumerate(pair))
    return scene, rig, motion


def _chosen_seeds(part: StatedPart, own: OwnNames, chosen: Selection) -> tuple[int, ...]:
    """The seeds of a part that a run is to have: its own, and those that no part has."""
    seeds = _chosen_names(chosen.seeds, own["seeds"])
    for seed in seeds:
        if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
            raise InvalidInput(f"seed is {seed!r}; expected a whole number from 0 on")
    if not seeds:
        raise InvalidInput("no seeds are selected; expected at least one")
    return tuple(dict.fromkeys(seed for seed in seeds if seed in part.seeds or seed not in own["seeds"]))


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
