"""The page: everything of a run in one HTML file that needs no network."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from rectbench.pairs.spec import NO_SCENE
from rectbench.plugins.result import distinct
from rectbench.reporting.asked import methods_part, part_title, wanted_figures
from rectbench.reporting.charts.critical_difference import CriticalDifference, why_not_drawn
from rectbench.reporting.figures import EXTENSIONS, Drawn
from rectbench.reporting.names import slug
from rectbench.reporting.shares import explained
from rectbench.reporting.style import looks
from rectbench.reporting.tables.findings import findings
from rectbench.reporting.tables.main_tables import is_ranked
from rectbench.reporting.tables.table import SPELLINGS, Entry, Table
from rectbench.reporting.tables.tabulation import ALL_MOTIONS, ALL_RIGS
from rectbench.runs.record import RunRecord
from rectbench.runs.run import Run

FIRST = ("Ranking", "Charts", "Poses", "Row error", "Distortion", "Pictures", "Energy", "Random starts")
LAST = ("Reconstruction", "Time", "Every pair", "Photographs")
"""The headings of a part in their order; topics that are not among them come between."""
_TABLES = {
    "main": "Ranking",
    "rigs": "Ranking",
    "beliefs": "Ranking",
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
_MOST_ROWS = 30
"""Of a longer table, headings of sections counted, the page shows the averages over all rigs or motions, and
folds the rest."""
_FACTS = {
    "command": "Command",
    "data": "Photographs of",
    "wall_s": "Took",
    "git_revision": "Git revision",
    "cpu": "CPU",
    "cores": "Cores",
    "jobs": "Jobs",
    "llvm": "LLVM",
    "python": "Python",
    "platform": "Platform",
    "seeds": "Seeds",
}
"""What of run.json is worth a line of its own on the page, and what it is called there."""


@dataclass(frozen=True)
class Topic:
    """A section of a part: its tables and its figures, and what is to be said of those that are not there.

    `anchor` is where links lead.
    """

    anchor: str
    title: str
    tables: list[Table]
    figures: list[Drawn]
    note: str = ""


@dataclass(frozen=True)
class Part:
    """A part of the report; that of a report without parts has no name and no title."""

    name: str
    anchor: str
    title: str
    topics: list[Topic]
    findings: tuple[str, ...]
    """What it tells, a sentence each."""


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
    environment.globals |= {
        "sort_value": _sort_value,
        "summaries": (ALL_RIGS, ALL_MOTIONS),
        "most_rows": _MOST_ROWS,
    }
    shown = {part.group: methods_part(part) for part in run.parts}
    methods = distinct(m for part in shown.values() if part for m in part.methods)
    found = findings(run)
    return environment.get_template("index.html.j2").render(
        run=run,
        record=run.record,
        methods=methods,
        methods_count=len({r.cell.method for part in shown.values() if part for r in part.results}),
        glossary=explained(map(run.catalogue.column, run.metrics)),
        of_kind={table.kind: table for table in tables},
        scenes=[scene for scene in run.scenes if scene != NO_SCENE],
        parts=[_part(part, tables, drawn, found.get(part.group, ())) for part in run.parts],
        tables=tables,
        colours={method: look.colour for method, look in looks(run.methods).items()},
        facts=_facts(run.record),
        extensions=EXTENSIONS,
        spellings=tuple(SPELLINGS),
    )


def _part(part: Run, tables: Sequence[Table], drawn: Sequence[Drawn], told: tuple[str, ...]) -> Part:
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
    if topics and (note := _absent_figure(part)):
        place = next((i for i, topic in enumerate(topics) if topic.title == CriticalDifference.topic), 0)
        topics[place] = replace(topics[place], note=note)
    return Part(part.group, anchor, part_title(part), topics, told)


def _absent_figure(part: Run) -> str:
    """Why the figure of critical differences is not there, where it is asked for and methods are ranked."""
    methods = methods_part(part)
    if methods is None or not is_ranked(methods) or CriticalDifference.name not in wanted_figures(part):
        return ""
    return why_not_drawn(methods)


def _sort_value(entry: Entry) -> str:
    """What the page's script sorts by; nothing for an entry without a value, which sorts last."""
    if isinstance(entry.value, float) and math.isinf(entry.value):
        return "1e308" if entry.value > 0 else "-1e308"
    return entry.stored


def _facts(record: RunRecord) -> list[tuple[str, str]]:
    """What is told of the run by its name, the versions of libraries last; run.json is shown beside them."""
    told = {**vars(record), "wall_s": f"{record.wall_s:.1f} s"}
    facts = [(label, _text(told[name])) for name, label in _FACTS.items() if told[name] not in (None, ())]
    present = [f"{name} {version}" for name, version in record.versions.items() if version is not None]
    return [*facts, ("Versions", ", ".join(present))]


def _text(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {item}" for name, item in value.items() if item is not None)
    return ", ".join(map(str, value)) if isinstance(value, tuple) else str(value)
