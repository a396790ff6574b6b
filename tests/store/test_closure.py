"""Keys cover the source of all that computes: editing any of it gives another key, and nothing else does."""

from __future__ import annotations

import ast
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from rectbench.store.closure import PACKAGE, source_closure
from rectbench.store.keys import code_digest

CELLS = "rectbench.experiments.execution.cells"
"""What computes the rows of a run."""

WITHOUT_ROWS = (
    *("api", "applications", "cli", "progress"),  # verbs
    *("reporting", "runs", "statistics"),  # what is done with rows
    *(
        "calibrations",
        "experiments",
        "pairs.finding",
    ),  # which rows there are to be; a rig's numbers are in the key
)
COMPUTING_BUT_NO_ROWS = {
    "rectbench": "imports each public name when it is first used",
    "rectbench.__main__": "the command line",
    "rectbench.matching.pose.uncalibrated": "a rig for images without a calibration, which no cell has",
    "rectbench.plugins.catalogue": "what columns are called and how they are judged",
    "rectbench.plugins.defaults": "a cell names its method",
    "rectbench.plugins.figure": "what is drawn of the rows",
    "rectbench.plugins.result": "rows as figures and tables ask for them",
    "rectbench.plugins.homography": "in the key of each method that uses it, as its own file is",
}


def module_of(path: Path, root: Path) -> str:
    names = [root.name, *path.relative_to(root).with_suffix("").parts]
    return ".".join(names).removesuffix(".__init__")


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    """A copy of the package's sources."""
    return shutil.copytree(PACKAGE, tmp_path / "rectbench", ignore=shutil.ignore_patterns("*.so*", "*.pyc"))


def test_a_cells_key_moves_with_each_module_of_its_closure_and_with_no_other(copied: Path) -> None:
    closure = set(source_closure(CELLS, root=copied))
    digest_of_cells = code_digest.__wrapped__  # not what was computed before the edit
    before = digest_of_cells(CELLS, root=copied)
    moved = set()
    for path in sorted(copied.rglob("*.py")):
        source = path.read_bytes()
        path.write_bytes(source + b"\n# edited\n")
        if digest_of_cells(CELLS, root=copied) != before:
            moved.add(path)
        path.write_bytes(source)
    assert moved == closure
    assert digest_of_cells(CELLS, root=copied) == before


def test_only_what_computes_no_row_lies_outside_of_a_cells_key() -> None:
    outside = {module_of(path, PACKAGE) for path in PACKAGE.rglob("*.py")} - {
        module_of(path, PACKAGE) for path in source_closure(CELLS)
    }
    folders = tuple(f"rectbench.{folder}" for folder in WITHOUT_ROWS)
    unexplained = {
        name for name in outside if not any(name == f or name.startswith(f"{f}.") for f in folders)
    }
    assert unexplained <= set(COMPUTING_BUT_NO_ROWS)


def imported_by_syntax(body: list[ast.stmt]) -> Iterator[str]:
    """A slow reference: the modules of rectbench that statements import, by Python's own parser."""
    for statement in body:
        if isinstance(statement, ast.ImportFrom):
            assert not statement.level, "expected no relative import"
            if (statement.module or "").split(".")[0] == "rectbench":
                yield statement.module or ""
                yield from (f"{statement.module}.{alias.name}" for alias in statement.names)
        elif isinstance(statement, ast.Import):
            yield from (alias.name for alias in statement.names)
        elif not (isinstance(statement, ast.If) and "TYPE_CHECKING" in ast.unparse(statement.test)):
            for field in ("body", "orelse", "finalbody", "handlers", "cases"):
                yield from imported_by_syntax(getattr(statement, field, []))


def test_the_closure_of_each_module_holds_what_the_parser_finds() -> None:
    by_module = {module_of(path, PACKAGE): path for path in PACKAGE.rglob("*.py")}
    for module, path in by_module.items():
        imported = set(imported_by_syntax(ast.parse(path.read_bytes()).body)) & set(by_module) - {"rectbench"}
        assert {by_module[name] for name in imported} <= set(source_closure(module)), module


def package(root: Path, **sources: str) -> Path:
    root.mkdir()
    (root / "__init__.py").touch()
    for name, source in sources.items():
        (root / f"{name}.py").write_text(source)
    return root


def test_imports_of_each_form_count_and_those_for_type_checkers_do_not(tmp_path: Path) -> None:
    root = package(
        tmp_path / "lib",
        start=(
            "from typing import TYPE_CHECKING\n"
            "import os, lib.plain\n"
            "from lib import named as other, third\n"
            "from lib.several import (\n    one,\n    two as too,  # why\n)\n"
            "if TYPE_CHECKING:\n    from lib.typed import T\n\n    import lib.typed\n\n"
            "def late():\n    from lib.inner import f\n    return f\n"
            "text = '''\nfrom elsewhere import lib\n'''\n"
        ),
        plain="",
        named="",
        third="",
        several="import lib.deep\n",
        deep="",
        inner="",
        typed="",
        alone="",
    )
    found = {path.stem for path in source_closure("lib.start", root=root)}
    assert found == {"start", "plain", "named", "third", "several", "deep", "inner"}
