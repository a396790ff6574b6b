from __future__ import annotations

import math

import numpy as np
import pytest

from rectbench.statistics.bayes import Belief, signed_rank


def values(ratio: float, spread: float = 0.0, units: int = 12) -> dict[str, dict[int, float]]:
    """Of a method, and of one whose values are so many times as large, give or take."""
    rng = np.random.default_rng(0)
    own = np.exp(rng.normal(0, 1.0, units))
    other = own * ratio * np.exp(rng.normal(0, spread, units))
    return {"a": dict(enumerate(own.tolist())), "b": dict(enumerate(other.tolist()))}


def belief(given: dict[str, dict[int, float]], equivalent: float = 0.02) -> Belief:
    (found,) = signed_rank(given, equivalent=equivalent)
    return found


def test_the_lower_method_is_better() -> None:
    found = belief(values(1.2, 0.02))
    assert found.a_better > 0.99
    mirrored = belief({"a": values(1.2, 0.02)["b"], "b": values(1.2, 0.02)["a"]})
    assert mirrored.b_better > 0.99


def test_a_difference_within_the_region_is_none_in_practice() -> None:
    assert belief(values(1.01, 0.002)).equivalent > 0.99
    assert belief(values(1.01, 0.002), equivalent=0.001).a_better > 0.99
    assert belief(values(1.0)).equivalent == 1.0


def test_probabilities_sum_to_one_and_are_unsure_where_the_units_are() -> None:
    found = belief(values(1.02, 0.2))
    assert found.a_better + found.equivalent + found.b_better == pytest.approx(1.0)
    assert max(found.a_better, found.equivalent, found.b_better) < 0.95


def test_the_same_seed_gives_the_same_probabilities() -> None:
    given = values(1.02, 0.1)
    assert signed_rank(given) == signed_rank(given)
    (first,), (other,) = signed_rank(given, seed=0), signed_rank(given, seed=1)
    assert first != other
    assert first.a_better == pytest.approx(other.a_better, abs=0.03)


def test_below_six_units_it_says_why_it_says_nothing() -> None:
    (found,) = signed_rank(values(2.0, units=5), unit="rig")
    assert found.reason == "5 rigs: below 6 no signed-rank test reaches 0.05"
    assert math.isnan(found.a_better)


def test_a_pair_is_compared_where_both_have_a_value() -> None:
    given = values(1.5)
    given["b"] |= {0: math.inf, 1: math.nan}
    given["a"] |= {0: math.inf}
    del given["a"][2]
    assert belief(given).units == 9


def test_infinite_is_worse_than_any_number() -> None:
    given = values(0.5)
    given["b"] |= dict.fromkeys(range(9), math.inf)
    assert belief(given).a_better > 0.9


def test_all_pairs_of_methods_are_told() -> None:
    given = values(1.5)
    given["c"] = given["a"]
    assert [(found.a, found.b) for found in signed_rank(given)] == [("a", "b"), ("a", "c"), ("b", "c")]
