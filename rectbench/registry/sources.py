"""What a plugin's key covers: its file, those beside it that it imports, and what it uses of rectbench."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from rectbench.store.closure import PACKAGE, source_closure
from rectbench.store.keys import digest, file_digest

_FAR_REACHING = {"rectbench.api", "rectbench.calibrations"}
"""The modules of the verbs, and of reading files. What calls a verb may run any part of rectbench and any
built-in plugin, and what reads a file any of the formats, which no import leads to."""


def plugin_digest(path: Path, package_root: Path | None = None) -> str:
    """SHA-256 over all sources that shape the plugin in the file `path`.

    Its own file; every file that it imports, however deep, from its folder or, of an installed package, from
    that package (`package_root` is its topmost folder); and the modules of the public names that it uses of
    rectbench, with all that these import. The folder's own place is no part of it.
    """
    own = _own_files(path, package_root or path.parent)
    names = frozenset().union(*(_public_names(file) for file in own))
    return digest(
        {
            "own": {str(file.relative_to(package_root or path.parent)): file_digest(file) for file in own},
            "rectbench": _digests_of(names),
        }
    )


def _own_files(path: Path, root: Path) -> list[Path]:
    """The file and those beside it, below `root`, that it imports."""
    found, queue = [], [path]
    while queue:
        file = queue.pop()
        if file not in found:
            found.append(file)
            queue += _imported_files(file, root)
    return sorted(found)


def _imported_files(file: Path, root: Path) -> Iterator[Path]:
    for node in ast.walk(ast.parse(file.read_bytes())):
        if isinstance(node, ast.ImportFrom):
            base = file.parents[node.level - 1] if node.level else None
            module = node.module.split(".") if node.module else []
            for alias in node.names:
                yield from _files_of(base, root, [*module, alias.name])
        elif isinstance(node, ast.Import):
            for alias in node.names:
                yield from _files_of(None, root, alias.name.split("."))


def _files_of(base: Path | None, root: Path, names: list[str]) -> Iterator[Path]:
    """The files of a module and of the packages it lies in; `base` is the folder of a relative import."""
    if base is None and root.name == names[0] and (root / "__init__.py").is_file():
        names = names[1:]  # an installed package that names itself
    place = root if base is None else base
    for name in names:
        place = place / name
        yield from (file for file in (place.with_suffix(".py"), place / "__init__.py") if file.is_file())


def _public_names(file: Path) -> frozenset[str]:
    """The names of rectbench that a file uses: `rb.NAME`, and `from rectbench import NAME`."""
    tree, aliases, names = ast.parse(file.read_bytes()), set(), set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            aliases |= {alias.asname or alias.name for alias in node.names if alias.name == "rectbench"}
        elif isinstance(node, ast.ImportFrom) and node.module == "rectbench":
            names |= {alias.name for alias in node.names}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in aliases:
            names.add(node.attr)
    return frozenset(names)


@cache
def _digests_of(names: frozenset[str]) -> str:
    """Of the sources behind public names; one that reaches far stands for all of rectbench."""
    modules = {_homes()[name] for name in names if name in _homes()}
    everything = _FAR_REACHING & modules
    files = sorted(PACKAGE.rglob("*.py")) if everything else source_closure(*sorted(modules), root=PACKAGE)
    return digest({str(file.relative_to(PACKAGE)): file_digest(file) for file in files})


@cache
def _homes() -> dict[str, str]:
    """The module that each public name comes from, as the package's stub states it."""
    stub = ast.parse((PACKAGE / "__init__.pyi").read_bytes())
    homes = {}
    for node in stub.body:
        if isinstance(node, ast.ImportFrom):
            module = f"{PACKAGE.name}.{node.module}" if node.module else PACKAGE.name
            for alias in node.names:
                homes[alias.asname or alias.name] = module if node.module else f"{module}.{alias.name}"
    return homes
