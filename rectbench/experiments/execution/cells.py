"""One cell: a method on a pair, fitted, timed and measured. Runs in a worker process."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path

from rectbench.errors import InvalidInput
from rectbench.experiments.execution.outcomes import LASTING, Outcome, outcome_of
from rectbench.experiments.spec import CALIBRATED, ESTIMATED
from rectbench.experiments.tasks import CellTask
from rectbench.images.stereo_pair import StereoPair
from rectbench.matching import BoardMatches, PoseEstimate, agreeing_matches, board_matches
from rectbench.metrics.scoring import digests_of, needs_of, score
from rectbench.metrics.timing import timed, warm_seconds
from rectbench.pairs.estimating import estimate_from_images, estimated_pose
from rectbench.pairs.features import scored_features
from rectbench.pairs.pairs import (
    give_memory_back,
    image_inputs,
    load_images,
    load_truth,
    make_pair,
    placed_rig,
    truth_inputs,
)
from rectbench.pairs.spec import PairSpec, PhotographedSpec, RenderedSpec
from rectbench.plugins.fitting import check_result, checked_options
from rectbench.plugins.metric import Case
from rectbench.plugins.rectifier import METHODS, Problem, pose_problem
from rectbench.registry import registry
from rectbench.rendering.truth import Truth
from rectbench.rigs import Rig
from rectbench.rigs.poses import POSES, perturb
from rectbench.store.keys import Inputs, code_digest, derived_seed, versions
from rectbench.store.store import Store
from rectbench.types import Images, Matches

CELLS = "cells"
ROW = "row.json"
MEASURING_PACKAGES = ("numpy", "scipy", "opencv-contrib-python-headless", "drjit", "pydantic")

SCORED_MATCHES = 10_000
"""Correspondences the row error is taken over."""


def cell_inputs(task: CellTask) -> Inputs:
    """All that shapes the row of a cell; its report's name does not."""
    method = registry(METHODS).get(task.method_source)
    return {
        "truth": truth_inputs(task.pair),
        "images": image_inputs(task.pair) if uses_images(task) else None,
        "pose": task.cell.pose,
        "method": method.name,
        "method_source": method.digest,
        "options": checked_options(method, task.options).model_dump(mode="json"),
        "metrics": digests_of(task.metrics),
        "match_count": task.match_count,
        "match_noise_px": task.match_noise_px,
        "code": code_digest(__name__),
        "versions": dict(versions(*MEASURING_PACKAGES)),
    }


def uses_images(task: CellTask) -> bool:
    """Whether the row of a cell hangs on its images, as that of photographs always does."""
    needs = registry(METHODS).get(task.method_source).value.needs
    asked = "images" in needs | needs_of(task.metrics) or task.cell.pose == ESTIMATED
    return asked or isinstance(task.pair, PhotographedSpec)


def stored_outcome(task: CellTask, store: Store) -> Outcome | None:
    """What an earlier run found for this cell; None where it has to be run."""
    folder = store.read(CELLS, cell_inputs(task))
    if folder is None:
        return None
    return Outcome(**json.loads((folder / ROW).read_text(encoding="utf-8")))


def run_cell(task: CellTask, store_root: Path) -> Outcome:
    """Run a cell and store how it ended; whatever a plugin raises becomes a status."""
    store = Store(store_root)
    try:
        outcome = _measured(task, store)
    except BaseException as error:  # a plugin may raise anything, SystemExit and KeyboardInterrupt too
        outcome = outcome_of(error)
    keep(task, outcome, store)
    give_memory_back()
    return outcome


def keep(task: CellTask, outcome: Outcome, store: Store) -> None:
    """Store how a cell ended, if it would end so again."""
    if outcome.status in LASTING:
        store.write_text(CELLS, cell_inputs(task), ROW, json.dumps(asdict(outcome)))


def run_pair(pair: RenderedSpec, store_root: Path) -> Outcome:
    """Render a pair into the store; whatever a scene raises becomes a status."""
    try:
        make_pair(pair, Store(store_root))
    except BaseException as error:  # a plugin may raise anything
        return outcome_of(error)
    return Outcome()


def believed_rig(task: CellTask, store: Store) -> Rig:
    """What the rectifier is told: the true rig with its pose perturbed, or estimated from the images.

    Of photographs it is the calibrated rig as it is, or in the pose that the images tell. Images do not
    tell how long a baseline is: the known length stands in an estimated rig, too.
    """
    cell, rig = task.cell, placed_rig(task.pair)
    if cell.pose == ESTIMATED:
        return estimated_pose(task.pair, store).rig(rig)
    if cell.pose == CALIBRATED:
        return rig
    # Not named after the method: all methods of a pair are misled in the same way.
    seed = derived_seed("pose", cell.scene, cell.rig, cell.motion, cell.pose, cell.seed)
    return perturb(rig, POSES[cell.pose], seed)


