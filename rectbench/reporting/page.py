"""The page: everything of a run in one HTML file that needs no network."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from rectbench.reporting.columns import Column, column
from rectbench.reporting.figures import EXTENSIONS, Drawn
from rectbench.reporting.run_facts import Fact, description, full_json, reproduce_command, run_facts, title
from rectbench.reporting.run_folder import Run
from rectbench.reporting.style import looks
from rectbench.reporting.tables import SPELLINGS, Entry, Table


@dataclass(frozen=True)
class Page:
    """What the template shows."""

    title: str
    description: str
    report: str
    cells: int
    failed: int
    scenes: tuple[str, ...]
    rigs: tuple[str, ...]
    methods: tuple[str, ...]
    poses: tuple[str, ...]
    main_tables: list[Table]
    distortion: Table
    pair_tables: list[Table]
    failures: Table | None
    charts: list[Drawn]
    pictures: list[Drawn]
    colours: dict[str, str]
    glossary: list[Column]
    facts: list[Fact]
    full_json: str
    reproduce: str
    extensions: tuple[str, ...] = EXTENSIONS
    spellings: tuple[str, ...] = tuple(SPELLINGS)


def render_page(run: Run, tables: Sequence[Table], drawn: Sequence[Drawn]) -> str:
    """index.html as text."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("rectbench.reporting"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["sort_value"] = _sort_value
    page = Page(
        title=title(run),
        description=description(run),
        report=run.report,
        cells=len(run.results),
        failed=len(run.failures),
        scenes=run.scenes,
        rigs=run.rigs,
        methods=run.methods,
        poses=run.poses,
        main_tables=[t for t in tables if t.name.startswith("main-")],
        distortion=next(t for t in tables if t.name == "distortion"),
        pair_tables=[t for t in tables if t.name.startswith("pair-")],
        failures=next((t for t in tables if t.name == "failures"), None),
        charts=[d for d in drawn if d.plan.group in ("bars", "scatter")],
        pictures=[d for d in drawn if d.plan.group not in ("bars", "scatter")],
        colours={method: colour for method, (colour, _) in looks(run.methods).items()},
        glossary=[column(key) for key in run.metrics],
        facts=run_facts(run),
        full_json=full_json(run),
        reproduce=reproduce_command(run),
    )
    return environment.get_template("index.html.j2").render(page=page)


def _sort_value(entry: Entry) -> str:
    """What the page's script sorts by; nothing for an entry without a value, which sorts last."""
    if isinstance(entry.value, float) and math.isinf(entry.value):
        return "1e308" if entry.value > 0 else "-1e308"
    return entry.stored
