"""What figures cost: in workers against one process, and PNG as it is compressed against zlib's usual.

pytest tests/benchmarks/test_drawing_speed.py
"""

from __future__ import annotations

import io
import shutil
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from pytest_benchmark.fixture import BenchmarkFixture

from rectbench.experiments.execution.running import workers_for
from rectbench.reporting.drawing import draw_here
from rectbench.reporting.figures import placed_drawings
from rectbench.reporting.report import write_report
from rectbench.reporting.sources import sources_of
from rectbench.reporting.style import encode
from rectbench.runs.making import run
from rectbench.runs.run import read_run
from rectbench.store.store import STORE_VARIABLE
from tests.experiments.fakes import small_report, write_scene

MOST_OF_USUAL = 0.8


def seconds(call: Callable[[], object]) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def test_figures_of_a_run_in_workers(
    benchmark: BenchmarkFixture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(STORE_VARIABLE, str(tmp_path / "store"))
    scene = write_scene(tmp_path, "wall")
    rigs, motions = ("t265", "sony-as200v", "canon-8mm"), ("sideways",)
    metrics = ("geometry", "row_error")
    report = small_report(
        scenes=(scene,), rigs=rigs, motions=motions, image_width=480, figures=None, metrics=metrics
    )
    with workers_for(report) as workers:
        run(report, tmp_path / "run", workers=workers)
        shutil.copytree(tmp_path / "run", tmp_path / "here")
        shutil.copytree(tmp_path / "run", tmp_path / "stored")
        in_workers = benchmark.pedantic(
            lambda: seconds(lambda: write_report(tmp_path / "run", workers=workers)), rounds=1
        )
    known = read_run(tmp_path / "here")
    here = seconds(lambda: list(draw_here(tmp_path / "here")(placed_drawings(known, sources_of(known)))))
    stored = seconds(lambda: write_report(tmp_path / "stored"))
    benchmark.extra_info |= {"workers_of_here": in_workers / here, "stored_of_here": stored / here}


def test_png_in_less_time_than_zlib_s_usual_level(benchmark: BenchmarkFixture) -> None:
    figure = Figure(figsize=(7, 7))
    image = np.random.default_rng(0).normal(128, 20, (900, 900, 3)).clip(0, 255).astype(np.uint8)
    figure.subplots().imshow(image)

    def usual() -> None:
        figure.savefig(io.BytesIO(), format="svg", dpi=220)

    def ours() -> None:
        encode(figure, "svg", 220)

    ours(), usual()
    ratio = float(np.median([seconds(ours) / seconds(usual) for _ in range(5)]))
    benchmark.extra_info["of_usual"] = ratio
    benchmark.pedantic(ours, rounds=1)
    assert ratio < MOST_OF_USUAL
