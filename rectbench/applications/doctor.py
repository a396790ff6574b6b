"""What is there and what is missing for rectbench to run on this machine."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from rectbench import llvm
from rectbench.applications.listing import plugin_kinds
from rectbench.calibrations import rig_names
from rectbench.errors import RectbenchError, Unavailable
from rectbench.registry import registry
from rectbench.runs.machine import cpu_name, llvm_facts
from rectbench.store.keys import versions
from rectbench.store.store import Store

OLDEST_PYTHON = (3, 11)


@dataclass(frozen=True)
class Finding:
    """One thing looked at; `ok` is None for what is optional and missing."""

    name: str
    ok: bool | None
    text: str


def examine() -> Iterator[Finding]:
    """Look at everything, the machine first."""
    yield Finding(
        "Python", sys.version_info >= OLDEST_PYTHON, f"{platform.python_version()} at {sys.executable}"
    )
    yield Finding("system", True, platform.platform())
    yield Finding("processor", True, f"{cpu_name()}, {os.cpu_count()} cores")
    yield from _packages()
    yield _llvm()
    yield _tried("rendering", _mitsuba)
    yield _tried("store", _store)
    yield from _plugins()


def _packages() -> Iterator[Finding]:
    try:
        wanted = importlib.metadata.requires("rectbench") or []
    except importlib.metadata.PackageNotFoundError:
        yield Finding("rectbench", False, "is not installed; pip install it")
        return
    yield Finding("rectbench", True, versions("rectbench")["rectbench"] or "")
    for requirement in wanted:
        name = re.split(r"[^A-Za-z0-9._-]", requirement, maxsplit=1)[0]
        optional = "extra ==" in requirement
        if optional and name != "distributed":
            continue
        version = versions(name)[name]
        if version is None and "platform_machine" in requirement and not _is_linux_x86():
            continue
        missing = "is not installed" + ("; pip install 'rectbench[dask]' for --dask" if optional else "")
        yield Finding(name, True if version else (None if optional else False), version or missing)


def _is_linux_x86() -> bool:
    return sys.platform == "linux" and platform.machine() == "x86_64"


def _llvm() -> Finding:
    facts = llvm_facts()
    if "problem" in facts:
        return Finding("LLVM", False, facts["problem"])
    return Finding("LLVM", True, f"{facts['version']} at {facts['path'] or 'a place of Dr.Jit’s own choice'}")


def _tried(name: str, look: Callable[[], str]) -> Finding:
    """What is found by a look that raises a RectbenchError where something is missing."""
    try:
        return Finding(name, True, look())
    except RectbenchError as error:
        return Finding(name, False, str(error))


def _mitsuba() -> str:
    from rectbench.rendering.variant import mitsuba

    if not llvm.available():
        raise Unavailable("needs LLVM")
    mi = mitsuba()
    return f"Mitsuba {mi.__version__}, variant {mi.variant()}"


def _store() -> str:
    store = Store.default()
    with store.making("doctor", {}):
        pass
    entries = store.entries()
    size = sum(entry.size_bytes for entry in entries) / 2**20
    return f"{store.root}: {len(entries)} objects, {size:.0f} MiB"


def _plugins() -> Iterator[Finding]:
    for kind in plugin_kinds():
        found = registry(kind)
        yield Finding(kind.name, bool(found.names()), ", ".join(found.names()) or "none are installed")
        for place, reason in found.broken.items():
            yield Finding(kind.name, None, f"broken: {place}: {reason}")
    yield Finding("rigs", bool(rig_names()), ", ".join(rig_names()) or "none are installed")
