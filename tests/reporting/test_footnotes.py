"""Where matches come from, as a mark with a note in tables."""

from __future__ import annotations

from rectbench.reporting.footnotes import with_footnotes
from rectbench.reporting.tables.table import Heading, Section, Table, text_heading, to_csv, words


def table(*methods: str) -> Table:
    heads = (text_heading("method"), *(Heading(method, method) for method in methods))
    rows = tuple((words(method), *(words("1") for _ in methods)) for method in methods)
    return Table("name", "title", f"Of {methods[0]}.", heads, (Section("", rows),), notes=(methods[-1],))


def test_a_mark_stands_for_the_level_and_is_explained_below() -> None:
    marked = with_footnotes(table("abraham", "hartley (true matches + 0.1 px)"))
    assert [heading.text for heading in marked.headings] == ["method", "abraham", "hartley*"]
    assert [row[0].text for row in marked.rows] == ["abraham", "hartley*"]
    assert marked.notes == ("hartley*", "* with true matches + 0.1 px")


def test_levels_have_marks_of_their_own_and_options_stay() -> None:
    marked = with_footnotes(table("a (f=1, true matches)", "b (true matches + 1 px)", "c (f=2)"))
    assert [row[0].text for row in marked.rows] == ["a (f=1)*", "b†", "c (f=2)"]
    assert marked.notes[1:] == ("* with true matches", "† with true matches + 1 px")


def test_the_csv_keeps_the_names() -> None:
    plain = table("hartley (true matches + 0.1 px)")
    assert to_csv(with_footnotes(plain)) == to_csv(plain)


def test_a_table_without_levels_stays_as_it_is() -> None:
    assert with_footnotes(table("abraham", "hartley")) == table("abraham", "hartley")
