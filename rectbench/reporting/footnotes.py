"""Names of methods with a mark in the place of where their matches come from, explained below the table."""

from __future__ import annotations

import re
from dataclasses import replace

from rectbench.reporting.tables.table import Section, Table

_MARKS = "*†‡§"
_LEVEL = re.compile(r" \((?:([^()]*), )?(true matches[^()]*)\)")
"""What `plugins.matches.marked` puts behind a name; options may stand before it."""


def with_footnotes(table: Table) -> Table:
    """The table with "hartley*" for "hartley (true matches + 0.1 px)", and a note of what the mark means.

    The CSV keeps the full names.
    """
    texts = [heading.text for heading in table.headings] + [e.text for row in table.rows for e in row]
    levels = dict.fromkeys(match[2] for text in texts for match in _LEVEL.finditer(text))
    marks = dict(zip(levels, _MARKS, strict=False))

    def marked(text: str) -> str:
        return _LEVEL.sub(lambda m: _shortened(m, marks), text)

    def section(one: Section) -> Section:
        return replace(
            one, rows=tuple(tuple(replace(e, text=marked(e.text)) for e in row) for row in one.rows)
        )

    return replace(
        table,
        caption=marked(table.caption),
        headings=tuple(replace(heading, text=marked(heading.text)) for heading in table.headings),
        sections=tuple(map(section, table.sections)),
        notes=(*map(marked, table.notes), *(f"{mark} with {level}" for level, mark in marks.items())),
    )


def _shortened(found: re.Match[str], marks: dict[str, str]) -> str:
    options, level = found.groups()
    if level not in marks:
        return found[0]
    return f"{f' ({options})' if options else ''}{marks[level]}"
