"""Files are there whole or not at all, and an error names the one that is not."""

from __future__ import annotations

from pathlib import Path

import pytest

from rectbench import InvalidInput, Unavailable
from rectbench.writing import make_folder, replace_files, write_atomically


def full_at(call: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The disk takes no more when it is asked to hold its nth file, from 0 on."""
    calls = iter(range(99))

    def fsync(descriptor: int) -> None:
        if next(calls) == call:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", fsync)


def test_text_is_utf_8_with_line_feeds_and_bytes_are_as_they_are(tmp_path: Path) -> None:
    replace_files({tmp_path / "a": "ä\n", tmp_path / "b": b"\r\n"})
    assert [(tmp_path / name).read_bytes() for name in "ab"] == ["ä\n".encode(), b"\r\n"]
    assert (tmp_path / "a").stat().st_mode & 0o777 == 0o644


def test_a_file_of_several_that_fails_leaves_all_as_they_were(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a").write_text("old")
    full_at(1, monkeypatch)
    with pytest.raises(Unavailable, match=r"b: cannot be written \(No space left on device\)"):
        replace_files({tmp_path / "a": "new", tmp_path / "b": "new"})
    assert (tmp_path / "a").read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_the_error_is_the_one_asked_for(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match=r"none/a: cannot be written"):
        replace_files({tmp_path / "none" / "a": "new"}, InvalidInput)


def test_a_folder_in_a_file_s_place_is_told_before_anything_is_written(tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    with pytest.raises(Unavailable, match=r"b: cannot be written \(a folder is there\)"):
        replace_files({tmp_path / "a": "new", tmp_path / "b": "new"})
    assert [path.name for path in tmp_path.iterdir()] == ["b"]


def test_one_file_makes_its_folder(tmp_path: Path) -> None:
    write_atomically(tmp_path / "deep" / "figure.svg", "<svg/>")
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["figure.svg"]


def test_a_file_where_a_folder_should_be_is_named(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("mine")
    with pytest.raises(Unavailable, match="a: cannot be written"):
        write_atomically(tmp_path / "a" / "b", "new")
    with pytest.raises(InvalidInput, match="a: cannot be written"):
        make_folder(tmp_path / "a", InvalidInput)
