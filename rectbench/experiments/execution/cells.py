"""One cell: a method on a pair, fitted, timed and measured. Runs in a worker process."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

from rectbench.experiments.execution.outcomes import LASTING, Outcome, outcome_of
from rectbench.experiments.tasks import CellTask
from rectbench.margin import MARGIN_DEG
from rectbench.matching import MATCHERS, USUAL_MATCHER
from rectbench.metrics.scoring import digests_of, needs_of, score
from rectbench.metrics.timing import timed
from rectbench.metrics.view import PROJECTION
from rectbench.pairs.opening import open_pair
from rectbench.pairs.pair import Pair
from rectbench.pairs.rendered import RenderedPair
from rectbench.pairs.rendering import Studio, give_memory_back
from rectbench.pairs.spec import ESTIMATED, PairSpec, RenderedSpec
from rectbench.plugins.fitting import checked_options, checked_result
from rectbench.plugins.matches import FROM_IMAGES, true_noise_px
from rectbench.plugins.metric import Case
from rectbench.plugins.rectifier import METHODS, Problem, pose_problem
from rectbench.registry import registry
from rectbench.scored import check_agreement
from rectbench.store.keys import Inputs, code_digest, versions
from rectbench.store.store import Store
from rectbench.types import Images
from rectbench.warps import Rectification

CELLS = "cells"
ROW = "row.json"
MEASURING_PACKAGES = ("numpy", "scipy", "opencv-contrib-python-headless", "drjit", "pydantic")


class Desk:
    """Keeps one pair and one scene: cells of one pair run one after another, as pairs of one scene do."""

    def __init__(self) -> None:
        self._studio = Studio()
        self._pair: Pair | None = None

    def pair(self, spec: PairSpec, store: Store) -> Pair:
        """The pair that is meant, with all that was found of it if it was the last one too."""
        if self._pair is None or (self._pair.spec, self._pair.store) != (spec, store):
            self._pair = None  # two pairs at once are a gigabyte
            self._pair = open_pair(spec, store, self._studio)
        return self._pair

    def clear(self) -> None:
        """Put both away."""
        self._studio, self._pair = Studio(), None


DESK = Desk()
"""That of this process."""


def cell_inputs(task: CellTask, pair: Pair) -> Inputs:
    """All that shapes the row of a cell; its report's name does not."""
    method = registry(METHODS).get(task.method_source)
    return {
        "pair": pair.inputs,
        "images": pair.image_inputs if uses_images(task, pair) else None,
        "pose": task.cell.pose,
        "method": method.name,
        "method_source": method.digest,
        "options": checked_options(method, task.options).model_dump(mode="json"),
        "metrics": digests_of(task.metrics),
        "matches": task.cell.matches,
        "match_count": task.match_count if true_noise_px(task.cell.matches) is not None else None,
        "code": code_digest(__name__),
        "versions": dict(versions(*MEASURING_PACKAGES)),
        **({} if pair.margin_deg == MARGIN_DEG else {"margin_deg": pair.margin_deg}),
        **({} if task.matcher == USUAL_MATCHER else {"matcher": _identity_of_matcher(task.matcher)}),
    }


def _identity_of_matcher(asked: str) -> list[str]:
    """Its name, as a file may hold several, and the digest of its source."""
    plugin = registry(MATCHERS).get(asked)
    return [plugin.name, plugin.digest]


def uses_images(task: CellTask, pair: Pair) -> bool:
    """Whether the row of a cell depends on its images, as that of photographs always does."""
    needs = registry(METHODS).get(task.method_source).value.needs
    asked = "images" in needs | needs_of(task.metrics)
    told = task.cell.pose == ESTIMATED or task.cell.matches == FROM_IMAGES
    return asked or told or not pair.knows_truth


def stored_outcome(task: CellTask, pair: Pair) -> Outcome | None:
    """What an earlier run found for this cell; None where it has to be run."""
    folder = pair.store.read(CELLS, cell_inputs(task, pair))
    if folder is None:
        return None
    return Outcome(**json.loads((folder / ROW).read_text(encoding="utf-8")))


def run_cell(task: CellTask, store_root: Path) -> Outcome:
    """Run a cell and store how it ended; whatever a plugin raises becomes a status."""
    pair = DESK.pair(task.pair, Store(store_root))
    inputs = cell_inputs(task, pair)  # of the sources that run now: a file may be edited meanwhile
    try:
        outcome = _measured(task, pair)
    except BaseException as error:  # a plugin may raise anything, SystemExit and KeyboardInterrupt too
        outcome = outcome_of(error)
    keep(pair.store, inputs, outcome)
    give_memory_back()
    return outcome


def keep(store: Store, inputs: Inputs, outcome: Outcome) -> None:
    """Store how a cell of these inputs ended, if it would end so again."""
    if outcome.status in LASTING:
        store.write_text(CELLS, inputs, ROW, json.dumps(asdict(outcome)))


def run_pair(spec: RenderedSpec, store_root: Path) -> Outcome:
    """Render a pair into the store; whatever a scene raises becomes a status."""
    pair = DESK.pair(spec, Store(store_root))
    assert isinstance(pair, RenderedPair)
    try:
        pair.make()
    except BaseException as error:  # a plugin may raise anything
        return outcome_of(error)
    return Outcome()


def problem_of(task: CellTask, pair: Pair) -> Problem:
    """What the cell's rectifier may know."""
    cell, needs = task.cell, registry(METHODS).get(task.method_source).value.needs
    return pose_problem(
        pair.believed_rig(cell.pose),
        matches=pair.given_matches(cell.matches, task.match_count) if cell.matches else None,
        images=Images(pair.images.left, pair.images.right) if "images" in needs else None,
        seed=pair.seed_of("method", cell.pose, cell.method),
        margin_deg=pair.margin_deg,
    )


def _measured(task: CellTask, pair: Pair) -> Outcome:
    method = registry(METHODS).get(task.method_source)
    pair.require()
    options, problem = checked_options(method, task.options), problem_of(task, pair)

    def fit() -> Rectification:
        return method.value.fit(problem, options)

    made, first_fit_s = timed(fit)
    rectification = checked_result(method.name, made, problem)
    case = Case(
        rectification,
        pair,
        believed=problem.rig,
        works_from=frozenset(method.value.needs),
        pose_is_estimated=task.cell.pose == ESTIMATED,
        fit=fit,
        first_fit_s=first_fit_s,
        matcher=task.matcher,
    )
    check_agreement(rectification, case.delivered)
    columns = score(case, task.metrics)
    stated = {name: note for name, note in rectification.notes.items() if name != PROJECTION}
    return Outcome(metrics=columns, notes={**stated, **case.remarks})
