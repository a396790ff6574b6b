"""Where the pictures in a report come from: the bench's store, or whatever a caller provides."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from rectbench.errors import InvalidInput, InvalidResult, RectbenchError
from rectbench.experiments.tasks import CellTask
from rectbench.metrics import Jacobians, distortion, distortion_of
from rectbench.pairs.opening import open_pair
from rectbench.pairs.pair import Pair
from rectbench.reporting import recall
from rectbench.rigs import Rig
from rectbench.runs.run import Result, Run
from rectbench.store.store import Store
from rectbench.types import FloatArray
from rectbench.warps import Rectification

Side = Literal["left", "right"]
Identity = tuple[Any, ...]
Made = TypeVar("Made")
_FINGERPRINT = "distortion_native"
_SAME_FIT = 1e-3


class Cloud(Protocol):
    """Points in space, one for each pixel of an image."""

    @property
    def points(self) -> FloatArray:
        """[H, W, 3] in the left camera's frame, metres; NaN where there is none."""

    @property
    def colours(self) -> NDArray[np.uint8]:
        """[H, W, 3] RGB."""


@dataclass(frozen=True)
class Sources:
    """How to get, for a cell, its images and what is known of them, its rectification, its distortion.

    Parameters
    ----------
    pair : the images of a cell and what is known of them.
    rectification : the cell's rectification, fitted again.
    distortion : native distortion [N] of a rectification at pixels [N, 2] of one side of a rig.
    reconstruction : the points that dense matching on the cell's rectified pair gives.
    version : changes with whatever changes those answers while the cell's row stays the same.
    """

    pair: Callable[[Result], Pair]
    rectification: Callable[[Result], Rectification]
    distortion: Callable[[Rectification, Rig, Side, FloatArray], FloatArray]
    reconstruction: Callable[[Result], Cloud]
    version: Callable[[Result], str] = lambda result: ""


def attempted(result: Result, make: Callable[[], Made]) -> Made | str:
    """What `make` gives of a cell, or the reason why its picture is missing."""
    if not result.ok:
        return f"{result.status}: {result.reason}" if result.reason else result.status
    try:
        return make()
    except Exception as error:  # a plugin's code runs here, and one picture is no reason to lose a report
        return f"no picture: {error}" if isinstance(error, RectbenchError) else f"no picture: {error!r}"


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
        self._store = Store.default()
        self._fitted: dict[Identity, Rectification] = {}
        self._pair: Pair | None = None

    @cached_property
    def _tasks(self) -> dict[Identity, CellTask]:
        return recall.read_tasks(self._folder)

    def _task(self, result: Result) -> CellTask:
        task = self._tasks.get(recall.identity_of(result.row))
        if task is None:
            raise InvalidInput(f"{self._folder / 'run.json'} does not plan {result.method} on {result.pair}")
        return task

    def pair(self, result: Result) -> Pair:
        return self._opened(self._task(result))

    def _opened(self, task: CellTask) -> Pair:
        if self._pair is None or self._pair.spec != task.pair:
            self._pair = open_pair(task.pair, self._store)
        return self._pair

    def rectification(self, result: Result) -> Rectification:
        key = recall.identity_of(result.row)
        if key not in self._fitted:
            task = self._task(result)
            rectification = recall.recalled_rectification(task, self._opened(task))
            _require_same(rectification, result)
            self._fitted[key] = rectification
        return self._fitted[key]

    def reconstruction(self, result: Result) -> Cloud:
        from rectbench.matching.dense.reconstruction import reconstruct

        images = self.pair(result).images
        return reconstruct(self.rectification(result), images.left, images.right)

    def version(self, result: Result) -> str:
        try:
            task = self._task(result)
            return recall.recalled_version(task, self._opened(task))
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
