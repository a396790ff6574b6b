from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

import rectbench as rb
from rectbench.statistics.intervals import (
    Interval,
    count_interval,
    geometric_interval,
    margins,
    mean_interval,
    nested_means,
)
from tests.statistics.benches import Bench, labelled, unit_values

UNITS = (3, 4, 6, 8, 12)
PAIR_SPREADS = pytest.mark.parametrize("pair", [3.0, 1.0, 0.3, 0.0], ids=lambda s: f"pair-spread-{s:g}-seeds")


def coverage(bench: Bench) -> float:
    """In which share of benches the 95 % interval over units holds the truth, which is zero."""
    values = unit_values(bench.leaves(np.random.default_rng(5)))[:, 0]
    return float(np.mean(np.abs(values.mean(axis=-1)) <= margins(values)))


@PAIR_SPREADS
@pytest.mark.parametrize("units", UNITS)
def test_95_percent_intervals_cover_95_percent_of_synthetic_benches(units: int, pair: float) -> None:
    assert 0.93 <= coverage(Bench.balanced(units, pair, 0.5 * pair, seed=1.0)) <= 0.97


@PAIR_SPREADS
@pytest.mark.parametrize("units", UNITS)
def test_they_cover_as_much_where_scenes_have_unequally_many_seeds(units: int, pair: float) -> None:
    seeds = np.random.default_rng(units).integers(1, 9, (units, 2))
    assert 0.93 <= coverage(Bench(pair, 0.5 * pair, 1.0, seeds)) <= 0.97


def test_an_interval_of_labelled_numbers_is_that_of_the_simulated_benches() -> None:
    leaves = Bench(0.5, 0.5, 1.0, np.array([[1, 4], [2, 2], [5, 1]])).leaves(np.random.default_rng(1), 20)
    for values, bench in zip(unit_values(leaves)[:, 0], leaves[:, 0], strict=True):
        found = mean_interval(nested_means(labelled(bench)).values())
        assert found.estimate == pytest.approx(values.mean())
        assert found.high - found.estimate == pytest.approx(float(margins(values)))


def test_seeds_taken_for_units_would_cover_far_less() -> None:
    leaves = Bench.balanced(4, 1.0, 0.0, seed=0.5).leaves(np.random.default_rng(2))
    pooled = leaves.reshape(len(leaves), -1)
    assert np.mean(np.abs(pooled.mean(axis=-1)) <= margins(pooled)) < 0.65


def test_an_interval_is_scipys() -> None:
    values = [0.3, 1.2, 0.9, 2.2]
    expected = stats.ttest_1samp(values, 0.0).confidence_interval(0.9)
    found = mean_interval(values, 0.9)
    assert (found.low, found.high) == pytest.approx((expected.low, expected.high))


def test_a_geometric_interval_is_that_of_the_logarithms() -> None:
    values = np.array([0.2, 3.0, 40.0, 1e5])
    logs, found = mean_interval(np.log(values)), geometric_interval(values)
    assert (found.estimate, found.low, found.high) == pytest.approx(
        (math.exp(logs.estimate), math.exp(logs.low), math.exp(logs.high))
    )
    with pytest.raises(rb.InvalidInput, match="a value is 0; expected numbers above 0"):
        geometric_interval([1.0, 0.0, 2.0])


@pytest.mark.parametrize(("successes", "trials"), [(0, 5), (3, 4), (7, 7), (12, 40)])
def test_a_count_interval_is_the_exact_one(successes: int, trials: int) -> None:
    found = count_interval(successes, trials)
    expected = stats.binomtest(successes, trials).proportion_ci(0.95, "exact")
    assert (found.low, found.high) == pytest.approx((expected.low, expected.high))
    assert (found.estimate, found.units) == (successes / trials, trials)


def test_a_count_beyond_its_trials_is_refused() -> None:
    with pytest.raises(rb.InvalidInput, match="successes are 5 of 4; expected a number from 0 to 4"):
        count_interval(5, 4)


@pytest.mark.parametrize("values", [[], [1.0], [1.0, 2.0], [1.0, 2.0, math.nan]])
def test_too_few_units_have_words_in_the_place_of_an_interval(values: list[float]) -> None:
    found = mean_interval(values)
    assert math.isnan(found.low)
    assert math.isnan(found.high)
    count = sum(not math.isnan(value) for value in values)
    assert found.why_none() == f"{count} unit{'s' if count != 1 else ''}: too few for an interval"


def test_an_infinite_unit_leaves_no_interval_and_no_warning(recwarn: pytest.WarningsRecorder) -> None:
    assert mean_interval([1.0, 2.0, math.inf]).why_none() == "unbounded"
    assert geometric_interval([1.0, 2.0, math.inf]).why_none() == "unbounded"
    assert geometric_interval([1e-300, 1e300, 1.0]).high == math.inf
    assert not recwarn.list


def test_an_interval_that_is_there_needs_no_words() -> None:
    assert Interval(1.0, 0.5, 1.5, 3).why_none() == ""


def test_a_unit_is_the_mean_of_its_scenes_and_not_of_its_seeds() -> None:
    numbers = {("t265", "street", seed): 1.0 for seed in range(9)} | {("t265", "room", 0): 3.0}
    assert nested_means(numbers) == {"t265": 2.0}


def test_what_was_not_measured_is_left_out_of_a_unit() -> None:
    assert nested_means({("a", 0): 1.0, ("a", 1): math.nan, ("b", 0): math.nan}) == {"a": 1.0}
    assert nested_means({}) == {}
