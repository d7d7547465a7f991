"""Pages' integrators against mpmath, against closed forms, and against each other."""

import math

import mpmath
import numpy as np
import pytest

from orbits import symbols
from orbits.integrators import heyoka, solve_ivp
from orbits.integrators.expressions import Layout, Values, derivatives, replaced, variable, variables_of
from orbits.symbols import sin, sqrt

LAYOUT = Layout(("x", "v"), "clock", ("k",))
x, v, clock, k = (variable(name) for name in ("x", "v", "clock", "k"))
BOTH = pytest.mark.parametrize("engine", [heyoka, solve_ivp], ids=["heyoka", "scipy"])


def everything(functions, x, v, k):
    """A formula in which every elementary function and operator occurs."""
    f = functions
    return (
        f.sin(x * v) / (2 + f.cos(k)) + f.tan(x) * f.exp(-v) - f.log(2 + x) * f.sqrt(1 + v * v)
        + f.sinh(x) * f.cosh(v) + f.tanh(x - v) + f.asin(x / 2) + f.acos(v / 3) + f.atan(k * x)
        + (1 + x * x) ** k + 2**v + x**5 - 3 / (1 + x * x)
    )  # fmt: skip


def test_formulas_and_their_derivatives_agree_with_mpmath():
    formula = everything(symbols, x, v, k)
    values = Values(LAYOUT, [formula, *derivatives([formula], [x, v, k])[0]])
    for point in ((0.3, -0.7, 1.3), (-0.8, 0.4, 0.6), (0.0, 0.9, 2.0)):
        with mpmath.workdps(30):
            told = [
                mpmath.diff(lambda *at: everything(mpmath, *at), tuple(map(mpmath.mpf, point)), order)
                for order in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
            ]
        one = values.one(np.array(point[:2]), 0.0, np.array(point[2:]))
        five = np.array([point[:2]] * 5), np.zeros(5), np.array([point[2:]] * 5)
        for found in (one, values(*five)[3], heyoka.Values(LAYOUT, values.values)(*five)[3]):
            assert found == pytest.approx([float(t) for t in told], rel=1e-13, abs=1e-13)


def test_what_is_no_number_is_nan():
    values = Values(LAYOUT, [sqrt(x), 1 / v, x**0.5])
    with np.errstate(all="ignore"):
        assert np.isnan(values.one(np.array([-1.0, 2.0]), 0.0, np.zeros(1))[[0, 2]]).all()
        assert np.isinf(values.one(np.array([1.0, 0.0]), 0.0, np.zeros(1))[1])


def test_alike_expressions_are_one():
    assert sin(x * v) is sin(x * v)
    assert variables_of(x * 0.0 + v) == {"v"}
    assert variables_of(replaced(x * v + k, {"x": 0.0})) == {"k"}


RATES = [v, -k * x]  # x = cos(w clock), w^2 = k


@BOTH
def test_flights_carry_their_derivatives(engine):
    flight, w, out = engine.Flight(LAYOUT, RATES, (0,)), 1.3, np.empty(8)
    assert flight(np.array([1.0, 0.0]), 0.5, 2.0, np.array([w * w]), out)
    t, c, s = 1.5, math.cos(1.5 * w), math.sin(1.5 * w)
    by_k = (-t * s / (2 * w), (-s - t * w * c) / (2 * w))
    told = [c, -w * s, c, s / w, by_k[0], -w * s, c, by_k[1]]
    assert out == pytest.approx(told, abs=1e-12)


@BOTH
def test_two_crossings_within_a_step_are_not_missed(engine):
    """The lowest point is passed below zero by 1e-6 only: two crossings, sqrt(2e-6) on either side of pi."""
    run = engine.Run(LAYOUT, [v, -k * x], [x + (1.0 - 1e-6), x + 2.0])
    state = np.array([1.0, 0.0])
    when, which = run(state, 0.0, 6.0, np.array([1.0]))
    assert which == 0
    assert when == pytest.approx(math.pi - math.acos(1.0 - 1e-6), abs=1e-9)
    watch = engine.Watch(LAYOUT, RATES, [v])
    found = watch(np.array([1.0, 0.0]), 0.0, 12.0, np.array([1.0]))
    assert [c for c, _, _ in found] == pytest.approx([math.pi, 3 * math.pi], abs=1e-10)


@BOTH
def test_a_function_that_starts_at_zero_and_rises_has_not_fallen(engine):
    run = engine.Run(LAYOUT, [v, -k + 0.0 * x], [x])
    state = np.array([0.0, 0.5])  # thrown up: it is back at 2 v/k
    assert run(state, 0.0, 9.0, np.array([2.0])) == pytest.approx((0.5, 0))
    assert state == pytest.approx([0.0, -0.5], abs=1e-13)


@BOTH
def test_a_flow_that_runs_away_is_told(engine):
    run = engine.Run(LAYOUT, [x * x, 0.0 * v], [v + 1.0])
    assert run(np.array([1.0, 0.0]), 0.0, 3.0, np.zeros(1))[1] == -1


@BOTH
def test_a_path_has_its_states_at_given_clocks(engine):
    watch = engine.Watch(LAYOUT, RATES, [])
    clocks = np.array([1.0, 1.0, 1.7, 2.5, 2.5])
    rows = watch.path(np.array([math.cos(1.0), -math.sin(1.0)]), clocks, np.ones(1))
    assert rows == pytest.approx(np.column_stack([np.cos(clocks), -np.sin(clocks)]), abs=1e-12)
