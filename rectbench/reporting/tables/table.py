"""A table as a thing of its own, and its three spellings: CSV, Markdown, LaTeX (booktabs).

The page shows the same object, so that no number is formatted twice.
"""

from __future__ import annotations

import csv
import io
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache

from jinja2 import Environment, PackageLoader, Template
from pylatexenc.latexencode import RULE_REGEX, UnicodeToLatexConversionRule, UnicodeToLatexEncoder
from tabulate import tabulate

from rectbench.plugins.metric import Column
from rectbench.reporting.shares import is_of_own_view
from rectbench.reporting.tables.numbers import MISSING, shown


@dataclass(frozen=True)
class Entry:
    """One field: what is read (`text`), what is sorted and stored (`value`), and how it stands out.

    `hint` is what the page tells under the pointer; `beside` are numbers that only the CSV holds, in columns
    of their own, by what their names end with.
    """

    text: str
    value: float | str | None = None
    best: bool = False
    failed: bool = False
    hint: str = ""
    beside: Mapping[str, float] = field(default_factory=dict)

    @property
    def stored(self) -> str:
        """The field in CSV: full numbers, nothing where there is none."""
        return _stored(self.value)


@dataclass(frozen=True)
class Heading:
    """A column's head: what is read, its name in CSV, whether it holds numbers, or sentences to wrap.

    One that is not stored repeats for readers what the CSV holds beside another column.
    """

    text: str
    key: str
    numeric: bool = True
    meaning: str = ""
    wraps: bool = False
    is_stored: bool = True


def _stored(value: float | str | None) -> str:
    if isinstance(value, float):
        return f"{value:.9g}"
    return "" if value is None else str(value)


def text_heading(text: str, key: str = "", wraps: bool = False) -> Heading:
    """The head of a column of words; named as it reads unless `key` says otherwise."""
    return Heading(text, key or text, numeric=False, wraps=wraps)


@dataclass(frozen=True)
class Section:
    """Rows that belong together under an optional title."""

    title: str
    rows: tuple[tuple[Entry, ...], ...]


@dataclass(frozen=True)
class Table:
    """Headings and sections of rows; `name` is the file's stem, `notes` stand below the table.

    `kind` says what the table is about, `part` which part of the report it belongs to.
    """

    name: str
    title: str
    caption: str
    headings: tuple[Heading, ...]
    sections: tuple[Section, ...]
    notes: tuple[str, ...] = ()
    kind: str = ""
    part: str = ""
    legend: str = ""
    """What columns mean whose headings do not say it, where no pointer can be held on them."""

    @property
    def printed_caption(self) -> str:
        """The caption of a file, with the legend."""
        return " ".join(filter(None, (self.caption, self.legend)))

    @property
    def rows(self) -> list[tuple[Entry, ...]]:
        """The rows of all sections."""
        return [row for section in self.sections for row in section.rows]


def number(value: float | None, shown_as: Column, suffix: str = "") -> Entry:
    """An entry for a metric's value, with `suffix` after a number that is there."""
    text = shown(value, shown_as)
    return Entry(text if text == MISSING else text + suffix, value)


def words(text: str) -> Entry:
    """An entry that says what it holds."""
    return Entry(text, text)


def whole(count: int) -> Entry:
    """An entry for a number of things."""
    return Entry(str(count), float(count))


def with_best(entries: Sequence[Entry], shown_as: Column, eligible: Sequence[bool]) -> list[Entry]:
    """`entries` of one metric with the best eligible ones marked.

    None is where each method's number is over what it shows itself: showing less is no merit.
    Values that read the same tie, and where all read the same nothing is marked: a difference that
    is not shown is no merit.
    """
    competing = [
        (entry.value, entry.text)
        for entry, may_win in zip(entries, eligible, strict=True)
        if may_win and isinstance(entry.value, float)
    ]
    if shown_as.better is None or is_of_own_view(shown_as) or len({text for _, text in competing}) < 2:
        return list(entries)
    winner = (min if shown_as.better == "lower" else max)(competing)[1]
    return [
        replace(entry, best=may_win and entry.text == winner)
        for entry, may_win in zip(entries, eligible, strict=True)
    ]


def to_csv(table: Table) -> str:
    """Full numbers in stored units under the rows' own column names; sections become a first column."""
    titled = any(section.title for section in table.sections)
    titles = [section.title for section in table.sections for _ in section.rows]
    columns = [("section", titles)] if titled else []
    columns += [column for place in range(len(table.headings)) for column in _stored_columns(table, place)]
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([name for name, _ in columns])
    writer.writerows(zip(*(fields for _, fields in columns), strict=True))
    return out.getvalue()


def _stored_columns(table: Table, place: int) -> Iterator[tuple[str, list[str]]]:
    """A column by name as the CSV has it, and behind it those of the numbers beside its entries."""
    heading, entries = table.headings[place], [row[place] for row in table.rows]
    if heading.is_stored:
        yield heading.key, [entry.stored for entry in entries]
    for end in dict.fromkeys(end for entry in entries for end in entry.beside):
        yield f"{heading.key}_{end}", [_stored(entry.beside.get(end)) for entry in entries]


