"""Whatever a calibration file holds, loading it gives a rig or one line that names the file."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rectbench import InvalidInput, Rig, load_rig
from tests.rigs.calibration_files import WHOLE_RIG, opencv_file

FRAGMENTS = [
    *(
        "nan",
        ".inf",
        "1e999",
        "-1",
        "0",
        "99999999999999999999",
        "''",
        '"',
        "[",
        "]",
        "{",
        "}",
        "<",
        "</",
        ">",
        "null",
    ),
    *(
        "!!python/object:os.system",
        "!!opencv-matrix",
        "!!binary |",
        "$base64$",
        "&a",
        "*a",
        "<<",
        "? ",
        "- ",
        ": ",
    ),
    *(
        "\0",
        "\t",
        "\n",
        "\r",
        "\x1b",
        "%YAML",
        "---",
        "...",
        "#",
        "\\U00110000",
        "\ufeff",
        "é",
        "cam2:",
        "true",
    ),
]


@st.composite
def damaged(draw: st.DrawFn, text: str) -> bytes:
    """`text` with up to four cuts, replacements, repetitions, or swapped bytes."""
    content = text.encode()
    for _ in range(draw(st.integers(1, 4))):
        start = draw(st.integers(0, len(content)))
        end = min(len(content), start + draw(st.sampled_from([0, 1, 3, 10, 60, 10_000])))
        piece = draw(
            st.one_of(
                st.sampled_from([fragment.encode() for fragment in FRAGMENTS]),
                st.binary(max_size=4),
                st.just(content[start:end] * 2),
                st.just(b""),
            )
        )
        content = content[:start] + piece + content[end:]
    return content


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


fuzzing = settings(
    max_examples=80,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


@fuzzing
@given(data=st.data())
def test_a_damaged_native_file(data: st.DataObject, rig: Rig, tmp_path: Path) -> None:
    rig.save(tmp_path / "whole.yaml")
    check_rig_or_one_line(tmp_path / "rig", data.draw(damaged((tmp_path / "whole.yaml").read_text())))


@fuzzing
@given(data=st.data())
def test_a_damaged_camchain(data: st.DataObject, camchain: str, tmp_path: Path) -> None:
    check_rig_or_one_line(tmp_path / "rig", data.draw(damaged(camchain)))


@pytest.mark.parametrize("suffix", [".yml", ".xml", ".json"])
@fuzzing
@given(data=st.data())
def test_a_damaged_opencv_file(data: st.DataObject, tmp_path: Path, suffix: str) -> None:
    check_rig_or_one_line(tmp_path / "rig", data.draw(damaged(opencv_file(suffix, **WHOLE_RIG))))


@fuzzing
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
        (b"x" * (5 << 20), "is larger than 4 MiB"),
        (b"cam0: " + b"[" * 2000, "is nested too deeply"),
        (b"cam0: " + b"[1]," * 50_000, "is larger than 128 KiB"),
        (b"%YAML:1.0\n---\nM1: " + b"[" * 100_000, "brackets, tags and keys"),
        (b'{"M1": ' * 100_000, "brackets, tags and keys"),
        (b'<?xml version="1.0"?>\n<opencv_storage>' + b"<a>" * 100_000, "brackets, tags and keys"),
        (b"%YAML:1.0\n---\nM1:\n " + b"- " * 100_000, "brackets, tags and keys"),
        (b"%YAML:1.0\n---\nM1: !!opencv-matrix\n   data:!!binary |[ 1 ]\n", "base64"),
        (HUGE_MATRIX, "M1 is no matrix"),
        (b"%YAML:1.0\n---\n", "holds no keys"),
        (b"%YAML:1.0\n---\nM1: [ 1, 2\n", "is damaged at line"),
    ],
)
def test_what_is_amiss_is_said(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "rig"
    check_rig_or_one_line(path, content)
    assert message in (refusal(path, content) or "")


def test_a_small_file_cannot_unfold_into_a_huge_one(tmp_path: Path) -> None:
    levels = "\n".join(f"l{n}: &l{n} [{', '.join([f'*l{n - 1}'] * 9)}]" for n in range(1, 12))
    path = tmp_path / "bomb.yaml"
    path.write_text(f"rectbench_rig: 1\nl0: &l0 [1]\n{levels}\n")
    with pytest.raises(InvalidInput, match="an alias"):
        load_rig(path)
