"""Messages name arguments as whoever gave them does: the command line's by options, Python's by names."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import typer

import rectbench
import rectbench as rb
from rectbench import cli
from rectbench.applications.requests import photographs, rendering, running
from rectbench.applications.requests.request import Request, Word
from rectbench.errors import argument, renamed, spelled
from tests.conftest import Shell
from tests.rigs_for_tests import rig

PACKAGE = Path(rectbench.__file__).parent
REQUESTS = {
    "rectify": photographs.RectifyRequest,
    "pose": photographs.PoseRequest,
    "reconstruct": photographs.ReconstructRequest,
    "uncertainty": photographs.UncertaintyRequest,
    "convert": photographs.ConvertRequest,
    "render": rendering.RenderRequest,
    "export": rendering.ExportRequest,
    "run": running.RunRequest,
    "plan": running.PlanRequest,
}
COMMANDS: dict[str, Any] = typer.main.get_command(cli.app).commands  # type: ignore[attr-defined]
FIELDS = [(verb, name) for verb, request in REQUESTS.items() for name in request.model_fields]
OF_FILES = {("cameras/camera.py", "max_angle_deg"), ("formats/toolboxes/opencv.py", "image_width")}
"""Messages about a key of a file, whoever reads it."""
OF_COMMANDS = ("applications/requests/", "applications/doctor.py", "cli/", "runs/record.py")
"""Where options are named to those who read the command line's help, or a command that was given."""


def spelling(verb: str) -> Callable[[str, object], str]:
    return COMMANDS[verb]._spelling


@pytest.mark.parametrize(("verb", "name"), FIELDS)
def test_every_argument_is_called_by_its_option(verb: str, name: str) -> None:
    word = next(mark for mark in REQUESTS[verb].model_fields[name].metadata if isinstance(mark, Word))
    called = spelling(verb)(name, None)
    if word.is_positional:
        assert called == word.metavar
    else:
        assert called in COMMANDS[verb].get_help(typer.Context(COMMANDS[verb]))
        assert called.startswith("--")


@pytest.mark.parametrize(("verb", "name"), FIELDS)
def test_a_refused_value_is_called_so(verb: str, name: str) -> None:
    """Of no field is this a value; those of any type are checked where they are used."""
    request: type[Request] = REQUESTS[verb]
    needed = {key: "a" for key, field in request.model_fields.items() if field.is_required() or key == "rig"}
    said = {}
    for who in (spelling(verb), None):
        try:
            with spelled(who) if who else renamed():
                request(**{**needed, name: Nothing()})
        except rb.InvalidInput as error:
            said[who] = str(error)
    if len(said) == 2:
        on_the_command_line, in_python = said.values()
        assert spelling(verb)(name, None) in on_the_command_line
        assert re.search(rf"\b{name.removesuffix('s')}", in_python), in_python
        assert "--" not in in_python


class Nothing:
    """No value of anything."""

    def __repr__(self) -> str:
        return "Nothing"

    def __fspath__(self) -> str:
        raise TypeError("it is no path")


def test_an_argument_that_a_verb_has_not_is_spelled_as_in_python() -> None:
    with spelled(spelling("pose")):
        assert argument("max_angle_deg") == "--max-angle-deg"
        assert argument("unit", "mm") == "--unit mm"
        assert argument("spp") == "spp"
    assert argument("unit", "mm") == "unit='mm'"


def test_a_caller_may_call_an_argument_otherwise() -> None:
    with spelled(spelling("convert")), renamed(image_size="size"):
        assert argument("image_size") == "--size"
    with renamed(size="image_size"):
        assert argument("size") == "image_size"


def test_the_same_fault_is_told_to_each_in_their_words(
    shell: Shell, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    rig("kannala-brandt", size=(64, 48)).save("rig.yaml", format="kalibr")
    text = Path("rig.yaml").read_text()
    Path("rig.yaml").write_text("".join(line for line in text.splitlines(True) if "resolution" not in line))
    with pytest.raises(rb.InvalidInput, match="or `size` beside the file"):
        rb.load_rig("rig.yaml")
    code, _, err = shell("convert", "rig.yaml", "-o", "out.yaml")
    assert code == 2
    assert "or `--size` beside the file" in err
    with pytest.raises(rb.InvalidInput, match="or `size` beside the file"):  # it is only told so for a while
        rb.load_rig("rig.yaml")


def test_a_file_of_settings_is_told_of_its_own_keys(
    shell: Shell, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("run.toml").write_text("[run]\njobs = 0\n")
    assert shell("run", "quick", "--config", "run.toml") == (
        2,
        "",
        "rectbench: run.toml: jobs is 0; expected a whole number from 1 on\n",
    )


def sources() -> Iterator[tuple[str, ast.AST]]:
    for path in sorted(PACKAGE.rglob("*.py")):
        yield path.relative_to(PACKAGE).as_posix(), ast.parse(path.read_bytes())


def texts(tree: ast.AST) -> Iterator[str]:
    """The texts of a file that are no docstrings."""
    documenting = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            documenting.update(map(id, node.values))
            yield "".join(
                str(part.value) if isinstance(part, ast.Constant) else "..." for part in node.values
            )
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in documenting:
            yield node.value


def test_no_message_writes_an_option_out() -> None:
    """What names one says `argument`; a whole command, such as `rectbench gate RUN --accept`, may stand."""
    options = {word for command in COMMANDS.values() for param in command.params for word in param.opts}
    written = [
        (file, text)
        for file, tree in sources()
        if not file.startswith(OF_COMMANDS)
        for text in texts(tree)
        if options & set(re.findall(r"--[a-z-]+", re.sub(r"`[^`]*`", "", text)))
    ]
    assert written == []


def test_no_message_writes_an_argument_of_several_words_out() -> None:
    names = {name for _, name in FIELDS if "_" in name}
    written = {
        (file, name)
        for file, tree in sources()
        for node in ast.walk(tree)
        if isinstance(node, ast.Raise)
        for text in texts_said(node)
        for name in names
        if re.search(rf"\b{name}\b", text)
    }
    assert {
        (file, name) for file, name in written if not any((end, name) in OF_FILES for end in ends(file))
    } == set()


def ends(file: str) -> Iterator[str]:
    parts = file.split("/")
    yield from ("/".join(parts[i:]) for i in range(len(parts)))


def texts_said(node: ast.Raise) -> Iterator[str]:
    """The texts of a message, but for the names that `argument` is called with."""
    named = {id(arg) for call in ast.walk(node) if called(call, "argument") for arg in call.args}  # type: ignore[attr-defined]
    for inner in ast.walk(node):
        if isinstance(inner, ast.Constant) and isinstance(inner.value, str) and id(inner) not in named:
            yield inner.value


def called(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == name


def test_every_argument_that_a_message_names_is_one() -> None:
    known = {param.name for command in COMMANDS.values() for param in command.params}
    named = {
        node.args[0].value  # type: ignore[attr-defined]
        for _, tree in sources()
        for node in ast.walk(tree)
        if called(node, "argument") and isinstance(node.args[0], ast.Constant)  # type: ignore[attr-defined]
    }
    assert len(named) > 15
    assert named <= known
