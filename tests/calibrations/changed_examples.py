"""Examples of formats with something of them changed."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rectbench import load_rig
from tests.calibrations.examples import EXAMPLES

Change = Callable[[Any], Any]


def loaded(name: str, change: Change, folder: Path, **options: Any) -> Any:
    """The rig of an example whose first file, JSON or text, is changed."""
    example = EXAMPLES[name]
    for number, (file, text) in enumerate(example.files.items()):
        path = folder / file
        if number == 0 and file.endswith(".json"):
            content = json.loads(text)
            content = change(content) or content
            text = json.dumps(content)
        elif number == 0:
            text = change(text)
        path.write_text(str(text))
    paths = [folder / file for file in example.paths or example.files]
    return load_rig(paths, **{**example.options, **options})


def set_at(*keys: Any, value: Any) -> Change:
    """Put a value in a nested place."""

    def change(content: Any) -> None:
        for key in keys[:-1]:
            content = content[key]
        content[keys[-1]] = value

    return change


def put(old: str, new: str, count: int = -1) -> Change:
    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new, count)

    return change
