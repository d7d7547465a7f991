"""A pair of multipliers that passes the circle and comes back within one step, with a fold in between, beside it, or far away."""

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.kinds import BORDERS
from tests.contvines.lines import Line


def map_of(excess, bend, middle):
    """x turns at p = 1; beside it a spiral whose multipliers have the modulus 1 + excess - y/(1 + y), y = bend (x - middle)^2."""

    def f(x, p):
        y = bend * (x[0] - middle) ** 2
        modulus = 1.0 + excess - y / (1.0 + y)
        c, s = modulus * np.cos(1.1), modulus * np.sin(1.1)
        return [x[0] + 0.3 * (1.0 - p - x[0] ** 2), c * x[1] - s * x[2], s * x[1] + c * x[2]]

    return cv.MapProblem(f, [0.6, 0.0, 0.0], 0.64)


@pytest.mark.parametrize("max_step", [0.1, 0.003])
@pytest.mark.parametrize("middle", [0.0, 0.001, -0.02])
@pytest.mark.parametrize("excess", [1e-4, 1e-3])
def test_both_are_found_and_the_fold(max_step, middle, excess):
    """The modulus is 1 at y = excess/(1 - excess), either side of x = middle; the branch turns at x = 0, and is unstable below that."""
    bend = 40.0
    graph = cv.diagram(map_of(excess, bend, middle), within=(0.5, 1.5), settings={"max_step": max_step})
    assert not any(point.kind in BORDERS for point in graph.special.values())
    (fold,) = graph.of_kind("fold")
    assert fold.value == pytest.approx(1.0, abs=1e-10)
    x = middle + np.sqrt(excess / (1.0 - excess) / bend) * np.array([-1.0, 1.0])
    found = sorted(point.u[0] for point in graph.of_kind("neimark-sacker"))
    assert found == pytest.approx(list(x), abs=1e-7)


@pytest.mark.parametrize("max_step", [0.1, 0.03])
@pytest.mark.parametrize("pole", [1e-5, 4e-3])
@pytest.mark.parametrize("k", [0.3, 0.9, 1.1])
def test_a_multiplier_that_comes_back_from_infinity_beside_a_fold(max_step, pole, k):
    """As where an event of a virtual orbit grazes: on p = u^2, which turns at u = 0, it is -1 at u = 2 pole/(2 - k), and inside the circle before the fold and behind that."""
    problem = Line(
        multipliers=lambda u, p: [1.0 + k * u / (pole - u)],
        curve=lambda u, p: (p - u * u, -2.0 * u, 1.0),
        start=(-0.6, 0.36),
    )
    graph = cv.diagram(problem, within=(-0.2, 0.4), settings={"max_step": max_step}, depth=0)
    (fold,), (flip,) = graph.of_kind("fold"), graph.of_kind("period-doubling")
    assert abs(fold.value) < 1e-14
    assert flip.u[0] == pytest.approx(2.0 * pole / (2.0 - k), rel=1e-8)
