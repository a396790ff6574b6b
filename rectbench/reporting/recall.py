"""What the cells of a finished run stood on, for the pictures of a report: images, truth, the fit again."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from rectbench.errors import PoseNotFound
from rectbench.experiments.execution.cells import cell_inputs, corners_of_board, feature_matches, problem_of
from rectbench.experiments.tasks import CellTask
from rectbench.images.stereo_pair import StereoPair
from rectbench.pairs.pairs import image_inputs, load_images, load_truth, placed_rig
from rectbench.pairs.spec import PhotographedSpec
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.rectifier import METHODS
from rectbench.registry import registry
from rectbench.rendering.truth import Truth
from rectbench.rigs import Rig
from rectbench.store.keys import digest
from rectbench.store.store import Store
from rectbench.types import Matches
from rectbench.warps import Rectification

SHOWN_MATCHES = 2000
"""True correspondences that pictures choose from."""


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
