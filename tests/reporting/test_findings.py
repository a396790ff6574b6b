"""Sentences that are computed: reversals between rigs, and up to which view a perspective image is best."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from rectbench.plugins.metric import Column
from rectbench.reporting.curves import rig_curves
from rectbench.reporting.tables.findings import findings, leading, perspective_limit, reversals, turn
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
    assert limit(write_run, rows) == (
        "On 5 of 6 rigs abraham has less log distortion than any perspective image, even on the inmost "
        "10 % of the view. On a a perspective image has the least log distortion up to "
        "96° across, abraham beyond."
    )


def test_rigs_without_any_perspective_image_are_counted(write_run: WriteRun) -> None:
    rows = [
        *crossing_at(64.0, "a"),
        *(row for row in crossing_at(64.0, "b") if row["method"] != "conventional"),
    ]
    assert limit(write_run, rows).endswith(
        "up to 96° across, abraham beyond. On 1 of 2 rigs no perspective image was to be had."
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


SIX = tuple(f"rig-{i}" for i in range(6))
TEN = tuple(f"rig-{i}" for i in range(10))


def flat_rows(values: Mapping[str, Mapping[str, float]]) -> list[dict[str, Any]]:
    """Curves that are level, by method and rig."""
    return [
        curve_row(rig, method, lambda s, value=value: value)  # type: ignore[misc]  # mypy takes no default
        for method, by_rig in values.items()
        for rig, value in by_rig.items()
    ]


def told(write_run: WriteRun, sentence: Callable[..., str], rows: list[dict[str, Any]]) -> str:
    return sentence(read_run(write_run(rows)))


def test_a_leader_that_the_rigs_tell_apart_is_ahead(write_run: WriteRun) -> None:
    ours = dict(zip(SIX, (0.2, 0.21, 0.2, 0.19, 0.2, 0.2), strict=True))
    theirs = {rig: 1.5 * ours[rig] * factor for rig, factor in zip(SIX, (1, 1.02, 0.98) * 2, strict=True)}
    assert re.fullmatch(
        r"local-homography is ahead of abraham at 95 % of the view: abraham's log distortion is 50 % more "
        r"\(interval over rigs: \+4\d % to \+5\d %\); local-homography is ahead on 6 of 6 rigs\.",
        told(write_run, leading, flat_rows({"abraham": theirs, "local-homography": ours})),
    )


def test_two_that_the_rigs_do_not_tell_apart_are_said_not_to_be(write_run: WriteRun) -> None:
    ours = dict(zip(SIX, (0.2, 0.2, 0.2, 0.4, 0.3, 0.3), strict=True))
    theirs = dict(zip(SIX, (0.3, 0.4, 0.3, 0.3, 0.2, 0.3), strict=True))
    sentence = told(write_run, leading, flat_rows({"abraham": theirs, "local-homography": ours}))
    assert sentence.startswith("local-homography and abraham are not told apart at 95 % of the view: ")
    assert "(interval over rigs: −" in sentence
    assert sentence.endswith(
        "local-homography is ahead on 3 of 6 rigs, behind on rig-3 and rig-4, alike on rig-5."
    )


def test_few_rigs_that_differ_much_are_too_few_to_tell(write_run: WriteRun) -> None:
    values = {"abraham": {"a": 0.1, "b": 0.4, "c": 0.4}, "local-homography": {"a": 0.3, "b": 0.2, "c": 0.1}}
    assert "more (3 rigs: too few to tell); " in told(write_run, leading, flat_rows(values))


def test_what_a_signed_rank_test_finds_beside_the_t_test_is_told(write_run: WriteRun) -> None:
    theirs = dict.fromkeys(TEN, 0.3)
    ours = dict.fromkeys(TEN, 0.28) | {"rig-0": 0.6}  # one rig keeps the t test from telling
    sentence = told(write_run, leading, flat_rows({"abraham": theirs, "local-homography": ours}))
    assert "not told apart" in sentence
    assert "by their ranks alone, local-homography is better by 2 % or more with probability 0.9" in sentence


def test_nobody_leads_where_fewer_than_two_are_ranked(write_run: WriteRun) -> None:
    alone = flat_rows({"abraham": dict.fromkeys(SIX, 0.2)})
    assert told(write_run, leading, alone) == told(write_run, turn, alone) == ""
    two_rigs = flat_rows({m: {"a": 0.2, "b": 0.3} for m in ("abraham", "local-homography")})
    assert told(write_run, leading, two_rigs) == ""


def leaders(crossings: Mapping[str, float]) -> list[dict[str, Any]]:
    """Abraham's curve rises through the other's, a flat one, at a share (%) of each rig."""
    return [
        row
        for rig, share in crossings.items()
        for row in (
            curve_row(rig, "local-homography", lambda s: 0.2),
            curve_row(rig, "abraham", lambda s, share=share: 0.2 * s / share),  # type: ignore[misc]
        )
    ]


def test_a_turn_is_told_by_the_view_up_to_which_the_second_has_less(write_run: WriteRun) -> None:
    assert told(write_run, turn, leaders({"a": 40.0, "b": 60.0, "c": 64.0})) == (
        "In the inner part of the view abraham has less log distortion than local-homography: on 3 of 3 rigs "
        "up to 90° across (median)."
    )


def test_rigs_where_the_second_has_less_throughout_are_named_beside(write_run: WriteRun) -> None:
    rows = leaders({"a": 40.0, "b": 40.0, "c": 40.0, "d": 120.0})
    assert told(write_run, turn, rows).endswith(
        "on 3 of 4 rigs up to 60° across (median), on d in the whole view."
    )


def test_no_turn_is_told_where_the_second_has_more_everywhere(write_run: WriteRun) -> None:
    assert told(write_run, turn, leaders({"a": 5.0, "b": 5.0, "c": 5.0})) == ""


def test_only_the_part_of_the_most_rigs_tells_how_far_a_perspective_image_is_best(
    write_run: WriteRun,
) -> None:
    many = [row | {"group": "many"} for rig in "abc" for row in crossing_at(64.0, rig)]
    few = [row | {"group": "few"} for row in crossing_at(64.0, "a")]
    spec = {"groups": [{"name": name, "title": name, "figures": []} for name in ("few", "many")]}
    found = findings(read_run(write_run([*few, *many], spec=spec)))
    assert not any("perspective image" in sentence for sentence in found["few"])
    assert any("perspective image" in sentence for sentence in found["many"])
