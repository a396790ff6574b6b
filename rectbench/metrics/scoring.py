"""All metrics that are asked for of one rectification, as the columns of a result row."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from copy import copy
from numbers import Real
from pathlib import Path
from typing import Any

from rectbench.errors import InvalidInput, InvalidResult, UnknownName
from rectbench.plugins.metric import METRICS, Case, Known, Metric, Need
from rectbench.plugins.rectifier import METHODS
from rectbench.registry import Plugin, is_path, registry
from rectbench.store.closure import PACKAGE

BUNDLES: Mapping[str, tuple[str, ...]] = {
    "geometry": (
        "log_distortion",
        "distortion",
        "distortion_detail",
        "view",
        "coverage",
        "sampling",
        "order",
        "row_misfit",
        "floor",
    ),
    "homography": ("loop_zhang", "mallon_whelan", "usr_cgd", "gluckman_nayar"),
}
"""Names that stand for several metrics. `geometry`: all that needs neither image nor match, and is this
harness's own; `homography`: what papers on rectifying homographies measure."""
POSE = "pose"
"""The metric that nobody has to ask for: it is computed wherever a pose is estimated."""


def metrics_of(asked: Iterable[str | Path]) -> dict[str, Plugin[Metric]]:
    """The metrics of these names, bundles or files, each by what finds it in another process too.

    Raises UnknownName, with the nearest names; InvalidInput for a broken file, and where two metrics
    have a column of one name.
    """
    sources = [source for name in asked for source in BUNDLES.get(str(name), (str(name),))]
    found = {_source(source): _metric(source) for source in sources}
    owners = {column.key: plugin for plugin in registry(METRICS).plugins() for column in plugin.value.columns}
    for plugin in found.values():
        for column in plugin.value.columns:
            owner = owners.setdefault(column.key, plugin)
            if (owner.name, owner.path) != (plugin.name, plugin.path):
                raise InvalidInput(
                    f"two metrics have a column '{column.key}': {owner.path} and {plugin.path}"
                )
    return found


def needs_of(asked: Iterable[str | Path]) -> frozenset[Need]:
    """What of a pair these metrics look at beside the geometry.

    >>> sorted(needs_of(["geometry", "reconstruction"]))
    ['images', 'truth']
    """
    return frozenset().union(*(plugin.value.needs for plugin in metrics_of(asked).values()))


def digests_of(asked: Iterable[str | Path]) -> dict[str, str]:
    """The digests of these metrics' sources by their names, for the key of a cell; of methods they fit, too.

    Empty of the built-in ones: the key covers what `rectbench.metrics` imports, and these are all of them.
    """
    plugins = metrics_of(asked).values()
    own = {p.name: "" if p.path.resolve().is_relative_to(PACKAGE) else p.digest for p in plugins}
    methods = sorted({name for p in plugins for name in p.value.fits})
    return own | {f"method {name}": registry(METHODS).get(name).digest for name in methods}


def score(case: Case, asked: Iterable[str | Path]) -> dict[str, float]:
    """The numbers of a row: of all that is asked, and of the pose where it was estimated.

    Raises InvalidResult for a metric that gives anything but numbers, or for no column of its own.
    """
    wanted = [*asked, POSE] if case.pose_is_estimated else asked
    row: dict[str, float] = {}
    for plugin in metrics_of(wanted).values():
        row |= _numbers(plugin.value, _declared(case, plugin.value))
    return row


def _declared(case: Case, metric: Metric) -> Case:
    """The case with a pair that hands out what the metric has declared to need, and images in any event where
    the pose came from them: the cell's key covers no more."""
    known: frozenset[Need] = frozenset({"images"}) if case.pose_is_estimated else frozenset()
    declared = copy(case)
    object.__setattr__(declared, "pair", _DeclaredPair(case.pair, metric.name, metric.needs | known))
    return declared


class _DeclaredPair:
    """A pair that refuses the rest."""

    def __init__(self, pair: Known, metric: str, needs: frozenset[Need]) -> None:
        implied: frozenset[Need] = frozenset({"true_matches"} if "truth" in needs else ())
        self._pair, self._metric, self._needs = pair, metric, needs | implied

    def __getattr__(self, name: str) -> Any:
        need = _NEEDED.get(name)
        if need and need not in self._needs:
            who = f"metric {self._metric}"
            raise InvalidResult(f"{who} asks for {name} of the pair; expected '{need}' in its needs")
        return getattr(self._pair, name)


_NEEDED: Mapping[str, Need] = {
    "truth": "truth",
    "true_matches": "true_matches",
    **dict.fromkeys(("images", "board", "features", "estimate", "shown_matches", "pose_seconds"), "images"),
}
"""What a metric must need to be handed a thing of the pair."""


def _numbers(metric: Metric, case: Case) -> dict[str, float]:
    found = metric.compute(case)
    if not isinstance(found, Mapping):
        raise InvalidResult(
            f"metric {metric.name} returned a {type(found).__name__}; expected numbers by their columns"
        )
    keys = {column.key for column in metric.columns}
    for key, value in found.items():
        if key not in keys:
            raise InvalidResult(f"metric {metric.name} returned {key!r}, which is none of its columns")
        if isinstance(value, bool) or not isinstance(value, Real):
            raise InvalidResult(f"metric {metric.name} returned {value!r} for {key}; expected a number")
    return {key: float(value) for key, value in found.items()}


def _metric(name: str) -> Plugin[Metric]:
    try:
        return registry(METRICS).get(name)
    except UnknownName:
        raise UnknownName("metric", name, [*registry(METRICS).names(), *BUNDLES]) from None


def _source(name: str) -> str:
    return str(Path(name).resolve()) if is_path(name) else name
