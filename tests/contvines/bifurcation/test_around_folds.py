"""A pair of multipliers that passes the circle and comes back within one step, with a fold in between, beside it, or far away."""

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.kinds import BORDERS
from contvines.problems.dense import KERNELS
from contvines.problems.protocol import Kernels
from tests.contvines.bifurcation.test_dips import Line


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


class Parabola(Line):
    """p = u^2, turning at u = 0, with the multiplier 1 + k u/(pole - u): at infinity where u = pole, from above to below."""

    u0, p0 = np.array([-0.6]), 0.36

    def __init__(self, k, pole):
        def inspect(data, u, p, work, row):
            row[:] = 1.0 + k * u[0] / (pole - u[0]), 0.0, 1.0

        super().__init__()
        self.kernels = Kernels(KERNELS.linearise, KERNELS.bordered, inspect)

    def equations(self, u, p):
        return p - u * u, np.diag(-2.0 * u), np.array([1.0])


@pytest.mark.parametrize("max_step", [0.1, 0.03])
@pytest.mark.parametrize("pole", [1e-5, 4e-3])
@pytest.mark.parametrize("k", [0.3, 0.9, 1.1])
def test_a_multiplier_that_comes_back_from_infinity_beside_a_fold(max_step, pole, k):
    """As where an event of a virtual orbit grazes. It is -1 at u = 2 pole/(2 - k), and inside the circle before the fold and behind that."""
    graph = cv.diagram(Parabola(k, pole), within=(-0.2, 0.4), settings={"max_step": max_step}, depth=0)
    (fold,), (flip,) = graph.of_kind("fold"), graph.of_kind("period-doubling")
    assert abs(fold.value) < 1e-14
    assert flip.u[0] == pytest.approx(2.0 * pole / (2.0 - k), rel=1e-8)


class Exchanged(Parabola):
    """p = u^2 with two multipliers of given sum and product: one is -1, both a pair of modulus 1, one is +1 where the branch turns, in turn.

    With z = w tanh(u/w) the product is 1 + (z + gap)/width, and one minus the sum plus the product is -rate z.
    """

    n_multipliers = 2

    def __init__(self, gap, width, rate, w=0.01):
        self.gap, self.width, self.rate, self.w = gap, width, rate, w

        def inspect(data, u, p, work, row):
            z = w * np.tanh(u[0] / w)
            product = 1.0 + (z + gap) / width
            row[::2] = np.append(np.roots([1.0, -(1.0 + product + rate * z), product]).real, 1.0)
            row[1:4:2] = np.roots([1.0, -(1.0 + product + rate * z), product]).imag

        super().__init__(0.3, 1.0)
        self.kernels = Kernels(KERNELS.linearise, KERNELS.bordered, inspect)

    def at(self, z):
        """The unknown at a value of z."""
        return self.w * np.arctanh(z / self.w)


@pytest.mark.parametrize("max_step", [0.1, 0.03, 0.003])
@pytest.mark.parametrize("gap", [1e-5, 1e-4, 1e-3])
def test_a_pair_that_leaves_between_a_doubling_and_a_fold(max_step, gap):
    """One multiplier is outside before all three and one behind, past -1 and past +1: a doubling and a fold account for that."""
    problem = Exchanged(gap, 2.0 * gap, 0.8 / gap)
    graph = cv.diagram(problem, within=(-0.2, 0.4), settings={"max_step": max_step}, depth=0)
    (fold,), (flip,), (pair,) = (graph.of_kind(k) for k in ("fold", "period-doubling", "neimark-sacker"))
    assert abs(fold.value) < 1e-14
    assert flip.u[0] == pytest.approx(problem.at(-5.0 * gap / 1.8), rel=1e-6)
    assert pair.u[0] == pytest.approx(problem.at(-gap), rel=1e-6)
    assert not graph.unresolved


@pytest.mark.parametrize("max_step", [0.1, 0.03, 0.003])
@pytest.mark.parametrize("gap", [1e-9, 1e-8, 1e-7, 1e-6, 3e-6])
def test_nearer_than_segments_are_halved_the_fold_is_found_and_what_lacks_is_unresolved(max_step, gap):
    """All three lie within three gaps of the fold; on the parts into which the step is halved the parameter turns by less than rounding."""
    problem = Exchanged(gap, 2.0 * gap, 0.8 / gap)
    graph = cv.diagram(problem, within=(-0.2, 0.4), settings={"max_step": max_step}, depth=0)
    (fold,), flips, pairs = (graph.of_kind(k) for k in ("fold", "period-doubling", "neimark-sacker"))
    assert abs(fold.u[0]) < 1e-12 and abs(fold.value) < 1e-14
    assert [point.u[0] for point in flips] == pytest.approx(
        [problem.at(-5.0 * gap / 1.8)] * len(flips), rel=1e-6
    )
    assert [point.u[0] for point in pairs] == pytest.approx([problem.at(-gap)] * len(pairs), rel=1e-6)
    assert len(flips) <= 1 and len(pairs) <= 1
    assert (flips and pairs) or any(stretch.low < 1e-10 for stretch in graph.unresolved)
