"""Where a multiplier is on the unit circle by definition stability is undecided, unless another one is outside."""

import numpy as np
import pytest

import contvines as cv
from contvines.shared.motions import marginal_text, onto_circle
from tests.contvines.loci.systems import bautin
from tests.machines import absorber_graph


def test_a_cycle_and_an_equilibrium():
    flow = cv.FlowProblem(bautin, [0.0, 0.0], {"mu": -0.5, "b": 2.0})
    graph = cv.diagram(flow, over="mu", within=(-1.2, 0.5))
    fold, hopf = graph["LP1"].orbit, graph["HB1"].orbit
    assert graph["LP1"].value == pytest.approx(-1.0, abs=1e-9)
    assert fold.stable is None and "marginal" in repr(fold) and fold.to_dict()["stable"] is None
    assert hopf.stable is None and "marginal: a pair of eigenvalues is imaginary" in str(hopf)
    cycles = graph[graph["LP1"].branch]
    aside = [i for i, mu in enumerate(cycles.values) if -0.999 < mu < -0.01]
    assert {cycles.orbit(i).stable for i in aside} == {True, False}


@pytest.mark.parametrize(("rate", "stable"), [(-1.0, None), (1.0, False)])
def test_another_eigenvalue_decides(rate, stable):
    problem = cv.FlowProblem(lambda x, p: [p.q - x[0] ** 2, rate * x[1]], [1.0, 0.0], {"q": 1.0})
    assert cv.diagram(problem, over="q", within=(-1.0, 2.0))["LP1"].orbit.stable is stable


def test_motions_of_a_machine(run):
    """Phase and velocity contract by R^2 at each of two impacts, so that one multiplier is R^4 where the other is 1."""
    graph = absorber_graph(0.6, (0.17, 1.0), depth=1)
    for label in ("LP1", "SB1"):
        orbit = graph[label].orbit
        assert orbit.stable is None
        assert np.sort(np.abs(orbit.multipliers)) == pytest.approx([0.76**4, 1.0], abs=1e-9)
    (stable,) = np.flatnonzero(np.abs(graph["B1"].values - 0.6) < 1e-12)
    assert graph["B1"].orbit(int(stable)).stable is True
    graph.save("motions.vines")
    assert "(marginal: a multiplier is 1)" in run("orbit", "motions.vines", "LP1")[1]
    locus = cv.locus(graph["LP1"], over="restitution", within=(0.7, 0.8))
    assert {locus.orbit(i).stable for i in range(len(locus))} == {None}


def test_multipliers_alone():
    """Those of a pair are told; none is put on the circle that is not near to it."""
    pair = np.array([0.6 + 0.8j, 0.6 - 0.8j, 0.3])
    assert marginal_text(pair) == "marginal: a pair of multipliers is on the unit circle"
    assert np.array_equal(onto_circle(np.array([1.2, 0.5]), 1e-4), [1.2, 0.5])
