"""What the cells of a finished run stood on, for the pictures of a report: images, truth, the fit again."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rectbench.errors import InvalidInput, PoseNotFound
from rectbench.experiments.execution.cells import cell_inputs, corners_of_board, feature_matches, problem_of
from rectbench.experiments.tasks import IDENTITY, CellTask
from rectbench.images.stereo_pair import StereoPair
from rectbench.pairs.pairs import image_inputs, load_images, load_truth, placed_rig
from rectbench.pairs.spec import PhotographedSpec
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.rectifier import METHODS
from rectbench.registry import registry
from rectbench.rendering.truth import Truth
from rectbench.rigs import Rig
from rectbench.runs.record import RUN_FILE
from rectbench.store.keys import digest
from rectbench.store.store import Store
from rectbench.types import Matches
from rectbench.warps import Rectification

SHOWN_MATCHES = 2000
"""True correspondences that pictures choose from."""


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


@dataclass(frozen=True, eq=False)
class KnownPair:
    """The images under a cell, and what is known of them."""

    images: StereoPair
    rig: Rig
    """The true rig; of photographs the calibrated one."""
    matches: Matches
    """Pixels [N, 2] each that correspond: true ones, or of photographs those found in them."""
    truth: Truth | None
    """None of photographs."""


def recalled_pair(task: CellTask, store: Store | None = None) -> KnownPair:
    """The images of a cell and what is known of them; what the store has lost is rendered again."""
    store, pair = store or Store.default(), task.pair
    images = load_images(pair, store)
    if isinstance(pair, PhotographedSpec):
        return KnownPair(images, placed_rig(pair), _found_matches(pair, store), None)
    truth = load_truth(pair, store)
    return KnownPair(images, truth.rig, Matches(*truth.matches(SHOWN_MATCHES, seed=0)), truth)


def _found_matches(pair: PhotographedSpec, store: Store) -> Matches:
    """The matches that agree on a pose, and the corners of a board, as far as there are any."""
    found = [] if (board := corners_of_board(pair, store)) is None else [board.matches]
    with suppress(PoseNotFound):
        found.append(feature_matches(pair, False, store))
    sides = zip(*found, strict=True) if found else ([np.empty((0, 2))], [np.empty((0, 2))])
    return Matches(*(np.concatenate(side) for side in sides))


def recalled_rectification(task: CellTask, store: Store | None = None) -> Rectification:
    """What the cell's method made of it, fitted again."""
    method = registry(METHODS).get(task.method_source)
    problem = problem_of(task, store or Store.default())
    return fit(method, problem, checked_options(method, task.options))


def recalled_version(task: CellTask) -> str:
    """Changes with whatever changes the cell's images, truth or rectification."""
    return digest([cell_inputs(task), image_inputs(task.pair)])
