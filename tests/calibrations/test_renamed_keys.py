"""A key that a reader does not find is no other lens: the rig stays, is refused, or the guess is told."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from rectbench import InvalidInput, load_rig
from tests.calibrations.examples import devices, exports, photogrammetry, vehicles
from tests.calibrations.test_every_format import assert_same_rig, written

EXAMPLES = {**devices.EXAMPLES, **exports.EXAMPLES, **photogrammetry.EXAMPLES, **vehicles.EXAMPLES}
NESTED = {name: example for name, example in EXAMPLES.items() if not name.startswith(("opencv", "metashape"))}
SUFFIXES = (".json", ".yaml")


def keys(content: Any) -> Iterator[tuple[Any, str]]:
    """Every key at any depth, with the mapping that it is in."""
    for value in content.values() if isinstance(content, dict) else content:
        if isinstance(value, dict | list):
            yield from keys(value)
    if isinstance(content, dict):
        yield from ((content, key) for key in content)


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


@pytest.mark.parametrize("name", NESTED)
def test_a_renamed_key_is_no_other_lens(tmp_path: Path, name: str, caplog: pytest.LogCaptureFixture) -> None:
    paths = written(EXAMPLES[name], tmp_path)
    words = words_of(name, paths, caplog)
    for path in [path for path in paths if path.suffix in SUFFIXES]:
        text = path.read_text()
        read, write = (json.loads, json.dumps) if path.suffix == ".json" else (yaml.safe_load, yaml.safe_dump)
        for place in range(len(list(keys(read(text))))):
            content = copy.deepcopy(read(text))
            holder, key = list(keys(content))[place]
            renamed = {f"{old}_x" if old == key else old: value for old, value in holder.items()}
            holder.clear()
            holder.update(renamed)
            path.write_text(write(content))
            check_rig_refusal_or_word(name, paths, f"{path.name}: {key} renamed", caplog, words)
        path.write_text(text)


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
