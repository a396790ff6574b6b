"""A plugin's file and those beside it: imported under a name of their own, by their bare names, at any time.

Two plugins may each have a `helper.py` in their folders, a helper may bear the name of a library, and it may
be imported within a function: so nothing is put into `sys.path`. The file becomes a module of a private
package whose folder is the plugin's, and its `import helper` is turned into an import from that package.
"""

from __future__ import annotations

import builtins
import importlib
import importlib.util
import sys
from collections.abc import Mapping, Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import FileFinder, ModuleSpec, SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

PRIVATE = "rectbench_file_"
"""How the packages of plugins' folders are called."""


def is_beside(name: str, folder: Path) -> bool:
    """Whether `import name` in a file of this folder means a file, or a folder, beside it.

    Never a module of Python's own or of rectbench; a folder without `__init__.py` only where no library has
    the name.
    """
    if name in sys.stdlib_module_names or name.startswith("rectbench"):
        return False
    if (folder / f"{name}.py").is_file() or (folder / name / "__init__.py").is_file():
        return True
    return any((folder / name).glob("*.py")) and importlib.util.find_spec(name) is None


def load_beside(path: Path, package: str) -> ModuleType:
    """The module of a file, in the private package of this name; raises whatever the file does."""
    if not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder())
    home = ModuleType(package)
    home.__path__ = [str(path.parent)]
    sys.modules[package] = home
    try:
        return importlib.import_module(f"{package}.{path.stem}")
    except BaseException:
        for name in [name for name in sys.modules if name.partition(".")[0] == package]:
            del sys.modules[name]
        raise


class _Finder(MetaPathFinder):
    """Finds the modules of private packages."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if not fullname.startswith(PRIVATE) or not path:
            return None
        return FileFinder(path[0], (_Loader, [".py"])).find_spec(fullname)


class _Loader(SourceFileLoader):
    """Runs a plugin's file as it is now: a compiled one of the same second and size may yet be older."""

    def get_code(self, fullname: str) -> CodeType:
        return compile(self.get_data(self.path), self.path, "exec", dont_inherit=True)

    def exec_module(self, module: ModuleType) -> None:
        package = module.__name__.partition(".")[0]
        vars(module)["__builtins__"] = {**vars(builtins), "__import__": _importer(package)}
        super().exec_module(module)


def _importer(package: str) -> Any:
    """`__import__` for the files of a private package."""
    folder = Path(sys.modules[package].__path__[0])

    def import_(
        name: str,
        globals: Mapping[str, object] | None = None,
        locals: Mapping[str, object] | None = None,
        fromlist: Sequence[str] | None = (),
        level: int = 0,
    ) -> ModuleType:
        top = name.partition(".")[0]
        if level or not is_beside(top, folder):
            return builtins.__import__(name, globals, locals, fromlist or (), level)
        imported = builtins.__import__(f"{package}.{name}", globals, locals, fromlist or (), 0)
        return imported if fromlist else sys.modules[f"{package}.{top}"]

    return import_
