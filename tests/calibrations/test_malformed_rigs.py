"""What is amiss with a file that is no calibration is said in one line that names it."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rectbench import InvalidInput, Rig, load_rig


def refusal(path: Path, content: bytes) -> str | None:
    """Why a file of that content is no rig, or None where it is one."""
    path.write_bytes(content)
    try:
        assert isinstance(load_rig(path), Rig)
    except InvalidInput as error:
        return str(error)
    return None


def check_rig_or_one_line(path: Path, content: bytes) -> None:
    message = refusal(path, content)
    assert message is None or (str(path) in message and message.isprintable())


@settings(
    max_examples=200,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(content=st.binary())
def test_any_bytes(content: bytes, tmp_path: Path) -> None:
    check_rig_or_one_line(tmp_path / "rig", content)


HUGE_MATRIX = b"""\
%YAML:1.0
---
M1: !!opencv-matrix
   rows: 3000000
   cols: 3000000
   dt: d
   data: [ 1. ]
"""


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is empty"),
        (b" \n", "is empty"),
        (b"\xff\xd8\xff\xe0 a picture", "is not text"),
        (b"cam0:\0", "is binary"),
        (b"hello", "is no calibration known here"),
        (
            b"# Title\n\nProse of a ZED's, [LEFT_CAM_HD], or: an ocam_model: both",
            "is no calibration but text, ",
        ),
        (b"MIT License\n\nCopyright: nobody: here", "is no calibration but text, 'MIT License'; expected"),
        (b"x" * (5 << 20), "is larger than 4 MiB"),
        (b"cam0: " + b"[" * 2000, "is nested too deeply"),
        (b"cam0: " + b"[1]," * 50_000, "is no YAML"),
        (b"cam0: [" + b"[1]," * 50_000, "has over 60000 values"),
        (b"cam0: " + b"1" * (1 << 20), "is larger than 1024 KiB"),
        (b"%YAML:1.0\n---\nM1: " + b"[" * 100_000, "is nested too deeply"),
        (b'{"M1": ' * 100_000, "is nested too deeply"),
        (b'<?xml version="1.0"?>\n<opencv_storage>' + b"<a>" * 100_000, "is nested too deeply"),
        (b"%YAML:1.0\n---\nM1:\n " + b"- " * 100_000, "is nested too deeply"),
        (
            b"%YAML:1.0\n---\nM1: !!opencv-matrix\n   data: !!binary |\n      AAAA\n",
            "tag:yaml.org,2002:binary",
        ),
        (HUGE_MATRIX, "M1 is ['1.']; expected a 3x3 camera matrix"),
        (b"%YAML:1.0\n---\n", "is no calibration known here but ''"),
        (b"%YAML:1.0\n---\nM1: [ 1, 2\n", "is no YAML at line 4"),
    ],
)
def test_what_is_amiss_is_said(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "rig"
    check_rig_or_one_line(path, content)
    assert message in (refusal(path, content) or "")


ENTITIES = """<?xml version="1.0"?>
<!DOCTYPE lolz [<!ENTITY lol "lol"><!ENTITY lol2 "&lol;&lol;&lol;">]>
<opencv_storage><M1>&lol2;</M1></opencv_storage>
"""


def test_xml_entities_are_refused(tmp_path: Path) -> None:
    message = refusal(tmp_path / "rig.xml", ENTITIES.encode())
    assert message is not None
    assert "declares a document type" in message


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "rig.yaml")
    with pytest.raises(InvalidInput, match="cannot be read \\(a pipe\\)"):
        load_rig(tmp_path / "rig.yaml")


def test_a_configuration_cannot_name_files_elsewhere(tmp_path: Path) -> None:
    for name in ("../secret.yaml", "/etc/passwd"):
        path = tmp_path / "config.yaml"
        path.write_text(f"cam0_calib: {name}\ncam1_calib: b.yaml\nbody_T_cam0: {np.eye(4).tolist()}\n")
        with pytest.raises(InvalidInput, match="expected one in its own folder or inside it"):
            load_rig(path)


def test_a_small_file_cannot_unfold_into_a_huge_one(tmp_path: Path) -> None:
    levels = "\n".join(f"l{n}: &l{n} [{', '.join([f'*l{n - 1}'] * 9)}]" for n in range(1, 12))
    path = tmp_path / "bomb.yaml"
    path.write_text(f"rectbench_rig: 1\nl0: &l0 [1]\n{levels}\n")
    with pytest.raises(InvalidInput, match="has over 60000 values"):
        load_rig(path)
