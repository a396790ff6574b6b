"""Whether a run is as good as the numbers accepted for its report.

A gate that measured nothing does not pass, a cell that failed is not skipped, and a run that left
cells out is incomplete rather than good. Times differ from machine to machine and are not compared.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import pandas as pd

from rectbench.errors import InvalidInput, UnknownName
from rectbench.experiments.spec import ESTIMATED, REPORTS
from rectbench.experiments.tasks import IDENTITY
from rectbench.registry import registry
from rectbench.runs.record import read_facts, read_results

KEY = [name for name in IDENTITY if name != "report"]

GOOD, REGRESSION, INCOMPLETE = 0, 1, 3


@dataclass(frozen=True)
class Tolerance:
    """How far a column may be worse than accepted: by `relative` of the accepted value, plus `absolute`."""

    better: Literal["lower", "higher"]
    relative: float
    absolute: float

    def change(self, accepted: float, now: float) -> Literal["same", "better", "worse"]:
        """How `now` stands to `accepted`; a number that is no longer there is worse."""
        if math.isnan(accepted) or math.isnan(now):
            if math.isnan(accepted) and math.isnan(now):
                return "same"
            return "worse" if math.isnan(now) else "better"
        if accepted == now:
            return "same"  # infinities too
        if math.isfinite(accepted) and abs(now - accepted) <= self.relative * abs(accepted) + self.absolute:
            return "same"
        return "better" if (now < accepted) == (self.better == "lower") else "worse"


GATED: dict[str, Tolerance] = {
    "row_error_mean_px": Tolerance("lower", 0.02, 1e-6),
    "row_error_p95_px": Tolerance("lower", 0.05, 1e-6),
    "row_error_source_mean_px": Tolerance("lower", 0.02, 1e-6),
    "row_error_board_mean_px": Tolerance("lower", 0.05, 0.01),
    "row_error_features_mean_px": Tolerance("lower", 0.1, 0.02),
    "distortion_native": Tolerance("lower", 0.01, 1e-6),
    "distortion_rescaled": Tolerance("lower", 0.01, 1e-6),
    "distortion_stretched": Tolerance("lower", 0.01, 1e-6),
    "log_distortion": Tolerance("lower", 0.01, 1e-6),
    "coverage_pixels": Tolerance("higher", 0.0, 0.002),
    "coverage_solid_angle": Tolerance("higher", 0.0, 0.002),
    "closure_px": Tolerance("lower", 0.0, 1e-6),
    "reconstruction_completeness": Tolerance("higher", 0.0, 0.01),
    "pose_rotation_error_deg": Tolerance("lower", 0.05, 0.002),
    "pose_direction_error_deg": Tolerance("lower", 0.05, 0.01),
}
"""The gated columns. Relative where rounding and libraries move the last digits of a fit; features hang
on the detector's version most of all."""

ESTIMATED_SLACK = 10.0
"""How many times as far off a column may be where the pose was found in the images: a feature more or less,
and all that follows from the pose moves a little."""


def tolerance_for(column: str, pose: str) -> Tolerance:
    """How far a column may be worse than accepted, given where the pose came from."""
    tolerance = GATED[column]
    if pose != ESTIMATED:
        return tolerance
    wider = replace(tolerance, relative=ESTIMATED_SLACK * tolerance.relative)
    return replace(wider, absolute=ESTIMATED_SLACK * tolerance.absolute)


@dataclass
class Verdict:
    """What a gate found, a line each."""

    compared: int = 0
    """Cells that were measured and have accepted numbers."""
    regressions: list[str] = field(default_factory=list)
    incomplete: list[str] = field(default_factory=list)
    improvements: list[str] = field(default_factory=list)
    new: list[str] = field(default_factory=list)

    @property
    def exit_code(self) -> int:
        """0 good, 1 a regression, 3 incomplete or nothing measured."""
        if self.regressions:
            return REGRESSION
        return INCOMPLETE if self.incomplete or not self.compared else GOOD


