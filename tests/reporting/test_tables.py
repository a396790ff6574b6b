from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rectbench.plugins.catalogue import known
from rectbench.reporting.tables.main_tables import main_tables
from rectbench.reporting.tables.pair_tables import pair_tables
from rectbench.reporting.tables.part_tables import all_tables
from rectbench.reporting.tables.rig_tables import distortion_tables
from rectbench.reporting.tables.table import Table, escape_latex, to_csv, to_latex, to_markdown
from rectbench.runs.run import read_run
from tests.reporting.runs import RIGS, SCENES, failed_row, make_row, quick_rows

WriteRun = Callable[..., Path]


def with_failures(
    rows: list[dict[str, Any]], fails: Callable[[dict[str, Any]], bool]
) -> list[dict[str, Any]]:
    return [failed_row(r["scene"], r["rig"], r["pose"], r["method"]) if fails(r) else r for r in rows]


def records(table: Table) -> dict[str, dict[str, str]]:
    """The CSV by method."""
    return {row["method"]: row for row in csv.DictReader(io.StringIO(to_csv(table)))}


def texts(table: Table, method: str) -> dict[str, str]:
    """What a reader sees in a method's row, by column."""
    row = next(row for row in table.rows if method in [entry.text for entry in row])
    return {heading.key: entry.text for heading, entry in zip(table.headings, row, strict=True)}


def nested(rows: list[dict[str, Any]], key: str, average: Callable[[list[float]], float]) -> float:
    """The average over rigs of each rig's average over its scenes, by brute force."""
    return average([average([r[key] for r in rows if r["rig"] == rig]) for rig in RIGS])


def geometric(values: list[float]) -> float:
    return float(np.exp(np.mean(np.log(values))))


def mean(values: list[float]) -> float:
    return float(np.mean(values))


def test_main_table_holds_the_means_of_the_input(write_run: WriteRun) -> None:
    rows = quick_rows()
    rules = {"log_distortion_50": geometric, "row_error_50_mean_px": mean, "fit_s": mean}
    for table, pose in zip(main_tables(read_run(write_run(rows))), ("exact", "perturbed"), strict=True):
        for method, record in records(table).items():
            mine = [r for r in rows if r["method"] == method and r["pose"] == pose]
            for key, rule in rules.items():
                assert float(record[key]) == pytest.approx(nested(mine, key, rule), rel=1e-8), key
            assert record["ok"] == "12/12"


def test_a_method_with_failures_says_so_ranks_last_and_wins_nothing(write_run: WriteRun) -> None:
    rows = with_failures(quick_rows(), lambda r: r["method"] == "local-homography" and r["scene"] == "room")
    table = main_tables(read_run(write_run(rows)))[1]
    assert texts(table, "local-homography")["ok"] == "9/12"
    assert texts(table, "local-homography")["not_ok"] == "3 unsupported"
    assert texts(table, "local-homography").get("rank", "–") == "–"
    last = table.rows[-1]
    assert "local-homography" in [entry.text for entry in last]
    assert not any(entry.best for entry in last)
    assert any("measured cells alone" in note for note in table.notes)


def test_a_value_missing_from_measured_cells_is_counted(write_run: WriteRun) -> None:
    rows = quick_rows(poses=("perturbed",))
    rows[0] = make_row("street", "t265", "perturbed", "conventional", row_error_50_mean_px=float("nan"))
    table = main_tables(read_run(write_run(rows)))[0]
    assert texts(table, "conventional")["row_error_50_mean_px"].endswith("(11/12)")


def test_rms_is_pooled_and_a_maximum_stays_one(write_run: WriteRun) -> None:
    from rectbench.reporting.tables.summaries import summarise

    run = read_run(write_run(quick_rows(poses=("perturbed",))))
    results = run.select(method="abraham")
    columns = map(run.catalogue.column, ("row_error_rms_px", "row_error_max_px"))
    averages = summarise("abraham", results, columns).averages
    rms = [r.metrics["row_error_rms_px"] for r in results]
    assert averages["row_error_rms_px"].value == pytest.approx(np.sqrt(np.mean(np.square(rms))))
    assert averages["row_error_max_px"].value == max(r.metrics["row_error_max_px"] for r in results)


def test_the_best_value_is_bold_and_equal_looking_ones_tie(write_run: WriteRun) -> None:
    rows = quick_rows(scenes=("street",), rigs=("t265",), poses=("exact",))
    table = pair_tables(read_run(write_run(rows)))[0]
    by_metric = {row[0].value: row for row in table.rows}
    best = [entry.best for entry in by_metric["row_error_50_mean_px"][1:]]
    assert best == [True, True, False, False, True]
    assert [entry.best for entry in by_metric["log_distortion_95"][1:]] == [False, False, False, False, True]
    assert not any(entry.best for entry in by_metric["log_distortion"][1:])  # each of what it shows
    assert not any(entry.best for entry in by_metric["maps_s"])  # all alike
    assert not any(entry.best for entry in by_metric["row_error_matches"])  # no better or worse


