"""The house keeps its order: files import one way, and each folder is small and says what is in it."""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import rectbench

PACKAGE = Path(rectbench.__file__).parent
MOST_FILES = 15


def files_by_module(package: Path) -> dict[str, Path]:
    """The package's files by module; an `__init__` is a file like any other."""
    files = {}
    for path in sorted(package.rglob("*.py")):
        parts = (package.name, *path.relative_to(package).with_suffix("").parts)
        files[".".join(parts).removesuffix(".__init__")] = path
    return files


def imports_of(module: str, path: Path, known: dict[str, Path]) -> Iterator[str]:
    """The modules that a file names in any import, those in functions and for type checkers included."""
    package = module.split(".") if path.stem == "__init__" else module.split(".")[:-1]
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            source = ".".join([*base, *([node.module] if node.module else [])])
            targets = {f"{source}.{alias.name}" for alias in node.names}
            yield from targets & known.keys()
            if source in known and targets - known.keys():
                yield source


def circle(package: Path) -> list[str]:
    """The modules of a circle of imports; none where there is no circle."""
    files = files_by_module(package)
    try:
        TopologicalSorter(
            {module: set(imports_of(module, path, files)) for module, path in files.items()}
        ).prepare()
    except CycleError as error:
        found: list[str] = error.args[1]
        return found
    return []


def crowded(package: Path) -> dict[str, int]:
    """The folders with more files of one level than one looks through, and how many beside `__init__`."""
    counts = {folder: len(set(folder.glob("*.py")) - {folder / "__init__.py"}) for folder in folders(package)}
    return {str(folder): count for folder, count in counts.items() if count > MOST_FILES}


def silent(package: Path) -> list[str]:
    """The folders that do not say in a first line what may be in them."""
    return [str(folder) for folder in folders(package) if not first_line(folder / "__init__.py")]


def folders(package: Path) -> list[Path]:
    return sorted({path.parent for path in package.rglob("*.py")})


def first_line(path: Path) -> str:
    if not path.is_file():
        return ""
    return (ast.get_docstring(ast.parse(path.read_bytes())) or "").partition("\n")[0].strip()


def test_no_files_import_each_other_in_a_circle() -> None:
    assert circle(PACKAGE) == []


def test_no_folder_holds_more_files_than_one_looks_through() -> None:
    assert crowded(PACKAGE) == {}


def test_each_folder_says_what_is_in_it() -> None:
    assert silent(PACKAGE) == []


UNDER_TYPE_CHECKING = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from house.a import x\n"


@pytest.mark.parametrize(
    "back",
    [
        "import house.a\n",
        "from house import a\n",
        "from .a import x\n",
        "def f():\n    from house.a import x\n",
        UNDER_TYPE_CHECKING,
    ],
)
def test_a_circle_is_found_however_it_is_written(tmp_path: Path, back: str) -> None:
    house = tmp_path / "house"
    house.mkdir()
    (house / "__init__.py").write_text("")
    (house / "a.py").write_text("from house.b import y\nx = 1\n")
    (house / "b.py").write_text("y = 1\n")
    assert circle(house) == []
    (house / "b.py").write_text(back)
    assert set(circle(house)) == {"house.a", "house.b"}


def test_a_package_is_not_implied_by_its_submodules(tmp_path: Path) -> None:
    house = tmp_path / "house"
    house.mkdir()
    (house / "__init__.py").write_text("from house.a import x\n")
    (house / "a.py").write_text("from house.b import y\n")
    (house / "b.py").write_text("y = 1\n")
    assert circle(house) == []
    (house / "b.py").write_text("from house import x\n")
    assert "house" in circle(house)


def test_a_crowded_and_a_silent_folder_are_named(tmp_path: Path) -> None:
    house = tmp_path / "house"
    house.mkdir()
    for number in range(MOST_FILES):
        (house / f"room{number}.py").write_text("")
    assert crowded(house) == {}
    assert silent(house) == [str(house)]
    (house / "__init__.py").write_text('"""Rooms."""\n')
    assert crowded(house) == {}
    (house / "one_more.py").write_text("")
    assert crowded(house) == {str(house): MOST_FILES + 1}
    assert silent(house) == []


def test_each_folder_is_installed_with_the_package() -> None:
    project = tomllib.loads((PACKAGE.parent / "pyproject.toml").read_text(encoding="utf-8"))
    roots = [PACKAGE, *(PACKAGE.parent / name for name in ("methods", "scenes", "reports"))]
    modules = {module: path for root in roots for module, path in files_by_module(root).items()}
    folders = {module for module, path in modules.items() if path.stem == "__init__"}
    own_names = {name if name.startswith("rectbench") else f"rectbench_{name}" for name in folders}
    assert set(project["tool"]["setuptools"]["packages"]) == own_names
