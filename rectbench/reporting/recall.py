"""What the cells of a finished run stood on, for the pictures of a report: images, truth, the fit again."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rectbench.errors import InvalidInput
from rectbench.experiments.execution.cells import cell_inputs, problem_of
from rectbench.experiments.tasks import IDENTITY, CellTask
from rectbench.pairs.pair import Pair
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.rectifier import METHODS
from rectbench.registry import registry
from rectbench.runs.record import RUN_FILE
from rectbench.store.keys import digest
from rectbench.warps import Rectification


def read_tasks(run_dir: Path) -> dict[tuple[Any, ...], CellTask]:
    """The tasks of a run by their identity; look one up with `identity_of(row)`."""
    try:
        facts = json.loads((run_dir / RUN_FILE).read_text(encoding="utf-8"))
        tasks = [CellTask.model_validate(values) for values in facts["cells"]]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InvalidInput(f"{run_dir / RUN_FILE} tells no plan: {type(error).__name__} {error}") from None
    return {identity_of(vars(task.cell)): task for task in tasks}


def identity_of(row: Mapping[str, Any]) -> tuple[Any, ...]:
    """The values of a row's identity columns."""
    return tuple(row[name] for name in IDENTITY)


def recalled_rectification(task: CellTask, pair: Pair) -> Rectification:
    """What the cell's method made of it, fitted again."""
    method = registry(METHODS).get(task.method_source)
    return fit(method, problem_of(task, pair), checked_options(method, task.options))


def recalled_version(task: CellTask, pair: Pair) -> str:
    """Changes with whatever changes the cell's images, truth or rectification."""
    return digest([cell_inputs(task, pair), pair.image_inputs])
