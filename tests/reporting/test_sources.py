from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from rectbench.errors import InvalidResult
from rectbench.metrics import distortion
from rectbench.reporting import sources
from rectbench.reporting.sources import sources_of
from rectbench.runs.run import Run, read_run
from tests.reporting.runs import fake_rectification, fake_rig, make_row

RIG = fake_rig(160)
RECTIFICATION = fake_rectification(RIG, "abraham")


@pytest.fixture
def run_of(write_run: Callable[..., Path], monkeypatch: pytest.MonkeyPatch) -> Callable[[float], Run]:
    """A run of one cell whose refit is RECTIFICATION, by the distortion it claims to have measured."""

    def read(native: float) -> Run:
        row = make_row("street", "t265", "exact", "abraham", distortion_native_grid=native)
        run = read_run(write_run([row]))
        planned = SimpleNamespace(cell=run.results[0].cell, pair="the pair")
        monkeypatch.setattr(sources, "open_pair", lambda spec, store: SimpleNamespace(spec=spec))
        monkeypatch.setattr(sources, "_fitted_again", refit)
        return replace(run, record=run.record.model_copy(update={"cells": (planned,)}))

    fits: list[Any] = []

    def refit(task: Any, pair: Any) -> Any:
        fits.append(task)
        assert len(fits) == 1, "fitted twice"
        return RECTIFICATION

    return read


def test_a_cell_is_fitted_once_for_all_its_pictures(run_of: Callable[[float], Run]) -> None:
    run = run_of(float(distortion(RECTIFICATION, RIG)))
    found = sources_of(run)
    assert found.rectification(run.results[0]) is RECTIFICATION
    assert found.rectification(run.results[0]) is RECTIFICATION


def test_a_refit_that_is_not_what_the_run_measured_is_no_picture_of_it(
    run_of: Callable[[float], Run],
) -> None:
    run = run_of(1.01 * float(distortion(RECTIFICATION, RIG)))
    with pytest.raises(InvalidResult, match="have changed since"):
        sources_of(run).rectification(run.results[0])


def test_a_version_that_cannot_be_told_stops_nothing(write_run: Callable[..., Path]) -> None:
    run = read_run(write_run([make_row("street", "t265", "exact", "abraham")]))
    assert "run.json" in sources_of(run).version(run.results[0])
