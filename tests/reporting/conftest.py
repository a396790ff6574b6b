"""Fixtures of the report's tests."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from rectbench.plugins.figure import Sources
from tests.reporting.runs import fake_sources, save_run


@pytest.fixture
def write_run(tmp_path: Path) -> Callable[..., Path]:
    """Writes rows as a run's folder in the test's own place."""

    def write(rows: list[dict[str, Any]], name: str = "run", **facts: Any) -> Path:
        return save_run(tmp_path / name, rows, **facts)

    return write


@pytest.fixture
def sources() -> Sources:
    return fake_sources(160)