def problem_of(task: CellTask, store: Store) -> Problem:
    """What the cell's rectifier may know."""
    cell, needs = task.cell, registry(METHODS).get(task.method_source).value.needs
    images = load_images(task.pair, store) if "images" in needs else None
    return pose_problem(
        believed_rig(task, store),
        matches=_given_matches(task, store) if "matches" in needs else None,
        images=Images(images.left, images.right) if images else None,
        seed=derived_seed("method", cell.scene, cell.rig, cell.motion, cell.pose, cell.method, cell.seed),
    )


def _given_matches(task: CellTask, store: Store) -> Matches:
    """What a method that works from matches gets: those of the estimate, else true ones with noise.

    Photographs have no true ones: theirs are those of the estimate, whatever pose the others are told.
    """
    cell = task.cell
    if cell.pose == ESTIMATED or isinstance(task.pair, PhotographedSpec):
        return estimated_pose(task.pair, store).inliers
    seed = derived_seed("matches", cell.scene, cell.rig, cell.motion, cell.seed)
    truth = _truth(task.pair, store)
    return Matches(*truth.matches(task.match_count, seed=seed, noise_px=task.match_noise_px))


@lru_cache(maxsize=1)
def _true_matches(pair: PairSpec, store: Store) -> Matches:
    return Matches(*_truth(pair, store).matches(SCORED_MATCHES))


@lru_cache(maxsize=1)
def feature_matches(pair: PairSpec, by_estimate: bool, store: Store) -> Matches:
    """Freed of wrong matches by the true pose; or, as the paper frees its own, by the estimated one.

    Of photographs those that agree on the pose in the images, whatever the calibration says: it may be
    what is wrong. Raises PoseNotFound where photographs tell none.
    """
    rig = placed_rig(pair)
    if isinstance(pair, PhotographedSpec):
        photographs = load_images(pair, store)
        images = Images(photographs.left, photographs.right)
        return agreeing_matches(estimated_pose(pair, store), rig.left, rig.right, images)
    known = estimated_pose(pair, store).rig(rig) if by_estimate else rig
    return scored_features(load_images(pair, store), known)


@lru_cache(maxsize=1)
def corners_of_board(pair: PairSpec, store: Store) -> BoardMatches | None:
    """The corners of a calibration board that both images of a pair show; None where they show none."""
    images = load_images(pair, store)
    return board_matches(images.left, images.right)


@lru_cache(maxsize=1)
def _truth(pair: PairSpec, store: Store) -> Truth:
    """Kept, since the methods of one pair run one after another."""
    if isinstance(pair, PhotographedSpec):
        raise InvalidInput(f"nobody knows the truth about the photographs of {pair.scene}")
    return load_truth(pair, store)


@dataclass(frozen=True)
class _Known:
    """What is known of a pair, for its metrics."""

    pair: PairSpec
    store: Store

    @property
    def rig(self) -> Rig:
        return placed_rig(self.pair)

    @property
    def has_truth(self) -> bool:
        return not isinstance(self.pair, PhotographedSpec)

    @property
    def images(self) -> StereoPair:
        return load_images(self.pair, self.store)

    @property
    def truth(self) -> Truth:
        return _truth(self.pair, self.store)

    @property
    def true_matches(self) -> Matches:
        return _true_matches(self.pair, self.store)

    @property
    def board(self) -> BoardMatches | None:
        return corners_of_board(self.pair, self.store)

    @property
    def estimate(self) -> PoseEstimate:
        return estimated_pose(self.pair, self.store)

    def features(self, *, by_estimate: bool) -> Matches:
        return feature_matches(self.pair, by_estimate, self.store)

    def pose_seconds(self) -> float:
        return _pose_time(self.pair, self.store)


def _measured(task: CellTask, store: Store) -> Outcome:
    method = registry(METHODS).get(task.method_source)
    if isinstance(task.pair, PhotographedSpec):
        load_images(task.pair, store)  # raises for images that are not the calibration's
    options, problem = checked_options(method, task.options), problem_of(task, store)
    rectification, seconds = timed(lambda: method.value.fit(problem, options))
    check_result(method.name, rectification, problem)
    case = Case(
        rectification,
        _Known(task.pair, store),
        pose_is_estimated=task.cell.pose == ESTIMATED,
        fit=lambda: method.value.fit(problem, options),
        first_fit_s=seconds,
    )
    columns = score(case, task.metrics)
    return Outcome(metrics=columns, notes={**rectification.notes, **case.remarks})


@lru_cache(maxsize=1)
def _pose_time(pair: PairSpec, store: Store) -> float:
    """Seconds from the two images, in memory, to the pose."""
    images = load_images(pair, store)
    return warm_seconds(lambda: estimate_from_images(pair, images))
