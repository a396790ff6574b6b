"""The page: everything of a run in one HTML file that needs no network."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from rectbench.plugins.metric import Column
from rectbench.reporting.asked import methods_part, part_title
from rectbench.reporting.figures import EXTENSIONS, Drawn
from rectbench.reporting.names import slug
from rectbench.reporting.page.run_facts import Fact, run_facts
from rectbench.reporting.style import looks
from rectbench.reporting.tables.table import SPELLINGS, Entry, Table
from rectbench.runs.run import Run

FIRST = ("Ranking", "Charts", "Poses", "Row error", "Distortion", "Pictures", "Energy", "Random starts")
LAST = ("Reconstruction", "Time", "Every pair", "Photographs")
"""The headings of a part in their order; topics that are not among them come between."""
_TABLES = {
    "main": "Ranking",
    "pose": "Poses",
    "rows": "Row error",
    "distortion": "Distortion",
    "energy": "Energy",
    "starts": "Random starts",
    "depth": "Reconstruction",
    "time": "Time",
    "pair": "Every pair",
    "photographs": "Photographs",
    "left-out": "Photographs",
}
"""Under which heading each kind of table stands."""


@dataclass(frozen=True)
class Topic:
    """A section of a part: its tables and its figures; `anchor` is where links lead."""

    anchor: str
    title: str
    tables: list[Table]
    figures: list[Drawn]


@dataclass(frozen=True)
class Part:
    """A part of the report; that of a report without parts has no name and no title."""

    name: str
    anchor: str
    title: str
    topics: list[Topic]


@dataclass(frozen=True)
class Page:
    """What the template shows."""

    title: str
    description: str
    report: str
    cells: int
    failed: int
    scenes: tuple[str, ...]
    scenes_called: str
    rigs: tuple[str, ...]
    methods: tuple[str, ...]
    poses: tuple[str, ...]
    verdicts: Table | None
    measurements: Table | None
    parts: list[Part]
    failures: Table | None
    tables: list[Table]
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
    of_kind = {table.kind: table for table in tables}
    page = Page(
        title=run.record.spec.title,
        description=run.record.spec.description,
        report=run.record.report,
        cells=len(run.results),
        failed=len(run.failures),
        scenes=run.scenes,
        scenes_called=f"{run.record.spec.pair_source.scene_word}s",
        rigs=run.rigs,
        methods=_methods(run),
        poses=run.poses,
        verdicts=of_kind.get("claims"),
        measurements=of_kind.get("measurements"),
        parts=[_part(part, tables, drawn) for part in run.parts],
        failures=of_kind.get("failures"),
        tables=list(tables),
        colours={method: look.colour for method, look in looks(run.methods).items()},
        glossary=[run.catalogue.column(key) for key in run.metrics],
        facts=run_facts(run),
        full_json=run.record.to_json("cells"),
        reproduce=run.record.command,
    )
    return environment.get_template("index.html.j2").render(page=page)


def _methods(run: Run) -> tuple[str, ...]:
    parts = [methods for part in run.parts if (methods := methods_part(part))]
    return tuple(dict.fromkeys(method for part in parts for method in part.methods))


def _part(part: Run, tables: Sequence[Table], drawn: Sequence[Drawn]) -> Part:
    anchor = slug("part", part.group) if part.group else ""
    heading_of = {slug(topic): topic for topic in part.catalogue.topics} | _TABLES
    mine = [table for table in tables if table.part == part.group and table.kind in heading_of]
    figures = [one for one in drawn if one.placed.part == part.group]
    found: dict[str, Topic] = {}
    for heading in (*(heading_of[table.kind] for table in mine), *(one.placed.topic for one in figures)):
        found[heading] = Topic(
            slug(anchor, heading),
            heading,
            [table for table in mine if heading_of[table.kind] == heading],
            [one for one in figures if one.placed.topic == heading],
        )
    between = sorted(found.keys() - {*FIRST, *LAST})
    topics = [found[heading] for heading in (*FIRST, *between, *LAST) if heading in found]
    return Part(part.group, anchor, part_title(part), topics)


def _sort_value(entry: Entry) -> str:
    """What the page's script sorts by; nothing for an entry without a value, which sorts last."""
    if isinstance(entry.value, float) and math.isinf(entry.value):
        return "1e308" if entry.value > 0 else "-1e308"
    return entry.stored
