"""A report becomes a plan: every name looked up and every option checked before anything runs."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from rectbench.calibrations import load_rig, rig_names
from rectbench.errors import InvalidInput, UnknownName
from rectbench.experiments.spec import ESTIMATED, REPORTS, Group, PairName, Report
from rectbench.experiments.tasks import Cell, CellTask
from rectbench.metrics.scoring import metrics_of
from rectbench.pairs.finding.photographs import Photographs, find_photographs
from rectbench.pairs.spec import AS_CALIBRATED, PairSpec, PhotographedSpec, RenderedSpec
from rectbench.plugins.fitting import checked_options
from rectbench.plugins.rectifier import METHODS, Rectifier
from rectbench.plugins.scene import SCENES
from rectbench.registry import Kind, Plugin, is_path, registry
from rectbench.rigs.motions import MOTIONS
from rectbench.rigs.poses import POSES
from rectbench.store.keys import canonical_json

T = TypeVar("T")


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
    photographs: Photographs | None = None
    """What was found in the folder, for a report of photographs."""

    @property
    def is_whole(self) -> bool:
        """Whether every cell of the report is in the plan."""
        own = {**self.report.own_names, "seeds": self.report.all_seeds}
        return not self.selection.options and all(
            set(names) <= set(chosen_names(getattr(self.selection, dimension), names))
            for dimension, names in own.items()
        )

    @property
    def pairs(self) -> tuple[PairSpec, ...]:
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
    found: Report = registry(REPORTS).get(report).value
    return found


def make_plan(report: Report, selection: Selection | None = None, data: str | Path | None = None) -> Plan:
    """The cells of a report, or of the selected part of it.

    A selected name need not be one of the report's: `methods=["mine.py"]` runs a method of one's own
    on the report's pairs. `data` is the folder that a report of photographs takes them from. Raises
    UnknownName or InvalidInput for a name or option that does not exist, and for a folder without pairs.
    """
    chosen = selection or Selection()
    photographs = _photographs(report, data)
    if photographs is not None:
        report = report.model_copy(update={"pairs": tuple(_pair_names(photographs))})
        for kind in ("scenes", "rigs"):
            own = report.own_names[kind]
            _require_known(kind[:-1], chosen_names(getattr(chosen, kind), own), own)
    else:
        _require_known("pose", report.poses, (*POSES, ESTIMATED))
    tasks: dict[Cell, CellTask] = {}
    for part in report.parts:
        for task in _tasks_of(part, report, chosen, photographs):
            rival = tasks.setdefault(task.cell, task)
            if rival is not task:
                cell = f"{task.cell.method} on {task.cell.scene}, {task.cell.rig}"
                raise InvalidInput(f"{cell} stands in two groups, {rival.group} and {part.name}")
    if not tasks:
        raise InvalidInput(f"no cell of report {report.name} is selected; expected some of its names")
    _check_option_names(report, chosen, {cell.method for cell in tasks})
    return Plan(report, chosen, tuple(_sharing_pairs(tasks.values())), photographs)


def _photographs(report: Report, data: str | Path | None) -> Photographs | None:
    if report.photographs == (data is not None):
        return None if data is None else find_photographs(data)
    expected = "a folder of them, --data FOLDER" if report.photographs else "no --data"
    takes = "takes photographs" if report.photographs else "renders its pairs"
    raise InvalidInput(f"report {report.name} {takes}; expected {expected}")


def _pair_names(photographs: Photographs) -> Iterator[PairName]:
    for pair in photographs.pairs:
        yield pair.name, pair.calibration.name, AS_CALIBRATED


def _tasks_of(
    part: Group, report: Report, chosen: Selection, photographs: Photographs | None
) -> Iterator[CellTask]:
    """The cells of one part of a report, pair by pair."""
    names = _chosen_methods(part, report, chosen)
    if not names:
        return
    methods = _plugins(METHODS, names)
    option_sets = _option_sets({**report.options, **part.options}, chosen, [plugin for plugin, _ in methods])
    needs = frozenset().union(*(plugin.value.needs for plugin, _ in methods))
    pairs = _chosen_pairs(part, report, chosen)
    seeds = _chosen_seeds(part, report, chosen)
    images_wanted = report.needs_images(part) or "images" in needs
    truth_wanted = report.needs_truth(part) or "matches" in needs
    made: Iterator[PairSpec]
    if photographs is None:
        made = _rendered(pairs, seeds, report, part, truth=truth_wanted, images=images_wanted)
    else:
        made = _photographed(pairs, seeds, photographs)
    for pair in made:
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
                    metrics=tuple(metrics_of(report.metrics_of(part))),
                    match_count=report.match_count,
                    match_noise_px=report.match_noise_px,
                    group=part.name,
                    alone=part.alone,
                )


def _rendered(
    pairs: list[PairName], seeds: Sequence[int], report: Report, part: Group, *, truth: bool, images: bool
) -> Iterator[RenderedSpec]:
    """The pairs of a part that are rendered: each rig in its scene."""
    scenes = {name: _plugins(SCENES, [name])[0] for name in dict.fromkeys(scene for scene, _, _ in pairs)}
    rigs = _rigs(dict.fromkeys(rig for _, rig, _ in pairs))
    _require_known("motion", [motion for _, _, motion in pairs], MOTIONS)
    for (scene, rig, motion), seed in itertools.product(pairs, seeds):
        plugin, scene_source = scenes[scene]
        rig_name, rig_source = rigs[rig]
        yield RenderedSpec(
            scene=plugin.name,
            rig=rig_name,
            motion=motion,
            seed=seed,
            scene_source=scene_source,
            rig_source=rig_source,
            image_width=report.image_width_of(part),
            quality=report.quality,
            spp=report.spp,
            truth=truth,
            images=images,
        )


def _photographed(
    pairs: list[PairName], seeds: Sequence[int], photographs: Photographs
) -> Iterator[PhotographedSpec]:
    """The pairs that were found in a folder."""
    found = {(pair.name, pair.calibration.name): pair for pair in photographs.pairs}
    for (scene, rig, motion), seed in itertools.product(pairs, seeds):
        pair = found[scene, rig]
        calibration = pair.calibration
        yield PhotographedSpec(
            scene=scene,
            rig=rig,
            motion=motion,
            seed=seed,
            left=str(pair.left),
            right=str(pair.right),
            calibration=tuple(map(str, calibration.files)),
            size=calibration.size,
            unit=calibration.unit,
            max_angle_deg=calibration.max_angle_deg,
            cameras=calibration.cameras,
        )


def _sharing_pairs(tasks: Collection[CellTask]) -> Iterator[CellTask]:
    """The tasks, those of different parts on one pair sharing one task for it, so that it is made once."""
    wanted: dict[RenderedSpec, RenderedSpec] = {}
    for pair in (task.pair for task in tasks):
        if isinstance(pair, RenderedSpec):
            bare = pair.model_copy(update={"truth": False, "images": False})
            known = wanted.get(bare, bare)
            wanted[bare] = bare.model_copy(
                update={"truth": pair.truth or known.truth, "images": pair.images or known.images}
            )
    for task in tasks:
        pair = task.pair
        if isinstance(pair, RenderedSpec):
            pair = wanted[pair.model_copy(update={"truth": False, "images": False})]
        yield task.model_copy(update={"pair": pair})


def _chosen_methods(part: Group, report: Report, chosen: Selection) -> list[str]:
    """The methods of a part that a run is to have: its own, and those that no part has."""
    own = report.own_names["methods"]
    names = chosen_names(chosen.methods, own)
    foreign = [name for name in names if name not in own]
    return [*(name for name in part.methods if name in names), *(foreign if part.is_open else ())]


def _chosen_pairs(part: Group, report: Report, chosen: Selection) -> list[PairName]:
    """The pairs of a part that a run is to have, in the part's order."""
    pairs = list(part.pairs)
    for place, kind in enumerate(("scenes", "rigs")):
        own = report.own_names[kind]
        names = chosen_names(getattr(chosen, kind), own)
        if not names:
            raise InvalidInput(f"no {kind} are selected; expected at least one")
        foreign = [name for name in names if name not in own]
        kept = [pair for pair in pairs if pair[place] in names]
        # A name of the user's own takes the place of each of the part's.
        added = [_with(pair, place, name) for pair in pairs for name in foreign]
        pairs = list(dict.fromkeys([*kept, *added]))
    return pairs


