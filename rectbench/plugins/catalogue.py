"""The columns of all metrics as readers meet them, for tables, charts, gate and the page's glossary."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache

from rectbench.plugins.metric import METRICS, TOPICS, Column, Metric, Shown
from rectbench.registry import registry

_UNITS = {"px": "px", "s": "s", "m": "m", "deg": "°"}


@dataclass(frozen=True)
class Catalogue:
    """Columns by topic, both in the order of display."""

    topics: Mapping[str, tuple[Column, ...]]

    @classmethod
    def of(cls, metrics: Iterable[Metric]) -> Catalogue:
        """Topics as in `TOPICS`, others after them; in each, metrics by name, behind the one that ranks."""
        topics: dict[str, tuple[Column, ...]] = {}
        for metric in sorted(metrics, key=_place):
            topics[metric.topic] = (*topics.get(metric.topic, ()), *metric.columns)
        return cls(topics)

    def joined(self, others: Mapping[str, tuple[Column, ...]]) -> Catalogue:
        """These columns, and those of the others that are not among them."""
        topics = dict(self.topics)
        for topic, columns in others.items():
            new = tuple(column for column in columns if column.key not in self._by_key)
            topics[topic] = (*topics.get(topic, ()), *new)
        return Catalogue(topics)

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """All columns."""
        return tuple(column for columns in self.topics.values() for column in columns)

    @cached_property
    def _by_key(self) -> dict[str, Column]:
        return {column.key: column for column in reversed(self.columns)}

    def column(self, key: str) -> Column:
        """The column of this key; of an unknown one what its name and unit suffix tell.

        >>> known().column("depth_error_mean_m").full_heading
        'depth error mean [m]'
        """
        if key in self._by_key:
            return self._by_key[key]
        stem, _, suffix = key.rpartition("_")
        if stem and suffix in _UNITS:
            return Column(key, stem.replace("_", " "), _UNITS[suffix])
        return Column(key, key.replace("_", " "))

    def in_display_order(self, keys: Collection[str]) -> list[str]:
        """`keys` with the known ones first, in the order of display, then the others by name."""
        own = dict.fromkeys(column.key for column in self.columns if column.key in keys)
        return [*own, *sorted(set(keys) - self._by_key.keys())]

    def shown(self, *levels: Shown, topic: str | None = None) -> list[Column]:
        """The columns that first appear at one of these levels, of one topic or of all."""
        columns = self.columns if topic is None else self.topics.get(topic, ())
        return [column for column in columns if column.shown in levels]

    def panels(self, topic: str) -> dict[str, str]:
        """The columns of a topic that have a panel in its chart, and what stands above it."""
        return {column.key: column.panel for column in self.topics.get(topic, ()) if column.panel}

    @property
    def promised(self) -> list[str]:
        """The columns that every row has, empty where the report does not measure them."""
        return [column.key for column in self.columns if column.promised]

    @property
    def gated(self) -> list[Column]:
        """The columns that a gate looks at."""
        return [column for column in self.columns if column.tolerance]

    @cached_property
    def ranking(self) -> Column:
        """The column that methods are ranked by."""
        return next(column for column in self.columns if column.ranks)


def known() -> Catalogue:
    """Of the metrics that are installed here."""
    return _catalogue(tuple(plugin.value for plugin in registry(METRICS).plugins()))


@lru_cache(maxsize=1)
def _catalogue(metrics: tuple[Metric, ...]) -> Catalogue:
    return Catalogue.of(metrics)


def _place(metric: Metric) -> tuple[int, str, bool, str]:
    rank = TOPICS.index(metric.topic) if metric.topic in TOPICS else len(TOPICS)
    return rank, metric.topic, not any(column.ranks for column in metric.columns), metric.name


def column(key: str) -> Column:
    """The known column of this key; see `Catalogue.column`."""
    return known().column(key)
