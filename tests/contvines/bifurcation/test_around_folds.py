"""A pair of multipliers that passes the circle and comes back within one step, with a fold in between, beside it, or far away."""

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.kinds import BORDERS
from tests.contvines.lines import PARABOLA, Line


def map_of(excess, bend, middle):
    """x turns at p = 1; beside it a spiral whose multipliers have the modulus 1 + excess - y/(1 + y), y = bend (x - middle)^2."""

    def f(x, p):
        y = bend * (x[0] - middle) ** 2
        modulus = 1.0 + excess - y / (1.0 + y)
        c, s = modulus * np.cos(1.1), modulus * np.sin(1.1)
        return np.array([x[0] + 0.3 * (1.0 - p - x[0] ** 2), c * x[1] - s * x[2], s * x[1] + c * x[2]])

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


def on_the_parabola(multipliers, max_step):
    """Folds, doublings and pairs of p = u^2, which turns at u = 0, with given multipliers; and the graph."""
    problem = Line(multipliers=multipliers, **PARABOLA)
    graph = cv.diagram(problem, within=(-0.2, 0.4), settings={"max_step": max_step}, depth=0)
    (fold,), flips, pairs = (graph.of_kind(k) for k in ("fold", "period-doubling", "neimark-sacker"))
    assert abs(fold.value) < 1e-14
    return [point.u[0] for point in flips], [point.u[0] for point in pairs], graph


@pytest.mark.parametrize("max_step", [0.1, 0.03])
@pytest.mark.parametrize("pole", [1e-5, 4e-3])
@pytest.mark.parametrize("k", [0.3, 0.9, 1.1])
def test_a_multiplier_that_comes_back_from_infinity_beside_a_fold(max_step, pole, k):
    """As where an event of a virtual orbit grazes. It is -1 at u = 2 pole/(2 - k), and inside the circle before the fold and behind that."""
    flips, _, _ = on_the_parabola(lambda u, p: [1.0 + k * u / (pole - u)], max_step)
    assert flips == pytest.approx([2.0 * pole / (2.0 - k)], rel=1e-8)


@pytest.mark.parametrize("max_step", [0.1, 0.03, 0.003])
@pytest.mark.parametrize("gap", [1e-9, 1e-8, 1e-7, 1e-6, 3e-6, 1e-5, 1e-4, 1e-3])
def test_a_pair_that_leaves_between_a_doubling_and_a_fold(max_step, gap):
    """One multiplier is outside before all three and one behind, past -1 and past +1: a doubling and a fold account for that.

    With z = w tanh(u/w) the product of both is 1 + (z + gap)/(2 gap), and one minus the sum plus the product is -0.8 z/gap.
    """
    w = 0.01

    def multipliers(u, p):
        z = w * np.tanh(u / w)
        product = 1.0 + (z + gap) / (2.0 * gap)
        return np.roots([1.0, -(1.0 + product + 0.8 * z / gap), product])

    flips, pairs, graph = on_the_parabola(multipliers, max_step)
    for found, z in ((flips, -gap * 5.0 / 1.8), (pairs, -gap)):
        assert found == pytest.approx([w * np.arctanh(z / w)] * len(found), rel=1e-6)
    if gap < 5e-6:  # on the parts into which the step is halved the parameter turns by less than rounding
        assert len(flips) <= 1 and len(pairs) <= 1
        assert (flips and pairs) or any(stretch.low < 1e-10 for stretch in graph.unresolved)
    else:
        assert len(flips) == len(pairs) == 1 and not graph.unresolved
