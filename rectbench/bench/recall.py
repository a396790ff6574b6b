"""What the cells of a finished run stood on, for the pictures of a report: images, truth, the fit again."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rectbench.bench.cells import cell_inputs, problem_of
from rectbench.bench.keys import digest
from rectbench.bench.pairs import image_inputs, load_images, load_truth
from rectbench.bench.planning import IDENTITY, CellTask
from rectbench.bench.plugins import registry
from rectbench.bench.rectifying import checked_options, fit
from rectbench.bench.run_folder import RUN_FILE
from rectbench.bench.store import Store
from rectbench.errors import InvalidInput
from rectbench.rendering.images import StereoPair
from rectbench.rendering.truth import Truth
from rectbench.warps import Rectification


def read_tasks(run_dir: Path) -> dict[tuple[Any, ...], CellTask]:
    """The tasks of a run by their identity; look one up with `identity_of(row)`."""
    try:
        facts = json.loads((run_dir / RUN_FILE).read_text(encoding="utf-8"))
        tasks = [CellTask.from_json(values) for values in facts["cells"]]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InvalidInput(f"{run_dir / RUN_FILE} tells no plan: {type(error).__name__} {error}") from None
    return {identity_of(vars(task.cell)): task for task in tasks}


def identity_of(row: Mapping[str, Any]) -> tuple[Any, ...]:
    """The values of a row's identity columns."""
    return tuple(row[name] for name in IDENTITY)


def recalled_pair(task: CellTask, store: Store | None = None) -> tuple[StereoPair, Truth]:
    """The images and the truth of a cell; what the store has lost is rendered again."""
    store = store or Store.default()
    return load_images(task.pair, store), load_truth(task.pair, store)


def recalled_rectification(task: CellTask, store: Store | None = None) -> Rectification:
    """What the cell's method made of it, fitted again."""
    method = registry("methods").get(task.method_source)
    problem = problem_of(task, store or Store.default())
    return fit(method, problem, checked_options(method, task.options))


def recalled_version(task: CellTask) -> str:
    """Changes with whatever changes the cell's images, truth or rectification."""
    return digest([cell_inputs(task), image_inputs(task.pair)])
