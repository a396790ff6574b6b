"""A claim is judged by the interval of what was measured, never by a lucky mean."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

import rectbench as rb
from rectbench.bench.claims import judged_claims

BECAUSE = {verdict: verdict.upper() for verdict in ("held", "not held", "depends", "not measured")}


def rows(method: str, values: Any, **fields: Any) -> list[dict[str, Any]]:
    """Rows of one method: values [pairs, seeds] of the column `x`."""
    return [
        {
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
    (judged,) = judged_claims([claim.model_dump(mode="json")], table)
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


def test_the_interval_is_that_of_an_independent_bootstrap() -> None:
    from scipy.stats import bootstrap

    values = np.random.default_rng(2).gamma(2.0, size=(4, 6))
    judged = judge(rows("ours", values), rb.Statement(label="mean", metric="x", method="ours", below=100.0))
    found = bootstrap((values.ravel(),), np.mean, method="percentile", rng=np.random.default_rng(5))
    test = judged.tests[0]
    assert test.low == pytest.approx(found.confidence_interval.low, rel=0.03)
    assert test.high == pytest.approx(found.confidence_interval.high, rel=0.03)


def test_pairing_takes_the_pairs_own_size_out_of_a_ratio() -> None:
    sizes = np.array([[1.0, 1000.0], [1e-3, 1.0]])
    test = judge(rows("ours", 0.7 * sizes) + rows("theirs", sizes), ratio(below=0.71)).tests[0]
    assert (test.low, test.high) == pytest.approx((0.7, 0.7))
    assert test.pairs_held == 2


def test_statements_that_disagree_make_it_depend() -> None:
    table = rows("ours", [[0.5, 0.5]]) + rows("theirs", [[1.0, 1.0]])
    assert judge(table, ratio(below=0.6), ratio(above=0.6)).verdict == "depends"
    assert judge(table, ratio(above=0.6), ratio(above=0.7)).verdict == "not held"


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


def test_wins_count_the_pairs_where_the_mean_over_seeds_is_least() -> None:
    ours = [[1.0, 1.0], [1.0, 9.0], [3.0, 3.0]]
    theirs = [[2.0, 2.0], [2.0, 2.0], [2.0, 2.0]]
    wins = rb.Statement(label="wins", metric="x", method="ours", measure="wins", above=1)
    test = judge(rows("ours", ours) + rows("theirs", theirs), wins).tests[0]
    assert test.mean == 1.0
    assert (test.low, test.high) == (1.0, 2.0)  # the second pair is won if only its first seed is drawn
    assert test.verdict == "held"
    assert test.pairs_held == 1


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


def test_a_statement_without_bounds_states_nothing() -> None:
    with pytest.raises(ValidationError, match="below"):
        rb.Statement(label="x", metric="x", method="ours")
