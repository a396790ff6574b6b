"""Numbers as text: three significant digits, no noise below what matters, never a bare NaN."""

from __future__ import annotations

import math
from collections.abc import Callable

from rectbench.plugins.metric import Column

MISSING = "–"
"""What stands where there is no number."""

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_FIXED_RANGE = (1e-3, 1e4)
_LONGEST_COUNT = 1e6
_FACTORS_FROM = 3.0


def shown(value: float | None, column: Column) -> str:
    """The stored `value` of a column as a reader sees it, in the column's shown unit."""
    return _spelt(value, column, three_digits)


def shown_roughly(value: float, column: Column) -> str:
    """The same with two significant digits, enough for the end of an interval."""
    return _spelt(value, column, two_digits)


def three_digits(value: float) -> str:
    """A finite value with three significant digits: 0.0123, 12.3, 1230, 1.23×10⁴."""
    if value == 0:
        return "0"
    rounded = float(f"{value:.2e}")
    if _FIXED_RANGE[0] <= abs(rounded) < _FIXED_RANGE[1]:
        decimals = max(0, 2 - math.floor(math.log10(abs(rounded))))
        return _with_minus(f"{rounded:.{decimals}f}")
    mantissa, exponent = f"{rounded:.2e}".split("e")
    return f"{_with_minus(mantissa)}×{_power_of_ten(int(exponent))}"


def signed(value: float) -> str:
    """A change with its sign, three significant digits; zero has none.

    >>> signed(0.0123), signed(-12.34), signed(0.0)
    ('+0.0123', '−12.3', '0')
    """
    if math.isinf(value):
        return "+∞" if value > 0 else "−∞"
    return f"+{three_digits(value)}" if value > 0 else three_digits(value)


def two_digits(value: float) -> str:
    """A finite value with two significant digits, whole numbers whole: 0.012, 1.2, 120.

    >>> two_digits(17.6), two_digits(0.1561)
    ('18', '0.16')
    """
    rounded = float(f"{value:.1e}")
    if rounded and _FIXED_RANGE[0] <= abs(rounded) < _FIXED_RANGE[1]:
        decimals = max(0, 1 - math.floor(math.log10(abs(rounded))))
        return _with_minus(f"{rounded:.{decimals}f}")
    return three_digits(rounded)


def change(ratio: float) -> str:
    """A ratio as a change: in whole percent, beyond 3 as a factor.

    >>> change(1.114), change(0.99), change(4.2)
    ('+11 %', '−1 %', '4.2 times')
    """
    if not math.isfinite(ratio) or ratio >= _FACTORS_FROM:
        return f"{two_digits(ratio)} times" if math.isfinite(ratio) else "endlessly"
    return _with_minus(f"{100 * (ratio - 1):+.0f} %") if round(100 * (ratio - 1)) else "0 %"


def decade(value: float) -> str:
    """A round value on a logarithmic axis: 0.001, 0.5, 20, 10⁴, 2×10⁵."""
    mantissa, exponent = f"{value:.2e}".split("e")
    if -3 <= int(exponent) <= 3:
        return f"{value:g}"
    power = _power_of_ten(int(exponent))
    return power if float(mantissa) == 1 else f"{float(mantissa):g}×{power}"


def _spelt(value: float | None, column: Column, digits: Callable[[float], str]) -> str:
    if value is None or math.isnan(value):
        return MISSING
    scaled = value * column.scale
    if math.isinf(scaled):
        return "∞" if scaled > 0 else "−∞"
    if column.is_percentage:
        return _percentage(scaled)
    if column.is_count and abs(scaled) < _LONGEST_COUNT:
        return str(round(scaled))
    if 0 <= scaled < column.floor:
        return f"<{_power_of_ten(round(math.log10(column.floor)))}"
    return digits(scaled)


def _percentage(value: float) -> str:
    if 0 < value < 0.05:
        return "<0.1"
    if 99.95 <= value < 100:
        return ">99.9"
    return _with_minus(f"{value:.1f}")


def _power_of_ten(exponent: int) -> str:
    return f"10{str(exponent).translate(_SUPERSCRIPTS)}"


def _with_minus(text: str) -> str:
    return text.replace("-", "−")
