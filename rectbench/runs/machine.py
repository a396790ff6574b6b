"""What a run runs on: the processor, libLLVM, Python, the versions of libraries and of the source."""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict

from rectbench import llvm
from rectbench.store.closure import PACKAGE
from rectbench.store.keys import versions

PACKAGES = (
    "rectbench",
    "numpy",
    "scipy",
    "opencv-contrib-python-headless",
    "mitsuba",
    "drjit",
    "pandas",
    "pyarrow",
    "pydantic",
    "karellen-llvm-core",
)


class Machine(BaseModel):
    """The machine and the software on it."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    git_revision: str | None
    """The commit of the source, marked where files differ from it; None outside of git."""
    cpu: str
    cores: int | None
    llvm: Mapping[str, str | None]
    python: str
    platform: str
    versions: Mapping[str, str | None]

    @classmethod
    def here(cls) -> Machine:
        """This one."""
        return cls(
            git_revision=git_revision(),
            cpu=cpu_name(),
            cores=os.cpu_count(),
            llvm=llvm_facts(),
            python=platform.python_version(),
            platform=platform.platform(),
            versions=versions(*PACKAGES),
        )


def git_revision() -> str | None:
    """The commit of the source this runs from, marked where files differ from it; None outside of git."""
    describe = ("describe", "--always", "--dirty", "--abbrev=40", "--exclude=*")
    command = ["git", "-C", str(PACKAGE.parent), *describe]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()


def cpu_name() -> str:
    """The processor's name, as the system tells it."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor() or platform.machine())


def llvm_facts() -> dict[str, Any]:
    """Which libLLVM compiles the kernels, its version, or why there is none."""
    problem = llvm.problem()
    facts: dict[str, Any] = {"path": os.environ.get(llvm.PATH_VARIABLE)}
    if problem:
        return {**facts, "problem": problem}
    import drjit

    return {**facts, "version": ".".join(map(str, drjit.detail.llvm_version()))}
