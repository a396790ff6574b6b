"""Who is ranked, by what, and how sure: on runs whose effects are known."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rectbench.reporting.tables.belief_table import belief_table
from rectbench.reporting.tables.main_tables import main_tables
from rectbench.reporting.tables.rig_tables import rig_table
from rectbench.reporting.tables.table import Table, to_csv, to_latex, to_markdown
from rectbench.runs.run import Run, read_run
from tests.reporting.runs import failed_row, make_row

WriteRun = Callable[..., Path]
SIX = tuple(f"rig-{i}" for i in range(6))
UNEVEN = np.exp(0.02 * np.array([1, -1, 2, -2, 1.5, -1.5]))
"""How far each rig is off a method's usual distortion."""


def rows_of(values: Mapping[str, Mapping[str, float]], **changes: Any) -> list[dict[str, Any]]:
    """A pair a rig: log distortion at 95 % of the view by method and rig, NaN where that is not kept."""
    return [
        make_row("street", rig, "exact", method, log_distortion_95=value, **changes)
        for method, by_rig in values.items()
        for rig, value in by_rig.items()
    ]


def around(level: float, spread: np.ndarray[Any, Any] = UNEVEN) -> dict[str, float]:
    return dict(zip(SIX, level * spread, strict=True))


def only_table(run: Run) -> Table:
    (table,) = main_tables(run)
    return table


def column(table: Table, key: str) -> dict[str, str]:
    """What a reader sees in a column, by method, in the table's order."""
    heads = [heading.key for heading in table.headings]
    return {row[heads.index("method")].text: row[heads.index(key)].text for row in table.rows}


def test_methods_far_apart_have_ranks_of_their_own(write_run: WriteRun) -> None:
    values = {"hartley": around(0.9), "abraham": around(0.3), "local-homography": around(0.2, UNEVEN[::-1])}
    table = only_table(read_run(write_run(rows_of(values))))
    assert column(table, "rank") == {"local-homography": "1", "abraham": "2", "hartley": "3"}
    assert "Ranked by log distortion at 95 % of the view." in table.caption


def test_methods_that_the_rigs_do_not_tell_apart_share_their_ranks(write_run: WriteRun) -> None:
    turned = np.roll(UNEVEN, 1)
    values = {"hartley": around(0.9), "abraham": around(0.301), "local-homography": around(0.3, turned)}
    table = only_table(read_run(write_run(rows_of(values))))
    assert column(table, "rank") == {"local-homography": "1–2", "abraham": "1–2", "hartley": "3"}


def test_equal_methods_tie_and_are_both_bold(write_run: WriteRun) -> None:
    values = {
        "hartley": around(0.9),
        "abraham": around(0.3),
        "local-homography": around(0.3 * (1 + 1e-12)),
    }
    table = only_table(read_run(write_run(rows_of(values))))
    place = [heading.key for heading in table.headings].index("log_distortion_95")
    assert [row[place].best for row in table.rows] == [True, True, False]
    ranks = column(table, "rank")
    assert ranks["abraham"] == ranks["local-homography"] == "1–2"


def test_files_say_what_the_page_alone_shows_when_pointed_at(write_run: WriteRun) -> None:
    rows = rows_of({"abraham": around(0.3), "hartley": around(0.9)}, sampling_lost=0.5, distortion_native=0.1)
    table = only_table(read_run(write_run(rows)))
    for text in (to_markdown(table), to_latex(table)):
        assert "Pixels lost: Share of source area squeezed (" in text
        assert "Distortion, native: The paper's mean L" in text.replace("’", "'")
    assert "Pixels lost" not in table.caption


def test_the_design_s_resolution_stands_before_the_results(write_run: WriteRun) -> None:
    values = {"abraham": around(0.3), "local-homography": around(0.2, np.roll(UNEVEN, 1))}
    caption = only_table(read_run(write_run(rows_of(values)))).caption
    assert re.match(
        r"A difference of \d+ % between two methods shows on 6 rigs with 80 % power; where no "
        r"difference shows, methods share their places, such as 1–2\. Ranked by log distortion at 95 % of "
        r"the view\.",
        caption,
    )


