from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import combinations

import numpy as np
import pytest
from scipy import stats

from rectbench.statistics.paired import better, holm, p_values
from rectbench.statistics.power import power, resolved
from rectbench.statistics.ranking import rank, signed_rank_caveat
from rectbench.types import FloatArray
from tests.statistics.benches import Bench, unit_values

UNITS = (3, 4, 6, 8, 12)


def logs(bench: Bench, shifts: list[float], seed: int = 0) -> FloatArray:
    """[benches, methods, units]: a method's logarithms, what is alike for all methods of a unit included."""
    rng = np.random.default_rng(seed)
    values = unit_values(bench.leaves(rng, methods=len(shifts)))
    return values + rng.normal(0, 3.0, (len(values), 1, values.shape[-1])) + np.array(shifts)[:, None]


def as_values(rows: FloatArray) -> dict[str, dict[int, float]]:
    """[methods, units] logarithms as `rank` takes them; methods are called a, b, ..."""
    return {chr(97 + i): dict(enumerate(np.exp(row).tolist())) for i, row in enumerate(rows)}


@pytest.mark.parametrize("pair", [3.0, 1.0, 0.3], ids=lambda s: f"pair-spread-{s:g}-seeds")
@pytest.mark.parametrize("units", UNITS)
def test_methods_that_are_alike_are_told_apart_in_5_percent_of_benches(units: int, pair: float) -> None:
    told = better(logs(Bench.balanced(units, pair, 0.5 * pair, seed=1.0), [0.0] * 5))
    assert np.mean(told.any(axis=(-1, -2))) <= 0.062


def test_methods_that_are_alike_stay_so_beside_others_that_are_not() -> None:
    alike = better(logs(Bench.balanced(6, 0.5, 0.2, seed=0.5), [0.0, 0.0, 0.0, 9.0, -9.0]))[:, :3, :3]
    assert np.mean(alike.any(axis=(-1, -2))) <= 0.062


@pytest.mark.parametrize("units", UNITS)
def test_a_known_difference_is_told_as_often_as_predicted(units: int) -> None:
    bench, difference = Bench.balanced(units, 0.5, 0.3, seed=0.4), 0.8
    spread = math.sqrt(2 * (0.5**2 + 0.3**2 / 2 + 0.4**2 / 6))
    told = better(logs(bench, [0.0, difference]))
    assert np.mean(told[:, 0, 1]) == pytest.approx(power(difference, spread, units), abs=0.035)
    assert np.mean(told[:, 1, 0]) <= 0.01


@pytest.mark.parametrize("units", UNITS)
def test_what_a_design_resolves_is_told_in_four_benches_of_five(units: int) -> None:
    bench, spread = Bench.balanced(units, 0.5, 0.0, seed=0.0), 0.5 * math.sqrt(2)
    difference = resolved(spread, units, tests=6)
    told = better(logs(bench, [0.0, difference, difference, difference]))[:, 0, 1:]
    # Holm's later steps tell a little more than the first, by which it is predicted.
    assert 0.77 <= np.mean(told) <= 0.93


def test_power_is_that_of_the_textbook() -> None:
    # Cohen, Statistical Power Analysis, 1988, example 2.5 on: d = 0.5, n = 34, two-sided 5 %.
    assert power(0.5, 1.0, 34) == pytest.approx(0.808, abs=0.001)
    assert power(0.0, 1.0, 34) == 0.0
    assert power(0.5, 1.0, 1) == 0.0
    assert power(0.5, 0.0, 4) == 1.0
    assert resolved(0.0, 4) == 0.0
    assert math.isnan(resolved(1.0, 1))


def test_the_tests_are_scipys() -> None:
    numbers = np.random.default_rng(0).normal(0.3, 1.0, (4, 7))
    expected = [stats.ttest_1samp(row, 0.0).pvalue for row in numbers]
    assert p_values(numbers) == pytest.approx(expected)


def test_holm_corrects_step_by_step() -> None:
    assert holm(np.array([0.01, 0.04, 0.03, 0.5])) == pytest.approx([0.04, 0.09, 0.09, 0.5])


def test_a_rank_reaches_from_those_told_to_be_better_to_those_told_to_be_worse() -> None:
    rows = logs(Bench.balanced(8, 0.05, 0.0, seed=0.0), [0.0, 0.001, 2.0, 4.0], seed=1)[0]
    ranking = rank(as_values(rows))
    assert ranking.ranks == {"a": (1, 2), "b": (1, 2), "c": (3, 3), "d": (4, 4)}
    assert set(ranking.order[:2]) == {"a", "b"}
    assert ranking.order[2:] == ("c", "d")
    assert (ranking.units, ranking.reason) == (8, "")


