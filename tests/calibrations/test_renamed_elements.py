"""An element, attribute or line that a reader does not find is no other lens, as in `test_renamed_keys`."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from rectbench import InvalidInput, load_rig
from tests.calibrations.examples import EXAMPLES
from tests.calibrations.test_every_format import assert_same_rig, written


def check_rig_refusal_or_word(name: str, paths: list[Path], what: str, caplog: Any, words: int) -> None:
    example = EXAMPLES[name]
    caplog.clear()
    try:
        rig = load_rig(paths, **example.options)
    except InvalidInput:
        return
    if len(caplog.records) > words:
        return
    try:
        assert_same_rig(rig, example.rig)
    except AssertionError as error:
        raise AssertionError(f"{what} made another rig without a word") from error


def words_of(name: str, paths: list[Path], caplog: Any) -> int:
    """How many assumptions are told of the example as it is."""
    caplog.clear()
    load_rig(paths, **EXAMPLES[name].options)
    return len(caplog.records)


@pytest.mark.parametrize("name", ["metashape", "metashape-fisheye"])
def test_a_renamed_element_or_attribute_is_no_other_lens(
    tmp_path: Path, name: str, caplog: pytest.LogCaptureFixture
) -> None:
    (path,) = written(EXAMPLES[name], tmp_path)
    text, words = path.read_text(), words_of(name, [path], caplog)
    for tag in sorted(set(re.findall(r"<(\w+)", text))):
        path.write_text(re.sub(rf"(</?){tag}\b", rf"\g<1>{tag}_x", text))
        check_rig_refusal_or_word(name, [path], f"<{tag}> renamed", caplog, words)
    for attribute in sorted(set(re.findall(r" (\w+)=", text))):
        path.write_text(re.sub(rf" {attribute}=", f" {attribute}_x=", text))
        check_rig_refusal_or_word(name, [path], f"{attribute}= renamed", caplog, words)


@pytest.mark.parametrize("name", ["realsense", "realsense-d400"])
def test_a_renamed_line_is_no_other_lens(tmp_path: Path, name: str, caplog: pytest.LogCaptureFixture) -> None:
    (path,) = written(EXAMPLES[name], tmp_path)
    text, words = path.read_text(), words_of(name, [path], caplog)
    for word in sorted(set(re.findall(r"(?m)^ *([A-Z]\w+)", text))):
        path.write_text(re.sub(rf"(?m)^( *){word}\b", rf"\g<1>{word}x", text))
        check_rig_refusal_or_word(name, [path], f"{word} renamed", caplog, words)
