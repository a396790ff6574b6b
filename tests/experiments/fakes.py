"""Plugin files as a user would drop them in, sound and broken, and small reports over them."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any

import rectbench as rb

METHOD = '''
"""A rectifier for tests."""

import os, signal, sys, time
from pathlib import Path

import numpy as np

import rectbench as rb


class Fake(rb.Rectifier):
    """Keeps rows as Abraham and Förstner do."""

    name = "{name}"

    class Options(rb.Options):
        scale: float = rb.option(1.0, "pixels of output for one of source", gt=0, le=4)

    def fit(self, problem, options):
{before}
        rb.refuse_epipole_in_view(problem.rig)
        focal = options.scale * rb.centre_resolution_px(problem.rig)
        angle = rb.Radial("equidistant", focal, 0.0)
        return rb.Rectification.from_profiles(problem.rig, angle, angle, angle, {{"focal_px": focal}})
'''

SCENE = '''
"""A scene for tests."""

import numpy as np

import rectbench as rb


@rb.scene("{name}")
def build(seed: int) -> rb.World:
    """A wall of random tiles, two metres away."""
{before}
    texels = np.random.default_rng(seed).uniform(0.1, 0.9, (64, 64, 3)).astype(np.float32)
    corners = np.array([[-9, 2, -9], [9, 2, -9], [9, 2, 9], [-9, 2, 9]], dtype=float)
    uv = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    wall = rb.Mesh("wall", corners, np.array([[0, 1, 2], [0, 2, 3]]), uv, rb.Material(texels))
    pose = np.eye(4)
    pose[:3, :3] = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    return rb.World((wall,), pose, ambient=(1.0, 1.0, 1.0))
'''

REPORT = '''
"""A report for tests."""

import rectbench as rb

report = rb.Report(**{fields!r})
'''


def write_method(folder: Path, name: str, before: str = "pass") -> str:
    """The path of a method's file; `before` is what its fit does first."""
    return _write(folder / f"{name}.py", METHOD.format(name=name, before=_indented(before, 8)))


def write_scene(folder: Path, name: str = "wall", before: str = "pass") -> str:
    """The path of a scene's file."""
    return _write(folder / f"{name}.py", SCENE.format(name=name, before=_indented(before, 4)))


def write_report_file(folder: Path, name: str = "small", **fields: Any) -> str:
    """The path of a report's file."""
    report = {**FIELDS, "name": name, **fields}
    return _write(folder / f"{name}.py", REPORT.format(fields=report))


ASSERT_ONE_THREAD = """
    import scipy.linalg, threadpoolctl
    threads = [library["num_threads"] for library in threadpoolctl.threadpool_info()]
    assert threads and set(threads) == {1}, threads
"""
"""What a method may do first that is to run where BLAS and OpenMP have one thread."""

FIELDS: dict[str, Any] = {
    "name": "small",
    "title": "A small report",
    "scenes": ("street",),
    "rigs": ("t265",),
    "methods": ("abraham",),
    "image_width": 96,
    "quality": "fast",
    "spp": 4,
    "metrics": ("geometry",),
    "figures": ("bars",),
    "timeout_s": 120.0,
}
"""A report that asks for nothing that has to be rendered."""


def small_report(**fields: Any) -> rb.Report:
    """A report of one cell; `fields` change it."""
    return rb.Report(**{**FIELDS, **fields})


def _write(path: Path, text: str) -> str:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return str(path)


def _indented(text: str, columns: int) -> str:
    return textwrap.indent(textwrap.dedent(text).strip(), " " * columns)
