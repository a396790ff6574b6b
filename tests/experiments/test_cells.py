from __future__ import annotations

import time

import numpy as np
import pytest

from rectbench.experiments.execution.cells import problem_of
from rectbench.experiments.planning import make_plan
from rectbench.experiments.tasks import CellTask
from rectbench.metrics.stopwatch import timed
from rectbench.pairs.opening import open_pair
from rectbench.rigs import Rig
from rectbench.store.store import Store
from tests.experiments.fakes import small_report


def test_times_are_warm_and_the_best_of_three() -> None:
    naps = iter([0.2, 0.03, 0.01, 0.05])
    result, seconds = timed(lambda: time.sleep(next(naps)) or "done")
    assert result == "done"
    assert 0.01 <= seconds < 0.03
    assert next(naps, None) is None


def test_a_slow_call_is_made_once() -> None:
    calls: list[int] = []

    def slow() -> None:
        calls.append(1)
        time.sleep(1.05)

    assert timed(slow)[1] == pytest.approx(1.05, abs=0.3)
    assert len(calls) == 1


def believed(task: CellTask, store: Store) -> Rig:
    return open_pair(task.pair, store).believed_rig(task.cell.pose)


def test_all_methods_of_a_pair_are_misled_alike_and_never_told(store: Store) -> None:
    plan = make_plan(small_report(methods=("abraham", "conventional"), poses=("exact", "perturbed")))
    exact, _, first, second = plan.tasks
    assert believed(exact, store) == open_pair(exact.pair, store).rig
    assert believed(first, store) == believed(second, store) != open_pair(first.pair, store).rig
    problem = problem_of(first, open_pair(first.pair, store))
    assert problem.rig == believed(first, store)
    assert problem.images is None
    # The matches of a calibrated method come from what is believed, not from what is true.
    rays_left, _ = problem.rig.left.unproject(problem.matches.left)
    rays_right, _ = problem.rig.right.unproject(problem.matches.right)
    error = np.einsum("ni,ij,nj->n", rays_right, problem.rig.essential_matrix, rays_left)
    assert np.abs(error).max() < 1e-9


def test_random_numbers_hang_on_the_cell_alone(store: Store) -> None:
    few = make_plan(small_report(methods=("abraham",), poses=("perturbed",), seeds=(5,))).tasks[0]
    many = make_plan(
        small_report(
            name="other", methods=("conventional", "abraham"), poses=("exact", "perturbed"), seeds=(4, 5)
        )
    ).tasks[-1]
    assert (few.cell.method, few.cell.seed) == (many.cell.method, many.cell.seed)
    assert believed(few, store) == believed(many, store)
