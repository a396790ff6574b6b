from __future__ import annotations

from pathlib import Path

import pytest

import rectbench as rb
from rectbench.applications.requests.running import RunRequest, overlaid
from rectbench.applications.requests.words import option_sets_in


def test_options_on_the_command_line_have_types() -> None:
    assert option_sets_in(
        ["conventional.fov_deg=80", "conventional.focal=fov", "m.on=true", "m.list=[1, 2]"]
    ) == {
        "conventional": {"fov_deg": 80, "focal": "fov"},
        "m": {"on": True, "list": [1, 2]},
    }
    assert option_sets_in(["local-homography.alpha-skew=0.7"]) == {"local-homography": {"alpha_skew": 0.7}}


@pytest.mark.parametrize("text", ["alpha", "alpha=1", ".alpha=1", "method.=1", "=1"])
def test_an_option_without_its_parts_says_what_is_expected(text: str) -> None:
    with pytest.raises(rb.InvalidInput, match=r"expected method\.name=value"):
        option_sets_in([text])


def test_later_layers_win() -> None:
    assert overlaid({"m": {"a": 1, "b": 2}}, {"m": {"b": 3}, "n": {}}) == {"m": {"a": 1, "b": 3}, "n": {}}


def test_a_file_says_what_the_command_line_could_which_wins(tmp_path: Path) -> None:
    path = tmp_path / "run.toml"
    path.write_text('[run]\nmethods = ["abraham"]\njobs = 2\n[methods.local-homography]\nalpha_skew = 0.7\n')
    request = RunRequest(report="quick", config=path, jobs=3, options=["local-homography.alpha_skew=0.5"])
    assert (request.methods, request.jobs) == (["abraham"], 3)
    assert request.options == {"local-homography": {"alpha_skew": 0.5}}
    assert RunRequest(report="quick", config=path).options == {"local-homography": {"alpha_skew": 0.7}}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[run]\njops = 2\n", "unknown key of .run. .* 'jops'; did you mean jobs"),
        ("[runs]\n", "unknown section .* 'runs'; did you mean run"),
        ('[run]\njobs = "two"\n', "jobs is 'two'; expected a whole number"),
        ("[run]\njobs = true\n", "jobs is True; expected a whole number"),
        ('[run]\nmethods = "abraham"\n', "methods is 'abraham'; expected a list"),
        ("run = 3\n", "expected a section"),
        ("[methods]\nabraham = 3\n", "expected a section of options"),
        ("[run\n", "is no TOML"),
    ],
)
def test_a_slip_in_the_file_is_named(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "run.toml"
    path.write_text(text)
    with pytest.raises(rb.InvalidInput, match=message) as caught:
        RunRequest(report="quick", config=path)
    assert "run.toml" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(rb.InvalidInput, match=r"absent.toml cannot be read"):
        RunRequest(report="quick", config=tmp_path / "absent.toml")