def test_two_rigs_are_too_few_for_ranks_and_say_so(write_run: WriteRun) -> None:
    values = {"abraham": {"a": 0.3, "b": 0.31}, "local-homography": {"a": 0.2, "b": 0.21}}
    table = only_table(read_run(write_run(rows_of(values))))
    assert table.caption.startswith("2 rigs: too few to tell methods apart. In the order of log distortion")
    assert "Ranked by" not in table.caption
    assert {"rank", "log_distortion_95_interval"}.isdisjoint(heading.key for heading in table.headings)
    assert list(column(table, "ok")) == ["local-homography", "abraham"]


def test_a_method_that_shows_less_of_the_view_stands_below_by_what_it_keeps(write_run: WriteRun) -> None:
    lost = dict.fromkeys(SIX, float("nan"))
    rows = [
        *rows_of({"hartley": lost}, view_kept=0.5),
        *rows_of({"conventional": lost}, view_kept=0.7),
        *rows_of({"fusiello": around(0.01) | {"rig-3": float("nan")}}, view_kept=0.6),
        *rows_of(
            {"abraham": around(0.3), "local-homography": around(0.2, np.roll(UNEVEN, 1))}, view_kept=1.0
        ),
    ]
    table = only_table(read_run(write_run(rows)))
    ranks = column(table, "rank")
    assert list(ranks) == ["local-homography", "abraham", "fusiello", "conventional", "hartley"]
    assert list(ranks.values()) == ["1", "2", "–", "–", "–"]
    assert column(table, "view_kept")["conventional"] == "70.0"
    assert any("less than 95 % of the view" in note and "conventional" in note for note in table.notes)


def kept_row(rig: str, kept: float, **changes: Any) -> dict[str, Any]:
    return make_row(
        "street", rig, "exact", "conventional", **{"log_distortion_95": NONE, "view_kept": kept, **changes}
    )


NONE = float("nan")
LEADERS = {"abraham": around(0.3), "local-homography": around(0.2, np.roll(UNEVEN, 1))}


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ([kept_row(rig, kept) for rig, kept in zip(SIX, [0.4, 0.48] * 3, strict=True)], "keeps 44 %"),
        (
            [kept_row(rig, 0.949) for rig in SIX[:2]]
            + rows_of({"conventional": dict.fromkeys(SIX[2:], 0.1)}),
            "keeps 94 % on 2 of 6",
        ),
        (
            [kept_row(rig, 1.0, row_bend_px=px, rectifies=0.0) for px, rig in enumerate(SIX, 3)],
            "rows bent by 8.0 px",
        ),
        (
            [kept_row(rig, 1.0, row_misfit=0.0341, rectifies=0.0) for rig in SIX[:1]]
            + [kept_row(rig, 0.5, row_misfit=0.001) for rig in SIX[1:]],
            "rows 3.4 % apart on 1 of 6",
        ),
        ([kept_row(rig, 1.0, row_misfit=0.009) for rig in SIX], "–"),
        ([failed_row("street", rig, "exact", "conventional") for rig in SIX], "unsupported"),
        (
            [failed_row("street", rig, "exact", "conventional", "timeout") for rig in SIX[:3]]
            + [kept_row(rig, 0.5) for rig in SIX[3:5]]
            + rows_of({"conventional": {SIX[5]: 0.3}}),
            "timeout on 3 of 6",
        ),
    ],
)
def test_in_the_place_of_the_number_stands_why_there_is_none(
    write_run: WriteRun, rows: list[dict[str, Any]], expected: str
) -> None:
    table = only_table(read_run(write_run([*rows_of(LEADERS), *rows])))
    texts = column(table, "log_distortion_95")
    assert list(texts)[-1] == "conventional"
    assert texts["conventional"].replace("\u00a0", " ") == expected
    assert column(table, "rank")["conventional"] == "–"


