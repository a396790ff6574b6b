"""A run's folder: run.json, results.parquet and results.csv, each there whole or not at all."""

from __future__ import annotations

import json
import os
import platform
import shlex
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pandas as pd

from rectbench import llvm
from rectbench.errors import InvalidInput, Unavailable
from rectbench.experiments.execution.outcomes import Outcome
from rectbench.experiments.planning import Plan
from rectbench.experiments.tasks import IDENTITY
from rectbench.pairs.finding.photographs import UNREADABLE
from rectbench.store.closure import PACKAGE
from rectbench.store.keys import canonical_json, versions
from rectbench.writing import check_writable as check_writable

RUN_FILE, PARQUET, CSV = "run.json", "results.parquet", "results.csv"
LEADING = (*IDENTITY, "status", "reason")
TEXTS = ("group", "notes")
"""Columns that are neither identity nor metric: the part of the report, what the method says of itself."""
PACKAGES = (
    "rectbench",
    "numpy",
    "scipy",
    "opencv-contrib-python-headless",
    "mitsuba",
    "drjit",
    "pandas",
    "pyarrow",
    "pydantic",
    "karellen-llvm-core",
)

PROMISED = (
    "row_error_mean_px",
    "row_error_median_px",
    "row_error_p95_px",
    "row_error_max_px",
    "row_error_below_1px",
    "row_error_features_mean_px",
    "distortion_native",
    "distortion_rescaled",
    "distortion_stretched",
    "log_distortion",
    "coverage_pixels",
    "coverage_solid_angle",
    "valid_output",
    "fit_s",
    "maps_s",
    "warp_s",
)
"""Columns that are always there, empty where the report does not measure them."""


