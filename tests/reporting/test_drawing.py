"""Figures drawn in worker processes: the same files, a dying one costs no other, and the store keeps them."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from rectbench.reporting import drawing
from rectbench.reporting.figures import EXTENSIONS, placed_drawings
from rectbench.reporting.report import write_report
from rectbench.reporting.sources import sources_of
from rectbench.runs.making import run
from rectbench.runs.record import CSV, PARQUET, RUN_FILE
from rectbench.runs.run import read_run
from rectbench.store.store import STORE_VARIABLE
from tests.experiments.fakes import small_report, write_scene

DIES = '''
"""A figure that takes its process down where there is more than one."""
import multiprocessing, os
import rectbench as rb


class Dies(rb.Figure):
    """Nothing."""

    name, topic = "dies", "Charts"

    def drawings(self, given):
        def draw():
            if multiprocessing.parent_process() is not None:
                os._exit(9)

        yield rb.Drawing("dies", "Dies", "", 0, draw)
'''


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a run without figures, and its store."""
    folder = tmp_path_factory.mktemp("finished")
    (folder / "dies.py").write_text(DIES)
    report = small_report(
        scenes=(write_scene(folder, "wall"),),
        methods=("abraham", "conventional"),
        motions=("sideways",),
        metrics=("geometry", "row_error"),
        figures=("bars", "pairs", "maps", str(folder / "dies.py")),
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(STORE_VARIABLE, str(folder / "store"))
        run(report, folder / "run", jobs=1)
    return folder


@pytest.fixture(autouse=True)
def _store(finished: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(STORE_VARIABLE, str(finished / "store"))


def copied(finished: Path, place: Path) -> Path:
    """The run in another folder, without anything drawn."""
    place.mkdir()
    for name in (RUN_FILE, PARQUET, CSV):
        shutil.copy(finished / "run" / name, place)
    return place


def files(folder: Path) -> dict[str, bytes]:
    """The bytes of all figures by name."""
    return {f.name: f.read_bytes() for f in folder.glob("figures/*") if f.suffix[1:] in EXTENSIONS}


def test_workers_draw_what_this_process_draws_and_the_store_gives_it_to_other_folders(
    finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    in_workers = copied(finished, tmp_path / "in-workers")
    page = write_report(in_workers).read_text()
    assert page.count("could not be drawn") == 1
    assert "ended with exit code 9" in page

    here = copied(finished, tmp_path / "here")
    known = read_run(here)
    drawings = [one for one in placed_drawings(known, sources_of(known)) if one.name != "dies"]
    assert [error for _, error in drawing.draw_here(here)(drawings)] == [""] * len(drawings)
    assert files(here) == files(in_workers)
    assert len(files(here)) >= 3 * len(EXTENSIONS)

    def drawn_anew(folder: Path, placed: drawing.PlacedDrawing) -> None:
        assert placed.name == "dies", placed.name
        raise ValueError("nothing to see")

    monkeypatch.setattr(drawing, "draw_files", drawn_anew)
    again = copied(finished, tmp_path / "again")
    write_report(again)
    assert files(again) == files(in_workers)


def test_a_run_with_other_rows_takes_no_figure_from_the_store(
    finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_report(copied(finished, tmp_path / "first"))
    other = copied(finished, tmp_path / "other")
    rows = read_run(other).table
    rows["distortion_native"] *= 1.1
    rows.to_parquet(other / PARQUET)
    wanted: list[str] = []
    monkeypatch.setattr(
        drawing.Workers, "run", lambda self, jobs: iter([wanted.append(job.arguments[1]) for job in jobs][:0])
    )
    write_report(other)
    assert "distortion-native" in wanted
