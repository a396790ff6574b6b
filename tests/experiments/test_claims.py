"""A claim is judged by the interval of what was measured, never by a lucky mean."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

import rectbench as rb
from rectbench.runs.judging import judged_claims
from rectbench.runs.rows import read_rows
from tests.experiments.fakes import small_report

BECAUSE = {verdict: verdict.upper() for verdict in ("held", "not held", "depends", "not measured")}


def rows(method: str, values: Any, **fields: Any) -> list[dict[str, Any]]:
    """Rows of one method: values [pairs, seeds] of the column `x`."""
    return [
        {
            "report": "small",
            "scene": f"scene{pair}",
            "rig": "rig",
            "motion": "sideways",
            "pose": "estimated",
            "seed": seed,
            "method": method,
            "options": "{}",
            "status": "ok",
            "group": "",
            "x": value,
            **fields,
        }
        for pair, of_seeds in enumerate(np.asarray(values, dtype=float).tolist())
        for seed, value in enumerate(of_seeds)
    ]


def judge(table: list[dict[str, Any]], *statements: rb.Statement) -> Any:
    claim = rb.Claim(name="claim", says="So it is.", statements=statements, because=BECAUSE)
    claim = rb.Claim.model_validate(claim.model_dump(mode="json"))
    (judged,) = judged_claims([claim], read_rows(table, Path("rows")), ["x"] if table else [])
    return judged


def ratio(**fields: Any) -> rb.Statement:
    given = {"label": "ratio", "metric": "x", "method": "ours", "against": "theirs", "measure": "ratio"}
    return rb.Statement(**{**given, **fields})


@pytest.mark.parametrize(
    ("bounds", "verdict"),
    [
        ({"below": 0.6}, "held"),
        ({"above": 0.4, "below": 0.6}, "held"),
        ({"below": 0.4}, "not held"),
        ({"above": 0.6}, "not held"),
        ({"below": 0.5}, "depends"),
    ],
)
def test_the_whole_interval_must_lie_within_the_bounds(bounds: dict[str, float], verdict: str) -> None:
    rng = np.random.default_rng(1)
    theirs = rng.uniform(1, 100, (4, 5))
    ours = theirs * 0.5 * np.exp(rng.normal(0, 0.05, (4, 5)))
    judged = judge(rows("ours", ours) + rows("theirs", theirs), ratio(**bounds))
    assert judged.verdict == verdict
    assert judged.because == verdict.upper()
    (test,) = judged.tests
    assert test.mean == pytest.approx(math.exp(np.log(ours / theirs).mean()))
    assert test.low < test.mean < test.high
    assert (test.pairs, test.cells, test.failed) == (4, 20, 0)


def test_the_interval_of_one_pair_is_that_of_an_independent_bootstrap() -> None:
    from scipy.stats import bootstrap

    values = np.random.default_rng(2).gamma(2.0, size=(1, 24))
    judged = judge(rows("ours", values), rb.Statement(label="mean", metric="x", method="ours", below=100.0))
    found = bootstrap((values.ravel(),), np.mean, method="percentile", rng=np.random.default_rng(5))
    test = judged.tests[0]
    assert test.low == pytest.approx(found.confidence_interval.low, rel=0.03)
    assert test.high == pytest.approx(found.confidence_interval.high, rel=0.03)


def test_seeds_of_one_pair_are_no_independent_pairs() -> None:
    few = np.random.default_rng(2).gamma(2.0, size=(5, 1))
    many = np.repeat(few, 20, axis=1)  # the same pairs, each seed alike
    statement = rb.Statement(label="mean", metric="x", method="ours", below=100.0)
    alone, repeated = (judge(rows("ours", values), statement).tests[0] for values in (few, many))
    assert repeated.high - repeated.low == pytest.approx(alone.high - alone.low, rel=0.05)


def test_pairing_takes_the_pairs_own_size_out_of_a_ratio() -> None:
    sizes = np.array([[1.0, 1000.0], [1e-3, 1.0]])
    test = judge(rows("ours", 0.7 * sizes) + rows("theirs", sizes), ratio(below=0.71)).tests[0]
    assert (test.low, test.high) == pytest.approx((0.7, 0.7))
    assert test.pairs_held == 2


def test_ways_to_measure_one_clause_that_disagree_make_it_depend() -> None:
    table = rows("ours", [[0.5, 0.5]]) + rows("theirs", [[1.0, 1.0]])
    assert judge(table, ratio(below=0.6), ratio(above=0.6)).verdict == "depends"
    assert judge(table, ratio(above=0.6), ratio(above=0.7)).verdict == "not held"


def test_a_claim_holds_only_where_each_of_its_clauses_does() -> None:
    table = rows("ours", [[0.5, 0.5]]) + rows("theirs", [[1.0, 1.0]])
    less, much_less = ratio(below=0.6, clause="less"), ratio(below=0.1, clause="much less")
    either_way = [ratio(below=0.6, clause="either"), ratio(above=0.6, clause="either")]
    assert judge(table, less, less).verdict == "held"
    assert judge(table, less, *either_way).verdict == "depends"
    assert judge(table, less, *either_way, much_less).verdict == "not held"


def test_a_failed_cell_keeps_a_statement_from_being_held() -> None:
    table = rows("ours", [[0.5, 0.5, 0.5]]) + rows("theirs", [[1.0, 1.0, 1.0]])
    table[0].update(status="timeout", x=math.nan)
    judged = judge(table, ratio(below=0.6))
    assert judged.verdict == "depends"
    assert judged.tests[0].failed == 1


def test_what_was_not_measured_is_neither_held_nor_not() -> None:
    judged = judge([], ratio(below=0.6))
    assert judged.verdict == "not measured"
    assert math.isnan(judged.tests[0].mean)


def wins(**fields: Any) -> rb.Statement:
    given = {"label": "wins", "metric": "x", "method": "ours", "rivals": ("theirs",), "measure": "wins"}
    return rb.Statement(**{**given, "above": 1, **fields})


def test_wins_count_the_pairs_where_the_mean_over_seeds_is_least() -> None:
    ours = [[1.0, 1.0], [1.0, 1.0], [3.0, 3.0]]
    theirs = [[2.0, 2.0], [2.0, 2.0], [2.0, 2.0]]
    stranger = rows("stranger", np.zeros((3, 2)))
    test = judge(rows("ours", ours) + rows("theirs", theirs) + stranger, wins()).tests[0]
    assert test.mean == test.pairs_held == 2
    assert (test.low, test.high) == (0, 3)
    assert test.verdict == "depends"


def test_nothing_is_won_without_the_rivals_or_on_fewer_pairs_than_are_claimed() -> None:
    ours = rows("ours", [[1.0, 1.0]])
    assert judge(ours, wins()).verdict == "not measured"
    assert judge(ours + rows("theirs", [[2.0, 2.0]]), wins(above=3)).verdict == "not measured"


def test_one_number_has_no_interval() -> None:
    test = judge(rows("ours", [[2.0]]), rb.Statement(label="x", metric="x", method="ours", below=3.0)).tests[
        0
    ]
    assert (test.mean, test.verdict) == (2.0, "held")
    assert math.isnan(test.low)
    assert math.isnan(test.high)


def test_a_share_compares_variants_with_the_default_of_another_group() -> None:
    default = rows("ours", [[1.0, 1.0]], group="fisheye")
    starts = [
        row
        for draw, factor in enumerate((1.0, 1.005, 30.0, 1.0))
        for row in rows(
            "ours", [[factor, factor]], group="starts", options=f'{{"draw":{draw},"start":"random"}}'
        )
    ]
    share = rb.Statement(
        label="share",
        group="starts",
        metric="x",
        method="ours",
        options={"start": "random"},
        against="ours",
        against_group="fisheye",
        measure="share",
        within=(0.0, 1.01),
        above=0.5,
    )
    test = judge(default + starts, share).tests[0]
    assert test.mean == 0.75
    assert test.cells == 8


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({}, "neither above nor below"),
        ({"above": 2.0, "below": 1.0}, "expected a range"),
        ({"above": math.nan}, "expected a range"),
        ({"measure": "ratio", "below": 1.0}, "`against` is for ratio and share"),
        ({"measure": "wins", "above": 1.0}, "`rivals` is for wins"),
        ({"measure": "share", "against": "theirs", "above": 0.5}, "`within` is for share"),
    ],
)
def test_a_statement_that_says_nothing_is_refused(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        rb.Statement(label="x", metric="x", method="ours", **fields)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"group": "fisheyes"}, "speaks of group 'fisheyes', which is none"),
        ({"method": "abrahm"}, "speaks of abrahm, which the report lacks"),
        ({"measure": "ratio", "against": "hartley"}, "speaks of hartley, which the report lacks"),
    ],
)
def test_a_report_has_what_its_claims_speak_of(fields: dict[str, Any], message: str) -> None:
    statement = rb.Statement(**{"label": "x", "metric": "x", "method": "abraham", "below": 1.0, **fields})
    claim = rb.Claim(name="claim", says="So it is.", statements=(statement,), because=BECAUSE)
    with pytest.raises(ValidationError, match=message):
        small_report(claims=(claim,))