def test_the_resolution_is_that_of_the_median_pair() -> None:
    rows = logs(Bench.balanced(6, 0.2, 0.0, seed=0.0), [0.0, 0.0, 0.0])[0]
    spreads = sorted(np.std(rows[i] - rows[j], ddof=1) for i, j in combinations(range(3), 2))
    assert rank(as_values(rows)).resolves == pytest.approx(math.exp(resolved(spreads[1], 6, tests=3)))


def test_identical_values_are_a_tie() -> None:
    same = {unit: 0.1 + unit for unit in range(12)}
    assert rank({"a": same, "b": dict(same)}).ranks == {"a": (1, 2), "b": (1, 2)}
    assert rank({"a": same, "b": dict(same)}).resolves == 1.0


@pytest.mark.parametrize("noise", [1e-9, 9e-7])
def test_rounding_tells_no_methods_apart(noise: float) -> None:
    same = {unit: 0.1 + unit for unit in range(12)}
    rounded = {unit: value * (1 + noise) for unit, value in same.items()}
    assert rank({"a": same, "b": rounded}).ranks == {"a": (1, 2), "b": (1, 2)}


def test_what_is_below_the_floor_is_a_tie_however_often_it_is_smaller() -> None:
    exact = dict.fromkeys(range(12), 1e-13)
    also_exact = dict.fromkeys(range(12), 5e-13)
    zero = dict.fromkeys(range(12), 0.0)
    far = dict.fromkeys(range(12), 1.0)
    ranking = rank({"a": exact, "b": also_exact, "c": zero, "d": far})
    assert ranking.ranks == {"a": (1, 3), "b": (1, 3), "c": (1, 3), "d": (4, 4)}
    assert rank({"a": far, "b": dict.fromkeys(range(12), 2.0)}, floor=3.0).ranks["a"] == (1, 2)


def test_a_difference_that_is_the_same_everywhere_is_told() -> None:
    ranking = rank({"a": {0: 1.0, 1: 2.0, 2: 5.0}, "b": {0: 1.01, 1: 2.02, 2: 5.05}})
    assert ranking.ranks == {"a": (1, 1), "b": (2, 2)}


def test_a_method_that_lacks_a_unit_follows_without_a_rank() -> None:
    ranking = rank(
        {
            "narrow": {0: 0.1, 1: 0.1, 2: math.nan, 3: 0.1},
            "narrower": {0: 0.01, 1: 0.01},
            "failed": {},
            "unbounded": {0: 0.2, 1: 0.2, 2: math.inf, 3: 0.2},
            "good": {0: 1.0, 1: 1.1, 2: 1.2, 3: 1.3},
            "worse": {0: 9.0, 1: 9.4, 2: 9.2, 3: 8.8},
        }
    )
    assert ranking.order == ("good", "worse", "narrow", "unbounded", "narrower", "failed")
    assert ranking.ranks == {"good": (1, 1), "worse": (2, 2)}
    assert ranking.units == 4


def test_too_few_units_have_words_in_the_place_of_ranks() -> None:
    two = rank({"a": {0: 1.0, 1: 1.0}, "b": {0: 2.0, 1: 2.0}}, unit="rig")
    assert (two.order, two.ranks, two.resolves, two.units) == (("a", "b"), {}, None, 2)
    assert two.reason == "2 rigs: too few to tell methods apart"
    one = rank({"a": {0: 1.0}, "b": {0: 2.0}}, unit="rig")
    assert one.reason == "1 rig: too few to tell methods apart"
    assert rank({}).reason == "0 units: too few to tell methods apart"


@pytest.mark.parametrize("units", [3, 5, 6])
def test_below_six_units_no_signed_rank_test_reaches_5_percent(units: int) -> None:
    least = stats.wilcoxon(np.arange(1.0, units + 1), method="exact").pvalue
    assert (least > 0.05) == bool(signed_rank_caveat(units))


def test_where_each_method_lacks_a_unit_none_is_ranked() -> None:
    ranking = rank({"a": {0: 1.0, 1: 1.0, 2: 1.0}, "b": {1: 1.0, 2: 1.0, 3: 1.0}}, unit="rig")
    assert (ranking.ranks, ranking.reason) == ({}, "no method has a number on each rig")


def test_a_method_alone_has_no_rank() -> None:
    ranking = rank({"a": {0: 1.0, 1: 2.0, 2: 3.0}}, unit="rig")
    assert (ranking.order, ranking.ranks, ranking.resolves) == (("a",), {}, None)
    assert ranking.reason == "only a has a number on each rig: none to compare it with"


