"""A plugin may be several files: those beside it import, and are part of its key."""

from __future__ import annotations

import importlib.metadata
import sys
from pathlib import Path

import pytest

import rectbench as rb
from rectbench.plugins.rectifier import METHODS, pose_problem
from rectbench.registry import Plugin, forget_plugins, registry, sources
from tests.rigs_for_tests import rig

METHOD = """
import rectbench as rb
{imports}


class Mine(rb.Rectifier):
    '''A method of several files.'''

    name = "{name}"

    def fit(self, problem, options):
        angle = rb.Radial("equidistant", {focal}, 0.0)
        return rb.Rectification.from_profiles(problem.rig, angle, angle, angle)
"""


def write(folder: Path, imports: str, focal: str, name: str = "mine", **helpers: str) -> Path:
    """A folder with a method's file, and files beside it."""
    folder.mkdir(parents=True, exist_ok=True)
    for helper, source in helpers.items():
        (folder / f"{helper}.py").write_text(source)
    path = folder / f"{name.replace('-', '_')}.py"
    path.write_text(METHOD.format(imports=imports, focal=focal, name=name))
    return path


def loaded(path: Path) -> Plugin[rb.Rectifier]:
    return registry(METHODS).get(path)


def focal_of(plugin: Plugin[rb.Rectifier]) -> float:
    rect = plugin.value.fit(pose_problem(rig()), plugin.value.Options())
    return rect.left.target.u.focal_px


@pytest.mark.parametrize("imports", ["import helper", "from . import helper"])
def test_a_file_beside_a_plugin_imports(tmp_path: Path, imports: str) -> None:
    path = write(tmp_path, imports, "helper.FOCAL", helper="FOCAL = 70.0\n")
    assert focal_of(loaded(path)) == 70.0


def test_two_plugins_may_each_have_a_helper_of_one_name(tmp_path: Path) -> None:
    paths = [
        write(tmp_path / name, "import helper", "helper.FOCAL", name, helper=f"FOCAL = {focal}\n")
        for name, focal in (("first", 50.0), ("second", 60.0))
    ]
    plugins = [loaded(path) for path in paths]
    assert [focal_of(plugin) for plugin in plugins] == [50.0, 60.0]
    assert "helper" not in sys.modules
    assert str(tmp_path / "first") not in sys.path


def test_a_helper_may_hold_dataclasses_and_pydantic_models(tmp_path: Path) -> None:
    helper = (
        "from __future__ import annotations\n"
        "from dataclasses import dataclass\nfrom pydantic import BaseModel\n\n"
        "@dataclass(frozen=True)\nclass Lens:\n    focal: float\n\n"
        "class Model(BaseModel):\n    lens: Lens\n\n"
        "MODEL = Model(lens=Lens(focal=80.0))\n"
    )
    assert (
        focal_of(loaded(write(tmp_path, "import helper", "helper.MODEL.lens.focal", helper=helper))) == 80.0
    )


def test_editing_a_helper_or_its_helper_gives_another_digest_and_the_new_code(tmp_path: Path) -> None:
    def method(deepest: str) -> Plugin[rb.Rectifier]:
        helper = "from . import deeper\nFOCAL = deeper.FOCAL\n"
        return loaded(write(tmp_path, "from . import helper", "helper.FOCAL", helper=helper, deeper=deepest))

    first, second = method("FOCAL = 50.0\n"), method("FOCAL = 60.0\n")
    assert (focal_of(first), focal_of(second)) == (50.0, 60.0)
    assert first.digest != second.digest


def test_a_file_beside_that_is_not_imported_is_no_part_of_the_digest(tmp_path: Path) -> None:
    path = write(tmp_path, "import helper", "helper.FOCAL", helper="FOCAL = 70.0\n", notes="x = 1\n")
    first = loaded(path).digest
    (tmp_path / "notes.py").write_text("x = 2\n")
    assert loaded(path).digest == first


def test_a_broken_helper_is_named(tmp_path: Path) -> None:
    path = write(tmp_path, "import helper", "1.0", helper="import no_such_package_here\n")
    with pytest.raises(rb.InvalidInput, match=r"no_such_package_here.*helper\.py"):
        loaded(path)


