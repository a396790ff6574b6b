from __future__ import annotations

import numpy as np

from rectbench.experiments.execution.cells import cell_inputs, problem_of
from rectbench.experiments.planning import make_plan
from rectbench.experiments.selecting import Selection
from rectbench.experiments.tasks import CellTask
from rectbench.margin import MARGIN_DEG
from rectbench.pairs.opening import open_pair
from rectbench.rigs import Rig
from rectbench.store.store import Store
from tests.experiments.fakes import small_report


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


def test_a_margin_reaches_method_score_and_store_and_the_usual_one_changes_no_key(store: Store) -> None:
    usual = make_plan(small_report(methods=("abraham",))).tasks[0]
    stated = make_plan(small_report(methods=("abraham",)), Selection(margin_deg=20.0)).tasks[0]
    same = make_plan(small_report(methods=("abraham",)), Selection(margin_deg=MARGIN_DEG)).tasks[0]
    pairs = [open_pair(task.pair, store) for task in (usual, stated, same)]
    assert [pair.margin_deg for pair in pairs] == [MARGIN_DEG, 20.0, MARGIN_DEG]
    assert pairs[0].inputs == pairs[1].inputs  # nothing is rendered again
    keys = [cell_inputs(task, pair) for task, pair in zip((usual, stated, same), pairs, strict=True)]
    assert keys[0] == keys[2] != keys[1]
    assert problem_of(stated, pairs[1]).rig == pairs[1].rig.trimmed(20.0)


def test_an_image_circle_of_a_report_takes_the_place_of_the_rigs(store: Store) -> None:
    report = small_report(methods=("abraham",), max_angle_deg={"t265": 60.0})
    tasks = make_plan(report).tasks
    circles = {task.cell.rig: open_pair(task.pair, store).rig.left.max_angle_deg for task in tasks}
    assert circles.get("t265", 60.0) == 60.0
    assert tasks[0].pair.max_angle_deg == report.max_angle_deg.get(tasks[0].cell.rig)


def test_a_run_with_another_margin_is_not_the_whole_report() -> None:
    assert not make_plan(small_report(), Selection(margin_deg=5.0)).is_whole
