"""The figure of freedoms: points by their coefficients, and three sentences that are computed."""

import pytest

from rectbench.plugins.figure import Look
from rectbench.reporting.charts.freedom import MEASURES, Freedom, Point, draw_freedom, sentences


def one_of(objective: str, scale: float) -> Freedom:
    return Freedom(
        objective,
        MEASURES[objective][1],
        {
            "separable": (Point(20, 1.3 * scale), Point(40, 1.25 * scale)),
            "full": (Point(30, 1.1 * scale), Point(100, 1.0005 * scale), Point(300, scale)),
            "per-image": (Point(130, 0.9 * scale),),
        },
        {"abraham": Point(3, 2 * scale), "local-homography": Point(9, 1.5 * scale)},
        4,
    )


def test_the_sentences_are_the_numbers() -> None:
    gained, shared, price = sentences([one_of("log", 0.1), one_of("L", 0.2)])
    assert "gain 20.0% (log distortion) and 20.0% (L)" in gained
    assert "beyond 100 coefficients nothing gains a thousandth more" in gained
    assert "cost 11.2% (log distortion) and 11.2% (L)" in shared
    assert "0.1 in log distortion and 0.2 in L, best scale, is the price" in price
    assert "50.0% (log distortion) and 50.0% (L) above it" in price


@pytest.mark.parametrize("kind", ["separable", "full", "per-image"])
def test_each_form_is_drawn_at_its_coefficients(kind: str) -> None:
    data = [one_of("log", 0.1), one_of("L", 0.2)]
    look = Look("#000000", "o", "")
    figure = draw_freedom(data, {"abraham": look, "local-homography": look})
    for ax, one in zip(figure.axes, data, strict=True):
        drawn = [[tuple(map(float, p)) for p in line.get_xydata()] for line in ax.get_lines()]
        assert [tuple(point) for point in one.free[kind]] in drawn
