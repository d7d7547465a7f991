"""Functions that draw random numbers are told from bad guesses."""

import numpy as np
import pytest

import contvines as cv

TWICE = "asked twice for the same arguments .* in row 0"


def noisy(*shape):
    """Normal numbers, others at each call."""
    return 0.1 * np.random.default_rng().standard_normal(shape or None)


def rates(x, p):
    return [p.a * x[0] - x[1] - x[0] ** 3 + noisy(), x[0] - x[1]]


def test_an_equilibrium_of_random_rates():
    with pytest.raises(ValueError, match=TWICE):
        cv.diagram(cv.FlowProblem(rates, [0.0, 0.0], {"a": 0.5}), over="a", within=(0, 2))


def test_a_cycle_of_random_rates():
    with pytest.raises(ValueError, match=TWICE):
        cv.FlowProblem(rates, [0.0, 0.0], {"a": 2.5}).attractor()


def test_random_rates_that_are_forced():
    with pytest.raises(ValueError, match=TWICE):
        cv.FlowProblem(
            lambda x, p, t: [x[1] + noisy(), p.g * np.cos(t) - x[0] - x[1]],
            [0.0, 0.0],
            {"g": 0.5},
            period=2 * np.pi,
        )


def test_a_random_map():
    with pytest.raises(ValueError, match=TWICE):
        cv.diagram(
            cv.MapProblem(lambda x, p: [p.a * x[0] * (1 - x[0]) + noisy()], [0.5], {"a": 2.0}), within=(1, 3)
        )


def test_a_bad_guess_stays_one():
    """x^2 + 1 + a has no zero at a = 1."""
    with pytest.raises(ValueError, match="give a better guess"):
        cv.diagram(
            cv.FlowProblem(lambda x, p: [x[0] ** 2 + 1 + p.a], [1.0], {"a": 1.0}), over="a", within=(0.5, 2)
        )
