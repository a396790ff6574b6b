"""Whatever a calibration's files hold, loading them gives a rig or one line, soon and in little memory.

`RECTBENCH_FUZZ=10000 pytest tests/rigs/test_fuzzing.py` tries so many inputs of each format.
"""

from __future__ import annotations

import os
import resource
import time
from pathlib import Path

import numpy as np
import pytest

from rectbench import RectbenchError, Rig, load_rig
from tests.rigs.examples import EXAMPLES, Example
from tests.rigs.mutations import damaged

INPUTS = int(os.environ.get("RECTBENCH_FUZZ", "25"))
LONGEST_S = 1.0
MOST_BYTES = 200 << 20


@pytest.fixture
def native(rig: Rig, tmp_path: Path) -> Example:
    rig.save(tmp_path / "native.yaml")
    return Example({"native.yaml": (tmp_path / "native.yaml").read_text()}, rig)


def peak_bytes() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def check_survives(example: Example, name: str, folder: Path) -> None:
    """Damage one of the files, load, and put the file back, `INPUTS` times."""
    for file, text in example.files.items():
        (folder / file).parent.mkdir(exist_ok=True)
        (folder / file).write_text(text)
    paths = [folder / file for file in example.paths or example.files]
    load_rig(paths, **example.options)
    before = peak_bytes()
    for number in range(INPUTS):
        rng = np.random.default_rng([number, *name.encode()])
        file = list(example.files)[rng.integers(len(example.files))]
        content = damaged(example.files[file], rng)
        (folder / file).write_bytes(content)
        check_rig_or_one_line(paths, example.options, f"{name} {number}")
        (folder / file).write_text(example.files[file])
    assert peak_bytes() - before < MOST_BYTES


def check_rig_or_one_line(paths: list[Path], options: dict, what: str) -> None:
    start = time.process_time()
    try:
        assert isinstance(load_rig(paths, **options), Rig)
    except RectbenchError as error:
        message = str(error)
        assert message.isprintable(), what
        assert any(str(path.parent) in message for path in paths), (what, message)
        assert len(message) < 1500, (what, message)
    except Exception as error:
        raise AssertionError(f"{what}: {error!r}") from error
    assert time.process_time() - start < LONGEST_S, what


@pytest.mark.parametrize("name", EXAMPLES)
def test_damaged_files_give_a_rig_or_one_line(tmp_path: Path, name: str) -> None:
    check_survives(EXAMPLES[name], name, tmp_path)


def test_damaged_native_files_give_a_rig_or_one_line(tmp_path: Path, native: Example) -> None:
    check_survives(native, "native", tmp_path)
