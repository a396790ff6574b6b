"""The quick report, cold and warm, as a user starts it. Run alone: it wants both cores.

pytest tests/benchmarks/test_report_speed.py
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest


@pytest.mark.benchmark(group="rectbench run quick")
@pytest.mark.parametrize("rounds", [1, 2], ids=["cold", "warm"])
def test_quick(benchmark: Callable[..., Any], tmp_path_factory: pytest.TempPathFactory, rounds: int) -> None:
    root: Path = tmp_path_factory.mktemp("quick")
    # A new home too: compiled kernels are kept in ~/.drjit, and cold means without them.
    environment = {**os.environ, "RECTBENCH_STORE": str(root / "store"), "HOME": str(root)}
    command = [sys.executable, "-m", "rectbench", "run", "quick", "--out", str(root / "run")]

    def run() -> None:
        subprocess.run(command, env=environment, check=True, capture_output=True)

    for _ in range(rounds - 1):
        run()
    benchmark.pedantic(run, rounds=1)  # type: ignore[attr-defined]
