"""Whatever key of a calibration is renamed or moved: the right lens, a refusal or a told assumption.

Never another lens or pose without a word.
"""

from __future__ import annotations

import logging
from pathlib import Path

import numpy as np
import pytest

from rectbench import RectbenchError, Rig, load_rig
from tests.calibrations.examples import EXAMPLES
from tests.calibrations.renaming import changed_documents, changed_texts, content_of
from tests.calibrations.test_every_format import written

RAYS = np.random.default_rng(3).normal(size=(40, 3)) * [1, 1, 0.6] + [0, 0, 0.5]


def is_same(rig: Rig, expected: Rig) -> bool:
    """Whether two rigs see and stand alike, to the rounding of files."""
    for camera, other in ((rig.left, expected.left), (rig.right, expected.right)):
        (pixels, seen), (pixels_other, seen_other) = camera.project(RAYS), other.project(RAYS)
        both = seen & seen_other
        if camera.size != other.size or (seen != seen_other).any():
            return False
        if not np.allclose(pixels[both], pixels_other[both], atol=1e-6):
            return False
    R, t = rig.R_right_left, rig.t_right_left
    return np.allclose(R, expected.R_right_left, atol=1e-9) and np.allclose(
        t, expected.t_right_left, atol=1e-9
    )


def silently_another(name: str, folder: Path, caplog: pytest.LogCaptureFixture) -> list[str]:
    """The changes after which an example gives another rig, and nothing is told that was not told before."""
    example = EXAMPLES[name]
    paths = written(example, folder)
    caplog.set_level(logging.WARNING)
    expected = load_rig(paths, **example.options)
    told = set(caplog.messages)
    wrong = []
    for file, text in example.files.items():
        if isinstance(text, bytes):
            continue  # an archive, whose keys are read as those of the same document are
        changes = changed_texts(text) if content_of(text) is None else changed_documents(text)
        for what, changed in changes:
            caplog.clear()
            (folder / file).write_text(changed)
            try:
                rig = load_rig(paths, **example.options)
            except RectbenchError:
                continue
            if not set(caplog.messages) - told and not is_same(rig, expected):
                wrong.append(f"{file}: {what}")
        (folder / file).write_text(text)
    return wrong


@pytest.mark.parametrize("name", EXAMPLES)
def test_no_renamed_or_moved_key_gives_silently_another_rig(
    tmp_path: Path, name: str, caplog: pytest.LogCaptureFixture
) -> None:
    assert silently_another(name, tmp_path, caplog) == []
