"""Figures as plugins: one file draws into a run, and what is wrong with it costs nothing else."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

import rectbench as rb
from rectbench.errors import InvalidInput, UnknownName
from rectbench.experiments.planning import make_plan
from rectbench.experiments.spec import Report
from rectbench.plugins.figure import FIGURES, Sources, usual_figures
from rectbench.registry import registry
from rectbench.reporting.figures import EXTENSIONS
from rectbench.reporting.report import write_report
from tests.reporting.runs import quick_rows

WriteRun = Callable[..., Path]
ROWS = quick_rows(scenes=("street",), rigs=("t265",), poses=("exact",), methods=("abraham", "hartley"))
MINE = '''
"""A third party's figure."""
import matplotlib.figure
import rectbench as rb


class Kept(rb.Figure):
    """What each method keeps of the view."""

    name = "kept"
    topic = "{topic}"
    needs = frozenset([{needs}])

    def drawings(self, given):
        kept = {{r.method: r.metrics["coverage_pixels"] for r in given.part.results}}

        def draw():
            figure = matplotlib.figure.Figure(figsize=(3, 2))
            ax = figure.subplots()
            for method, share in kept.items():
                ax.bar(method, share, color=given.looks[method].colour)
            return figure

        yield rb.Drawing("kept", "What is kept", "Shares of the view.", kept, draw)
        {last}
'''


def mine(folder: Path, *, topic: str = "Charts", needs: str = "", last: str = "") -> str:
    path = folder / "mine.py"
    path.write_text(MINE.format(topic=topic, needs=needs, last=last))
    return str(path)


def manifest(folder: Path) -> dict[str, str]:
    found: dict[str, str] = json.loads((folder / "figures/manifest.json").read_text())["figures"]
    return found


def test_a_figure_in_one_file_is_drawn_and_stands_on_the_page(
    write_run: WriteRun, sources: Sources, tmp_path: Path
) -> None:
    folder = write_run(ROWS, figures=["coverage-curve", mine(tmp_path, topic="What is kept")])
    text = write_report(folder, sources=sources).read_text()
    assert all((folder / f"figures/kept.{extension}").is_file() for extension in EXTENSIONS)
    assert "Shares of the view." in text
    assert '<section id="what-is-kept">' in text


def test_a_figure_is_drawn_again_where_its_file_has_changed(
    write_run: WriteRun, sources: Sources, tmp_path: Path
) -> None:
    folder = write_run(ROWS, figures=["coverage-curve", mine(tmp_path)])
    write_report(folder, sources=sources)
    before = manifest(folder)
    mine(tmp_path, last="# a remark")
    write_report(folder, sources=sources)
    after = manifest(folder)
    assert before["distortion-coverage"] == after["distortion-coverage"]
    assert before["kept"] != after["kept"]


@pytest.mark.parametrize(
    ("last", "told"),
    [
        ("raise ValueError('no such column')", "no such column"),
        ("yield 3", "expected Drawings"),
        ("yield rb.Drawing('kept', 'Again', '', 0, draw)", "two drawings are called kept"),
        ("yield rb.Drawing('other', 'Other', '', 0, lambda: 1 / 0)", "division by zero"),
    ],
)
def test_a_broken_figure_says_why_and_costs_no_other(
    write_run: WriteRun, sources: Sources, tmp_path: Path, last: str, told: str
) -> None:
    folder = write_run(ROWS, figures=[mine(tmp_path, last=last), "coverage-curve"])
    text = write_report(folder, sources=sources).read_text()
    assert text.count("could not be drawn") == 1
    assert told in text
    assert (folder / "figures/distortion-coverage.png").is_file()


def test_a_figure_whose_file_is_gone_says_so_on_the_page(
    write_run: WriteRun, sources: Sources, tmp_path: Path
) -> None:
    folder = write_run(ROWS, figures=[str(tmp_path / "gone.py"), "coverage-curve"])
    text = write_report(folder, sources=sources).read_text()
    assert "there is no file" in text
    assert (folder / "figures/distortion-coverage.png").is_file()


def report(*figures: str) -> Report:
    return Report(
        name="r", title="R", scenes=("street",), rigs=("t265",), methods=("abraham",), figures=figures
    )


def test_a_wrong_figure_stops_a_run_before_anything_runs(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match="coverage-curve"):
        make_plan(report("coverage-curv"))
    with pytest.raises(InvalidInput, match="no file"):
        make_plan(report(str(tmp_path / "gone.py")))


def test_images_are_rendered_only_for_figures_that_need_them(tmp_path: Path) -> None:
    for needs, images in (("", False), ('"images"', True)):
        plan = make_plan(report("bars", mine(tmp_path, needs=needs)))
        assert plan.pairs[0].model_dump()["images"] == images
    with pytest.raises(InvalidInput, match="expected at most images"):
        make_plan(report(mine(tmp_path, needs='"truth"')))


def test_a_figure_s_path_holds_from_any_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    path = mine(tmp_path)
    monkeypatch.chdir(tmp_path)
    assert report("./mine.py").figures == (path,)


def test_a_report_that_asks_for_none_gets_the_usual_ones() -> None:
    assert usual_figures() == ("bars", "coverage-curve", "critical-difference", "pairs", "maps")


def test_each_built_in_figure_lies_in_a_file_of_its_name() -> None:
    found = registry(FIGURES)
    assert not found.broken
    stems = {plugin.name: plugin.path.stem for plugin in found.plugins()}
    assert stems == {name: name.replace("-", "_") for name in found.names()}
    assert all(isinstance(plugin.value, rb.Figure) and plugin.summary for plugin in found.plugins())