def accepted_path(run_dir: Path) -> Path:
    """Where the accepted numbers of the run's report lie: beside the report's file."""
    facts = read_facts(run_dir)
    if "photographs" in facts:
        raise InvalidInput(
            f"{run_dir} is a run of photographs, whose numbers are not the report's; expected --accepted FILE"
        )
    try:
        report = registry(REPORTS).get(facts["report"]).path
    except UnknownName:
        if not facts.get("report_file"):
            raise
        report = Path(facts["report_file"])
    return report.with_suffix(".accepted.csv")


def accept(run_dir: Path, path: Path) -> int:
    """Make the run's numbers the accepted ones; returns how many cells they hold.

    Raises InvalidInput for a run that measured nothing or was no whole run of its report.
    """
    table = read_results(run_dir)
    if not (table["status"] == "ok").any():
        raise InvalidInput(f"{run_dir} measured nothing; there is nothing to accept")
    if not read_facts(run_dir).get("is_whole"):
        raise InvalidInput(f"{run_dir} is a part of its report; expected a run without a selection")
    columns = [name for name in GATED if name in table and table[name].notna().any()]
    unfinished = path.with_name(f".{path.name}.unfinished")
    try:
        table[[*KEY, "status", *columns]].to_csv(unfinished, index=False, float_format="%.9g")
        unfinished.replace(path)
    except OSError as error:
        raise InvalidInput(f"{path} cannot be written: {error.strerror}") from None
    return len(table)


def gate(run_dir: Path, path: Path) -> Verdict:
    """Compare a run with the accepted numbers in the file `path`.

    Raises InvalidInput where either cannot be read.
    """
    run, accepted = _by_key(read_results(run_dir)), _by_key(_read_accepted(path))
    is_whole = bool(read_facts(run_dir).get("is_whole"))
    verdict = Verdict()
    for key, known in accepted.items():
        if key not in run:
            missing = verdict.regressions if is_whole else verdict.incomplete
            missing.append(f"{_name(key)}: the cell is missing")
            continue
        _compare(_name(key), known, run[key], verdict)
    verdict.new += [f"{_name(key)}: no accepted numbers" for key in run if key not in accepted]
    return verdict


def _compare(cell: str, known: dict[str, Any], now: dict[str, Any], verdict: Verdict) -> None:
    if known["status"] != now["status"]:
        kind = verdict.improvements if now["status"] == "ok" else verdict.regressions
        because = f" ({now['reason']})" if now.get("reason") else ""
        kind.append(f"{cell}: status {known['status']} -> {now['status']}{because}")
        return
    if now["status"] != "ok":
        return
    verdict.compared += 1
    for column in (name for name in GATED if name in known):
        tolerance = tolerance_for(column, known["pose"])
        accepted, value = float(known[column]), float(now.get(column, math.nan))
        change = tolerance.change(accepted, value)
        if change != "same":
            kind = verdict.improvements if change == "better" else verdict.regressions
            kind.append(f"{cell}: {column} {accepted:.6g} -> {value:.6g}")


def _read_accepted(path: Path) -> pd.DataFrame:
    if not path.is_file():
        raise InvalidInput(
            f"there are no accepted numbers at {path}; `rectbench gate RUN --accept` makes them"
        )
    try:
        table = pd.read_csv(
            path, dtype=dict.fromkeys([*KEY, "status"], str), keep_default_na=False, na_values=[""]
        )
        table["seed"] = table["seed"].astype(int)
    except (OSError, ValueError, KeyError) as error:
        raise InvalidInput(f"{path} cannot be read: {' '.join(str(error).split())}") from None
    missing = [name for name in (*KEY, "status") if name not in table]
    if missing:
        raise InvalidInput(f"{path} lacks the column {missing[0]}")
    return table


def _by_key(table: pd.DataFrame) -> dict[tuple[Any, ...], dict[str, Any]]:
    rows = table.to_dict("records")
    return {tuple(row[name] for name in KEY): {str(k): v for k, v in row.items()} for row in rows}


def _name(key: tuple[Any, ...]) -> str:
    scene, rig, motion, pose, method, options, seed = key
    variant = "" if options == "{}" else " " + ",".join(f"{k}={v}" for k, v in json.loads(options).items())
    return f"{method}{variant} on {scene}/{rig}/{motion}/{pose}/seed {seed}"
