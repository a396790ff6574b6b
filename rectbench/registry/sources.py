"""What a plugin's key covers: its file, those beside it that it imports, and what it uses of rectbench."""

from __future__ import annotations

import ast
import importlib.util
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from rectbench.registry.beside import is_beside
from rectbench.store.closure import PACKAGE, source_closure
from rectbench.store.keys import digest, file_digest

_FAR_REACHING = {"rectbench.api", "rectbench.applications.choose_method", "rectbench.calibrations"}
"""The modules of the verbs, and of reading files. What calls a verb may run any part of rectbench and any
built-in plugin, and what reads a file any of the formats, which no import leads to."""
_OURS = ("rectbench.", "rectbench_")
_EVERYTHING = "*"
"""Stands among the public names that a file uses where it uses rectbench in a way that tells no names."""


def plugin_digest(path: Path, root: Path | None = None) -> str:
    """SHA-256 over the sources that shape the plugin in the file `path`.

    Its own file; every file that it imports, however deep, of those beside it or, of an installed package, of
    that package (`root` is its topmost folder, or the file itself of a package that is one file); and the
    modules of the public names that it uses of rectbench, with all that these import. The folder's own place
    is no part of it; neither are files that it reads, modules whose names it makes up, and other libraries.
    """
    is_package, folder = root is not None, root or path.parent
    own = [path] if folder == path else _own_files(path, folder, is_package)
    names = frozenset().union(*(_public_names(file) for file in own))
    return digest(
        {
            "own": {str(file.relative_to(folder)): file_digest(file) for file in own},
            "rectbench": _digests_of(names),
        }
    )


def _own_files(path: Path, root: Path, is_package: bool) -> list[Path]:
    """The file, those below `root` that it imports, and the `__init__.py` of the packages they lie in."""
    found: set[Path] = set()
    queue = [path]
    while queue:
        file = queue.pop()
        if file in found or not file.is_relative_to(root):
            continue
        found.add(file)
        queue += _imported_files(file, root, is_package)
        homes = [folder for folder in file.parents if folder.is_relative_to(root)]
        inits = (folder / "__init__.py" for folder in homes if folder != root or is_package)
        queue += [init for init in inits if init.is_file()]
    return sorted(found)


@cache
def _nodes(source: bytes) -> tuple[ast.AST, ...]:
    """All of a file, walked once: plugins share the files beside them."""
    return tuple(ast.walk(ast.parse(source)))


def _imported_files(file: Path, root: Path, is_package: bool) -> Iterator[Path]:
    for node in _nodes(file.read_bytes()):
        if isinstance(node, ast.ImportFrom):
            module = node.module.split(".") if node.module else []
            for alias in node.names:
                if node.level:
                    yield from _files_of(file.parents[node.level - 1], [*module, alias.name])
                else:
                    yield from _absolute(root, [*module, alias.name], is_package)
        elif isinstance(node, ast.Import):
            for alias in node.names:
                yield from _absolute(root, alias.name.split("."), is_package)


def _absolute(root: Path, names: list[str], is_package: bool) -> Iterator[Path]:
    """The files of a module that is named in full, where it is a plugin's own."""
    if is_package and names[0] == root.name:
        yield from _files_of(root, names[1:])
    elif not is_package and is_beside(names[0], root):
        yield from _files_of(root, names)


def _files_of(place: Path, names: list[str]) -> Iterator[Path]:
    """The files of a module below a folder."""
    for name in names:
        place = place / name
        yield from (file for file in (place.with_suffix(".py"), place / "__init__.py") if file.is_file())


def _public_names(file: Path) -> frozenset[str]:
    """The names of rectbench that a file uses: `rb.NAME`, `from rectbench import NAME`, and modules of it."""
    return _names_in(file.read_bytes())


@cache
def _names_in(source: bytes) -> frozenset[str]:
    aliases: set[str] = set()
    names: set[str] = set()
    for node in _nodes(source):
        if isinstance(node, ast.Import):
            aliases |= {alias.asname or alias.name for alias in node.names if alias.name == "rectbench"}
            names |= {alias.name for alias in node.names if alias.name.startswith(_OURS)}
        elif isinstance(node, ast.ImportFrom) and node.module == "rectbench":
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith(_OURS):
            names.add(str(node.module))
    attributes = [node for node in _nodes(source) if isinstance(node, ast.Attribute)]
    named = [node for node in attributes if isinstance(node.value, ast.Name) and node.value.id in aliases]
    uses = sum(isinstance(node, ast.Name) and node.id in aliases for node in _nodes(source))
    return frozenset({*names, *(node.attr for node in named), *[_EVERYTHING] * (uses > len(named))})


@cache
def _digests_of(names: frozenset[str]) -> str:
    """Of the sources behind names; one that reaches far stands for all of rectbench and its plugins."""
    modules = {_homes().get(name, name) for name in names}
    if _EVERYTHING in modules or _FAR_REACHING & modules or any(m.startswith("rectbench_") for m in modules):
        return digest({name: _digests_in(folder) for name, folder in _folders()})
    known = sorted(module for module in modules if _is_module(module))
    files = source_closure(*known, root=PACKAGE)
    return digest({str(file.relative_to(PACKAGE)): file_digest(file) for file in files})


def _digests_in(folder: Path) -> dict[str, str]:
    files = [file for end in ("py", "yaml") for file in folder.rglob(f"*.{end}")]
    return {str(file.relative_to(folder)): file_digest(file) for file in files}


def _is_module(name: str) -> bool:
    place = PACKAGE.joinpath(*name.split(".")[1:])
    return "." in name and (place.with_suffix(".py").is_file() or (place / "__init__.py").is_file())


def _folders() -> Iterator[tuple[str, Path]]:
    """Those of rectbench and of its built-in plugins, by their packages' names."""
    yield PACKAGE.name, PACKAGE
    for name in ("rectbench_methods", "rectbench_scenes"):
        spec = importlib.util.find_spec(name)
        for folder in (spec.submodule_search_locations or ()) if spec else ():
            yield name, Path(folder)


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
