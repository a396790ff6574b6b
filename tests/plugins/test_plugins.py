from __future__ import annotations

import importlib.metadata
import sys
from pathlib import Path

import pytest

import rectbench as rb
from rectbench.experiments.spec import REPORTS
from rectbench.plugins.rectifier import METHODS
from rectbench.plugins.scene import SCENES
from rectbench.registry import Registry, forget_plugins, registry
from tests.experiments.fakes import write_method, write_report_file, write_scene


def test_built_ins_are_found_by_name() -> None:
    assert {"conventional", "abraham", "hartley", "fusiello", "local-homography"} <= set(
        registry(METHODS).names()
    )
    assert {"street", "corridor", "room", "forest"} <= set(registry(SCENES).names())
    assert "quick" in registry(REPORTS).names()
    for kind in (METHODS, SCENES, REPORTS):
        found = registry(kind)
        assert found.broken == {}
        assert all(plugin.summary for plugin in found.plugins())


def test_a_file_serves_where_a_name_does(tmp_path: Path) -> None:
    assert registry(METHODS).get(write_method(tmp_path, "mine")).name == "mine"
    assert registry(METHODS).get(Path(write_method(tmp_path, "mine"))).name == "mine"
    assert registry(SCENES).get(write_scene(tmp_path, "wall")).value.build(0).meshes
    assert registry(REPORTS).get(write_report_file(tmp_path, "little")).value.name == "little"


def test_the_digest_of_a_plugin_is_that_of_its_source(tmp_path: Path) -> None:
    first = registry(METHODS).get(write_method(tmp_path, "mine")).digest
    assert registry(METHODS).get(write_method(tmp_path / "elsewhere", "mine")).digest == first
    assert registry(METHODS).get(write_method(tmp_path, "mine", "x = 1")).digest != first


def test_an_edited_file_is_loaded_anew(tmp_path: Path) -> None:
    first = registry(METHODS).get(write_method(tmp_path, "mine"))
    path = Path(first.path)
    path.write_text(path.read_text().replace('"mine"', '"yours"'))
    assert registry(METHODS).get(str(path)).name == "yours"


def test_an_unknown_name_gets_the_nearest() -> None:
    with pytest.raises(
        rb.UnknownName, match="unknown method 'local-homografy'; did you mean local-homography"
    ):
        registry(METHODS).get("local-homografy")


BROKEN = {
    "syntax": ("def f(:\n", "SyntaxError"),
    "import": ("import no_such_package_here\n", "ModuleNotFoundError.*line 1"),
    "raises": ("raise ValueError('at\\nimport')\n", r"ValueError: at import \(line 1"),
    "exits": ("raise SystemExit(3)\n", "SystemExit"),
    "empty": ("import rectbench as rb\n", "no method in it.*subclass of rectbench.Rectifier"),
    "abstract": (
        "import rectbench as rb\nclass M(rb.Rectifier):\n    name = 'm'\n",
        "abstract",
    ),
    "nameless": (
        "import rectbench as rb\nclass M(rb.Rectifier):\n    def fit(self, problem, options): ...\n",
        "name is None; expected a text",
    ),
    "options": (
        "import rectbench as rb\nclass M(rb.Rectifier):\n    name = 'm'\n    Options = dict\n"
        "    def fit(self, problem, options): ...\n",
        "expected a subclass of Options",
    ),
    "two": (
        "import rectbench as rb\n"
        + "".join(
            f"class M{i}(rb.Rectifier):\n    name = 'm{i}'\n    def fit(self, problem, options): ...\n"
            for i in range(2)
        ),
        "several methods",
    ),
}


@pytest.mark.parametrize("kind", BROKEN)
def test_a_broken_file_says_why_in_one_line(tmp_path: Path, kind: str) -> None:
    source, reason = BROKEN[kind]
    (tmp_path / "mine.py").write_text(source)
    with pytest.raises(rb.InvalidInput, match=reason) as caught:
        registry(METHODS).get(str(tmp_path / "mine.py"))
    assert "mine.py" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_report_with_a_wrong_field_names_it(tmp_path: Path) -> None:
    with pytest.raises(rb.InvalidInput, match="spp") as caught:
        registry(REPORTS).get(write_report_file(tmp_path, spp=0))
    assert "\n" not in str(caught.value)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(rb.InvalidInput, match=r"there is no file .*absent\.py"):
        registry(METHODS).get(str(tmp_path / "absent.py"))


