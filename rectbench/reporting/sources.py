"""Where the pictures in a report come from: the bench's store, or whatever a caller provides."""

from __future__ import annotations

import math
from functools import cached_property
from pathlib import Path
from typing import Any

from rectbench.errors import InvalidInput, InvalidResult, RectbenchError
from rectbench.experiments.tasks import CellTask
from rectbench.metrics import Jacobians, distortion, distortion_of
from rectbench.pairs.spec import PairSpec
from rectbench.plugins.figure import Cloud, Result, Sources
from rectbench.reporting import recall
from rectbench.reporting.recall import KnownPair
from rectbench.runs.run import Run
from rectbench.warps import Rectification

Identity = tuple[Any, ...]
_FINGERPRINT = "distortion_native"
_SAME_FIT = 1e-3


def sources_of(run: Run) -> Sources:
    """The bench's store and the project's own metrics."""
    recalled = _Recalled(run.folder)
    return Sources(
        pair=recalled.pair,
        rectification=recalled.rectification,
        distortion=lambda rect, rig, side, pixels: distortion(rect, rig, pixels).per_pixel[side],
        reconstruction=recalled.reconstruction,
        version=recalled.version,
    )


class _Recalled:
    """Cells of a finished run: each fitted once, the last pair kept, since several figures show them."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._fitted: dict[Identity, Rectification] = {}
        self._pair: tuple[PairSpec, KnownPair] | None = None

    @cached_property
    def _tasks(self) -> dict[Identity, CellTask]:
        return recall.read_tasks(self._folder)

    def _task(self, result: Result) -> CellTask:
        task = self._tasks.get(recall.identity_of(result.row))
        if task is None:
            raise InvalidInput(f"{self._folder / 'run.json'} does not plan {result.method} on {result.pair}")
        return task

    def pair(self, result: Result) -> KnownPair:
        task = self._task(result)
        if self._pair is None or self._pair[0] != task.pair:
            self._pair = task.pair, recall.recalled_pair(task)
        return self._pair[1]

    def rectification(self, result: Result) -> Rectification:
        key = recall.identity_of(result.row)
        if key not in self._fitted:
            rectification = recall.recalled_rectification(self._task(result))
            _require_same(rectification, result)
            self._fitted[key] = rectification
        return self._fitted[key]

    def reconstruction(self, result: Result) -> Cloud:
        from rectbench.matching.dense.reconstruction import reconstruct

        images = self.pair(result).images
        return reconstruct(self.rectification(result), images.left, images.right)

    def version(self, result: Result) -> str:
        try:
            return recall.recalled_version(self._task(result))
        except RectbenchError as error:  # a plugin or a rig that is not on this machine
            return str(error)


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
