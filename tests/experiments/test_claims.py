"""A claim is judged by the interval of what was measured, never by a lucky mean."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.stats import binomtest, ttest_1samp

import rectbench as rb
from rectbench.runs.judging import judged_claims
from rectbench.runs.rows import read_rows
from tests.experiments.fakes import small_report

BECAUSE = {verdict: verdict.upper() for verdict in ("held", "not held", "depends", "not measured")}


def rows(method: str, values: Any, **fields: Any) -> list[dict[str, Any]]:
    """Rows of one method: values [rigs, seeds] of the column `x`; None where there is none."""
    return [
        {
            "report": "small",
            "scene": "scene",
            "rig": f"rig{rig}",
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
        for rig, of_seeds in enumerate(np.asarray(values, dtype=float).tolist())
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


def value(**fields: Any) -> rb.Statement:
    return rb.Statement(**{"label": "x", "metric": "x", "method": "ours", **fields})


@pytest.mark.parametrize(
    ("bounds", "verdict"),
    [
        ({"below": 0.6}, "held"),
        ({"above": 0.4, "below": 0.6}, "held"),
        ({"below": 0.4}, "not held"),
        ({"above": 0.6}, "not held"),
        ({"below": 0.5}, "undecided"),
    ],
)
def test_the_whole_interval_must_lie_within_the_bounds(bounds: dict[str, float], verdict: str) -> None:
    rng = np.random.default_rng(1)
    theirs = rng.uniform(1, 100, (4, 5))
    ours = theirs * 0.5 * np.exp(rng.normal(0, 0.05, (4, 5)))
    judged = judge(rows("ours", ours) + rows("theirs", theirs), ratio(**bounds))
    assert judged.verdict == verdict
    (test,) = judged.tests
    assert test.interval.estimate == pytest.approx(math.exp(np.log(ours / theirs).mean()))
    assert test.interval.low < test.interval.estimate < test.interval.high
    assert (len(test.by_rig), test.failed) == (4, 0)


def test_the_interval_is_students_over_the_means_of_rigs() -> None:
    values = np.random.default_rng(2).gamma(2.0, size=(7, 3))
    test = judge(rows("ours", values), value(below=100.0)).tests[0]
    found = ttest_1samp(values.mean(axis=1), 0.0).confidence_interval(0.95)
    assert (test.interval.low, test.interval.high) == pytest.approx((found.low, found.high))


def test_seeds_of_one_rig_are_no_independent_rigs() -> None:
    few = np.random.default_rng(2).gamma(2.0, size=(5, 1))
    many = np.repeat(few, 20, axis=1)  # the same rigs, each seed alike
    alone, repeated = (judge(rows("ours", each), value(below=100.0)).tests[0] for each in (few, many))
    assert repeated.interval.high == pytest.approx(alone.interval.high)


def test_scenes_of_one_rig_weigh_alike_however_many_seeds_they_have() -> None:
    table = rows("ours", [[1.0]]) + rows("ours", [[4.0] * 9], scene="another")
    assert judge(table, value(below=100.0)).tests[0].by_rig == {"rig0": 2.5}


def test_two_lenses_decide_nothing_however_many_seeds_they_have() -> None:
    judged = judge(rows("ours", np.full((2, 50), 0.5)), value(below=0.6))
    assert judged.verdict == "undecided"
    assert judged.because == "2 rigs: too few for an interval"
    assert judge(rows("ours", np.full((3, 50), 0.5)), value(below=0.6)).verdict == "held"


def test_lenses_that_differ_leave_a_claim_undecided_that_each_seed_would_decide() -> None:
    ours = np.repeat([[0.46], [1.19], [0.5], [1.1]], 5, axis=1)
    test = judge(rows("ours", ours) + rows("theirs", np.ones((4, 5))), ratio(below=0.8)).tests[0]
    assert test.verdict == "undecided"
    assert (test.rigs_held, test.by_rig["rig1"]) == (2, pytest.approx(1.19))


def test_pairing_takes_the_rigs_own_size_out_of_a_ratio() -> None:
    sizes = np.array([[1.0, 1000.0], [1e-3, 1.0], [5.0, 7.0]])
    test = judge(rows("ours", 0.7 * sizes) + rows("theirs", sizes), ratio(below=0.71)).tests[0]
    assert (test.interval.low, test.interval.high) == pytest.approx((0.7, 0.7))
    assert test.rigs_held == 3


HALVES = rows("ours", np.full((3, 2), 0.5)) + rows("theirs", np.ones((3, 2)))


def test_ways_to_measure_one_clause_that_disagree_make_it_depend() -> None:
    assert judge(HALVES, ratio(below=0.6), ratio(above=0.6)).verdict == "depends"
    assert judge(HALVES, ratio(above=0.6), ratio(above=0.7)).verdict == "not held"


def test_a_clause_that_some_way_refutes_and_none_holds_is_not_held() -> None:
    ours = [[0.9], [1.1], [1.0]]
    table = rows("ours", ours) + rows("theirs", np.ones((3, 1)))
    cannot_say, refuted = ratio(below=1.0), ratio(below=0.5)
    assert judge(table, cannot_say).verdict == "undecided"
    assert judge(table, cannot_say, refuted).verdict == "not held"
    assert judge(table, cannot_say, ratio(below=2.0)).verdict == "undecided"


def test_a_way_that_cannot_say_leaves_the_clause_undecided_not_depending() -> None:
    elsewhere = ratio(below=0.6, metric="y")  # a column that the run does not have
    assert judge(HALVES, ratio(below=0.6), elsewhere).verdict == "undecided"


def test_a_claim_holds_only_where_each_of_its_clauses_does() -> None:
    less, much_less = ratio(below=0.6, clause="less"), ratio(below=0.1, clause="much less")
    either_way = [ratio(below=0.6, clause="either"), ratio(above=0.6, clause="either")]
    assert judge(HALVES, less, less).verdict == "held"
    assert judge(HALVES, less, *either_way).verdict == "depends"
    judged = judge(HALVES, less, *either_way, much_less)
    assert judged.verdict == "not held"
    assert judged.clauses == {"less": "held", "either": "depends", "much less": "not held"}


def test_a_failed_cell_keeps_a_statement_from_being_held() -> None:
    table = [dict(row) for row in HALVES]
    for row in (table[0], table[1]):  # all of a rig
        row.update(status="timeout", x=math.nan)
    judged = judge(table, ratio(below=0.6))
    assert judged.verdict == "undecided"
    assert (judged.tests[0].failed, judged.tests[0].absent) == (2, ())


def test_a_rig_that_a_method_does_not_show_enough_of_is_named_and_no_failure() -> None:
    ours, theirs = np.full((4, 1), 0.5), [[1.0], [1.0], [1.0], [math.nan]]
    test = judge(rows("ours", ours) + rows("theirs", theirs), ratio(below=0.6)).tests[0]
    assert (test.verdict, test.failed, test.absent) == ("held", 0, ("rig3",))


def test_a_rig_that_a_method_does_not_serve_is_named_and_no_failure() -> None:
    table = rows("ours", np.full((4, 1), 0.5)) + rows("theirs", np.ones((4, 1)))
    table[-1].update(status="unsupported", x=math.nan)
    test = judge(table, ratio(below=0.6)).tests[0]
    assert (test.verdict, test.failed, test.absent) == ("held", 0, ("rig3",))


def test_what_stands_beside_a_claim_does_not_judge_it() -> None:
    judged = judge(HALVES, ratio(below=0.6), ratio(above=0.6, judges=False))
    assert (judged.verdict, [test.verdict for test in judged.tests]) == ("held", ["held", "not held"])
    with pytest.raises(ValidationError, match="no statement that judges it"):
        judge(HALVES, ratio(below=0.6, judges=False))


def test_what_was_not_measured_is_neither_held_nor_not() -> None:
    judged = judge([], ratio(below=0.6))
    assert judged.verdict == "not measured"
    assert math.isnan(judged.tests[0].interval.estimate)
    assert judge(rows("ours", [[1.0]]), ratio(below=0.6)).verdict == "not measured"


def count(**fields: Any) -> rb.Statement:
    given = {"label": "least", "metric": "x", "method": "ours", "rivals": ("theirs",), "measure": "count"}
    return rb.Statement(**{**given, "above": 3, "of": 4, **fields})


def least_on(rigs: int, of: int) -> list[dict[str, Any]]:
    ours = np.where(np.arange(of)[:, None] < rigs, 1.0, 3.0).repeat(2, axis=1)
    return rows("ours", ours) + rows("theirs", np.full((of, 2), 2.0))


@pytest.mark.parametrize(
    ("rigs", "of", "verdict"),
    [
        (4, 4, "held"),
        (3, 4, "held"),
        (2, 4, "undecided"),
        (0, 4, "not held"),
        (9, 12, "held"),
        (8, 12, "undecided"),
        (5, 12, "not held"),
    ],
)
def test_three_of_four_can_hold_at_three_of_four_and_fail(rigs: int, of: int, verdict: str) -> None:
    test = judge(least_on(rigs, of), count()).tests[0]
    assert test.verdict == verdict
    assert test.rigs_held == rigs
    assert test.interval.estimate == rigs / of


def test_a_count_is_refuted_where_the_exact_test_says_so() -> None:
    for rigs in range(13):
        p = binomtest(rigs, 12, 0.75, alternative="less").pvalue
        verdict = judge(least_on(rigs, 12), count()).tests[0].verdict
        assert (verdict == "not held") == (p < 0.05)


def test_a_count_tells_how_probable_it_is_by_chance() -> None:
    test = judge(least_on(9, 12), count()).tests[0]
    p = binomtest(9, 12, 1 / 2, alternative="greater").pvalue
    assert test.remark == f"as many by chance: p = {p:.2g}"


def test_a_count_of_four_is_not_held_on_fewer() -> None:
    assert judge(least_on(3, 3), count()).verdict == "undecided"
    assert judge(least_on(3, 3), count(above=4)).verdict == "undecided"
    assert judge(least_on(2, 3), count(above=4)).verdict == "not held"  # one exception refutes "all"


def test_the_least_has_the_least_mean_of_the_rig_and_strangers_do_not_count() -> None:
    ours = [[1.0, 1.0], [1.9, 2.2], [3.0, 3.0]]
    stranger = rows("stranger", np.zeros((3, 2)))
    test = judge(rows("ours", ours) + rows("theirs", np.full((3, 2), 2.0)) + stranger, count()).tests[0]
    assert test.rigs_held == 1


def test_ties_are_ties() -> None:
    alike = rows("ours", np.ones((4, 2))) + rows("theirs", np.full((4, 2), 1 + 1e-9))
    assert judge(alike, count()).tests[0].rigs_held == 0


NONE, ONES = np.full((4, 1), math.nan), np.ones((4, 1))


def test_a_rival_that_does_not_show_that_much_is_not_less_and_one_that_alone_does_is() -> None:
    two = count(rivals=("theirs", "others"))
    table = rows("ours", ONES) + rows("theirs", NONE) + rows("others", 2 * ONES)
    assert judge(table, two).tests[0].rigs_held == 4
    assert judge(rows("ours", NONE) + rows("theirs", ONES), count()).tests[0].rigs_held == 0


def test_a_rig_on_which_no_rival_has_a_number_is_no_win() -> None:
    nowhere = judge(rows("ours", ONES) + rows("theirs", NONE), count()).tests[0]
    assert (nowhere.verdict, nowhere.rigs_held) == ("undecided", 0)
    assert nowhere.absent == ("rig0", "rig1", "rig2", "rig3")
    theirs = [[2.0], [2.0], [math.nan], [0.5]]
    some = judge(rows("ours", ONES) + rows("theirs", theirs), count()).tests[0]
    assert (some.rigs_held, some.interval.units, some.absent) == (2, 3, ("rig2",))


def test_what_is_without_bound_is_never_the_least() -> None:
    endless = rows("ours", np.full((4, 1), math.inf))
    assert judge(endless + rows("theirs", np.ones((4, 1))), count()).tests[0].rigs_held == 0


def test_every_variant_of_a_rival_counts() -> None:
    variant = rows("theirs", np.full((4, 1), 0.5), options='{"focal":"balance"}')
    table = rows("ours", np.ones((4, 1))) + rows("theirs", np.full((4, 1), 2.0))
    assert judge(table, count()).tests[0].rigs_held == 4
    assert judge(table + variant, count()).tests[0].rigs_held == 0


def test_nothing_is_least_without_the_rivals() -> None:
    assert judge(rows("ours", np.ones((4, 1))), count()).verdict == "not measured"


def test_a_variant_is_compared_with_by_its_options() -> None:
    theirs = rows("theirs", np.full((3, 1), 4.0), options='{"focal":"balance"}')
    table = rows("ours", np.ones((3, 1))) + rows("theirs", np.full((3, 1), 2.0)) + theirs
    test = judge(table, ratio(below=1.0, against_options={"focal": "balance"})).tests[0]
    assert test.interval.estimate == pytest.approx(0.25)
    with pytest.raises(rb.InvalidInput, match="several sets of options of theirs"):
        judge(table, ratio(below=1.0))


def test_a_part_of_a_whole_is_judged_by_its_share() -> None:
    table = [{**row, "whole": 4.0 * (1 + row["seed"])} for row in rows("ours", [[1.0, 2.0]] * 3)]
    test = judge(table, value(over="whole", above=0.2, below=0.3)).tests[0]
    assert (test.verdict, test.interval.estimate) == ("held", 0.25)


def test_a_share_compares_variants_with_the_default_of_another_group() -> None:
    default = rows("ours", np.ones((3, 2)), group="fisheye")
    starts = [
        row
        for draw, factor in enumerate((1.0, 1.005, 30.0, 1.0))
        for row in rows(
            "ours",
            np.full((3, 2), factor),
            group="starts",
            options=f'{{"draw":{draw},"start":"random"}}',
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
    assert test.by_rig == pytest.approx(dict.fromkeys(("rig0", "rig1", "rig2"), 0.75))
    assert test.verdict == "held"


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({}, "neither above nor below"),
        ({"above": 2.0, "below": 1.0}, "expected a range"),
        ({"above": math.nan}, "expected a range"),
        ({"measure": "ratio", "below": 1.0}, "`against` is for ratio and share"),
        ({"measure": "count", "above": 1.0, "of": 1}, "`rivals` is for count"),
        ({"measure": "count", "above": 1.0, "rivals": ("theirs",)}, "`of` is for count"),
        ({"measure": "count", "above": 5.0, "of": 4, "rivals": ("theirs",)}, "true of 5.0 of 4 rigs"),
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
