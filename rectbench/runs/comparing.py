"""Two runs side by side, paired cell by cell."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from rectbench.plugins.matches import marked
from rectbench.runs.gating import KEY
from rectbench.runs.record import LEADING, TEXTS
from rectbench.runs.run import read_run
from rectbench.statistics.intervals import mean_interval, nested_means

_OUTERMOST = ("rig", "motion", "scene")
LEVELS = [*_OUTERMOST, *(name for name in KEY if name not in (*_OUTERMOST, "method", "seed")), "seed"]
"""From what is drawn independently to what is nested in it."""


@dataclass(frozen=True)
class Comparison:
    """What changed from run A to run B.

    `table` has a row for each method and metric: `pairs` of cells and the `rigs` they are of, the medians
    of A and B, the mean `difference` B - A over rigs, the scenes and seeds of each averaged first, and the
    ends `low`, `high` of its 95 % t interval over rigs, NaN for fewer than 3 rigs. `unpaired` says which
    cells stand in one run alone, or failed in one.
    """

    table: pd.DataFrame
    unpaired: tuple[str, ...]


def compare(a: Path, b: Path) -> Comparison:
    """Compare two runs; raises InvalidInput where either cannot be read."""
    both = read_run(a).table.merge(
        read_run(b).table, on=KEY, how="outer", suffixes=("_a", "_b"), indicator=True
    )
    both["method"] = list(map(marked, both["method"], both["matches"]))
    ok = (both["status_a"] == "ok") & (both["status_b"] == "ok")
    unpaired = tuple(_why_unpaired(row) for _, row in both[~ok].iterrows() if _differs(row))
    metrics = [
        name.removesuffix("_a")
        for name in both.columns
        if name.endswith("_a") and f"{name[:-2]}_b" in both and name[:-2] not in (*LEADING, *TEXTS)
    ]
    rows = [
        {"method": method, "metric": metric, **_difference(cells, metric)}
        for method, cells in both[ok].groupby("method", sort=True)
        for metric in metrics
    ]
    columns = ["method", "metric", "pairs", "rigs", "median_a", "median_b", "difference", "low", "high"]
    table = pd.DataFrame(rows, columns=columns)
    return Comparison(table[table["pairs"] > 0].reset_index(drop=True), unpaired)


def _difference(cells: pd.DataFrame, metric: str) -> dict[str, float]:
    a, b = cells[f"{metric}_a"], cells[f"{metric}_b"]
    both = a.notna() & b.notna()
    first, second = a[both].to_numpy(dtype=float), b[both].to_numpy(dtype=float)
    if not len(first):
        return {"pairs": 0}
    differences = np.subtract(second, first, out=np.zeros_like(first), where=first != second)  # inf, too
    places = cells.loc[both, LEVELS].itertuples(index=False, name=None)
    found = mean_interval(nested_means(dict(zip(places, differences.tolist(), strict=True))).values())
    return {
        "pairs": len(first),
        "rigs": found.units,
        "median_a": float(np.median(first)),
        "median_b": float(np.median(second)),
        "difference": found.estimate,
        "low": found.low,
        "high": found.high,
    }


def _differs(row: pd.Series[str]) -> bool:
    return bool(row["_merge"] != "both" or row["status_a"] != row["status_b"])


def _why_unpaired(row: pd.Series[str]) -> str:
    cell = f"{row['method']} on {row['scene']}/{row['rig']}/{row['motion']}/{row['pose']}/seed {row['seed']}"
    if row["_merge"] == "both":
        return f"{cell}: {row['status_a']} in A, {row['status_b']} in B"
    return f"{cell}: only in {'A' if row['_merge'] == 'left_only' else 'B'}"
