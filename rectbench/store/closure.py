"""Which files of rectbench shape what a module computes: itself and all that it imports, however deep."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]


def source_closure(*modules: str, root: Path = PACKAGE) -> tuple[Path, ...]:
    """The source files of `modules` and of every module of the package that these import, sorted.

    Parameters
    ----------
    modules : full names, such as `rectbench.pairs.pair`.
    root : the package's folder, named after the package.

    Imports inside functions count, since they compute as well; those for type checkers alone do not. A
    package's `__init__` counts with each of its modules, since Python runs it first.
    """
    if unknown := [name for name in modules if _file_of(name, root) is None]:
        raise ValueError(f"there is no module {unknown[0]} in {root}")
    found: dict[str, Path] = {}
    queue = list(modules)
    while queue:
        for name in _with_packages(queue.pop()):
            path = _file_of(name, root)
            if path is not None and name not in found:
                found[name] = path
                queue += _imports_of(path, root.name)
    return tuple(sorted(found.values()))


def _with_packages(module: str) -> Iterator[str]:
    """A module's name and those of the packages it lies in, without the topmost, which imports lazily."""
    names = module.split(".")
    return (".".join(names[:count]) for count in range(2, len(names) + 1))


def _file_of(module: str, root: Path) -> Path | None:
    place = root.joinpath(*module.split(".")[1:])
    candidates = (place.with_suffix(".py"), place / "__init__.py")
    return next((path for path in candidates if path.is_file()), None)


@cache
def _imports_of(path: Path, package: str) -> tuple[str, ...]:
    """The modules of the package that a file imports; names that are no modules among them do no harm."""
    return tuple(_imported(ast.parse(path.read_bytes()).body, package))


def _imported(body: list[ast.stmt], package: str) -> Iterator[str]:
    for statement in body:
        if isinstance(statement, ast.ImportFrom):
            module = statement.module or ""
            if module.split(".")[0] == package:
                yield module
                yield from (f"{module}.{alias.name}" for alias in statement.names)
        elif isinstance(statement, ast.Import):
            yield from (alias.name for alias in statement.names if alias.name.split(".")[0] == package)
        elif not _is_for_type_checkers(statement):
            for field in ("body", "orelse", "finalbody", "handlers", "cases"):
                yield from _imported(getattr(statement, field, []), package)


def _is_for_type_checkers(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.If) and "TYPE_CHECKING" in ast.unparse(statement.test)
