"""The floor is below every method on the view it is of, and excess is counted from there."""

import numpy as np
import pytest

import rectbench as rb
from rectbench.metrics.analyses.floor import ExcessOverFloor, distortion_at, floor_of
from rectbench.metrics.distortion import distortion_of
from rectbench.metrics.scoring import digests_of
from rectbench.plugins.metric import Case
from rectbench.scored import Delivered, ScoredView
from tests.rigs_for_tests import rig


class Lenses:
    """A pair of which nothing is known but its rig."""

    def __init__(self, pair: rb.Rig) -> None:
        self.rig, self.scored_view = pair, ScoredView.of(pair)


def excess(pair: rb.Rig, rect: rb.Rectification) -> dict[str, float]:
    return ExcessOverFloor().compute(Case(rect, Lenses(pair)))  # type: ignore[arg-type]


@pytest.mark.parametrize("model", ["unified", "equidistant"])
def test_no_method_is_below_the_floor(model: str) -> None:
    pair = rig(model, size=(320, 240))
    view = ScoredView.of(pair)
    for method in ("abraham", "local-homography", "polar-optimal", "log-polar"):
        delivered = Delivered.of(rb.rectify(pair, method), view)
        assert floor_of(pair).log_distortion < delivered.log_distortion(0.95)
        assert floor_of(pair).distortion < distortion_at(delivered)


@pytest.mark.parametrize("objective", ["log", "L"])
def test_the_quick_search_ends_where_the_thorough_one_does(objective: str) -> None:
    pair = rig("double-sphere", size=(320, 240))
    view = ScoredView.of(pair)
    delivered = Delivered.of(rb.rectify(pair, "optimal", objective=objective), view)
    floor, thorough = (
        (floor_of(pair).log_distortion, delivered.log_distortion(0.95))
        if objective == "log"
        else (floor_of(pair).distortion, distortion_at(delivered))
    )
    # The thorough one is of all the view: on its 95 % it cannot be below, and is hardly above.
    assert floor < 1.003 * thorough < 1.1 * floor


def test_excess_is_the_share_above_the_floor_of_both_measures() -> None:
    pair = rig("equisolid", size=(320, 240))
    rect = rb.rectify(pair, "abraham")
    found, floor, delivered = excess(pair, rect), floor_of(pair), Delivered.of(rect, ScoredView.of(pair))
    expected = delivered.log_distortion(0.95) / floor.log_distortion - 1
    assert found["excess_over_floor"] == pytest.approx(expected)
    L = float(distortion_of(delivered.within(0.95), "rescaled"))
    assert found["excess_over_floor_distortion"] == pytest.approx(L / floor.distortion - 1)
    # One scale, whatever it is, changes neither.
    again = excess(pair, rect.scaled(0.7))
    for key, value in found.items():
        assert again[key] == pytest.approx(value, rel=0.01)


def test_who_does_not_show_the_view_has_no_excess() -> None:
    pair = rb.load_rig("t265").scaled(0.25)
    found = excess(pair, rb.rectify(pair, "conventional"))
    assert set(found) == {"floor_log_distortion"}


def test_over_no_floor_nothing_is_a_multiple() -> None:
    lens = rb.Camera("pinhole", (320, 240), {"fx": 250.0, "fy": 250.0, "cx": 159.5, "cy": 119.5})
    pair = rb.Rig(lens, lens, np.eye(3), np.array([-0.1, 0, 0]), name="parallel")
    found = excess(pair, rb.rectify(pair, "conventional"))
    assert set(found) == {"floor_log_distortion"}
    assert found["floor_log_distortion"] < 1e-3


def test_the_source_of_the_floors_method_is_part_of_a_cells_key() -> None:
    assert "method optimal" in digests_of(["geometry"])
    assert "method optimal" not in digests_of(["timing"])
