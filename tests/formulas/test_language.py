"""Every function of formulas means the same on NumPy, on Dr.Jit and on jets, with its derivatives."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from rectbench import llvm
from rectbench.formulas import protocol
from rectbench.formulas.evaluation import KERNEL_THRESHOLD, evaluate, evaluate_points
from rectbench.formulas.jets import Jet, JetNamespace, constant, variables
from rectbench.formulas.namespaces import NUMPY, drjit_namespace
from rectbench.formulas.protocol import ArrayFunctions, Formulas

NAMES = sorted(name for part in (ArrayFunctions, Formulas) for name in vars(part) if not name.startswith("_"))

AROUND = (-2.3, -0.51, -0.5, -0.11, -1e-3, -1e-9, 0.0, 1e-9, 1e-3, 0.0999, 0.1, 0.4999, 0.5, 1.2, 2.9)
ABOVE = (0.2, 0.3, 1.0, 2.5, 40.0)
WITHIN = (-0.9, -0.5, -1e-6, 0.0, 1e-9, 0.3, 0.9)
PAIRS = ((0.3, -1.7, 2.0, -0.4, 1e-7), (0.8, -0.2, -3.0, 1.1, 2.0))
KNOTS, PIECES = (-0.7, 0.2, 1.0), (0.1, -0.3, 2.0, 5.5)
LOWER, CUBICS = (-2.0, -0.6, 0.3, 2.0), ((0.1, 1.0, 0.3, -0.2), (1.4, 0.9, -0.3, 0.7), (2.2, 1.0, 0.0, 0.1))
SMOOTH = (-2.3, -0.61, -0.1, 0.01, 0.31, 1.2, 2.9)
"""Points where neither a piece nor a polynomial of those ends."""


def _series(x: Any, ratio: Callable[[Any], Any], limit: float, curvature: float) -> Any:
    """A quotient and its limit at 0, where x is too small for more than two terms."""
    small = abs(x) < 1e-6
    away = np.where(small, 1.0, x)
    return np.where(small, limit + curvature * x * x, ratio(away))


def _spline(x: Any) -> Any:
    place = np.clip(np.searchsorted(LOWER, np.asarray(x, dtype=float), side="right") - 1, 0, 2)
    powers = (x - np.array(LOWER)[place])[:, None] ** np.arange(4)
    return (np.array(CUBICS)[place] * powers).sum(axis=1)


def _versine(x: Any) -> Any:
    return 2 * np.sin(x / 2) ** 2 / (x * x)


Case = tuple[Callable[..., Any], tuple[tuple[float, ...], ...]]
CASES: dict[str, Case] = {
    **{name: (getattr(np, name), (AROUND,)) for name in ("sin", "cos", "tan", "atan", "square", "sinh")},
    **{name: (getattr(np, name), (AROUND,)) for name in ("exp", "expm1", "cosh", "tanh", "asinh")},
    **{name: (getattr(np, name), (ABOVE,)) for name in ("sqrt", "log")},
    **{name: (getattr(np, name), (WITHIN,)) for name in ("asin", "acos", "atanh", "log1p")},
    **{name: (getattr(np, name), (SMOOTH,)) for name in ("abs", "sign", "floor", "isfinite")},
    **{name: (getattr(np, name), PAIRS) for name in ("atan2", "hypot", "minimum", "maximum")},
    "acosh": (np.acosh, ((1.05, 1.5, 30.0),)),
    "pow": (np.pow, ((0.2, 1.0, 3.0, 7.0), (2.5, -1.3, 0.5, 2.0))),
    "where": (lambda x, y: np.where(x < y, x, y * y), PAIRS),
    "sinc": (lambda x: _series(x, lambda a: np.sin(a) / a, 1.0, -1 / 6), (AROUND,)),
    "sinhc": (lambda x: _series(x, lambda a: np.sinh(a) / a, 1.0, 1 / 6), (AROUND,)),
    "tanc": (lambda x: _series(x, lambda a: np.tan(a) / a, 1.0, 1 / 3), (AROUND,)),
    "atanc": (lambda x: _series(x, lambda a: np.atan(a) / a, 1.0, -1 / 3), (AROUND,)),
    "cosc": (lambda x: _series(x, _versine, 0.5, -1 / 24), (AROUND,)),
    "polynomial": (lambda x: 1.5 - 2.0 * x + 0.25 * x**3, (AROUND,)),
    "piecewise": (lambda x: np.array(PIECES)[np.searchsorted(KNOTS, x, side="right")], (SMOOTH,)),
    "spline": (_spline, (SMOOTH,)),
    "interval": (lambda x: sum((x >= knot).astype(int) for knot in LOWER[1:-1]), (SMOOTH,)),
    "take": (lambda x: np.array(PIECES)[np.searchsorted(KNOTS, x, side="right")], (SMOOTH,)),
}
"""By name: the function by its definition, and the arguments at which it is compared."""

CALLS: dict[str, Callable[..., Any]] = {
    "where": lambda xp, x, y: xp.where(x < y, x, y * y),
    "polynomial": lambda xp, x: xp.polynomial((1.5, -2.0, 0.0, 0.25), x),
    "piecewise": lambda xp, x: xp.piecewise(KNOTS, PIECES, x),
    "spline": lambda xp, x: xp.spline(LOWER, CUBICS, x),
    "interval": lambda xp, x: xp.interval(table(xp, LOWER), x),
    "take": lambda xp, x: xp.take(table(xp, PIECES), xp.interval(table(xp, (-9.0, *KNOTS, 9.0)), x)),
}
"""How those are called that take more than arrays."""


def call(name: str, xp: Any, *arguments: Any) -> Any:
    return CALLS[name](xp, *arguments) if name in CALLS else getattr(xp, name)(*arguments)


needs_llvm = pytest.mark.skipif(not llvm.available(), reason=f"no LLVM: {llvm.problem()}")


@pytest.fixture(params=["NumPy", pytest.param("Dr.Jit", marks=needs_llvm)])
def xp(request: pytest.FixtureRequest) -> Formulas:
    return NUMPY if request.param == "NumPy" else drjit_namespace()


def arrays(xp: Formulas, *columns: Any) -> list[Any]:
    if xp is NUMPY:
        return [np.array(column, dtype=float) for column in columns]
    from drjit.llvm import Float64

    return [Float64(np.array(column, dtype=float)) for column in columns]


def table(xp: Any, numbers: tuple[float, ...]) -> Any:
    """A constant that is an array, as the formulas get it; jets get jets."""
    if isinstance(xp, JetNamespace):
        return constant(table(xp.xp, numbers))
    return arrays(xp, numbers)[0]


def numbers(value: Any, count: int) -> np.ndarray:
    array = value.numpy() if hasattr(value, "numpy") else np.asarray(value)
    return np.broadcast_to(array, count)


def slope(function: Callable[..., Any], columns: tuple[Any, ...], place: int) -> np.ndarray:
    """The derivative by one argument: central differences of fourth order, in extended precision."""
    step = np.longdouble(1e-4)
    wide = [np.array(column, dtype=np.longdouble) for column in columns]

    def at(move: int) -> Any:
        return function(*(column + move * step * (i == place) for i, column in enumerate(wide)))

    return np.asarray((8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * step), dtype=float)


def test_each_name_of_the_language_is_compared_and_documented() -> None:
    assert sorted(CASES) == NAMES
    for name in NAMES:
        assert getattr(Formulas, name).__doc__
        assert name in str(protocol.__doc__)


@pytest.mark.parametrize("name", NAMES)
def test_values_are_those_of_the_definition(name: str, xp: Formulas) -> None:
    function, columns = CASES[name]
    found = numbers(call(name, xp, *arrays(xp, *columns)), len(columns[0]))
    expected = function(*(np.array(column, dtype=np.longdouble) for column in columns))
    np.testing.assert_allclose(found, expected.astype(found.dtype), rtol=1e-13, atol=1e-300)


@pytest.mark.parametrize("name", sorted(set(NAMES) - {"isfinite"}))
def test_partials_are_the_derivatives(name: str, xp: Formulas) -> None:
    function, columns = CASES[name]
    jet = call(name, JetNamespace(xp), *variables(*arrays(xp, *columns)))
    value = call(name, xp, *arrays(xp, *columns))
    np.testing.assert_array_equal(numbers(jet.value, len(columns[0])), numbers(value, len(columns[0])))
    for place, partial in enumerate(jet.partials or (0.0,)):
        found, expected = numbers(partial, len(columns[0])), slope(function, columns, place)
        np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-12)


INFINITE = {"sqrt": (0.0,), "asin": (-1.0, 1.0), "acosh": (1.0,), "log": (0.0,), "atanh": (-1.0, 1.0)}
BEYOND = {"sqrt": -1.0, "asin": 1.1, "acos": -1.1, "log": -1.0, "log1p": -1.5, "acosh": 0.5, "atanh": 2.0}
LIMITS = {"sinc": 1.0, "tanc": 1.0, "atanc": 1.0, "sinhc": 1.0, "cosc": 0.5}


@pytest.mark.parametrize("name", INFINITE)
def test_slopes_at_the_ends_of_a_domain_are_infinite(name: str, xp: Formulas) -> None:
    ends = INFINITE[name]
    with np.errstate(all="ignore"):
        jet = getattr(JetNamespace(xp), name)(*variables(*arrays(xp, ends)))
        np.testing.assert_allclose(
            numbers(jet.value, len(ends)), getattr(np, name)(np.array(ends)), rtol=1e-15
        )
    np.testing.assert_array_equal(np.abs(numbers(jet.partials[0], len(ends))), math.inf)


@pytest.mark.parametrize("name", BEYOND)
def test_what_lies_beyond_a_domain_is_nan(name: str, xp: Formulas) -> None:
    with np.errstate(all="ignore"):
        assert np.isnan(numbers(getattr(xp, name)(*arrays(xp, [BEYOND[name]])), 1)).all()


@pytest.mark.parametrize("name", sorted(set(NAMES) - {"isfinite", "where", "piecewise", "interval", "take"}))
def test_nan_stays_nan(name: str, xp: Formulas) -> None:
    pairs = [(math.nan,)] if len(CASES[name][1]) == 1 else [(math.nan, 2.0), (2.0, math.nan)]
    columns = arrays(xp, *zip(*pairs, strict=True))
    with np.errstate(all="ignore"):
        assert np.isnan(numbers(call(name, xp, *columns), len(pairs))).all()
        assert np.isnan(numbers(call(name, JetNamespace(xp), *variables(*columns)).value, len(pairs))).all()


@pytest.mark.parametrize("count", [10, KERNEL_THRESHOLD])
def test_a_point_whose_value_is_nan_on_the_way_is_invalid(count: int) -> None:
    def beyond(c: Any, x: Any, xp: Formulas) -> tuple[Any, ...]:
        return xp.atan2(xp.asin(x), 1.0), x > 0.0

    values, valid = evaluate_points(beyond, {}, np.full((count, 1), 2.0))
    assert not valid.any()
    assert np.isnan(values).all()


@pytest.mark.parametrize("name", ["log1p", "expm1"])
def test_logarithms_and_exponentials_keep_their_digits_far_from_0(name: str, xp: Formulas) -> None:
    at = [
        -math.inf,
        -1e4,
        -40.0,
        -1.0,
        -1 + 1e-10,
        -0.51,
        -0.49,
        0.49,
        0.51,
        1.0,
        700.0,
        1e10,
        1e300,
        math.inf,
    ]
    with np.errstate(all="ignore"):
        found = numbers(getattr(xp, name)(*arrays(xp, at)), len(at))
        expected = getattr(np, name)(np.array(at))
    np.testing.assert_allclose(found, expected, rtol=1e-13)


@pytest.mark.parametrize("name", LIMITS)
def test_quotients_have_their_limit_and_no_slope_at_0(name: str, xp: Formulas) -> None:
    jet = getattr(JetNamespace(xp), name)(*variables(*arrays(xp, [0.0, -0.0])))
    np.testing.assert_array_equal(numbers(jet.value, 2), LIMITS[name])
    np.testing.assert_array_equal(numbers(jet.partials[0], 2), 0.0)


def test_kinks_and_steps_have_the_stated_values(xp: Formulas) -> None:
    at = arrays(xp, [0.0, -2.0, 3.0])[0]
    np.testing.assert_array_equal(numbers(xp.sign(at), 3), [0.0, -1.0, 1.0])
    np.testing.assert_array_equal(numbers(xp.floor(at), 3), [0.0, -2.0, 3.0])
    np.testing.assert_array_equal(
        numbers(JetNamespace(xp).abs(*variables(at)).partials[0], 3), [1.0, -1.0, 1.0]
    )
    np.testing.assert_array_equal(numbers(xp.piecewise(KNOTS, PIECES, arrays(xp, KNOTS)[0]), 3), PIECES[1:])
    half_turn = xp.atan2(*arrays(xp, [0.0, 1.0, -1.0, 0.0], [-1.0, 0.0, 0.0, 1.0]))
    np.testing.assert_allclose(numbers(half_turn, 4), [math.pi, math.pi / 2, -math.pi / 2, 0.0], rtol=1e-15)
    below = xp.atan2(*arrays(xp, [-0.0, -0.0], [-1.0, 1.0]))
    np.testing.assert_allclose(numbers(below, 2), [-math.pi, 0.0], rtol=1e-15)


def test_a_choice_hides_what_it_does_not_choose(xp: Formulas) -> None:
    (x,) = variables(*arrays(xp, [-1.0, 4.0]))
    with np.errstate(all="ignore"):
        jet = JetNamespace(xp).where(x > 0.0, JetNamespace(xp).sqrt(x), 0.1)
    np.testing.assert_array_equal(numbers(jet.value, 2), [0.1, 2.0])
    np.testing.assert_array_equal(numbers(jet.partials[0], 2), [0.0, 0.25])


def test_a_choice_between_two_plain_numbers_keeps_all_digits(xp: Formulas) -> None:
    x = arrays(xp, [-1.0, 1.0])[0]
    np.testing.assert_array_equal(numbers(xp.where(x < 0.0, 0.1, 0.2), 2), [0.1, 0.2])


def test_whole_numbers_count_as_real_ones(xp: Formulas) -> None:
    x = arrays(xp, [-1.0, 1.0])[0]
    for one, two in ((1, 2), (np.int64(1), np.int64(2)), (1, 2.0)):
        np.testing.assert_array_equal(numbers(xp.where(x < 0.0, one, two) / 3, 2), [1 / 3, 2 / 3])
    np.testing.assert_array_equal(numbers(xp.piecewise((0,), (1, 2), x) * 0.1, 2), [0.1, 0.2])
    (x,) = variables(*arrays(xp, [0.1, 1.3]))
    jet = JetNamespace(xp).spline((0, 1, 2), ((1, 2, 3), (4, 5, 6)), x)
    np.testing.assert_allclose(numbers(jet.partials[0], 2), [2 + 6 * 0.1, 5 + 12 * 0.3], rtol=1e-14)


@pytest.mark.parametrize("count", [10, KERNEL_THRESHOLD])
def test_outputs_may_be_plain_numbers(count: int) -> None:
    def plain(c: Any, x: Any, xp: Formulas) -> tuple[Any, ...]:
        return 0.1, 2, x > 0.0

    values, _ = evaluate_points(plain, {}, np.ones((count, 1)))
    np.testing.assert_array_equal(values, np.full((count, 2), [0.1, 2.0]))
    for found, expected in zip(evaluate(plain, {}, np.ones(count)), (0.1, 2.0, True), strict=True):
        np.testing.assert_array_equal(found, expected)


def test_jets_are_equal_by_value(xp: Formulas) -> None:
    (x,) = variables(*arrays(xp, [0.0, -0.0, 1.0]))
    assert numbers(x == 0.0, 3).tolist() == [True, True, False]
    assert numbers(x != Jet(1.0), 3).tolist() == [True, True, False]
    with np.errstate(all="ignore"):
        jet = JetNamespace(xp).where(x == 0.0, 1.0, JetNamespace(xp).sin(x) / x)
    np.testing.assert_allclose(numbers(jet.value, 3), [1.0, 1.0, math.sin(1.0)], rtol=1e-15)
    with pytest.raises(TypeError, match="unhashable"):
        hash(x)


def test_whole_powers_serve_any_number(xp: Formulas) -> None:
    (x,) = variables(*arrays(xp, [-1.5, 0.0, 2.0]))
    jet = x**3
    np.testing.assert_allclose(numbers(jet.value, 3), [-3.375, 0.0, 8.0], rtol=1e-15)
    np.testing.assert_allclose(numbers(jet.partials[0], 3), [6.75, 0.0, 12.0], rtol=1e-15)
    np.testing.assert_array_equal(numbers((x**0).value, 3), 1.0)
    np.testing.assert_array_equal(numbers((x**0).partials[0], 3), 0.0)


def test_isfinite_looks_at_a_jets_value(xp: Formulas) -> None:
    jets = JetNamespace(xp)
    found = jets.isfinite(constant(arrays(xp, [1.0, math.nan, math.inf])[0]))
    assert numbers(found, 3).tolist() == [True, False, False]


def test_coefficients_may_be_jets(xp: Formulas) -> None:
    x = arrays(xp, [-0.4, 0.7, 1.1])[0]
    coefficients = variables(*arrays(xp, [1.0] * 3, [2.0] * 3, [3.0] * 3))
    jet = JetNamespace(xp).polynomial(coefficients, Jet(x))
    for power, partial in enumerate(jet.partials):
        np.testing.assert_allclose(
            numbers(partial, 3), np.array([-0.4, 0.7, 1.1]) ** power, rtol=1e-15, atol=1e-16
        )


def test_a_spline_holds_what_scipys_does(xp: Formulas) -> None:
    knots = np.array([-1.0, -0.4, 0.1, 0.9, 1.3])
    scipys = PchipInterpolator(knots, np.sinh(2 * knots))
    angles = np.linspace(-1.1, 1.5, 53)
    (x,) = variables(*arrays(xp, angles))
    jet = JetNamespace(xp).spline(knots, [tuple(row) for row in scipys.c[::-1].T], x)
    np.testing.assert_allclose(numbers(jet.value, 53), scipys(angles), rtol=1e-13)
    np.testing.assert_allclose(numbers(jet.partials[0], 53), scipys.derivative()(angles), rtol=1e-12)
