"""The quick report as a user starts it: cold, again, and from the store into a new folder.

Run alone: it wants both cores. The cold run's other times are shares of its own, so that a busy machine
does not tell.

pytest tests/benchmarks/test_report_speed.py
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import time
from pathlib import Path

import pytest
from pytest_benchmark.fixture import BenchmarkFixture


@pytest.mark.benchmark(group="rectbench run quick")
def test_quick(benchmark: BenchmarkFixture, tmp_path: Path) -> None:
    # A new home too: compiled kernels are kept in ~/.drjit, and cold means without them.
    environment = {**os.environ, "RECTBENCH_STORE": str(tmp_path / "store"), "HOME": str(tmp_path)}

    def run(folder: str) -> tuple[float, float]:
        """Seconds on the clock, and of all processors."""
        command = [sys.executable, "-m", "rectbench", "run", "quick", "--out", str(tmp_path / folder)]
        start, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, env=environment, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        computed = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return time.perf_counter() - start, computed

    cold, cold_computed = benchmark.pedantic(run, args=("run",), rounds=1)
    new, new_computed = run("new")
    again, again_computed = run("new")
    benchmark.extra_info |= {
        "cold_processor_s": cold_computed,
        "cores_busy": cold_computed / cold,
        "new_folder_of_cold": new / cold,
        "new_folder_of_cold_computed": new_computed / cold_computed,
        "again_of_cold": again / cold,
        "again_of_cold_computed": again_computed / cold_computed,
    }
