"""Whatever a calibration's files hold, loading them ends with a rig or one line (three of what is unknown).

`RECTBENCH_FUZZ=10000 pytest tests/calibrations/test_fuzzing.py` tries so many inputs of each format,
and cuts each file short at every byte. A hang ends with the stack of what it hangs in; the input lies in the
test's folder.
"""

from __future__ import annotations

import base64
import faulthandler
import os
import resource
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rectbench import RectbenchError, Rig, load_rig
from rectbench.calibrations import told_already
from rectbench.calibrations.checks.unknown import UnknownFormat
from rectbench.calibrations.formats.native import rig_fields
from rectbench.yaml_text import yaml_text
from tests.calibrations.examples import EXAMPLES, FISHEYES, Example
from tests.calibrations.mutations import damaged
from tests.calibrations.test_colmap import COLMAP_BINARY, COLMAP_TEXT
from tests.calibrations.test_mrcal import OPENCV8, RT_LEFT, RT_RIGHT, cameramodel

INPUTS = int(os.environ.get("RECTBENCH_FUZZ", "25"))
HANGS_S = 60.0
MOST_BYTES = 200 << 20


@dataclass(frozen=True)
class Calibration:
    """Files by name, what of them is passed to `load_rig`, and with what."""

    files: Mapping[str, bytes]
    paths: Sequence[str] = ()
    options: Mapping[str, Any] = field(default_factory=dict)


def encoded(example: Example) -> Calibration:
    files = {
        name: content if isinstance(content, bytes) else content.encode()
        for name, content in example.files.items()
    }
    return Calibration(files, example.paths, example.options)


TEXTS = {f"{kind}.txt": text.encode() for kind, text in COLMAP_TEXT.items()}
BINARIES = {f"{kind}.bin": base64.b64decode(COLMAP_BINARY[kind]) for kind in COLMAP_BINARY}
MRCAL = {"left.cameramodel": RT_LEFT, "right.cameramodel": RT_RIGHT}
CALIBRATIONS: dict[str, Calibration] = {
    **{name: encoded(example) for name, example in EXAMPLES.items()},
    "native": Calibration({"native.yaml": yaml_text(rig_fields(FISHEYES)).encode()}),
    "mrcal": Calibration(
        {name: cameramodel("LENSMODEL_OPENCV8", OPENCV8, rt).encode() for name, rt in MRCAL.items()}
    ),
    "colmap-text": Calibration(TEXTS, ["cameras.txt"]),
    "colmap-binary": Calibration(BINARIES, ["cameras.bin"]),
    "colmap-images": Calibration(
        {name: content for name, content in BINARIES.items() if name != "rigs.bin"}, ["cameras.bin"]
    ),
}


@pytest.fixture(autouse=True)
def no_hang() -> Iterator[None]:
    """What hangs in C takes no exception, so the process ends."""
    yield
    faulthandler.cancel_dump_traceback_later()


def resident_bytes(key: str) -> int:
    """Memory of this process in RAM: VmRSS, or VmHWM, its highest since `forget_peak`."""
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith(key))
    return int(line.split()[1]) * 1024


def forget_peak() -> None:
    Path("/proc/self/clear_refs").write_text("5")


def growth(load: Callable[[], None]) -> int:
    """By how many bytes the process grows while it loads, at most."""
    if not os.access("/proc/self/clear_refs", os.W_OK):
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        load()
        return (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024
    forget_peak()
    before = resident_bytes("VmRSS")
    load()
    return resident_bytes("VmHWM") - before


def inputs(name: str) -> Iterator[tuple[str, str, bytes]]:
    """What an input is called, the file that is damaged, and its content then."""
    files = CALIBRATIONS[name].files
    for number in range(INPUTS):
        rng = np.random.default_rng([number, *name.encode()])
        file = list(files)[rng.integers(len(files))]
        yield f"{name} {number}", file, damaged(files[file], rng)
    for file, content in files.items():
        ends = np.linspace(0, len(content), INPUTS // len(files), dtype=int, endpoint=False)
        for end in np.unique(ends):
            yield f"{name}, {file} cut at {end}", file, content[:end]


def check_rig_or_one_line(paths: Sequence[Path], options: Mapping[str, Any], what: str) -> None:
    try:
        with told_already() as told:
            assert isinstance(load_rig(paths, **options), Rig)
        assert all(line.isprintable() for line in told), what
    except RectbenchError as error:
        message = str(error)
        lines = message.split("\n") if isinstance(error, UnknownFormat) else [message]
        assert len(lines) <= 3, what
        assert all(line.isprintable() for line in lines), what
        assert any(str(path.parent) in message for path in paths), (what, message)
        assert len(message) < 1500, (what, message)
    except Exception as error:
        raise AssertionError(f"{what}: {error!r}") from error


@pytest.mark.parametrize("name", CALIBRATIONS)
def test_damaged_files_give_a_rig_or_one_line(tmp_path: Path, name: str) -> None:
    calibration = CALIBRATIONS[name]
    for file, content in calibration.files.items():
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_bytes(content)
    paths = [tmp_path / file for file in calibration.paths or calibration.files]
    load_rig(paths, **calibration.options)
    for what, file, content in inputs(name):
        (tmp_path / file).write_bytes(content)
        faulthandler.dump_traceback_later(HANGS_S, exit=True)
        grown = growth(lambda what=what: check_rig_or_one_line(paths, calibration.options, what))
        assert grown < MOST_BYTES, what
        (tmp_path / file).write_bytes(calibration.files[file])


def test_growth_is_seen_though_it_passes() -> None:
    def swell() -> None:
        bytearray(64 << 20)

    assert growth(swell) > 60 << 20
    assert growth(lambda: None) < 4 << 20