def test_a_map_that_is_no_rectification_stands_below_those_that_show_little(write_run: WriteRun) -> None:
    crooked = [kept_row(rig, 1.0, row_misfit=0.05, rectifies=0.0) | {"method": "hartley"} for rig in SIX]
    rows = [*rows_of(LEADERS), *crooked, *(kept_row(rig, 0.4) for rig in SIX)]
    table = only_table(read_run(write_run(rows)))
    assert list(column(table, "ok"))[2:] == ["conventional", "hartley"]
    assert any("rows are no epipolar planes" in note and "hartley" in note for note in table.notes)


def test_the_ranking_column_stands_before_all_others(write_run: WriteRun) -> None:
    table = only_table(read_run(write_run(rows_of(LEADERS))))
    keys = [heading.key for heading in table.headings]
    assert keys[:4] == ["rank", "method", "log_distortion_95", "log_distortion_95_interval"]


def test_the_csv_holds_places_intervals_and_counts_as_numbers(write_run: WriteRun) -> None:
    rows = [*rows_of(LEADERS), *(kept_row(rig, 0.4) for rig in SIX)]
    rows[-1] |= {"log_distortion_50": NONE}
    text = to_csv(only_table(read_run(write_run(rows))))
    found = {row["method"]: row for row in csv.DictReader(io.StringIO(text))}
    first = found["local-homography"]
    assert (first["rank_first"], first["rank_last"]) == ("1", "1")
    low, value, high = (float(first[f"log_distortion_95{end}"]) for end in ("_low", "", "_high"))
    assert low < value < high
    assert value == pytest.approx(0.2)
    assert found["conventional"]["log_distortion_95"] == found["conventional"]["rank_first"] == ""
    assert found["conventional"]["log_distortion_50_count"] == "5"
    assert first["log_distortion_50_count"] == "6"
    assert not {"log_distortion_95_interval", "view_kept_count"} & first.keys()


def test_an_interval_over_few_rigs_that_tells_nothing_is_said_to_tell_nothing(write_run: WriteRun) -> None:
    values = {"abraham": {"a": 0.1, "b": 0.4, "c": 0.2}, "local-homography": {"a": 0.3, "b": 0.31, "c": 0.3}}
    run = read_run(write_run(rows_of(values)))
    assert column(only_table(run), "log_distortion_95_interval") == {
        "abraham": "3 rigs: too few to tell",
        "local-homography": "0.29–0.32",
    }


def test_rigs_stand_in_the_order_of_their_field_of_view(write_run: WriteRun) -> None:
    rows = [
        row | {"view_95_deg": 100.0 + 10 * place}
        for place, rig in enumerate(reversed(SIX))
        for row in rows_of({method: {rig: values[rig]} for method, values in LEADERS.items()})
    ]
    table = rig_table(read_run(write_run(rows)))
    assert table is not None
    assert [row[0].text for row in table.rows] == [*reversed(SIX), "geometric mean"]


def test_what_a_method_shows_itself_has_no_best_one(write_run: WriteRun) -> None:
    run = read_run(write_run(rows_of(LEADERS)))
    table = only_table(run)
    place = [heading.key for heading in table.headings].index("distortion_native")
    assert not any(row[place].best for row in table.rows)


def test_a_method_that_fails_on_a_rig_where_two_do_not_has_no_rank(write_run: WriteRun) -> None:
    values = {"hartley": around(0.9), "abraham": around(0.3), "local-homography": around(0.2)}
    rows = rows_of(values)
    rows[-1] = failed_row("street", "rig-5", "exact", "local-homography")
    ranks = column(only_table(read_run(write_run(rows))), "rank")
    assert ranks == {"abraham": "1", "hartley": "2", "local-homography": "–"}


