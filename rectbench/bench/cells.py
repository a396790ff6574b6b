"""One cell: a method on a pair, fitted, timed and measured. Runs in a worker process."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import TypeVar

import numpy as np

from rectbench.bench.estimating import estimate_from_images, estimated_pose, pose_columns
from rectbench.bench.features import scored_features
from rectbench.bench.keys import Inputs, code_digest, derived_seed, versions
from rectbench.bench.outcomes import LASTING, Outcome, outcome_of
from rectbench.bench.pairs import (
    give_memory_back,
    image_inputs,
    load_images,
    load_truth,
    make_pair,
    placed_rig,
    truth_inputs,
)
from rectbench.bench.planning import CellTask, PairTask
from rectbench.bench.plugins import registry
from rectbench.bench.rectifying import check_result, checked_options, fit
from rectbench.bench.report_spec import ESTIMATED, IMAGE_METRICS
from rectbench.bench.store import Store
from rectbench.matching import reconstruct
from rectbench.metrics import (
    Jacobians,
    distortion_columns,
    energy_convex_share,
    measure,
    reconstruction_scores,
)
from rectbench.rendering.truth import Truth
from rectbench.rigs import Rig
from rectbench.rigs.poses import POSES, perturb
from rectbench.warps import Images, Matches, Problem, Rectification, pose_problem

CELLS = "cells"
ROW = "row.json"
MEASURING_CODE = ("warps", "matching", "metrics", "bench/cells", "bench/features", "bench/rectifying")
MEASURING_PACKAGES = ("numpy", "scipy", "opencv-contrib-python-headless", "drjit", "pydantic")

SCORED_MATCHES = 10_000
"""Correspondences the row error is taken over."""

REPEATS = 3
SLOW_CALL_S = 1.0

Result = TypeVar("Result")


def cell_inputs(task: CellTask) -> Inputs:
    """All that shapes the row of a cell; its report's name does not."""
    method = registry("methods").get(task.method_source)
    return {
        "truth": truth_inputs(task.pair),
        "images": image_inputs(task.pair) if _uses_images(task) else None,
        "pose": task.cell.pose,
        "method": method.name,
        "method_source": method.digest,
        "options": checked_options(method, task.options).model_dump(mode="json"),
        "metrics": sorted(task.metrics),
        "match_count": task.match_count,
        "match_noise_px": task.match_noise_px,
        "code": code_digest(*MEASURING_CODE),
        "versions": dict(versions(*MEASURING_PACKAGES)),
    }


def _uses_images(task: CellTask) -> bool:
    needs = registry("methods").get(task.method_source).value.needs
    return "images" in needs or task.cell.pose == ESTIMATED or not IMAGE_METRICS.isdisjoint(task.metrics)


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


def run_pair(pair: PairTask, store_root: Path) -> Outcome:
    """Render a pair into the store; whatever a scene raises becomes a status."""
    try:
        make_pair(pair, Store(store_root))
    except BaseException as error:  # a plugin may raise anything
        return outcome_of(error)
    return Outcome()


def believed_rig(task: CellTask, store: Store) -> Rig:
    """What the rectifier is told: the true rig with its pose perturbed, or estimated from the images.

    Images do not tell how long a baseline is: the true length stands in an estimated rig, too.
    """
    cell, rig = task.cell, placed_rig(task.pair)
    if cell.pose == ESTIMATED:
        return estimated_pose(task.pair, store).rig(rig)
    # Not named after the method: all methods of a pair are misled in the same way.
    seed = derived_seed("pose", cell.scene, cell.rig, cell.motion, cell.pose, cell.seed)
    return perturb(rig, POSES[cell.pose], seed)


def problem_of(task: CellTask, store: Store) -> Problem:
    """What the cell's rectifier may know."""
    cell, needs = task.cell, registry("methods").get(task.method_source).value.needs
    images = load_images(task.pair, store) if "images" in needs else None
    return pose_problem(
        believed_rig(task, store),
        matches=_given_matches(task, store) if "matches" in needs else None,
        images=Images(images.left, images.right) if images else None,
        seed=derived_seed("method", cell.scene, cell.rig, cell.motion, cell.pose, cell.method, cell.seed),
    )


