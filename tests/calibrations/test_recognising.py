"""Which format a file is of: its own marks decide, and no list of formats does."""

from __future__ import annotations

import importlib.metadata
import subprocess
import sys
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

import pytest

from rectbench import Rig, load_rig
from rectbench.calibrations import calibration_formats
from rectbench.calibrations.contract import CameraFormat, RigFormat
from rectbench.calibrations.documents.sources import Source, sources_in
from rectbench.calibrations.recognising import formats
from rectbench.registry import forget_plugins, registry
from rectbench.rigs import written_formats
from rectbench.rigs.file_formats import FORMATS
from tests.calibrations.examples import EXAMPLES, FISHEYES
from tests.calibrations.test_every_format import written

ALSO_CALLED = {
    "openvins": "kalibr",
    "openvins-estimator": "kalibr",
    "orbslam2": "orbslam",
    "orbslam2-rectified": "orbslam",
    "orbslam3": "orbslam",
    "matlab-fisheye": "matlab-camera",
    "anipose-caliscope": "anipose",
}
"""Examples whose format has another name than theirs begins with."""


def sources_of(name: str, folder: Path) -> list[Source]:
    """The files of an example, those in its folders included."""
    paths = written(EXAMPLES[name], folder)
    return [one for path in paths for one in (sources_in(path) if path.is_dir() else [Source.read(path)])]


def format_of(example: str) -> str:
    if example in ALSO_CALLED:
        return ALSO_CALLED[example]
    return max((name for name in calibration_formats() if example.startswith(name)), key=len)


@pytest.mark.parametrize("name", EXAMPLES)
def test_each_example_is_of_its_own_format(tmp_path: Path, name: str) -> None:
    sources = sources_of(name, tmp_path)
    chosen = next(format for format in formats() if any(map(format.recognises, sources)))
    assert chosen.name == format_of(name)


@pytest.mark.parametrize("name", EXAMPLES)
def test_no_two_formats_with_marks_of_their_own_recognise_one_file(tmp_path: Path, name: str) -> None:
    for source in sources_of(name, tmp_path):
        marked = [format for format in formats() if not getattr(format, "shares_keys", False)]
        assert len([format.name for format in marked if format.recognises(source)]) <= 1, source.path


def test_rigs_are_asked_for_before_cameras_and_what_shares_its_keys_last() -> None:
    turns = [(type(format), getattr(format, "shares_keys", False)) for format in formats()]
    assert [turn for turn, _ in groupby(turns)] == [
        (RigFormat, False),
        (CameraFormat, False),
        (RigFormat, True),
    ]


def test_every_file_of_a_family_loads_and_a_file_of_keys_is_no_broken_format() -> None:
    assert registry(FORMATS).broken == {}
    assert "opencv_keys" not in registry(FORMATS).names()


THIRD_PARTY = """
from rectbench.calibrations.contract import RigFormat
from rectbench.calibrations.formats.native import read_fields, rig_fields
from rectbench.rigs.file_formats import Writing

FORMAT = RigFormat(
    "third-party",
    "A lab's own numbers",
    lambda source: source.head.startswith("LAB "),
    lambda sources, given: made(sources[0]),
    write=Writing(lambda rig, name: {name: f"LAB {rig.baseline_m!r}"}),
)


def made(source):
    import numpy as np

    from rectbench import Camera, Rig

    lens = Camera("equidistant", (400, 400), {"fx": 100, "fy": 100, "cx": 199.5, "cy": 199.5})
    return Rig(lens, lens, np.eye(3), [-float(source.text.split()[1]), 0, 0])
"""


@pytest.fixture
def third_party(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """An installed package with a format of its own."""
    (tmp_path / "lab_format.py").write_text(THIRD_PARTY)
    monkeypatch.syspath_prepend(tmp_path)
    point = importlib.metadata.EntryPoint("lab", "lab_format", "rectbench.formats")
    monkeypatch.setattr(
        importlib.metadata, "entry_points", lambda group: [point] if group == point.group else []
    )
    forget_plugins()
    yield
    forget_plugins()


@pytest.mark.usefixtures("third_party")
def test_a_package_announces_a_format_that_is_read_and_written(tmp_path: Path) -> None:
    assert written_formats()["third-party"] is False
    (path,) = FISHEYES.save(tmp_path / "rig.lab", "third-party")
    assert load_rig(path).baseline_m == pytest.approx(FISHEYES.baseline_m, abs=1e-15)


FRESH = """
import sys
from rectbench.cameras import Camera
from rectbench.rigs import Rig

lens = Camera("equidistant", (400, 400), {"fx": 100, "fy": 100, "cx": 199.5, "cy": 199.5})
rig = Rig(lens, lens, [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [-0.1, 0, 0])
assert not any(name.startswith("rectbench.calibrations") for name in sys.modules)
rig.save(sys.argv[1], "kalibr")
"""


def test_a_rig_saves_itself_where_nothing_but_rigs_was_imported(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-c", FRESH, str(tmp_path / "chain.yaml")], check=True)
    assert isinstance(load_rig(tmp_path / "chain.yaml"), Rig)


BUILT_IN = """
import sys
import rectbench as rb

rb.load_rig("t265")
print(*sorted(name for name in sys.modules if name.startswith("rectbench.calibrations.formats.devices")))
"""


def test_a_built_in_rig_loads_no_format_of_others() -> None:
    done = subprocess.run([sys.executable, "-c", BUILT_IN], check=True, capture_output=True, text=True)
    assert done.stdout.split() == []
