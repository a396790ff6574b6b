"""The words of a verb are its request's; a calibration is given by the same words everywhere."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from pathlib import Path

import pytest

import rectbench as rb
from rectbench.applications.listing import LISTABLE, listed
from rectbench.cli import photographs, rendering
from tests.conftest import Shell
from tests.rigs_for_tests import rig

RIG = rig("kannala-brandt", size=(64, 48))
TAKE_A_RIG = (
    photographs.rectify,
    photographs.pose,
    photographs.reconstruct,
    photographs.uncertainty,
    photographs.convert,
    rendering.render,
    rendering.export,
)


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("verb", TAKE_A_RIG, ids=lambda verb: verb.__name__)
def test_every_verb_with_a_rig_takes_the_same_words_for_it(verb: Callable[..., None]) -> None:
    assert {"rig", "rest", "max_angle_deg", "unit", "cameras"} <= inspect.signature(verb).parameters.keys()


@pytest.mark.parametrize("words", [["--rig", "rig.yaml"], ["rig.yaml"], ["."], ["--rig", "."]])
def test_a_rig_is_a_file_or_a_folder_with_its_option_or_without(shell: Shell, words: list[str]) -> None:
    RIG.save("rig.yaml")
    assert shell("convert", *words, "-o", "out.yaml") == (0, "out.yaml\n", "")
    assert rb.load_rig("out.yaml").left == rb.load_rig("rig.yaml").left


def test_files_that_complete_each_other_are_given_in_either_way(shell: Shell) -> None:
    files = sorted(map(str, RIG.save("cameras", format="ros")))
    assert shell("convert", *files, "-o", "one.yaml")[0] == 0
    named = [word for file in files for word in ("--rig", file)]
    assert shell("convert", *named, "-o", "other.yaml")[0] == 0
    assert Path("one.yaml").read_bytes() == Path("other.yaml").read_bytes()


@pytest.mark.parametrize(
    "words", ["pose a.png b.png", "reconstruct a.png b.png", "uncertainty", "convert -o c", "render street"]
)
def test_a_verb_without_its_rig_says_how_to_give_one(shell: Shell, words: str) -> None:
    code, _, err = shell(*words.split())
    assert (code, err) == (
        2,
        "rectbench: no rig is given; expected --rig CALIB, or CALIB at the end\n",
    )


@pytest.mark.parametrize("kind", LISTABLE)
def test_all_that_can_be_listed_has_names(kind: str) -> None:
    found = listed(kind)
    assert found.entries
    assert not found.broken
    assert all(entry.name and entry.summary for entry in found.entries)
