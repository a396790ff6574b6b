from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import rectbench as rb
from rectbench.statistics.components import Level, Spread
from rectbench.statistics.design import Needs, units_needed
from rectbench.statistics.intervals import mean_interval
from rectbench.statistics.paired import better
from rectbench.statistics.power import power, resolved, variance_factors
from rectbench.types import FloatArray
from tests.statistics.benches import Bench, labelled, unit_values

BENCHES = 150


def mean_components(bench: Bench, alike: float = 0.0) -> FloatArray:
    """The means over benches of the units' variance, and of what scenes and seeds add to it.

    `alike` is the spread of what a scene and seed does alike in all units.
    """
    rng = np.random.default_rng(4)
    leaves = bench.leaves(rng, BENCHES)[:, 0]
    leaves += rng.normal(0, alike, (BENCHES, 1, *leaves.shape[2:]))
    spreads = [Spread.of(labelled(one)) for one in leaves]
    return np.mean([[s.variance, *(level.added for level in s.levels)] for s in spreads], axis=0)


@pytest.mark.parametrize("alike", [0.0, 3.0])
def test_each_level_adds_to_the_spread_of_units_what_theory_says(alike: float) -> None:
    found = mean_components(Bench.balanced(8, 1.0, 0.8, seed=0.6, scenes=4, seeds=3), alike)
    assert found == pytest.approx([1 + 0.64 / 4 + 0.36 / 12, 0.64 / 4, 0.36 / 12], rel=0.12)


def test_components_are_unbiased_where_scenes_have_unequally_many_seeds() -> None:
    seeds = np.random.default_rng(0).integers(1, 7, (8, 4))
    of_seeds = 0.6**2 * np.mean(1 / seeds) / 4
    found = mean_components(Bench(1.0, 0.8, 0.6, seeds))
    assert found == pytest.approx([1 + 0.64 / 4 + of_seeds, 0.64 / 4, of_seeds], rel=0.12)


def test_the_interval_of_a_mean_difference_is_that_of_the_units_values() -> None:
    leaves = Bench.balanced(5, 1.0, 0.8, seed=0.6).leaves(np.random.default_rng(0), 1)[0, 0]
    found, expected = Spread.of(labelled(leaves)).interval, mean_interval(unit_values(leaves))
    assert (found.estimate, found.low, found.high) == pytest.approx(
        (expected.estimate, expected.low, expected.high)
    )


def test_what_has_no_second_one_is_unknown_and_counts_to_the_level_above() -> None:
    spread = Spread.of(
        {(unit, "only", seed): unit + 0.1 * seed * unit for unit in range(4) for seed in range(3)}
    )
    scenes, seeds = spread.levels
    assert (scenes.count, seeds.count) == (1, 3)
    assert math.isnan(scenes.added)
    assert 0 < seeds.added < spread.variance


@pytest.mark.parametrize("spread", [0.05, 0.4, 3.0])
@pytest.mark.parametrize("tests", [1, 10])
def test_needed_units_are_the_least_that_have_the_power(spread: float, tests: int) -> None:
    units = units_needed(0.2, spread, tests)
    assert units is not None
    assert power(0.2, spread, units, tests) >= 0.8
    assert units == 3 or power(0.2, spread, units - 1, tests) < 0.8


def test_there_is_no_answer_that_nobody_could_measure() -> None:
    assert units_needed(1e-9, 1.0) is None
    with pytest.raises(rb.InvalidInput, match="difference is 0; expected a number above 0"):
        Needs.of(Spread(4, 0.0, 1.0, ()), 0.0)


def simulated_power(bench: Bench, difference: float) -> float:
    """In which share of benches two methods are told apart, whose paired differences spread as stated."""
    differences = unit_values(bench.leaves(np.random.default_rng(9)))[:, 0] + difference
    return float(np.mean(better(np.stack([np.zeros_like(differences), differences], axis=1))[:, 0, 1]))


BENCH, DIFFERENCE = Bench.balanced(6, 0.1, 0.4, seed=0.9, scenes=2, seeds=2), 0.45
SPREAD = Spread(6, 0.0, 0.1**2 + 0.4**2 / 2 + 0.9**2 / 4, (Level(2, 0.4**2 / 2), Level(2, 0.9**2 / 4)))


def test_as_many_units_scenes_or_seeds_as_are_needed_tell_the_difference_in_four_benches_of_five() -> None:
    needs = Needs.of(SPREAD, DIFFERENCE)
    scenes, seeds = needs.levels
    assert simulated_power(BENCH, DIFFERENCE) < 0.6
    assert needs.units is not None
    assert scenes is not None
    assert seeds is not None
    for enough in (
        Bench.balanced(needs.units, 0.1, 0.4, seed=0.9, scenes=2, seeds=2),
        Bench.balanced(6, 0.1, 0.4, seed=0.9, scenes=scenes, seeds=2),
        Bench.balanced(6, 0.1, 0.4, seed=0.9, scenes=2, seeds=seeds),
    ):
        assert 0.77 <= simulated_power(enough, DIFFERENCE) <= 0.9


def test_no_number_of_seeds_is_enough_where_scenes_differ_too_much() -> None:
    spread = replace(SPREAD, variance=0.9 + 0.3, levels=(Level(2, 0.9), Level(2, 0.3)))
    difference = resolved(math.sqrt(0.8), 6)
    scenes, seeds = Needs.of(spread, difference).levels
    assert seeds is None
    assert scenes == 3  # 1.2 * 2 / 3 = 0.8


def test_a_design_that_tells_the_difference_already_needs_no_more() -> None:
    assert Needs.of(SPREAD, 10.0) == Needs(3, (2, 2))


def test_how_well_a_variance_is_known_is_its_interval() -> None:
    values = np.random.default_rng(0).normal(0, 1, (20_000, 5))
    low, high = variance_factors(5)
    found = np.var(values, axis=1, ddof=1)
    assert np.mean((low * found <= 1) & (high * found >= 1)) == pytest.approx(0.95, abs=0.005)