def test_a_rig_that_one_method_alone_serves_makes_it_no_first(write_run: WriteRun) -> None:
    values = {"abraham": around(0.3), "local-homography": around(0.2), "hartley": around(0.9)}
    rows = [*rows_of(values), *rows_of({"hartley": {"rig-6": 0.9}})]
    rows += [failed_row("street", "rig-6", "exact", name) for name in ("abraham", "local-homography")]
    table = only_table(read_run(write_run(rows)))
    assert list(column(table, "rank").items()) == [
        ("local-homography", "1–2"),
        ("abraham", "2–3"),
        ("hartley", "1–3"),
    ]
    assert "shows on 6 of 7 rigs, which all ranked methods serve, with 80" in table.caption


def test_a_run_that_measures_no_distortion_is_not_said_to_be_ranked(write_run: WriteRun) -> None:
    rows = [
        {k: v for k, v in make_row("street", rig, "exact", "abraham").items() if "distortion" not in k}
        for rig in SIX
    ]
    rows = [{k: v for k, v in row.items() if not k.startswith("view")} for row in rows]
    caption = only_table(read_run(write_run(rows))).caption
    assert caption == "Means over 6 rigs (1 scene each)."


def test_below_six_rigs_the_table_says_what_its_ranks_rest_on(write_run: WriteRun) -> None:
    values = {"abraham": around(0.3), "local-homography": around(0.2, np.roll(UNEVEN, 1))}
    five = {method: dict(list(by_rig.items())[:5]) for method, by_rig in values.items()}
    for of, expected in ((five, True), (values, False)):
        table = only_table(read_run(write_run(rows_of(of))))
        assert any("no signed-rank test reaches 0.05" in note for note in table.notes) == expected


@pytest.mark.parametrize("seeds", [1, 4])
def test_seeds_and_scenes_of_a_rig_narrow_no_interval(write_run: WriteRun, seeds: int) -> None:
    rows = [
        make_row(scene, rig, "exact", "abraham", seed, log_distortion_95=value)
        for scene in ("street", "room")
        for seed in range(seeds)
        for rig, value in around(0.3).items()
    ]
    table = only_table(read_run(write_run(rows)))
    assert column(table, "log_distortion_95_interval") == {"abraham": "0.29–0.31"}


def test_the_rigs_have_a_row_each_and_their_geometric_mean_the_last(write_run: WriteRun) -> None:
    lost = {"rig-0": float("nan")}
    rows = [
        *rows_of({"abraham": around(0.3)}, view_kept=1.0),
        *rows_of({"conventional": around(0.1) | lost}, view_kept=0.8),
    ]
    table = rig_table(read_run(write_run(rows)))
    assert table is not None
    assert [row[0].text for row in table.rows] == [*SIX, "geometric mean"]
    assert [heading.text for heading in table.headings][-2:] == ["abraham", "conventional"]
    assert table.rows[0][-1].text == "keeps\u00a080\u00a0%"
    assert table.rows[0][-1].value is None
    assert table.rows[-1][-2].value == pytest.approx(0.3)
    assert table.rows[-1][-2].text == "0.300 (0.29–0.31)"
    assert table.rows[-1][-1].text == "–"


def test_from_ten_rigs_on_a_table_says_how_probably_methods_differ_in_practice(write_run: WriteRun) -> None:
    rigs = [f"rig-{i}" for i in range(10)]
    values = {
        "hartley": dict.fromkeys(rigs, 0.9),
        "abraham": dict.fromkeys(rigs, 0.3),
        "local-homography": dict.fromkeys(rigs, 0.301),
    }
    table = belief_table(read_run(write_run(rows_of(values))))
    assert table is not None
    assert "less" in table.caption
    assert "2 %" in table.caption
    by_pair = {(row[0].text, row[1].text): [entry.best for entry in row[2:]] for row in table.rows}
    assert by_pair == {
        ("abraham", "local-homography"): [False, True, False],
        ("abraham", "hartley"): [True, False, False],
        ("local-homography", "hartley"): [True, False, False],
    }
    nine = {method: dict(list(by_rig.items())[:9]) for method, by_rig in values.items()}
    assert belief_table(read_run(write_run(rows_of(nine)))) is None
