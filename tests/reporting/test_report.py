from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from rectbench.errors import InvalidInput, Unavailable
from rectbench.plugins.figure import Sources
from rectbench.progress import Advance, Progress
from rectbench.reporting.report import write_report
from tests.reporting.runs import METHODS, failed_row, fake_sources, quick_rows, save_run

WriteRun = Callable[..., Path]
SCRIPT = "<script>alert('x')</script> & \"quotes\""


class Page(HTMLParser):
    """Links, images, tags and text of a page."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.targets: list[str] = []
        self.tags: list[str] = []
        self.words: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.targets += [value for name, value in attrs if name in ("href", "src") and value]

    def handle_data(self, data: str) -> None:
        if self.tags and self.tags[-1] not in ("style", "script"):
            self.words.append(data)


def small_rows() -> list[dict[str, Any]]:
    """Two pairs, two poses, five methods; hartley fails on one rig."""
    rows = quick_rows(scenes=("street",), rigs=("t265", "perspective-wide"))
    return [
        failed_row(r["scene"], r["rig"], r["pose"], r["method"], reason=SCRIPT)
        if (r["method"], r["rig"]) == ("hartley", "t265")
        else r
        for r in rows
    ]


@pytest.fixture(scope="module")
def reported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One whole report, looked at by many tests."""
    folder = tmp_path_factory.mktemp("reported")
    write_report(save_run(folder, small_rows()), sources=fake_sources(160))
    return folder


