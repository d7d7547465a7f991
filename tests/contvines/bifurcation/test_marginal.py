"""Where a multiplier is on the unit circle by definition stability is undecided, unless another one is outside."""

import subprocess
import sys

import numpy as np
import pytest

import contvines as cv
from contvines.shared.motions import attracts, marginal_text, onto_circle
from orbits import Absorber


def bautin(x, p):
    """r' = r (mu + 2 r^2 - r^4): cycles turn at mu = -1, r = 1."""
    square = x[0] ** 2 + x[1] ** 2
    return [
        x[1] + x[0] * (p.mu + 2 * square - square**2),
        -x[0] + x[1] * (p.mu + 2 * square - square**2),
    ]


def test_a_cycle_and_an_equilibrium():
    graph = cv.diagram(cv.FlowProblem(bautin, [0.0, 0.0], {"mu": -0.5}), over="mu", within=(-1.2, 0.5))
    fold, hopf = graph["LP1"], graph["HB1"]
    assert fold.value == pytest.approx(-1.0, abs=1e-9)
    assert (
        fold.orbit.stable is None
        and "marginal" in repr(fold.orbit)
        and fold.orbit.to_dict()["stable"] is None
    )
    assert hopf.orbit.stable is None and "marginal: a pair of eigenvalues is imaginary" in str(hopf.orbit)
    cycles = graph[fold.branch]
    aside = [i for i, mu in enumerate(cycles.values) if -0.999 < mu < -0.01]
    assert {cycles.orbit(i).stable for i in aside} == {True, False}


@pytest.mark.parametrize(("rate", "stable"), [(-1.0, None), (1.0, False)])
def test_another_eigenvalue_decides(rate, stable):
    problem = cv.FlowProblem(lambda x, p: [p.q - x[0] ** 2, rate * x[1]], [1.0, 0.0], {"q": 1.0})
    assert cv.diagram(problem, over="q", within=(-1.0, 2.0))["LP1"].orbit.stable is stable


def test_motions_of_a_machine(tmp_path):
    """Phase and velocity contract by R^2 at each of two impacts, so that one multiplier is R^4 where the other is 1."""
    machine = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)
    graph = cv.diagram(machine.symmetric_orbit(amplitude=0.6), over="amplitude", within=(0.17, 1.0), depth=1)
    for label in ("LP1", "SB1"):
        orbit = graph[label].orbit
        assert orbit.stable is None
        assert np.sort(np.abs(orbit.multipliers)) == pytest.approx([0.76**4, 1.0], abs=1e-9)
    (stable,) = np.flatnonzero(np.abs(graph["B1"].values - 0.6) < 1e-12)
    assert graph["B1"].orbit(int(stable)).stable is True
    file = tmp_path / "motions.vines"
    graph.save(file)
    command = [sys.executable, "-m", "contvines.command", "orbit", str(file), "LP1"]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert "(marginal: a multiplier is 1)" in said
    locus = cv.locus(graph["LP1"], over="restitution", within=(0.7, 0.8))
    assert {locus.orbit(i).stable for i in range(len(locus))} == {None}


def test_multipliers_alone():
    found = onto_circle(np.array([0.6 + 0.8j, 0.6 - 0.8j, 0.3]) * (1.0 + 1e-9), 1e-4)
    assert np.abs(found[:2]) == pytest.approx(1.0, abs=1e-15) and found[2] == 0.3 * (1.0 + 1e-9)
    assert attracts(np.abs(found), 1.0) is None
    assert marginal_text(found) == "marginal: a pair of multipliers is on the unit circle"
    assert np.array_equal(onto_circle(np.array([1.2, 0.5]), 1e-4), [1.2, 0.5])
    assert (attracts(np.array([0.5]), 1.0), attracts(np.array([1.5, 1.0]), 1.0)) == (True, False)
