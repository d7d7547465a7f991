"""Wrong arguments of flows, and what is said of them."""

import numpy as np
import pytest

import contvines as cv


def josephson(x, p):
    """A shunted junction; the phase as cosine and sine."""
    square = x[0] ** 2 + x[1] ** 2
    return [
        -x[1] * x[2] + x[0] * (1 - square),
        x[0] * x[2] + x[1] * (1 - square),
        (p.i - x[1] - x[2]) / p.beta_c,
    ]


@pytest.fixture
def flow():
    return cv.FlowProblem(josephson, [1.0, 0.0, 0.0], {"i": 0.5, "beta_c": 4.0})


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda flow: cv.diagram(flow, over="I", within=(0, 2)), "did you mean 'i'"),
        (lambda flow: cv.diagram(flow, within=(0, 2)), "one of 'i', 'beta_c'"),
        (lambda flow: flow.attractor(Beta_c=3.0), "did you mean 'beta_c'"),
        (lambda flow: cv.basins(flow.population("i"), at=float("nan"), points=4), "at = nan"),
        (lambda flow: flow.population("i", box=[(1, -1), (-1, 1), (0, 1)]), "low < high"),
        (
            lambda flow: cv.FlowProblem(lambda x, p: [p.beta * x[0]], [1.0], {"beta_c": 1.0}),
            "did you mean 'beta_c'",
        ),
        (
            lambda flow: cv.FlowProblem(lambda x, a: [a * x[0]], [1.0], {"a": 1.0}),
            "parameters have names: p.a",
        ),
        (
            lambda flow: cv.FlowProblem(
                lambda x, t, p: [p.a * x[0] + np.cos(t)], [1.0], {"a": 1.0}, period=2 * np.pi
            ),
            r"called with \(x, p, t\)",
        ),
    ],
)
def test_a_wrong_argument_is_told_with_a_way_out(flow, wrong, words):
    with pytest.raises((ValueError, TypeError), match=words):
        wrong(flow)
