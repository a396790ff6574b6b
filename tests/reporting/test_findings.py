"""Sentences that are computed: reversals between rigs, and up to which view a perspective image is best."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from rectbench.plugins.metric import Column
from rectbench.reporting.curves import rig_curves
from rectbench.reporting.tables.findings import perspective_limit, reversals
from rectbench.runs.run import read_run
from tests.reporting.runs import SHARES, make_row

WriteRun = Callable[..., Path]
LOWER = Column("x", "x", better="lower")
PERSPECTIVE = '{"projection": "perspective"}'


def curve_row(
    rig: str, method: str, curve: Callable[[int], float], kept: float = 1.0, **changes: Any
) -> dict[str, Any]:
    """A row whose log distortion at a share is `curve` of it, on a view of 1.5° a percent."""
    nan = float("nan")
    columns = {f"log_distortion_{s}": curve(s) if s <= 100 * kept else nan for s in SHARES}
    columns |= {f"view_{s}_deg": 1.5 * s for s in SHARES} | {"view_kept": kept}
    notes = PERSPECTIVE if method == "conventional" else "{}"
    return make_row("none", rig, "exact", method, notes=notes, **(columns | changes))


def crossing_at(share: float, rig: str, kept: float = 1.0) -> list[dict[str, Any]]:
    """A perspective curve that crosses another, flat one at a share (%)."""
    return [
        curve_row(rig, "conventional", lambda s: 0.2 * s / share, kept),
        curve_row(rig, "abraham", lambda s: 0.2),
        curve_row(rig, "local-homography", lambda s: 0.25),
    ]


def limit(write_run: WriteRun, rows: list[dict[str, Any]]) -> str:
    return perspective_limit(read_run(write_run(rows)))


def test_a_reversal_names_the_rigs_where_the_order_is_turned_about() -> None:
    rigs = [f"rig-{i}" for i in range(6)]
    ours = dict.fromkeys(rigs, 0.2) | {"canon-8mm": 0.42, "t265": 0.4}
    theirs = dict.fromkeys([*rigs, "canon-8mm", "t265"], 0.34)
    assert list(reversals({"local-homography": ours, "abraham": theirs}, LOWER)) == [
        "local-homography is ahead of abraham on 6 of 8 rigs, behind on canon-8mm and t265."
    ]


def test_the_one_that_is_ahead_on_more_rigs_is_named_first() -> None:
    values: Mapping[str, Mapping[str, float]] = {
        "a": {"x": 0.1, "y": 0.5, "z": 0.5, "w": 0.3},
        "b": {"x": 0.4, "y": 0.4, "z": 0.4, "w": 0.3},
    }
    assert list(reversals(values, LOWER)) == ["b is ahead of a on 2 of 4 rigs, behind on x, alike on w."]


def test_what_reads_the_same_is_no_reversal() -> None:
    values = {"a": {"x": 0.1, "y": 0.30001}, "b": {"x": 0.2, "y": 0.3}}
    assert list(reversals(values, LOWER)) == []


def test_the_crossing_of_two_curves_is_the_limit(write_run: WriteRun) -> None:
    assert limit(write_run, crossing_at(64.0, "a")) == (
        "On a a perspective image has the least log distortion up to 96° across, abraham beyond."
    )


def test_the_crossing_is_found_between_the_measured_shares(write_run: WriteRun) -> None:
    (curves,) = rig_curves(read_run(write_run(crossing_at(64.0, "a"))))
    assert curves.view_deg(64.0) == pytest.approx(96.0)
    assert curves.view_deg(5.0) is None


def test_limits_of_several_rigs_are_told_as_a_range(write_run: WriteRun) -> None:
    rows = [row for share, rig in ((42.0, "a"), (50.0, "b"), (52.0, "c")) for row in crossing_at(share, rig)]
    assert (
        "On all 3 rigs a perspective image has the least log distortion up to 63° to 78° across (median 75°)"
        in limit(write_run, rows)
    )


def test_a_perspective_image_ends_where_it_keeps_no_more(write_run: WriteRun) -> None:
    told = limit(write_run, crossing_at(90.0, "a", kept=0.56))
    assert "up to 84° across, abraham beyond" in told


def test_rigs_without_a_crossing_are_told_apart(write_run: WriteRun) -> None:
    rows = [*crossing_at(150.0, "narrow"), *crossing_at(5.0, "wide")]
    assert limit(write_run, rows).endswith(
        "On narrow a perspective image has the least log distortion in the whole view."
    )


def test_many_rigs_are_counted_and_told_first(write_run: WriteRun) -> None:
    rows = [row for i in range(5) for row in crossing_at(5.0, f"wide-{i}")] + crossing_at(64.0, "a")
    assert limit(write_run, rows).endswith(
        "perspective image has the least log distortion: abraham has less. On a a perspective image has the "
        "least log distortion up to 96° across, abraham beyond."
    )


def test_a_report_of_one_kind_of_image_has_no_limit(write_run: WriteRun) -> None:
    rows = [row for row in crossing_at(64.0, "a") if row["method"] != "conventional"]
    assert limit(write_run, rows) == ""
    assert limit(write_run, [row for row in crossing_at(64.0, "a") if row["method"] == "conventional"]) == ""


def test_a_curve_has_a_point_where_every_pair_of_the_rig_has_one(write_run: WriteRun) -> None:
    rows = [
        curve_row("a", "abraham", lambda s: 0.1, kept=kept, motion=motion)
        for kept, motion in ((1.0, "still"), (0.55, "wide"))
    ]
    (curves,) = rig_curves(read_run(write_run(rows)))
    assert list(curves.curves["abraham"]) == [10, 20, 30, 40, 50]
    assert curves.kept["abraham"] == pytest.approx(55.0)
