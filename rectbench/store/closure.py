"""Which files of rectbench shape what a module computes: itself and all that it imports, however deep."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]

_COMMENT = re.compile(r"#.*")
_FOR_TYPE_CHECKERS = re.compile(r"^if TYPE_CHECKING:\n(?:[ \t]+.*\n|\n)*", re.MULTILINE)
_IMPORT = re.compile(r"^[ \t]*(?:from[ ]+([\w.]+)[ ]+)?import[ ]+(\([^)]*\)|.*)", re.MULTILINE)
"""A whole statement. Found in the text: parsing two hundred files costs half a second a process."""
_NAME = re.compile(r"[\w.]+")


def source_closure(*modules: str, root: Path = PACKAGE) -> tuple[Path, ...]:
    """The source files of `modules` and of every module of the package that these import, sorted.

    Parameters
    ----------
    modules : full names, such as `rectbench.pairs.pair`.
    root : the package's folder, named after the package.

    Imports inside functions count, since they compute as well; those for type checkers alone do not. A
    package's `__init__` counts with each of its modules, since Python runs it first.
    """
    files = _files_by_module(root)
    if unknown := [name for name in modules if name not in files]:
        raise ValueError(f"there is no module {unknown[0]} in {root}")
    found: dict[str, Path] = {}
    queue = list(modules)
    while queue:
        for name in _with_packages(queue.pop()):
            if name in files and name not in found:
                found[name] = files[name]
                queue += _imports_of(files[name], root.name)
    return tuple(sorted(found.values()))


@cache
def _files_by_module(root: Path) -> dict[str, Path]:
    files = {}
    for path in root.rglob("*.py"):
        names = [root.name, *path.relative_to(root).with_suffix("").parts]
        files[".".join(names).removesuffix(".__init__")] = path
    return files


def _with_packages(module: str) -> Iterator[str]:
    """A module's name and those of the packages it lies in, without the topmost, which imports lazily."""
    names = module.split(".")
    return (".".join(names[:count]) for count in range(2, len(names) + 1))


@cache
def _imports_of(path: Path, package: str) -> tuple[str, ...]:
    """The modules of the package that a file imports; names that are no modules among them do no harm."""
    text = _FOR_TYPE_CHECKERS.sub("", _COMMENT.sub("", path.read_text(encoding="utf-8")))
    modules = []
    for home, imported in _IMPORT.findall(text):
        names = _NAME.findall(imported)
        modules += [home, *(f"{home}.{name}" for name in names)] if home else names
    return tuple(module for module in modules if module.partition(".")[0] == package)
