"""Property tests draw the same examples in every run; and a shell, for tests of the command line."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import settings

from rectbench import cli

settings.register_profile("rectbench", derandomize=True, deadline=None)
settings.load_profile("rectbench")

Shell = Callable[..., tuple[int, str, str]]


@pytest.fixture
def shell(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Shell:
    """Runs `rectbench` with these words; gives exit code, stdout and stderr."""

    def call(*words: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["rectbench", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        captured = capsys.readouterr()
        assert isinstance(ended.value.code, int)
        return ended.value.code, captured.out, captured.err

    return call


@pytest.fixture(scope="session")
def real_data() -> Path:
    """Real pairs and calibrations, which are no part of this repository."""
    folder = Path(os.environ.get("RECTBENCH_DATA", Path(__file__).parents[1] / "../shared/data"))
    if not folder.is_dir():
        pytest.skip(f"no real data at {folder}; RECTBENCH_DATA names another place")
    return folder
