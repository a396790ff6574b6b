"""A table as a thing of its own, and its three spellings: CSV, Markdown, LaTeX (booktabs).

The page shows the same object, so that no number is formatted twice.
"""

from __future__ import annotations

import csv
import io
import re
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rectbench.plugins.metric import Column
from rectbench.reporting.tables.numbers import MISSING, shown


@dataclass(frozen=True)
class Entry:
    """One field: what is read (`text`), what is sorted and stored (`value`), and how it stands out."""

    text: str
    value: float | str | None = None
    best: bool = False
    failed: bool = False

    @property
    def stored(self) -> str:
        """The field in CSV: full numbers, nothing where there is none."""
        if isinstance(self.value, float):
            return f"{self.value:.9g}"
        return "" if self.value is None else str(self.value)


@dataclass(frozen=True)
class Heading:
    """A column's head: what is read, its name in CSV, whether it holds numbers, or sentences to wrap."""

    text: str
    key: str
    numeric: bool = True
    meaning: str = ""
    wraps: bool = False


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

    Values that read the same tie, and where all read the same nothing is marked: a difference that
    is not shown is no merit.
    """
    competing = [
        (entry.value, entry.text)
        for entry, may_win in zip(entries, eligible, strict=True)
        if may_win and isinstance(entry.value, float)
    ]
    if shown_as.better is None or len({text for _, text in competing}) < 2:
        return list(entries)
    winner = (min if shown_as.better == "lower" else max)(competing)[1]
    return [
        Entry(entry.text, entry.value, best=may_win and entry.text == winner, failed=entry.failed)
        for entry, may_win in zip(entries, eligible, strict=True)
    ]


def to_csv(table: Table) -> str:
    """Full numbers in stored units under the rows' own column names; sections become a first column."""
    titled = any(section.title for section in table.sections)
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["section"] * titled + [heading.key for heading in table.headings])
    for section in table.sections:
        for row in section.rows:
            writer.writerow([section.title] * titled + [entry.stored for entry in row])
    return out.getvalue()


def to_markdown(table: Table) -> str:
    """A pipe table a section, best values bold."""
    head = _pipe_row([_escape_markdown(heading.text) for heading in table.headings])
    rule = _pipe_row(["---:" if heading.numeric else ":---" for heading in table.headings])
    lines = [f"**{_escape_markdown(table.title)}.** {_escape_markdown(table.caption)}", ""]
    for section in table.sections:
        lines += [f"*{_escape_markdown(section.title)}*", ""] if section.title else []
        lines += [
            head,
            rule,
            *(_pipe_row([_markdown_entry(entry) for entry in row]) for row in section.rows),
            "",
        ]
    lines += [line for note in table.notes for line in (_escape_markdown(note), "")]
    return "\n".join(lines)


def to_latex(table: Table) -> str:
    r"""A `table*` for `\usepackage{booktabs,graphicx}`, shrunk to the text's width where it is wider.

    One of more rows than a page holds is a `longtable`, for a document of one column.
    """
    if len(table.rows) > _PAGE_ROWS:
        return _long_latex(table)
    alignment = "".join(map(_latex_alignment, table.headings))
    lines = [
        "% needs \\usepackage{booktabs,graphicx}",
        "\\begin{table*}[t]",
        "\\centering\\small\\setlength{\\tabcolsep}{3.5pt}",
        f"\\caption{{{escape_latex(f'{table.title}. {table.caption}')}}}",
        f"\\label{{tab:{table.name}}}",
        "\\resizebox{\\ifdim\\width>\\textwidth\\textwidth\\else\\width\\fi}{!}{%",
        f"\\begin{{tabular}}{{{alignment}}}",
        "\\toprule",
        _latex_head(table),
        *_latex_sections(table),
        "\\bottomrule",
        "\\end{tabular}}",
        *_latex_notes(table),
        "\\end{table*}",
    ]
    return "\n".join([*lines, ""])


