"""Columns of shares of the view: how they read, and how a glossary folds them."""

from __future__ import annotations

from rectbench.plugins.catalogue import known
from rectbench.reporting.shares import explained, is_of_own_view, reads, share_of


def test_columns_of_one_thing_on_many_shares_have_one_entry() -> None:
    columns = known().columns
    entries = {entry.column.key: entry for entry in explained(columns)}
    (folded,) = (entry for entry in entries.values() if entry.keys.startswith("log_distortion_N,"))
    assert folded.keys == "log_distortion_N, N = 10, 20, 30, 40, 50, 60, 70, 75, 80, 90, 95, 100"
    assert folded.column.heading == "log distortion, N % of view"
    assert "N %" in folded.column.meaning
    assert "10 %" not in folded.column.meaning
    assert folded.column.meaning.endswith("Methods are ranked by it at 95 %.")
    assert "view_N_deg" in {entry.keys.partition(",")[0] for entry in entries.values()}
    assert {"log_distortion", "fit_s"} <= {entry.keys for entry in entries.values()}


def test_no_share_reads_as_if_it_were_a_percentile() -> None:
    for column in known().columns:
        if share_of(column) is not None:
            assert f"{share_of(column)} % of" in reads(column).replace("\u00a0", " ")


def test_the_excess_over_the_floor_is_of_one_view_for_all_and_so_has_a_best() -> None:
    assert not is_of_own_view(known().column("excess_over_floor"))
    assert not is_of_own_view(known().column("excess_over_floor_distortion"))