def test_editing_a_submodule_of_an_installed_package_gives_another_digest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "party_of_two"
    write(package, "from party_of_two import optics", "optics.FOCAL", "of-two", optics="FOCAL = 90.0\n")
    (package / "__init__.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)
    point = importlib.metadata.EntryPoint("of-two", "party_of_two.of_two", "rectbench.methods")
    monkeypatch.setattr(
        importlib.metadata, "entry_points", lambda group: [point] if group == point.group else []
    )

    def announced() -> Plugin[rb.Rectifier]:
        for name in [name for name in sys.modules if name.startswith("party_of_two")]:
            del sys.modules[name]
        forget_plugins()
        return registry(METHODS).get("of-two")

    first = announced()
    assert focal_of(first) == 90.0
    assert announced().digest == first.digest
    (package / "optics.py").write_text("FOCAL = 90.0  # of the catalogue\n")
    assert announced().digest != first.digest


LATE = """def late(self):
        import helper
        from helper import FOCAL
        assert helper.FOCAL == FOCAL
        return FOCAL

    def fit(self, problem, options):"""


def test_a_helper_may_be_imported_within_a_function(tmp_path: Path) -> None:
    path = write(tmp_path, "", "70.0", helper="FOCAL = 3.0\n")
    path.write_text(path.read_text().replace("def fit(self, problem, options):", LATE))
    assert loaded(path).value.late() == 3.0  # type: ignore[attr-defined]


def test_folders_of_helpers_of_one_name_do_not_meet(tmp_path: Path) -> None:
    for folder, focal in (("a", 50.0), ("b", 60.0)):
        (tmp_path / folder / "parts").mkdir(parents=True)
        (tmp_path / folder / "parts" / "focals.py").write_text(f"FOCAL = {focal}\n")
        path = write(tmp_path / folder, "from parts.focals import FOCAL", "FOCAL", f"method-{folder}")
        assert focal_of(loaded(path)) == focal
    assert "parts" not in sys.modules


def test_pythons_own_modules_and_libraries_are_nobodys_helpers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    site = tmp_path / ".venv" / "site-packages"
    site.mkdir(parents=True)
    (site / "a_library.py").write_text("X = 1\n")
    monkeypatch.syspath_prepend(site)
    path = write(tmp_path, "import types, a_library", "70.0", types="raise RuntimeError('not this one')\n")
    before = loaded(path).digest
    assert "a_library" in sys.modules
    (tmp_path / "types.py").write_text("raise RuntimeError('nor this')\n")
    assert loaded(path).digest == before


@pytest.mark.parametrize(
    "line",
    ["rb.best_method", "from rectbench import *", "r = rb", "import rectbench_methods.homographies.hartley"],
)
def test_what_may_use_any_part_of_rectbench_depends_on_all_of_it(tmp_path: Path, line: str) -> None:
    for name, text in (("mine", line), ("all", "rb.rectify")):
        (tmp_path / f"{name}.py").write_text(f"import rectbench as rb\n{text}\n")
    mine, everything = (sources._public_names(tmp_path / f"{name}.py") for name in ("mine", "all"))
    assert sources._digests_of(mine) == sources._digests_of(everything)


def test_an_installed_package_of_one_file_depends_on_no_neighbour(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write(tmp_path, "import neighbour", "neighbour.FOCAL", neighbour="FOCAL = 70.0\n")
    alone = sources.plugin_digest(path, path)
    (tmp_path / "neighbour.py").write_text("FOCAL = 60.0\n")
    assert sources.plugin_digest(path, path) == alone


def test_the_init_files_of_a_package_are_in_its_key(tmp_path: Path) -> None:
    package = tmp_path / "acme" / "methods"
    path = write(package, "from .. import FOCAL", "FOCAL")
    for folder in (package, package.parent):
        (folder / "__init__.py").write_text("FOCAL = 70.0\n")
    before = sources.plugin_digest(path, package.parent)
    (package.parent / "__init__.py").write_text("FOCAL = 60.0\n")
    assert sources.plugin_digest(path, package.parent) != before