def _long_latex(table: Table) -> str:
    """A small table that runs over pages, the heading on each; columns of many words wrap."""
    columns = zip(*table.rows, strict=True)
    wide = [max(len(entry.text) for entry in column) > _WIDE_LETTERS for column in columns]
    paragraph = f"p{{{0.45 / max(1, sum(wide)):.2f}\\textwidth}}"
    alignment = "".join(
        paragraph if is_wide else _latex_alignment(heading)
        for is_wide, heading in zip(wide, table.headings, strict=True)
    )
    lines = [
        "% needs \\usepackage{booktabs,longtable}, and one column",
        "\\begingroup",
        "\\footnotesize\\setlength{\\tabcolsep}{3.5pt}\\setlength{\\LTcapwidth}{\\textwidth}",
        f"\\begin{{longtable}}{{{alignment}}}",
        f"\\caption{{{escape_latex(f'{table.title}. {table.caption}')}}}",
        f"\\label{{tab:{table.name}}} \\tabularnewline",
        "\\toprule",
        _latex_head(table),
        "\\endfirsthead",
        _latex_head(table),
        "\\midrule",
        "\\endhead",
        *_latex_sections(table),
        "\\bottomrule",
        "\\end{longtable}",
        *_latex_notes(table),
        "\\endgroup",
    ]
    return "\n".join([*lines, ""])


def _latex_head(table: Table) -> str:
    return _latex_row([_latex_heading(heading) for heading in table.headings])


def _latex_sections(table: Table) -> Iterator[str]:
    for section in table.sections:
        yield "\\midrule"
        if section.title:
            title = f"\\emph{{{escape_latex(section.title)}}}"
            yield f"\\multicolumn{{{len(table.headings)}}}{{l}}{{{title}}} \\\\"
        yield from (_latex_row([_latex_entry(entry) for entry in row]) for row in section.rows)


def _latex_notes(table: Table) -> list[str]:
    return [f"\\par\\smallskip{{\\footnotesize {escape_latex(note)}\\par}}" for note in table.notes]


_PAGE_ROWS = 45
_WIDE_LETTERS = 24
_HEADING_CHARACTERS = 10

SPELLINGS = {"csv": to_csv, "md": to_markdown, "tex": to_latex}
"""File extension to writer."""


def _pipe_row(fields: Sequence[str]) -> str:
    return f"| {' | '.join(fields)} |"


def _markdown_entry(entry: Entry) -> str:
    text = _escape_markdown(entry.text)
    return f"**{text}**" if entry.best else text


def _escape_markdown(text: str) -> str:
    escaped = re.sub(r"([\\`*_\[\]|])", r"\\\1", " ".join(text.split()))
    return escaped.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _latex_alignment(heading: Heading) -> str:
    if heading.wraps:
        return "p{0.3\\textwidth}"
    return "r" if heading.numeric else "l"


def _latex_row(fields: Sequence[str]) -> str:
    return f"{' & '.join(fields)} \\\\"


def _latex_entry(entry: Entry) -> str:
    text = escape_latex(entry.text)
    if not entry.best:
        return text
    return f"\\textbf{{\\boldmath {text}}}" if "$" in text else f"\\textbf{{{text}}}"


def _latex_heading(heading: Heading) -> str:
    """A number's heading over several short lines, so that the numbers set the column's width."""
    lines = textwrap.wrap(heading.text, _HEADING_CHARACTERS, break_long_words=False, break_on_hyphens=False)
    if not heading.numeric or len(lines) < 2:
        return escape_latex(heading.text)
    stacked = r" \\ ".join(map(escape_latex, lines))
    return f"\\shortstack[r]{{{stacked}}}"


_LATEX = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "&": r"\&",
    "%": r"\%",
    "$": r"\$",
    "#": r"\#",
    "_": r"\_",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": "$<$",
    ">": "$>$",
    "[": "{[}",
    "]": "{]}",
    "–": "--",
    "−": "$-$",
    "×": r"$\times$",
    "≤": r"$\leq$",
    "≥": r"$\geq$",
    "σ": r"$\sigma$",
    "û": r"$\hat{u}$",
    "β": r"$\beta$",
    "γ": r"$\gamma$",
    "∂": r"$\partial$",
    "\u0302": "",
    "²": "$^2$",
    "∞": r"$\infty$",
    "°": r"$^\circ$",
    "±": r"$\pm$",
    "Ψ": r"$\Psi$",
    "→": r"$\rightarrow$",
    "↓": r"$\downarrow$",
    "↑": r"$\uparrow$",
    "·": r"$\cdot$",
    "†": r"$\dagger$",
}
_POWER = re.compile(r"10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)")
_DIGITS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def escape_latex(text: str) -> str:
    """Plain text as LaTeX: special characters escaped, powers of ten and symbols in math."""
    pieces = []
    position = 0
    text = " ".join(text.split())
    for power in _POWER.finditer(text):
        pieces.append(_escape_characters(text[position : power.start()]))
        pieces.append(f"$10^{{{power[1].translate(_DIGITS)}}}$")
        position = power.end()
    return "".join([*pieces, _escape_characters(text[position:])])


def _escape_characters(text: str) -> str:
    return "".join(_LATEX.get(character, character) for character in text)
