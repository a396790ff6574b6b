"""A plugin's key covers what it uses of rectbench, and nothing else of it."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from rectbench.registry import sources
from rectbench.registry.sources import plugin_digest
from rectbench.store.closure import PACKAGE

Edited = Callable[[str], set[str]]
"""From a module's path in the package to the uses whose digest changes with it."""

USES = {
    "from matches": "matches = rb.consistent_matches\n",
    "by a target": "target = rb.Perspective\n",
    "by a verb": "verb = rb.rectify\n",
    "by metrics": "score = rb.metrics.distortion\n",
    "of nothing": "x = 1\n",
}


@pytest.fixture
def edited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Edited]:
    """Edits a copy of the package."""
    copy = shutil.copytree(PACKAGE, tmp_path / "rectbench", ignore=shutil.ignore_patterns("*.so*", "*.pyc"))
    monkeypatch.setattr(sources, "PACKAGE", copy)
    files = {use: tmp_path / f"{use.replace(' ', '_')}.py" for use in USES}
    for use, file in files.items():
        file.write_text(f"import rectbench as rb\n{USES[use]}")

    def digests() -> dict[str, str]:
        sources._homes.cache_clear()
        sources._digests_of.cache_clear()
        return {use: plugin_digest(file) for use, file in files.items()}

    def edit(module: str) -> set[str]:
        before = digests()
        with (copy / module).open("a") as stream:
            stream.write("\n# edited\n")
        after = digests()
        return {use for use in USES if before[use] != after[use]}

    yield edit
    sources._homes.cache_clear()
    sources._digests_of.cache_clear()


@pytest.mark.parametrize(
    ("module", "moved", "unmoved"),
    [
        ("matching/pose/consistent.py", {"from matches", "by a verb"}, {"by a target", "of nothing"}),
        ("warps/targets.py", {"from matches", "by a target", "by metrics", "by a verb"}, {"of nothing"}),
        ("metrics/distortion.py", {"by metrics", "by a verb"}, {"from matches", "by a target", "of nothing"}),
        ("reporting/style.py", {"by a verb"}, {"from matches", "by a target", "by metrics", "of nothing"}),
    ],
)
def test_a_digest_moves_with_the_modules_of_the_names_that_are_used(
    edited: Edited, module: str, moved: set[str], unmoved: set[str]
) -> None:
    changed = edited(module)
    assert moved <= changed
    assert not unmoved & changed


@pytest.mark.parametrize(
    ("source", "names"),
    [
        ("import rectbench as rb\nrb.Rig\nrb.metrics.energy\n", {"Rig", "metrics"}),
        ("import rectbench\nrectbench.Camera\n", {"Camera"}),
        ("from rectbench import Rig as R, Warp\n", {"Rig", "Warp"}),
        ("import numpy as rb\nrb.linspace\n", set()),
    ],
)
def test_public_names_are_found_however_they_are_spelt(tmp_path: Path, source: str, names: set[str]) -> None:
    file = tmp_path / "mine.py"
    file.write_text(source)
    assert sources._public_names(file) == names