def _with(pair: PairName, place: int, name: str) -> PairName:
    scene, rig, motion = (name if i == place else own for i, own in enumerate(pair))
    return scene, rig, motion


def _plugins(kind: Kind[T], names: Sequence[str]) -> list[tuple[Plugin[T], str]]:
    """Each plugin with what it is found by in another process: its name, or its absolute path."""
    found = [(registry(kind).get(name), _source(name)) for name in names]
    by_name: dict[str, tuple[Plugin[T], str]] = {}
    for plugin, source in found:
        rival, _ = by_name.setdefault(plugin.name, (plugin, source))
        if rival.path != plugin.path:
            raise InvalidInput(f"two {kind.name} are called '{plugin.name}': {rival.path} and {plugin.path}")
    return list(by_name.values())


def _rigs(names: Iterable[str]) -> dict[str, tuple[str, str]]:
    """By what each rig is asked for: its name, and where another process finds it."""
    rigs: dict[str, tuple[str, str]] = {}
    sources: dict[str, str] = {}
    for name in names:
        rig = load_rig(name).name
        source = name if name in rig_names() else str(Path(name).resolve())
        if sources.setdefault(rig, source) != source:
            raise InvalidInput(f"two rigs are called '{rig}': {sources[rig]} and {source}")
        rigs[name] = rig, source
    return rigs


def _source(name: str | Path) -> str:
    """What finds a plugin in a process that stands in another folder."""
    return str(Path(name).resolve()) if is_path(name) else str(name)


def _chosen_seeds(part: Group, report: Report, chosen: Selection) -> tuple[int, ...]:
    """The seeds of a part that a run is to have: its own, and those that no part has."""
    seeds = chosen_names(chosen.seeds, report.all_seeds)
    for seed in seeds:
        if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
            raise InvalidInput(f"seed is {seed!r}; expected a whole number from 0 on")
    if not seeds:
        raise InvalidInput("no seeds are selected; expected at least one")
    own, foreign = report.seeds_of(part), set(seeds) - set(report.all_seeds)
    return tuple(dict.fromkeys(seed for seed in seeds if seed in own or seed in foreign))


def _require_known(kind: str, names: Iterable[str], known: Iterable[str]) -> None:
    for name in names:
        if name not in known:
            raise UnknownName(kind, name, known)


def _check_option_names(report: Report, chosen: Selection, methods: set[str]) -> None:
    """An option for a method that is left out of this run may stand; one for no method is a slip."""
    stated = [name for part in report.parts for name in part.options]
    for name in dict.fromkeys((*report.options, *stated, *chosen.options)):
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