def test_two_plugins_of_one_name_name_both_files(tmp_path: Path) -> None:
    with pytest.raises(rb.InvalidInput) as caught:
        registry(METHODS).get(write_method(tmp_path, "abraham"))
    assert str(tmp_path / "abraham.py") in str(caught.value)
    assert str(registry(METHODS).get("abraham").path) in str(caught.value)


class FakePoint(importlib.metadata.EntryPoint):
    """An entry point of a package that is not installed as one."""


def with_points(monkeypatch: pytest.MonkeyPatch, folder: Path, *modules: str) -> Registry:
    monkeypatch.syspath_prepend(folder)
    points = [importlib.metadata.EntryPoint(name, name, "rectbench.methods") for name in modules]

    def entry_points(group: str) -> list[importlib.metadata.EntryPoint]:
        return points if group == "rectbench.methods" else []

    monkeypatch.setattr(importlib.metadata, "entry_points", entry_points)
    for module in modules:
        monkeypatch.delitem(sys.modules, module.partition(":")[0], raising=False)
    forget_plugins()
    return registry(METHODS)


def test_installed_packages_announce_theirs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_method(tmp_path, "third_party")
    assert with_points(monkeypatch, tmp_path, "third_party").get("third_party").path.parent == tmp_path


def test_a_broken_package_is_listed_and_stops_nobody(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "broken_party.py").write_text("import no_such_package_here\n")
    write_method(tmp_path, "sound_party")
    found = with_points(monkeypatch, tmp_path, "broken_party", "sound_party")
    assert {"sound_party", "abraham"} <= set(found.names())
    ((place, reason),) = found.broken.items()
    assert "broken_party" in place
    assert "no_such_package_here" in reason
    with pytest.raises(rb.UnknownName):
        found.get("broken_party_method")


def test_two_packages_of_one_name_clash_and_others_do_not_suffer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = Path(write_method(tmp_path, "first_party"))
    (tmp_path / "second_party.py").write_text(path.read_text())
    found = with_points(monkeypatch, tmp_path, "first_party", "second_party")
    with pytest.raises(rb.InvalidInput, match=r"first_party.py and .*second_party.py"):
        found.get("first_party")
    assert found.get("abraham").name == "abraham"
    assert "first_party" not in [plugin.name for plugin in found.plugins()]
    assert any("two methods are called" in reason for reason in found.broken.values())


def test_an_xml_scene_changes_with_the_files_it_names(tmp_path: Path) -> None:
    scene = tmp_path / "hall.xml"
    scene.write_text(
        '<scene version="3.0.0"><shape type="ply"><string name="filename" value="mesh.ply"/></shape></scene>'
    )
    (tmp_path / "mesh.ply").write_text("one")
    first = registry(SCENES).get(str(scene))
    assert first.name == "hall"
    (tmp_path / "mesh.ply").write_text("two")
    assert registry(SCENES).get(str(scene)).digest != first.digest


class Scale(rb.Options):
    scale: float = rb.option(1.0, "pixels of output for one of source")


class InBrackets(rb.Rectifier[Scale]):
    def fit(self, problem: rb.Problem, options: Scale) -> rb.Rectification: ...


class Nested(rb.Rectifier):
    class Options(rb.Options):
        scale: float = rb.option(1.0, "pixels of output for one of source")

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification: ...


class OfMatches(rb.HomographyRectifier[Scale]):
    def homographies(self, view: rb.PinholeView, options: Scale) -> tuple: ...


class Without(rb.Rectifier):
    def fit(self, problem: rb.Problem, options: rb.Options) -> rb.Rectification: ...


class Inherited(InBrackets): ...


@pytest.mark.parametrize("method", [InBrackets, Nested, OfMatches, Inherited])
def test_a_methods_options_stand_in_brackets_or_in_the_class(method: type[rb.Rectifier]) -> None:
    assert list(method.Options.model_fields) == ["scale"]


def test_a_method_without_options_has_the_empty_ones() -> None:
    assert Without.Options is rb.Options
