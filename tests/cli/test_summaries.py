"""What a run prints: what it tells, and tables that fit the terminal."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from rectbench.cli.printing import running
from tests.reporting.runs import METHODS, make_row, save_run

RIGS = tuple(f"rig-{i}" for i in range(6))


def printed(monkeypatch: pytest.MonkeyPatch, folder: Path, width: int) -> str:
    out = io.StringIO()
    monkeypatch.setattr(running, "console", lambda: Console(file=out, width=width, highlight=False))
    running.show_summary(folder)
    return out.getvalue()


def rows() -> list[dict[str, Any]]:
    level = {"matches": "true + 0.1 px"}
    return [
        make_row("none", rig, "exact", method, **(level if method in ("hartley", "fusiello") else {}))
        for rig in RIGS
        for method in METHODS
    ]


@pytest.mark.parametrize("width", [80, 120])
def test_what_ranks_is_there_at_any_width(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, width: int
) -> None:
    text = printed(monkeypatch, save_run(tmp_path / "run", rows()), width)
    assert max(map(len, text.splitlines()[:-1])) <= width  # the last is the page's path
    (first,) = re.findall(r"^ *[\d–]+ +local-homography +([\d.]+) ", text, re.MULTILINE)
    assert 0.1 < float(first) < 0.3
    assert re.search(r"^ *– +conventional +keeps.61.% ", text, re.MULTILINE)


def test_columns_without_room_are_counted(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    folder = save_run(tmp_path / "run", rows())
    assert re.search(r"\d more columns in a wider terminal", printed(monkeypatch, folder, 80))
    assert "wider terminal" not in printed(monkeypatch, folder, 400)


def test_levels_of_matches_are_a_mark_that_is_explained(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    text = printed(monkeypatch, save_run(tmp_path / "run", rows()), 80)
    assert re.search(r"^ *– +hartley\* ", text, re.MULTILINE)
    assert "* with true matches + 0.1 px" in text


def test_what_is_found_is_told_above_the_tables(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    text = " ".join(printed(monkeypatch, save_run(tmp_path / "run", rows()), 120).split())
    assert text.index("at 95 % of the view: abraham's log distortion is") < text.index(
        "Methods under the exact"
    )
    assert "a perspective image has the least log distortion" in text
