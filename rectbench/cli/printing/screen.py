"""Where tables are printed, and what a plain one looks like."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table
from rich.text import Text

WIDE = 160
"""Columns assumed where the output is no terminal, so that a pipe gets whole lines."""


def console() -> Console:
    """Standard output; never narrower than a table where nobody looks at it."""
    screen = Console(highlight=False, soft_wrap=False)
    return screen if screen.is_terminal else Console(highlight=False, width=WIDE)


def plain_table(*headings: str) -> Table:
    """A plain table; a single heading stands above two columns, name and meaning."""
    table = Table(box=None, pad_edge=False)
    columns = headings if len(headings) > 1 else (*headings, "")
    for heading in columns:
        table.add_column(Text(heading), header_style="bold", overflow="fold")  # [px] is no markup
    return table