EASY, HARD = tuple(range(11)), 11
"""Units that all serve, and one that not all do."""


def level(height: float, units: Iterable[int] = (*EASY, HARD)) -> dict[int, float]:
    """A method's values, uneven by 1 % or so."""
    return {u: height * (1 + 0.01 * math.sin(7 * u + height)) for u in units}


@pytest.mark.parametrize("rivals", [2, 3, 5])
def test_a_method_that_alone_serves_a_unit_is_not_first_for_that(rivals: int) -> None:
    others = {f"good{i}": level(1 + i, EASY) for i in range(rivals)}
    ranking = rank({"bad": level(99), **others})
    assert ranking.order == (*others, "bad")
    assert ranking.ranks["good0"][0] == 1
    assert (ranking.units, ranking.of, ranking.behind) == (11, 12, ())
    assert ranking.ranks["bad"] == (1, rivals + 1)  # who fails where it does not is not told to be better


def test_the_others_are_told_apart_as_if_the_unit_that_one_alone_serves_were_none() -> None:
    others = {"a": level(1, EASY), "b": level(2, EASY)}
    assert rank({"a": others["a"], "b": others["b"], "odd": {HARD: 0.01}}).ranks == rank(others).ranks
    odd = {"odd": {HARD: 0.01}, "odder": {HARD: 0.02}}
    assert rank({**odd, **others}).ranks == rank(others).ranks == {"a": (1, 1), "b": (2, 2)}


@pytest.mark.parametrize("height", [0.01, 1.5, 100.0])
def test_no_method_wins_by_failing_on_the_hardest_unit(height: float) -> None:
    others = {"a": level(1.0), "b": level(2.0)}
    fails = rank({**others, "c": level(height, EASY)})
    assert fails.behind == ("c",)
    assert fails.order == ("a", "b", "c")
    assert fails.ranks == {"a": (1, 1), "b": (2, 2)}


@pytest.mark.parametrize("height", [0.5, 2.0])
def test_of_two_methods_neither_is_ranked_where_one_fails_on_a_unit(height: float) -> None:
    two = rank({"a": level(1.0), "b": level(height, EASY)})
    assert (two.order, two.behind, two.ranks) == (("a", "b"), ("b",), {})
    assert two.reason == "only a has a number on each unit: none to compare it with"


def test_who_fails_on_a_unit_that_is_left_out_is_not_told_to_be_better_than_who_does_not() -> None:
    ranking = rank({"a": level(2.0), "b": level(1.0, EASY), "c": level(3.0, EASY)})
    assert ranking.order == ("b", "a", "c")
    assert ranking.ranks == {"b": (1, 2), "a": (1, 2), "c": (3, 3)}


def test_a_method_that_serves_few_units_is_ranked_with_none() -> None:
    few = rank({"wide": level(1.0), "narrow": level(0.1, EASY[:4])}, unit="rig")
    assert (few.order, few.behind, few.ranks) == (("wide", "narrow"), ("narrow",), {})
    assert few.reason == "only wide has a number on each rig: none to compare it with"
    several = {"narrow": level(0.1, EASY[:4]), "narrower": level(0.2, EASY[:4])}
    assert rank({"wide": level(1.0), **several}).ranks == {}


def test_methods_on_disjoint_units_are_not_compared() -> None:
    apart = rank({"a": level(1.0, EASY[:5]), "b": level(2.0, EASY[5:])}, unit="rig")
    assert (apart.ranks, apart.behind) == ({}, ("b", "a"))
    assert apart.reason == "no method has a number on each rig"


def test_methods_that_each_fail_on_another_unit_are_treated_alike() -> None:
    both = {"b": level(2.0, (*EASY[1:], HARD)), "c": level(3.0, (EASY[0], *EASY[2:], HARD))}
    fails = rank({"a": level(1.0), "d": level(4.0), **both})
    assert (fails.units, set(fails.behind)) == (12, {"b", "c"})
    assert fails.ranks == {"a": (1, 1), "d": (2, 2)}


def test_of_units_that_few_serve_no_two_methods_are_favoured() -> None:
    pairs = {"a": (*EASY, 11), "b": (*EASY, 11), "c": (*EASY, 12), "d": (*EASY, 12), "e": EASY}
    ranking = rank({name: level(1.0 + i, units) for i, (name, units) in enumerate(pairs.items())})
    assert (ranking.units, ranking.of, ranking.behind) == (11, 13, ())
    assert ranking.ranks["e"] == (5, 5)
    assert ranking.ranks["a"][0] == 1
