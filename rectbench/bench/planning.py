"""A report becomes a plan: every name looked up and every option checked before anything runs."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from rectbench.bench.keys import canonical_json
from rectbench.bench.plugins import Plugin, is_path, registry
from rectbench.bench.rectifying import checked_options
from rectbench.bench.report_spec import Report
from rectbench.errors import InvalidInput, UnknownName
from rectbench.rigs import load_rig, rig_names
from rectbench.rigs.motions import MOTIONS
from rectbench.rigs.poses import POSES

IDENTITY = ("report", "scene", "rig", "motion", "pose", "method", "options", "seed")
"""The columns that say which cell a row is; `status` and `reason` follow, then the metrics."""


@dataclass(frozen=True)
class Cell:
    """Which cell of which report: what its row and its random numbers are named after."""

    report: str
    scene: str
    rig: str
    motion: str
    pose: str
    method: str
    options: str
    """The options given, as canonical JSON; "{}" where all are the method's own."""
    seed: int


@dataclass(frozen=True)
class PairTask:
    """A pair of images and its truth: a rig that stands in a scene."""

    scene: str
    rig: str
    motion: str
    seed: int
    scene_source: str
    """The scene's name, or the absolute path of its file."""
    rig_source: str
    image_width: int | None
    quality: str
    spp: int
    truth: bool
    """Whether anything asks for the truth."""
    images: bool
    """Whether anything asks for the rendered images."""


@dataclass(frozen=True)
class CellTask:
    """All that a process needs to know to run one cell, as plain values."""

    cell: Cell
    pair: PairTask
    method_source: str
    options: dict[str, Any]
    metrics: tuple[str, ...]
    match_count: int
    match_noise_px: float

    def to_json(self) -> dict[str, Any]:
        """As JSON values."""
        return asdict(self)

    @staticmethod
    def from_json(values: Mapping[str, Any]) -> CellTask:
        """The task that `to_json` wrote."""
        return CellTask(
            **{
                **values,
                "cell": Cell(**values["cell"]),
                "pair": PairTask(**values["pair"]),
                "metrics": tuple(values["metrics"]),
            }
        )


@dataclass(frozen=True)
class Selection:
    """What to run of a report, and with which options; None runs all it names."""

    methods: Sequence[str] | None = None
    scenes: Sequence[str] | None = None
    rigs: Sequence[str] | None = None
    seeds: Sequence[int] | None = None
    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """By method; laid over the report's own."""


@dataclass(frozen=True)
class Plan:
    """The cells of a report in the order of its table."""

    report: Report
    selection: Selection
    tasks: tuple[CellTask, ...]

    @property
    def is_whole(self) -> bool:
        """Whether every cell of the report is in the plan."""
        dimensions = ("methods", "scenes", "rigs", "seeds")
        return not self.selection.options and all(
            set(getattr(self.report, name))
            <= set(chosen_names(getattr(self.selection, name), getattr(self.report, name)))
            for name in dimensions
        )

    @property
    def pairs(self) -> tuple[PairTask, ...]:
        """The pairs the cells stand on, each once."""
        return tuple(dict.fromkeys(task.pair for task in self.tasks))


def chosen_names(chosen: Sequence[Any] | None, own: Sequence[Any]) -> list[Any]:
    """What is run in the place of a report's `own` names; a "+" before a name adds it to them."""
    if chosen is None:
        return list(own)
    if isinstance(chosen, str):  # one name is a list of one, not of its letters
        chosen = [chosen]
    added = [name[1:] for name in chosen if isinstance(name, str) and name.startswith("+")]
    instead = [name for name in chosen if not (isinstance(name, str) and name.startswith("+"))]
    return [*(instead or (own if added else ())), *added]


def find_report(report: Report | str | Path) -> Report:
    """A report by name, by path, or as it is."""
    if isinstance(report, Report):
        return report
    found: Report = registry("reports").get(report).value
    return found