def table_of(plan: Plan, outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """One row a cell, in the plan's order: identity, status, reason, metrics, notes."""
    rows = []
    for task, outcome in zip(plan.tasks, outcomes, strict=True):
        ended = {"status": outcome.status, "reason": outcome.reason}
        notes = json.dumps(dict(outcome.notes), sort_keys=True, default=str)
        rows.append(
            {**task.cell.model_dump(), **ended, "group": task.group, **outcome.metrics, "notes": notes}
        )
    measured = dict.fromkeys(name for outcome in outcomes for name in outcome.metrics)
    metrics = [*PROMISED, *(name for name in measured if name not in PROMISED)]
    table = pd.DataFrame(rows, columns=[*LEADING, "group", *metrics, "notes"])
    return table.astype({**dict.fromkeys(metrics, "float64"), "seed": "int64"})


def facts_of(plan: Plan) -> dict[str, Any]:
    """What run.json says: the plan, and the machine and software it ran on."""
    return {
        "report": plan.report.name,
        "title": plan.report.title,
        "description": plan.report.description,
        "command": _command(plan),
        "git_revision": git_revision(),
        "cpu": cpu_name(),
        "cores": os.cpu_count(),
        "llvm": llvm_facts(),
        "python": platform.python_version(),
        "platform": platform.platform(),
        "seeds": sorted({task.cell.seed for task in plan.tasks}),
        "versions": dict(versions(*PACKAGES)),
        "selection": asdict(plan.selection),
        "is_whole": plan.is_whole,
        "spec": plan.report.model_dump(mode="json"),
        "figures": plan.report.figures,
        **_photograph_facts(plan),
        "cells": [task.model_dump(mode="json") for task in plan.tasks],
    }


def _photograph_facts(plan: Plan) -> dict[str, Any]:
    """The folder of a report of photographs: its pairs, what was assumed, and what was left out and why."""
    found = plan.photographs
    if found is None:
        return {}
    below = found.below
    pairs = [
        {
            "name": pair.name,
            "rig": pair.calibration.name,
            "left": below(pair.left),
            "right": below(pair.right),
            "calibration": [below(file) for file in pair.calibration.files],
        }
        for pair in found.pairs
    ]
    return {
        "data": str(found.folder),
        "photographs": {
            "pairs": pairs,
            "remarks": {one.name: list(one.remarks) for one in found.calibrations if one.remarks},
            "left_out": [{"path": below(out.path), "reason": out.reason} for out in found.left_out],
        },
    }


def unreadable_images(folder: Path) -> list[str]:
    """The images of a run of photographs that could not be read; none of other runs."""
    photographs = read_facts(folder).get("photographs", {})
    return [out["path"] for out in photographs.get("left_out", ()) if out["reason"] == UNREADABLE]


def write_run(folder: Path, table: pd.DataFrame, facts: Mapping[str, Any]) -> None:
    """Write the three files; run.json last, so that it speaks of the results beside it.

    Raises Unavailable where the folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _replace(folder / PARQUET, table.to_parquet(index=False))
        _replace(folder / CSV, table.to_csv(index=False).encode())
        _replace(folder / RUN_FILE, (json.dumps(facts, indent=1, ensure_ascii=False) + "\n").encode())
    except OSError as error:
        raise Unavailable(f"{folder} cannot be written: {error.strerror or error}") from error


def read_results(folder: Path) -> pd.DataFrame:
    """The rows of a run's folder; raises InvalidInput where there are none to be read."""
    path = folder / PARQUET
    if not path.is_file():
        raise InvalidInput(f"{folder} is no run's folder: {PARQUET} is missing")
    try:
        table = pd.read_parquet(path)
    except (OSError, ValueError) as error:
        raise InvalidInput(f"{path} cannot be read: {' '.join(str(error).split())}") from None
    missing = [name for name in LEADING if name not in table.columns]
    if missing:
        raise InvalidInput(f"{path} lacks the column {missing[0]}")
    return table


def read_facts(folder: Path) -> dict[str, Any]:
    """run.json of a run's folder; raises InvalidInput where it cannot be read."""
    path = folder / RUN_FILE
    try:
        facts = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InvalidInput(f"{folder} is no run's folder: {RUN_FILE} is missing") from None
    except (OSError, ValueError) as error:
        raise InvalidInput(f"{path} cannot be read: {error}") from None
    if not isinstance(facts, dict) or "report" not in facts:
        raise InvalidInput(f"{path} names no report")
    return facts


def git_revision() -> str | None:
    """The commit of the source this runs from, marked where files differ from it; None outside of git."""
    command = [
        "git",
        "-C",
        str(PACKAGE.parent),
        "describe",
        "--always",
        "--dirty",
        "--abbrev=40",
        "--exclude=*",
    ]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()


def cpu_name() -> str:
    """The processor's name, as the system tells it."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor() or platform.machine())


def llvm_facts() -> dict[str, Any]:
    """Which libLLVM compiles the kernels, its version, or why there is none."""
    problem = llvm.problem()
    facts: dict[str, Any] = {"path": os.environ.get(llvm.PATH_VARIABLE)}
    if problem:
        return {**facts, "problem": problem}
    import drjit

    return {**facts, "version": ".".join(map(str, drjit.detail.llvm_version()))}


def _command(plan: Plan) -> str:
    words = ["rectbench", "run", plan.report.name]
    if plan.photographs is not None:
        words += ["--data", shlex.quote(str(plan.photographs.folder))]
    for name in ("methods", "scenes", "rigs", "seeds"):
        chosen = getattr(plan.selection, name)
        if chosen is not None:
            words += [f"--{name}", ",".join(map(str, chosen))]
    for method, options in plan.selection.options.items():
        words += [f"--option {method}.{name}={canonical_json(value)}" for name, value in options.items()]
    return " ".join(words)


def _replace(path: Path, content: bytes) -> None:
    descriptor, unfinished = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
    try:
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        Path(unfinished).chmod(0o644)
        Path(unfinished).replace(path)
    finally:
        Path(unfinished).unlink(missing_ok=True)
