"""Bracketed roots and Chebyshev interpolation."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from contvines.bifurcation.roots import bracketed_root, chebyshev_fit, chebyshev_nodes, chebyshev_value


@given(st.floats(-0.95, 0.95), st.sampled_from([1, 3, 5]), st.floats(0.1, 10.0))
def test_root_of_odd_powers(root, power, scale):
    def f(x):
        return scale * (x - root) ** power

    found, low, high, flow, fhigh = bracketed_root(f, -1.0, 1.0, f(-1.0), f(1.0))
    assert abs(found - root) < 1e-12
    assert low <= found <= high and flow * fhigh <= 0.0
    assert abs(f(found)) == min(abs(flow), abs(fhigh))  # the better end of the bracket


@given(st.floats(-0.95, 0.95))
def test_jump_is_bracketed(root):
    def f(x):
        return 1.0 if x > root else -0.25

    _, low, high, flow, fhigh = bracketed_root(f, -1.0, 1.0, f(-1.0), f(1.0))
    assert low - 1e-15 <= root <= high + 1e-15 and high - low < 1e-12 and fhigh - flow == 1.25


def test_few_evaluations_for_a_smooth_function():
    calls = []

    def f(x):
        calls.append(x)
        return np.exp(x) - 2.0

    found = bracketed_root(f, 0.0, 1.0, -1.0, np.e - 2.0)[0]
    assert abs(found - np.log(2.0)) < 1e-15 and len(calls) < 15


def evaluations(f):
    """The root that is found of f between 0 and 1, and how often f is called."""
    calls = []

    def counted(x):
        calls.append(x)
        return f(x)

    return bracketed_root(counted, 0.0, 1.0, f(0.0), f(1.0), 1e-12)[0], len(calls)


def test_few_evaluations_at_a_jump_and_at_a_kink():
    """Bisection alone would take forty: the function is smooth on one side of its zero, or on both, but not across."""
    for root in (0.0081953, 0.3, 0.81209):

        def jumps(x, root=root):
            return np.sin(root - x) if x <= root else -3.0

        def bends(x, root=root):
            return (root - x) * (1e-3 if x <= root else 1.0)

        for f in (jumps, bends):
            found, count = evaluations(f)
            assert abs(found - root) < 2e-12
            assert count < 25


def test_nan_is_survived():
    def f(x):
        return float("nan") if abs(x - 0.5) < 1e-9 else x - 0.3

    assert abs(bracketed_root(f, 0.0, 1.0, -0.3, 0.7)[0] - 0.3) < 1e-12


def test_chebyshev_series_reproduces_polynomials():
    x = chebyshev_nodes(8)
    assert 0.0 not in x
    coefficients = np.array([0.3, -1.0, 0.5, 2.0, 0.0, 0.1, -0.2, 0.7])
    series = chebyshev_fit(np.stack([np.polyval(coefficients, x), x**2], axis=1))
    for t in np.linspace(-1, 1, 7):
        np.testing.assert_allclose(
            chebyshev_value(series, t), [np.polyval(coefficients, t), t * t], atol=1e-14
        )
