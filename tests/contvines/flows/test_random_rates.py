"""Functions that draw random numbers are told from bad guesses."""

import numpy as np
import pytest

import contvines as cv

NOISE = np.random.default_rng(1)


def noisy(x, p, *t):
    """Normal numbers beside the rates, others at each call."""
    noise = 0.1 * NOISE.standard_normal()
    return [p.a * x[0] - x[1] - x[0] ** 3 + noise, x[0] - x[1]]


@pytest.mark.parametrize(
    "ask",
    [
        lambda: cv.diagram(cv.FlowProblem(noisy, [0.0, 0.0], {"a": 0.5}), within=(0, 2)),
        lambda: cv.FlowProblem(noisy, [0.0, 0.0], {"a": 2.5}).attractor(),
        lambda: cv.FlowProblem(noisy, [0.0, 0.0], {"a": 0.5}, period=2 * np.pi),
        lambda: cv.diagram(cv.MapProblem(noisy, [0.0, 0.0], {"a": 0.5}), within=(0, 2)),
    ],
    ids=["an equilibrium", "a cycle", "forced", "a map"],
)
def test_random_rates(ask):
    with pytest.raises(ValueError, match="two evaluations .* at the same arguments differ .* in row 0"):
        ask()