def _given_matches(task: CellTask, store: Store) -> Matches:
    """What a method that works from matches gets: those of the estimate, else true ones with noise."""
    cell = task.cell
    if cell.pose == ESTIMATED:
        return estimated_pose(task.pair, store).inliers
    seed = derived_seed("matches", cell.scene, cell.rig, cell.motion, cell.seed)
    truth = _truth(task.pair, store)
    return Matches(*truth.matches(task.match_count, seed=seed, noise_px=task.match_noise_px))


@lru_cache(maxsize=1)
def _true_matches(pair: PairTask, store: Store) -> Matches:
    return Matches(*_truth(pair, store).matches(SCORED_MATCHES))


@lru_cache(maxsize=1)
def _feature_matches(pair: PairTask, by_estimate: bool, store: Store) -> Matches:
    """Freed of wrong matches by the true pose; or, as the paper frees its own, by the estimated one."""
    rig = placed_rig(pair)
    known = estimated_pose(pair, store).rig(rig) if by_estimate else rig
    return scored_features(load_images(pair, store), known)


@lru_cache(maxsize=1)
def _truth(pair: PairTask, store: Store) -> Truth:
    """Kept, since the methods of one pair run one after another."""
    return load_truth(pair, store)


def _measured(task: CellTask, store: Store) -> Outcome:
    method = registry("methods").get(task.method_source)
    options, problem = checked_options(method, task.options), problem_of(task, store)
    columns: dict[str, float] = {}
    if "timing" in task.metrics:
        rectification, columns["fit_s"] = timed(lambda: method.value.fit(problem, options))
        check_result(method.name, rectification, problem)
    else:
        rectification = fit(method, problem, options)
    columns |= _scores(task, rectification, store)
    if "timing" in task.metrics:
        columns |= _warp_times(rectification)
        if task.cell.pose == ESTIMATED:
            columns["pose_s"] = _pose_time(task.pair, store)
            columns["total_s"] = columns["pose_s"] + columns["fit_s"] + columns["warp_s"]
    return Outcome(metrics=columns, notes=dict(rectification.notes))


def _scores(task: CellTask, rectification: Rectification, store: Store) -> dict[str, float]:
    pair, asked, by_estimate = task.pair, task.metrics, task.cell.pose == ESTIMATED
    rig, with_features = placed_rig(pair), "row_error_features" in asked
    columns = measure(
        rectification,
        rig,
        geometry="geometry" in asked,
        true_matches=_true_matches(pair, store) if "row_error" in asked else None,
        feature_matches=_feature_matches(pair, by_estimate, store) if with_features else None,
    )
    if "distortion" in asked:
        columns |= distortion_columns(Jacobians.at(rectification))
    if by_estimate:
        columns |= pose_columns(estimated_pose(pair, store), rig)
    if "energy" in asked:
        columns["energy_convex_share"] = energy_convex_share(rectification)
    if "reconstruction" in asked:
        images = load_images(pair, store)
        found = reconstruct(rectification, images.left, images.right)
        columns |= reconstruction_scores(found, _truth(pair, store))
    return columns


@lru_cache(maxsize=1)
def _pose_time(pair: PairTask, store: Store) -> float:
    """Seconds from the two images, in memory, to the pose."""
    images = load_images(pair, store)
    return timed(lambda: estimate_from_images(pair, images))[1]


def _warp_times(rectification: Rectification) -> dict[str, float]:
    _, maps_s = timed(lambda: (rectification.maps("left"), rectification.maps("right")))
    left, right = (
        np.full((camera.height, camera.width, 3), 127, dtype=np.uint8)
        for camera in (rectification.left.source, rectification.right.source)
    )
    _, both_s = timed(lambda: rectification.remap(left, right))
    return {"maps_s": maps_s, "warp_s": both_s}


def timed(call: Callable[[], Result]) -> tuple[Result, float]:
    """The result of `call` and the seconds it takes warm: the best of 3 calls after a first one.

    A call of more than a second is timed as it is: it hardly feels that the caches were cold.
    """
    seconds: list[float] = []
    while len(seconds) <= REPEATS:
        start = time.perf_counter()
        result = call()
        seconds.append(time.perf_counter() - start)
        if seconds[0] > SLOW_CALL_S:
            return result, seconds[0]
    return result, min(seconds[1:])
