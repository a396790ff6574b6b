"""Two runs side by side, paired cell by cell."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from rectbench.plugins.matches import marked
from rectbench.plugins.metric import Column
from rectbench.runs.gating import KEY
from rectbench.runs.record import LEADING, TEXTS
from rectbench.runs.run import read_run
from rectbench.runs.units import GEOMETRIC, floor_of
from rectbench.statistics.intervals import Interval, mean_interval, nested_means, ratio
from rectbench.statistics.paired import TIE

_OUTERMOST = ("rig", "motion", "scene")
LEVELS = [*_OUTERMOST, *(name for name in KEY if name not in (*_OUTERMOST, "method", "seed")), "seed"]
"""From what is drawn independently to what is nested in it."""


COLUMNS = [
    *("part", "pose", "method", "metric", "pairs", "moved", "rigs"),
    *("median_a", "median_b", "difference", "low", "high"),
]


@dataclass(frozen=True)
class Comparison:
    """What changed from run A to run B.

    Parameters
    ----------
    table : a row for each part of the report, pose, method and metric: `pairs` of cells, how many of them
        `moved`, and the `rigs` they are of; the medians of A and B in stored units; the `difference` and the
        ends `low`, `high` of its 95 % t interval over rigs, NaN for fewer than 3 rigs. Where a metric's
        average is geometric, the difference is B / A - 1 of geometric means over rigs, a share such as
        0.02; else the mean B - A over rigs, in the metric's stored unit. The motions, scenes and seeds of
        a rig are averaged first.
    columns : what is known of the metrics, by their names.
    unpaired : which cells stand in one run alone, or failed in one.
    """

    table: pd.DataFrame
    columns: Mapping[str, Column]
    unpaired: tuple[str, ...]


def compare(a: Path, b: Path) -> Comparison:
    """Compare two runs; raises InvalidInput where either cannot be read."""
    first, second = read_run(a), read_run(b)
    both = first.table.merge(
        second.table, on=[*KEY, "group"], how="outer", suffixes=("_a", "_b"), indicator=True
    )
    both["method"] = list(map(marked, both["method"], both["matches"]))
    ok = (both["status_a"] == "ok") & (both["status_b"] == "ok")
    unpaired = tuple(_why_unpaired(row) for _, row in both[~ok].iterrows() if _differs(row))
    metrics = [
        name.removesuffix("_a")
        for name in both.columns
        if name.endswith("_a") and f"{name[:-2]}_b" in both and name[:-2] not in (*LEADING, *TEXTS)
    ]
    columns = {metric: first.catalogue.column(metric) for metric in metrics}
    rows = [
        {"part": part, "pose": pose, "method": method, "metric": metric, **_difference(cells, column)}
        for (part, pose, method), cells in both[ok].groupby(["group", "pose", "method"], sort=True)
        for metric, column in columns.items()
    ]
    table = pd.DataFrame(rows, columns=COLUMNS)
    table = table[table["pairs"] > 0].reset_index(drop=True)
    return Comparison(table.astype(dict.fromkeys(("pairs", "moved", "rigs"), int)), columns, unpaired)


def _difference(cells: pd.DataFrame, column: Column) -> dict[str, float]:
    a, b = cells[f"{column.key}_a"], cells[f"{column.key}_b"]
    both = a.notna() & b.notna()
    first, second = a[both].to_numpy(dtype=float), b[both].to_numpy(dtype=float)
    if not len(first):
        return {"pairs": 0}
    places = cells.loc[both, LEVELS].itertuples(index=False, name=None)
    onto = _log_ratio if column.average == GEOMETRIC else _gap
    changes = [onto(*pair, column) for pair in zip(first.tolist(), second.tolist(), strict=True)]
    found = mean_interval(nested_means(dict(zip(places, changes, strict=True))).values())
    if column.average == GEOMETRIC:
        estimate, low, high = (ratio(log) - 1 for log in (found.estimate, found.low, found.high))
        found = Interval(estimate, low, high, found.units)
    return {
        "pairs": len(first),
        "moved": sum(change != 0 for change in changes),
        "rigs": found.units,
        "median_a": float(np.median(first)),
        "median_b": float(np.median(second)),
        "difference": found.estimate,
        "low": found.low,
        "high": found.high,
    }


def _gap(a: float, b: float, column: Column) -> float:
    return 0.0 if a == b else b - a  # infinite ones, too


def _log_ratio(a: float, b: float, column: Column) -> float:
    """What is below the column's floor counts as that."""
    first, second = (math.log(max(value, floor_of(column))) for value in (a, b))
    change = _gap(first, second, column)
    return 0.0 if abs(change) <= TIE else change


def _differs(row: pd.Series[str]) -> bool:
    return bool(row["_merge"] != "both" or row["status_a"] != row["status_b"])


def _why_unpaired(row: pd.Series[str]) -> str:
    cell = f"{row['method']} on {row['scene']}/{row['rig']}/{row['motion']}/{row['pose']}/seed {row['seed']}"
    cell = f"{row['group']}: {cell}" if row["group"] else cell
    if row["_merge"] == "both":
        return f"{cell}: {row['status_a']} in A, {row['status_b']} in B"
    return f"{cell}: only in {'A' if row['_merge'] == 'left_only' else 'B'}"
