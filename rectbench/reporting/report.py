"""Turns a run's folder into tables, figures and a page."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from rectbench.experiments.execution.pool import Workers
from rectbench.experiments.execution.running import workers_for
from rectbench.plugins.figure import Sources
from rectbench.progress import Progress
from rectbench.reporting.drawing import draw_here, draw_in_workers
from rectbench.reporting.figures import EXTENSIONS, draw_changed, placed_drawings
from rectbench.reporting.page import render_page
from rectbench.reporting.sources import sources_of
from rectbench.reporting.tables.part_tables import all_tables
from rectbench.reporting.tables.table import SPELLINGS, Table
from rectbench.runs.run import Run, read_run
from rectbench.writing import write_atomically

MANIFEST = "figures/manifest.json"
"""What is drawn already, and which files earlier reports of this folder left."""


def write_report(
    run_dir: Path,
    *,
    progress: Progress | None = None,
    sources: Sources | None = None,
    workers: Workers | None = None,
) -> Path:
    """Write tables/, figures/ and index.html of a run; returns the page's path.

    Parameters
    ----------
    run_dir : a folder with run.json and results.parquet.
    progress : where to tell how many figures are done; nowhere by default.
    sources : where pictures come from; the bench's store by default. With others, figures are drawn in this
        process, since nobody knows whether they travel.
    workers : who draws; processes of the report's own by default, one a core.

    Figures whose data have not changed are left as they are. Files that an earlier report of the
    same folder wrote and this one does not are removed. Where a picture's source is gone, the page
    says so, and shows an earlier picture if there is one.

    Raises InvalidInput where the folder holds no run, Unavailable where it cannot be written.
    """
    run_dir = Path(run_dir)
    run = read_run(run_dir)
    manifest = _read_manifest(run_dir)
    drawings = placed_drawings(run, sources or sources_of(run))
    with ExitStack() as stack:
        # While others draw, this process has time for the tables.
        beside = stack.enter_context(ThreadPoolExecutor(1)).submit(_write_tables, run_dir, run)
        if sources is None:
            draw = draw_in_workers(run, workers or stack.enter_context(workers_for(run.record.spec)))
        else:
            draw = draw_here(run_dir)
        advance = stack.enter_context((progress or Progress()).stage("figures", len(drawings)))
        drawn, digests = draw_changed(run_dir, drawings, manifest["figures"], draw, advance)
    tables, written = beside.result()
    written += [figure.placed.path(e) for figure in drawn if figure.there for e in EXTENSIONS]
    _remove_leftovers(run_dir, set(manifest["files"]) - set(written))
    write_atomically(run_dir / "index.html", render_page(run, tables, drawn))
    fresh = {"figures": digests, "files": sorted(written)}
    if fresh != manifest:
        write_atomically(run_dir / MANIFEST, json.dumps(fresh, indent=1) + "\n")
    return run_dir / "index.html"


def _write_tables(folder: Path, run: Run) -> tuple[list[Table], list[str]]:
    """The tables of a run, and the files that they are written to."""
    tables = list(all_tables(run))
    return tables, [path for table in tables for path in _write_table(folder, table)]


def _write_table(folder: Path, table: Table) -> list[str]:
    texts = {f"tables/{table.name}.{extension}": spell(table) for extension, spell in SPELLINGS.items()}
    for path, text in texts.items():
        write_atomically(folder / path, text)
    return list(texts)


def _read_manifest(folder: Path) -> dict[str, Any]:
    """The manifest, or an empty one where there is none that can be read."""
    try:
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        return {"figures": dict(manifest["figures"]), "files": [str(path) for path in manifest["files"]]}
    except (OSError, ValueError, KeyError, TypeError):
        return {"figures": {}, "files": []}


def _remove_leftovers(folder: Path, paths: set[str]) -> None:
    for path in sorted(paths):
        place = (folder / path).resolve()
        if place.parent in ((folder / "tables").resolve(), (folder / "figures").resolve()):
            place.unlink(missing_ok=True)
