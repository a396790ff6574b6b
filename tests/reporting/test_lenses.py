"""A report of two parts: many lenses without a scene, and pairs on some of them."""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from rectbench.plugins.figure import FigureData
from rectbench.reporting.charts.bars import Bars
from rectbench.reporting.names import pair_labels
from rectbench.reporting.report import write_report
from rectbench.reporting.style import looks
from rectbench.reporting.tables.part_tables import all_tables
from rectbench.reporting.tables.rig_tables import rig_table
from rectbench.runs.run import read_run
from tests.reporting.runs import METHODS, fake_sources, make_row, save_run
from tests.reporting.test_report import Page

WriteRun = Callable[..., Path]
RIGS = tuple(f"lens-{i}" for i in range(8))
SCENES = ("street", "room")
SPEC = {
    "groups": [
        {"name": "lenses", "title": "All lenses", "figures": []},
        {"name": "pairs", "title": "Rendered pairs", "figures": []},
    ]
}


def lens_row(rig: str, motion: str, method: str) -> dict[str, Any]:
    row = make_row("none", rig, "exact", method, motion=motion, group="lenses")
    return {key: value for key, value in row.items() if not key.startswith(("row_error", "fit", "warp"))}


def rows() -> list[dict[str, Any]]:
    lenses = [lens_row(*place) for place in product(RIGS, ("sideways", "rolled"), METHODS)]
    pairs = [make_row(s, r, "exact", m, group="pairs") for s, r, m in product(SCENES, RIGS[:2], METHODS)]
    return lenses + pairs


@pytest.fixture(scope="module")
def reported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = save_run(tmp_path_factory.mktemp("lenses"), rows(), spec=SPEC)
    write_report(folder, sources=fake_sources(96))
    return folder


def test_pairs_without_a_scene_are_called_by_their_rig(reported: Path) -> None:
    labels = list(pair_labels(read_run(reported).part("lenses")).values())
    assert labels[:2] == ["lens-0\nsideways", "lens-0\nrolled"]
    shown = " ".join(Page(reported / "index.html").words).partition("run.json in full")[0]
    assert not re.search(r"\bnone\b", shown)


def test_lenses_have_no_tables_of_single_pairs(reported: Path) -> None:
    names = {path.stem for path in (reported / "tables").glob("*.csv")}
    assert {name for name in names if name.startswith("pair-")} == {
        f"pair-pairs-{scene}-{rig}" for scene, rig in product(SCENES, RIGS[:2])
    }
    assert {"main-lenses-exact", "rigs-lenses", "distortion-lenses"} <= names


def test_a_long_table_is_folded_behind_the_averages_over_all_rigs(reported: Path) -> None:
    text = (reported / "index.html").read_text()
    lenses = text[text.index('id="part-lenses-distortion"') : text.index('id="part-pairs"')]
    before, _, folded = lenses.partition("<details>")
    assert before.count("<span>all rigs</span>") == 1
    assert all(f"<span>{rig}</span>" in folded and f"<span>{rig}</span>" not in before for rig in RIGS)


def test_the_limit_of_perspective_images_is_told_once_by_the_part_of_most_rigs(reported: Path) -> None:
    text = (reported / "index.html").read_text()
    told = [match.start() for match in re.finditer("On all 8 rigs a perspective image has the least", text)]
    assert len(told) == 1
    assert text.index('id="part-lenses"') < told[0] < text.index('id="part-pairs"')


def test_the_page_counts_scenes_and_not_their_lack(reported: Path) -> None:
    assert "<dt>scenes</dt><dd>2</dd>" in (reported / "index.html").read_text()


def test_the_page_counts_methods_and_not_what_their_matches_are(tmp_path: Path) -> None:
    own = [row for row in rows() if row["group"] == "lenses"]
    true_ones = [row | {"matches": "true + 0.1 px"} for row in own if row["matches"]]
    folder = save_run(tmp_path / "run", own + true_ones, spec={"groups": SPEC["groups"][:1]})
    write_report(folder, sources=fake_sources(96))
    assert len(read_run(folder).methods) == 7
    assert "<dt>methods</dt><dd>5</dd>" in (folder / "index.html").read_text()


def test_the_glossary_has_one_entry_for_all_shares_of_a_thing(reported: Path) -> None:
    glossary = (reported / "index.html").read_text().partition('id="reading"')[2].partition("</dl>")[0]
    assert glossary.count("<code>log_distortion_N, N = 10, ") == 1
    assert "<code>log_distortion_10</code>" not in glossary


def test_the_hint_about_clicks_stands_below_the_table_that_they_sort(reported: Path) -> None:
    text = (reported / "index.html").read_text()
    first, second = text.index('<table class="main sortable'), text.index('<table class="rigs')
    assert first < text.index("A click on a heading sorts") < second


def test_each_finding_is_an_entry_of_its_own(reported: Path) -> None:
    text = (reported / "index.html").read_text()
    (lenses,) = re.findall(r'id="part-lenses">.*?<ul class="finding">(.*?)</ul>', text, re.DOTALL)
    assert lenses.count("<li>") == 2


def test_an_average_tells_its_interval_under_the_pointer(reported: Path) -> None:
    assert re.search(
        r'title="95 % confidence interval: [\d.]+–[\d.]+">', (reported / "index.html").read_text()
    )


def test_bars_are_for_pairs_with_a_scene(reported: Path) -> None:
    run = read_run(reported)
    for group, is_drawn in (("lenses", False), ("pairs", True)):
        part = run.part(group)
        assert (
            bool(list(Bars().drawings(FigureData(part, run, fake_sources(), looks(run.methods))))) == is_drawn
        )


def test_captions_count_rigs_and_never_pairs_alone(write_run: WriteRun) -> None:
    captions = " ".join(table.caption for table in all_tables(read_run(write_run(rows(), spec=SPEC))))
    assert "8 rigs (2 motions each)" in captions
    assert "2 rigs (2 scenes each)" in captions
    assert not re.search(r"over \d+ pairs", captions)


def test_a_rig_has_a_row_over_all_motions_and_one_under_each(reported: Path) -> None:
    table = rig_table(read_run(reported).part("lenses"))
    assert table is not None
    assert [section.title for section in table.sections] == ["all motions", "sideways", "rolled"]
    assert [row[0].text for row in table.sections[0].rows] == [*RIGS, "geometric mean"]
    values = [next(r[2].value for r in s.rows if r[0].text == "lens-3") for s in table.sections]
    assert isinstance(values[1], float)
    assert isinstance(values[2], float)
    assert values[0] == pytest.approx((values[1] * values[2]) ** 0.5)