def slim(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The rows without the columns that make yet more charts of the same kind."""
    return [
        {n: v for n, v in r.items() if n not in ("distortion_native", "distortion_rescaled")} for r in rows
    ]


def contents(folder: Path) -> dict[str, bytes]:
    files = [*folder.glob("tables/*"), *folder.glob("figures/*"), folder / "index.html"]
    return {str(file.relative_to(folder)): file.read_bytes() for file in files}


def test_the_contract_s_files_are_there(reported: Path) -> None:
    figures = {
        "row-error-50-perturbed",
        "row-error-95-perturbed",
        "distortion-native",
        "distortion-rescaled",
        "distortion-coverage",
        *(
            f"{kind}-{rig}"
            for kind in ("rectified", "distortion-map")
            for rig in ("t265", "perspective-wide")
        ),
    }
    assert {p.name for p in (reported / "figures").iterdir()} == {
        "manifest.json",
        *(f"{name}.{extension}" for name in figures for extension in ("pdf", "svg", "png")),
    }
    tables = {
        "main-exact",
        "main-perturbed",
        "rigs",
        "log-distortion",
        "distortion",
        "row-error",
        "coverage",
        "failures",
    }
    tables |= {"pair-street-t265", "pair-street-perspective-wide"}
    assert {p.name for p in (reported / "tables").iterdir()} == {
        f"{name}.{extension}" for name in tables for extension in ("csv", "md", "tex")
    }


def test_every_link_of_the_page_leads_to_a_file_of_the_run(reported: Path) -> None:
    targets = Page(reported / "index.html").targets
    assert len(targets) > 40
    for target in targets:
        assert target.startswith("#") or (reported / target).is_file(), target
    inside = set(re.findall(r'id="([^"]+)"', (reported / "index.html").read_text()))
    assert {t[1:] for t in targets if t.startswith("#")} <= inside


def test_the_page_needs_no_network(reported: Path) -> None:
    assert not re.search(r"https?://|@import|url\(", (reported / "index.html").read_text())


def test_a_nasty_reason_is_shown_as_text(reported: Path) -> None:
    page = Page(reported / "index.html")
    assert page.tags.count("script") == 1
    assert SCRIPT in " ".join(page.words)


def test_failed_cells_are_visible_and_no_nan_is(reported: Path) -> None:
    words = " ".join(Page(reported / "index.html").words)
    texts = {path.name: path.read_text() for path in (reported / "tables").iterdir()}
    for name, text in {**texts, "page": words}.items():
        assert not re.search(r"\bnan\b|\bNone\b", text, re.IGNORECASE), name
    assert "1/2" in words
    assert "2 of 20 cells hold no measurement" in words
    assert "1 unsupported" in words


def test_the_page_tells_how_to_make_the_run_again(reported: Path) -> None:
    words = " ".join(Page(reported / "index.html").words)
    for fact in (
        "rectbench run quick --jobs 2",
        "AMD EPYC 7B13",
        "0123456789abcdef",
        "mitsuba 3.9.1",
        "21.1.8",
    ):
        assert fact in words


def test_fonts_are_embedded_as_truetype(reported: Path) -> None:
    for pdf in (reported / "figures").glob("*.pdf"):
        data = pdf.read_bytes()
        assert b"/FontFile2" in data
        assert b"/Type3" not in data


def test_files_hold_no_time_and_are_the_same_in_two_runs(write_run: WriteRun) -> None:
    rows = slim(quick_rows(scenes=("street",), rigs=("t265",), poses=("perturbed",)))
    first, second = (write_run(rows, name) for name in ("first", "second"))
    for folder in (first, second):
        write_report(folder, sources=fake_sources(160))
    left, right = contents(first), contents(second)
    assert left.keys() == right.keys()
    assert [name for name in left if left[name] != right[name]] == []
    assert not any(b"CreationDate" in data for name, data in left.items() if name.endswith(".pdf"))
    assert not any(b"<dc:date>" in data for name, data in left.items() if name.endswith(".svg"))


def test_what_has_not_changed_is_not_drawn_again(reported: Path) -> None:
    before = {p: p.stat().st_mtime_ns for p in (reported / "figures").iterdir()}
    steps: list[int] = []

    class Counted(Progress):
        @contextmanager
        def stage(self, title: str, total: int) -> Iterator[Advance]:
            yield lambda: steps.append(total)

    write_report(reported, sources=fake_sources(160), progress=Counted())
    assert {p: p.stat().st_mtime_ns for p in (reported / "figures").iterdir()} == before
    assert steps == [9] * 9


def test_changed_numbers_are_drawn_again_and_leftovers_removed(write_run: WriteRun, sources: Sources) -> None:
    rows = quick_rows(scenes=("street", "room"), rigs=("t265",), poses=("perturbed",), methods=("abraham",))
    rows = slim(rows)
    folder = write_run(rows, figures=["coverage-curve"])
    write_report(folder, sources=sources)
    old = (folder / "figures/distortion-coverage.png").read_bytes()
    (folder / "tables/mine.csv").write_text("kept")
    write_report(
        write_run([r | {"log_distortion_50": 0.9} for r in rows[:1]], figures=["coverage-curve"]),
        sources=sources,
    )
    assert (folder / "figures/distortion-coverage.png").read_bytes() != old
    assert not (folder / "tables/pair-room-t265.csv").exists()
    assert (folder / "tables/mine.csv").read_text() == "kept"


@pytest.mark.parametrize("failing", [("hartley",), tuple(METHODS)])
def test_a_run_whose_cells_failed_still_has_its_report(
    write_run: WriteRun, sources: Sources, failing: tuple[str, ...]
) -> None:
    rows = quick_rows(scenes=("street",), rigs=("t265",), poses=("exact",))
    rows = [failed_row("street", "t265", "exact", r["method"]) if r["method"] in failing else r for r in rows]
    page = write_report(write_run(slim(rows), figures=["bars", "coverage-curve", "maps"]), sources=sources)
    words = " ".join(Page(page).words)
    assert f"{len(failing)} of 5 cells hold no measurement" in words
    assert "0/1" in words


def test_a_lost_picture_costs_neither_tables_nor_charts(write_run: WriteRun, sources: Sources) -> None:
    def lost(result: Any) -> Any:
        raise Unavailable("the store has lost <it>")

    rows = quick_rows(scenes=("street",), rigs=("t265",), poses=("exact",), methods=("abraham",))
    folder = write_run(rows, figures=["pairs"])
    broken = replace(sources, pair=lost)
    text = write_report(folder, sources=broken).read_text()
    assert "could not be drawn" in text
    assert "lost &lt;it&gt;" in text
    assert not (folder / "figures/rectified-t265.png").exists()
    assert "could not be drawn" not in write_report(folder, sources=sources).read_text()
    assert (folder / "figures/rectified-t265.png").is_file()


def test_a_method_that_raises_while_drawing_shows_why_in_its_panel(
    write_run: WriteRun, sources: Sources
) -> None:
    def raising(result: Any) -> Any:
        raise ZeroDivisionError("in a plugin")

    rows = quick_rows(scenes=("street",), rigs=("t265",), poses=("exact",), methods=("abraham",))
    broken = replace(sources, rectification=raising)
    folder = write_run(rows, figures=["pairs", "maps"])
    text = write_report(folder, sources=broken).read_text()
    assert "could not be drawn" not in text
    assert (folder / "figures/distortion-map-t265.pdf").is_file()


@pytest.mark.parametrize("missing", ["run.json", "results.parquet"])
def test_a_folder_without_a_run_is_refused_and_left_alone(write_run: WriteRun, missing: str) -> None:
    folder = write_run(quick_rows(scenes=("street",), rigs=("t265",)))
    (folder / missing).unlink()
    with pytest.raises(InvalidInput, match=missing):
        write_report(folder)
    assert not (folder / "index.html").exists()


def test_a_damaged_manifest_only_costs_time(write_run: WriteRun, sources: Sources) -> None:
    rows = quick_rows(scenes=("street",), rigs=("t265",), poses=("exact",), methods=("abraham",))
    folder = write_run(rows, figures=["coverage-curve"])
    write_report(folder, sources=sources)
    (folder / "figures/manifest.json").write_text('{"figures": 3')
    write_report(folder, sources=sources)
    assert json.loads((folder / "figures/manifest.json").read_text())["figures"].keys() == {
        "distortion-coverage"
    }
