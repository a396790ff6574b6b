from __future__ import annotations

import math

import pytest

from rectbench.plugins.catalogue import column, known
from rectbench.plugins.metric import Column
from rectbench.reporting.tables.numbers import decade, shown, three_digits


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.0123456, "0.0123"),
        (0.99951, "1.00"),
        (12.345, "12.3"),
        (-0.5, "−0.500"),
        (1234.5, "1230"),
        (123456789.0, "1.23×10⁸"),
        (9999.9, "1.00×10⁴"),
        (0.000123456, "1.23×10⁻⁴"),
    ],
)
def test_numbers_have_three_significant_digits(value: float, text: str) -> None:
    assert three_digits(value) == text


def test_rounding_noise_of_a_row_error_is_not_shown_as_a_measurement() -> None:
    assert shown(3.1e-13, column("row_error_mean_px")) == "<10⁻⁶"
    assert shown(0.0, column("row_error_mean_px")) == "<10⁻⁶"


@pytest.mark.parametrize(
    ("share", "text"),
    [(1.0, "100.0"), (0.99996, ">99.9"), (0.0, "0.0"), (0.0001, "<0.1"), (0.98765, "98.8")],
)
def test_a_share_reads_as_all_or_nothing_only_where_it_is(share: float, text: str) -> None:
    assert shown(share, column("coverage_pixels")) == text


def test_missing_and_infinite_values_have_signs_of_their_own() -> None:
    assert shown(None, Column("x", "x")) == shown(math.nan, Column("x", "x")) == "–"
    assert shown(math.inf, Column("x", "x")) == "∞"


def test_counts_are_whole() -> None:
    assert shown(10000.0, column("row_error_matches")) == "10000"
    assert shown(2.5e7, column("row_error_matches")) == "2.50×10⁷"


def test_seconds_are_shown_in_milliseconds() -> None:
    assert shown(0.0123, column("fit_s")) == "12.3"


def test_round_values_on_an_axis_are_short() -> None:
    values = (0.001, 0.01, 0.5, 20.0, 1000.0, 1e4, 2e5, 1e-5)
    assert [decade(v) for v in values] == ["0.001", "0.01", "0.5", "20", "1000", "10⁴", "2×10⁵", "10⁻⁵"]


def test_an_unknown_metric_gets_a_heading_with_its_unit() -> None:
    assert column("depth_error_mean_m").full_heading == "depth error mean [m]"


def test_every_known_metric_says_what_it_means() -> None:
    columns = known().columns
    assert all(len(column.meaning) > 10 for column in columns)
    assert len({column.key for column in columns}) == len(columns)