def make_plan(report: Report, selection: Selection | None = None) -> Plan:
    """The cells of a report, or of the selected part of it.

    A selected name need not be one of the report's: `methods=["mine.py"]` runs a method of one's own
    on the report's pairs. Raises UnknownName or InvalidInput for a name or option that does not exist.
    """
    chosen = selection or Selection()
    methods = _plugins("methods", chosen.methods, report.methods)
    scenes = _plugins("scenes", chosen.scenes, report.scenes)
    rigs = _rigs(chosen.rigs, report.rigs)
    _require_known("motion", report.motions, MOTIONS)
    _require_known("pose", report.poses, POSES)
    option_sets = _option_sets(report, chosen, [plugin for plugin, _ in methods])
    images = report.needs_images or any("images" in plugin.value.needs for plugin, _ in methods)
    truth = "row_error" in report.metrics or any("matches" in plugin.value.needs for plugin, _ in methods)
    tasks = []
    for (scene, scene_source), (rig, rig_source), motion, seed in itertools.product(
        scenes, rigs.items(), report.motions, _seeds(chosen.seeds, report.seeds)
    ):
        pair = PairTask(
            scene=scene.name,
            rig=rig,
            motion=motion,
            seed=seed,
            scene_source=scene_source,
            rig_source=rig_source,
            image_width=report.image_width,
            quality=report.quality,
            spp=report.spp,
            truth=truth,
            images=images,
        )
        for pose, (method, method_source) in itertools.product(report.poses, methods):
            tasks += [
                CellTask(
                    cell=Cell(
                        report.name, scene.name, rig, motion, pose, method.name, canonical_json(options), seed
                    ),
                    pair=pair,
                    method_source=method_source,
                    options=options,
                    metrics=report.metrics,
                    match_count=report.match_count,
                    match_noise_px=report.match_noise_px,
                )
                for options in option_sets[method.name]
            ]
    return Plan(report, chosen, tuple(tasks))


def _plugins(kind: Any, chosen: Sequence[str] | None, own: Sequence[str]) -> list[tuple[Plugin, str]]:
    """Each plugin with what it is found by in another process: its name, or its absolute path."""
    found = [(registry(kind).get(name), _source(name)) for name in chosen_names(chosen, own)]
    if not found:
        raise InvalidInput(f"no {kind} are selected; expected at least one")
    by_name: dict[str, tuple[Plugin, str]] = {}
    for plugin, source in found:
        rival, _ = by_name.setdefault(plugin.name, (plugin, source))
        if rival.path != plugin.path:
            raise InvalidInput(f"two {kind} are called '{plugin.name}': {rival.path} and {plugin.path}")
    return list(by_name.values())


def _rigs(chosen: Sequence[str] | None, own: Sequence[str]) -> dict[str, str]:
    """Where each rig is found, by the rig's name."""
    names = chosen_names(chosen, own)
    if not names:
        raise InvalidInput("no rigs are selected; expected at least one")
    sources: dict[str, str] = {}
    for name in names:
        rig = load_rig(name).name
        source = name if name in rig_names() else str(Path(name).resolve())
        if sources.setdefault(rig, source) != source:
            raise InvalidInput(f"two rigs are called '{rig}': {sources[rig]} and {source}")
    return sources


def _source(name: str | Path) -> str:
    """What finds a plugin in a process that stands in another folder."""
    return str(Path(name).resolve()) if is_path(name) else str(name)


def _seeds(chosen: Sequence[int] | None, own: Sequence[int]) -> tuple[int, ...]:
    seeds = chosen_names(chosen, own)
    for seed in seeds:
        if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
            raise InvalidInput(f"seed is {seed!r}; expected a whole number from 0 on")
    if not seeds:
        raise InvalidInput("no seeds are selected; expected at least one")
    return tuple(dict.fromkeys(seeds))


def _require_known(kind: str, names: Iterable[str], known: Iterable[str]) -> None:
    for name in names:
        if name not in known:
            raise UnknownName(kind, name, known)


def _option_sets(report: Report, chosen: Selection, methods: list[Plugin]) -> dict[str, list[dict[str, Any]]]:
    """The sets of options each method runs with, checked; the default ones where none are given."""
    for name in {**report.options, **chosen.options}:
        # An option for a method that is left out of this run may stand; one for no method is a slip.
        if name not in {plugin.name for plugin in methods}:
            registry("methods").get(name)
    sets = {}
    for plugin in methods:
        overlaid = chosen.options.get(plugin.name, {})
        given = [{**own, **overlaid} for own in report.options.get(plugin.name, ({},))]
        for options in given:
            checked_options(plugin, options)
        sets[plugin.name] = [options for i, options in enumerate(given) if options not in given[:i]]
    return sets
