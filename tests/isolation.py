"""Each test has a store of its own and loads plugins anew."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from rectbench.registry import forget_plugins
from rectbench.store.store import STORE_VARIABLE, Store


@pytest.fixture(autouse=True)
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Store]:
    monkeypatch.setenv(STORE_VARIABLE, str(tmp_path / "store"))
    monkeypatch.chdir(tmp_path)
    yield Store.default()
    forget_plugins()