def test_pair_tables_hold_every_metric_of_every_pair(write_run: WriteRun) -> None:
    rows = quick_rows()
    tables = pair_tables(read_run(write_run(rows)))
    assert len(tables) == len(SCENES) * len(RIGS)
    table = next(t for t in tables if t.name == "pair-room-sony-hdr-as200v")
    row = make_row("room", "sony-hdr-as200v", "perturbed", "abraham")
    lines = [r for r in csv.DictReader(io.StringIO(to_csv(table))) if r["section"] == "perturbed pose"]
    found = {line["metric"]: line["abraham"] for line in lines}
    of_rows_alone = {column.key for column in known().shown("rows")}
    assert "log_distortion_95" in found
    assert not of_rows_alone & found.keys()
    for key, value in row.items():
        if isinstance(value, float) and key not in of_rows_alone:
            assert float(found[key]) == pytest.approx(value, rel=1e-8), key
    assert found["note:focal_px"] == "412.25"


def test_distortion_tables_have_a_section_a_rig_every_share_and_every_protocol(write_run: WriteRun) -> None:
    tables = list(distortion_tables(read_run(write_run(quick_rows()))))
    for table in tables:
        assert [section.title for section in table.sections] == ["all rigs", *RIGS]
    by_view, by_protocol = ({heading.key for heading in table.headings} for table in tables)
    assert {f"log_distortion_{share}" for share in (50, 75, 95, 100)} <= by_view
    assert {"distortion_native", "distortion_rescaled", "distortion_stretched"} <= by_protocol


def test_variants_of_one_method_are_told_apart_by_their_options(write_run: WriteRun) -> None:
    rows = [
        make_row("street", "t265", "exact", "abraham", options=options)
        for options in ('{"law":"equidistant"}', '{"law":"stereographic"}')
    ]
    run = read_run(write_run(rows))
    assert run.methods == ("abraham (law=equidistant)", "abraham (law=stereographic)")


def test_latex_is_balanced_and_escaped(write_run: WriteRun) -> None:
    rows = with_failures(quick_rows(), lambda r: r["method"] == "hartley")
    rows = [r | {"reason": r["reason"] and r"100% of $x_1 & {y}^2 ~ \z # <10"} for r in rows]
    rows += [make_row("street", "t265", "exact", "my_own_method")]
    for table in all_tables(read_run(write_run(rows))):
        tex = to_latex(table)
        bare = re.sub(r"\\[\\{}&%$#_]", "", tex)
        assert bare.count("{") == bare.count("}")
        assert bare.count("$") % 2 == 0
        assert tex.count(r"\begin{") == tex.count(r"\end{")
        body = tex[tex.index(r"\toprule") : tex.index(r"\bottomrule")].replace(r"\&", "")
        lines = [line for line in body.splitlines() if line.endswith(r"\\") and "multicolumn" not in line]
        assert {line.count("&") for line in lines} == {len(table.headings) - 1}
        assert tex.isascii(), {c for c in tex if not c.isascii()}


def test_latex_symbols_become_commands() -> None:
    assert escape_latex("<10⁻⁶") == "$<$$10^{-6}$"
    assert escape_latex("a_b & 5%") == r"a\_b \& 5\%"


def test_markdown_marks_the_best_and_cannot_be_broken_by_names(write_run: WriteRun) -> None:
    nasty = failed_row("street", "t265", "exact", "pi|pe", reason="a|b\n<i>c</i>")
    rows = [*quick_rows(poses=("exact",)), nasty]
    made = list(all_tables(read_run(write_run(rows))))
    tables = {table.name: to_markdown(table) for table in made}
    csvs = {table.name: to_csv(table) for table in made}
    best = next(
        r for r in csv.DictReader(io.StringIO(csvs["main-exact"])) if r["method"] == "local-homography"
    )
    assert f"**{float(best['log_distortion_95']):.3g}**" in tables["main-exact"]
    assert r"pi\|pe" in tables["main-exact"]
    assert r"a\|b &lt;i&gt;c&lt;/i&gt;" in tables["failures"]
    for text in tables.values():
        pipes = {len(re.findall(r"(?<!\\)\|", line)) for line in text.splitlines() if line.startswith("|")}
        assert len(pipes) == 1