def to_markdown(table: Table) -> str:
    """A pipe table a section, best values bold."""
    headings = [_escape_markdown(heading.text) for heading in table.headings]
    sides = ["right" if heading.numeric else "left" for heading in table.headings]
    lines = [f"**{_escape_markdown(table.title)}.** {_escape_markdown(table.printed_caption)}", ""]
    for section in table.sections:
        lines += [f"*{_escape_markdown(section.title)}*", ""] if section.title else []
        rows = [[_markdown_entry(entry) for entry in row] for row in section.rows]
        lines += [tabulate(rows, headings, "pipe", colalign=sides, disable_numparse=True), ""]
    lines += [line for note in table.notes for line in (_escape_markdown(note), "")]
    return "\n".join(lines)


def _markdown_entry(entry: Entry) -> str:
    text = _escape_markdown(entry.text)
    return f"**{text}**" if entry.best else text


def _escape_markdown(text: str) -> str:
    escaped = re.sub(r"([\\`*_\[\]|])", r"\\\1", " ".join(text.split()))
    return escaped.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def to_latex(table: Table) -> str:
    r"""A `table*` for `\usepackage{booktabs,graphicx}`, shrunk to the text's width where it is wider.

    One of more rows than a page holds is a `longtable`, for a document of one column; columns of many
    words wrap in it.
    """
    is_long = len(table.rows) > _PAGE_ROWS
    columns = zip(*table.rows, strict=True) if is_long else [()] * len(table.headings)
    wide = [max((len(entry.text) for entry in column), default=0) > _WIDE_LETTERS for column in columns]
    paragraph = f"p{{{0.45 / max(1, sum(wide)):.2f}\\textwidth}}"
    alignment = "".join(
        paragraph if is_wide else _latex_alignment(heading)
        for is_wide, heading in zip(wide, table.headings, strict=True)
    )
    return _latex_template().render(table=table, is_long=is_long, alignment=alignment)


@cache
def _latex_template() -> Template:
    loader = PackageLoader("rectbench.reporting")
    environment = Environment("<%", "%>", "<<", ">>", trim_blocks=True, lstrip_blocks=True, loader=loader)
    environment.filters |= {"tex": escape_latex, "head": _latex_heading, "field": _latex_entry}
    return environment.get_template("table.tex.j2")


_PAGE_ROWS = 45
_WIDE_LETTERS = 24
_HEADING_CHARACTERS = 10

SPELLINGS = {"csv": to_csv, "md": to_markdown, "tex": to_latex}
"""File extension to writer."""


def _latex_alignment(heading: Heading) -> str:
    if heading.wraps:
        return "p{0.3\\textwidth}"
    return "r" if heading.numeric else "l"


def _latex_entry(entry: Entry) -> str:
    text = escape_latex(entry.text)
    if not entry.best:
        return text
    has_math = "$" in text or "ensuremath" in text
    return f"\\textbf{{\\boldmath {text}}}" if has_math else f"\\textbf{{{text}}}"


def _latex_heading(heading: Heading) -> str:
    """A number's heading over several short lines, so that the numbers set the column's width."""
    lines = textwrap.wrap(heading.text, _HEADING_CHARACTERS, break_long_words=False, break_on_hyphens=False)
    if not heading.numeric or len(lines) < 2:
        return escape_latex(heading.text)
    stacked = r" \\ ".join(map(escape_latex, lines))
    return f"\\shortstack[r]{{{stacked}}}"


_DIGITS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_IN_MATH = {"−": "-", "→": r"\rightarrow", "↓": r"\downarrow", "↑": r"\uparrow", "×": r"\times"}
_TO_LATEX = UnicodeToLatexEncoder(
    conversion_rules=[
        UnicodeToLatexConversionRule(
            RULE_REGEX,
            [
                (re.compile("10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)"), lambda m: f"$10^{{{m[1].translate(_DIGITS)}}}$"),
                (re.compile("[<>−→↓↑×]"), lambda m: f"${_IN_MATH.get(m[0], m[0])}$"),
                (re.compile("–"), "--"),
                (re.compile("(û)|v\u0302"), lambda m: rf"$\hat{{{'u' if m[1] else 'v'}}}$"),
                (re.compile(r"[\[\]]"), lambda m: f"{{{m[0]}}}"),  # after a row's end it would be an option
            ],
        ),
        "defaults",
    ],
    unknown_char_policy="keep",
    unknown_char_warning=False,
)


@lru_cache(maxsize=4096)
def escape_latex(text: str) -> str:
    r"""Plain text as LaTeX: special characters escaped, powers of ten and symbols in math.

    >>> print(escape_latex("a_b < 10⁻⁶"))
    a\_b $<$ $10^{-6}$
    """
    latex: str = _TO_LATEX.unicode_to_latex(" ".join(text.split()))
    return latex
