"""Content addresses: what an object is made from, as canonical JSON, hashed.

Everything that shapes an object goes into its key (source of the plugin, source of the parts of
rectbench that ran, options, rig, seed, versions of the libraries), so that a stored object can be
trusted without asking when it was made. Canonical JSON sorts its names: the order in which options
were given is no part of the key.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from rectbench.store.closure import PACKAGE, source_closure

Inputs = Mapping[str, Any]
"""What shapes an object, as plain JSON values by name."""


def canonical_json(value: Any) -> str:
    """The one JSON text of `value`: sorted names, no spaces, shortest digits that read back exactly.

    Raises ValueError for NaN and infinity, which JSON has not.
    """
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=False)


def digest(value: Any) -> str:
    """SHA-256 of `value` as canonical JSON, 64 hex digits."""
    return hashlib.sha256(canonical_json(value).encode()).hexdigest()


def file_digest(path: Path) -> str:
    """SHA-256 of a file's bytes, 64 hex digits."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def derived_seed(purpose: str, *identity: str | int) -> int:
    """A seed in [0, 2³²) that depends on the identity alone, not on order, process or job count."""
    return int(digest([purpose, *identity])[:8], 16)


@cache
def code_digest(*modules: str, root: Path = PACKAGE) -> str:
    """SHA-256 over the sources of modules of rectbench and of all that they import, see `source_closure`."""
    files = source_closure(*modules, root=root)
    return digest({str(file.relative_to(root)): file_digest(file) for file in files})


@cache
def versions(*packages: str) -> Mapping[str, str | None]:
    """Installed version by package name, None where it is not installed."""
    return {package: _version(package) for package in packages}


def _version(package: str) -> str | None:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None
