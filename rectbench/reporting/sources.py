"""Where the pictures in a report come from: the bench's store, or whatever a caller provides."""

from __future__ import annotations

import math
from functools import cached_property

from rectbench.errors import InvalidInput, InvalidResult, RectbenchError
from rectbench.experiments.execution.cells import cell_inputs, problem_of
from rectbench.experiments.tasks import CellTask
from rectbench.matching import Reconstruction, reconstruct
from rectbench.metrics import Jacobians, distortion, distortion_of
from rectbench.pairs.opening import open_pair
from rectbench.pairs.pair import Pair
from rectbench.plugins.cell import Cell
from rectbench.plugins.figure import Sources
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.rectifier import METHODS
from rectbench.plugins.result import Result
from rectbench.registry import registry
from rectbench.runs.record import RUN_FILE
from rectbench.runs.run import Run
from rectbench.store.keys import digest
from rectbench.store.store import Store
from rectbench.warps import Rectification

_FINGERPRINT = "distortion_native_grid"
_SAME_FIT = 1e-3


def sources_of(run: Run) -> Sources:
    """The bench's store and the project's own metrics."""
    recalled = _Recalled(run)
    return Sources(
        pair=recalled.pair,
        rectification=recalled.rectification,
        distortion=lambda rect, rig, side, pixels: distortion(rect, rig, pixels).per_pixel[side],
        reconstruction=recalled.reconstruction,
        version=recalled.version,
    )


class _Recalled:
    """Cells of a finished run: each fitted once, the last pair kept, since several figures show them."""

    def __init__(self, run: Run) -> None:
        self._run = run
        self._store = Store.default()
        self._fitted: dict[Cell, Rectification] = {}
        self._pair: Pair | None = None

    @cached_property
    def _tasks(self) -> dict[Cell, CellTask]:
        return {task.cell: task for task in self._run.record.cells}

    def _task(self, result: Result) -> CellTask:
        task = self._tasks.get(result.cell)
        if task is None:
            file = self._run.folder / RUN_FILE
            raise InvalidInput(f"{file} does not plan {result.method} on {result.pair}")
        return task

    def pair(self, result: Result) -> Pair:
        spec = self._task(result).pair
        if self._pair is None or self._pair.spec != spec:
            self._pair = open_pair(spec, self._store)
        return self._pair

    def rectification(self, result: Result) -> Rectification:
        if result.cell not in self._fitted:
            rectification = _fitted_again(self._task(result), self.pair(result))
            _require_same(rectification, result)
            self._fitted[result.cell] = rectification
        return self._fitted[result.cell]

    def reconstruction(self, result: Result) -> Reconstruction:
        images, matcher = self.pair(result).images, self._task(result).matcher
        return reconstruct(self.rectification(result), images.left, images.right, matcher)

    def version(self, result: Result) -> str:
        try:
            pair = self.pair(result)
            return digest([cell_inputs(self._task(result), pair), pair.image_inputs])
        except RectbenchError as error:  # a plugin or a rig that is not on this machine
            return str(error)


def _fitted_again(task: CellTask, pair: Pair) -> Rectification:
    method = registry(METHODS).get(task.method_source)
    return fit(method, problem_of(task, pair), checked_options(method, task.options))


def _require_same(rectification: Rectification, result: Result) -> None:
    """Raise InvalidResult where the new fit is not the one the run measured: a picture must not lie."""
    measured = result.metrics.get(_FINGERPRINT)
    if measured is None:
        return
    found = float(distortion_of(Jacobians.at(rectification)))
    if not math.isclose(found, measured, rel_tol=_SAME_FIT):
        raise InvalidResult(
            f"fitted again it has the distortion {found:.4g}, the run measured {measured:.4g}; "
            "code or libraries have changed since"
        )
