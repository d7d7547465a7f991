"""Many starts of flows: what they settle on is known from closed forms."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.flows.shooting import born, landau, run
from tools.demos.demo import NUMBERS
from tools.flow_demos.fields import hopf

pytestmark = pytest.mark.slow


def radial(x, p):
    """r' = r (m + r^2 - r^4), angle' = 1: at rest and a cycle, parted by r^2 = (1 - sqrt(1 + 4 m)) / 2."""
    return hopf(x, p.m, NUMBERS)


def duffing(x, p, t):
    return [x[1], -0.1 * x[1] - x[0] - x[0] ** 3 + 0.5 * np.cos(p.omega * t)]


def kinds(flow, starts, at):
    """What the starts settle on."""
    return [one.kind for one in flow.population().settle(np.array(starts), at)[0]]


def test_each_start_reaches_what_its_radius_says():
    flow = cv.FlowProblem(radial, [0.1, 0.0], {"m": -0.1})
    population = flow.population("m", box=[(-1.5, 1.5), (-1.5, 1.5)])
    starts = population.starts(64, 3, -0.1)
    motions, index, mirrored = population.settle(starts, -0.1)
    inside = (starts**2).sum(axis=1) < (1.0 - np.sqrt(0.6)) / 2.0
    words = np.array([motions[k].word for k in index])
    assert len(motions) == 2 and (words == np.where(inside, "equilibrium", "cycle")).all()
    assert not mirrored.any()


def test_what_escapes_and_what_does_not_recur():
    lorenz = cv.FlowProblem(
        lambda x, p: [10 * (x[1] - x[0]), p.r * x[0] - x[1] - x[0] * x[2], x[0] * x[1] - 8 / 3 * x[2]],
        [1.0, 1.0, 20.0],
        {"r": 28.0},
    )
    motions, index, _ = lorenz.population().settle(np.array([[1.0, 2.0, 20.0]]), 28.0)
    assert [m.kind for m in motions] == ["chaotic"]
    assert (
        abs(motions[0].exponent - 0.9056) < 4 * motions[0].error + 0.05
    )  # Sprott, Chaos and Time-Series Analysis, 2003
    away = cv.FlowProblem(lambda x, p: [x[0] ** 2 + p.a], [0.0], {"a": 1.0})
    assert kinds(away, [[0.0], [1.0]], 1.0) == ["escaped"]


def test_two_rates_that_share_no_period_make_a_torus():
    def rings(x, p):
        pairs = landau(x[:2], p), landau(x[2:], p)
        return [*pairs[0], *(2**0.5 * rate for rate in pairs[1])]

    flow = cv.FlowProblem(rings, [0.5, 0.1, 0.5, 0.1], {"mu": 1.0})
    motions, _, _ = flow.population().settle(np.array([[0.6, 0.1, 0.9, 0.3], [0.2, 0.9, -0.4, 0.3]]), 1.0)
    assert [(m.kind, round(m.exponent, 2)) for m in motions] == [("quasi-periodic", 0.0)]


def test_basins_of_a_forced_flow():
    flow = cv.FlowProblem(duffing, [0.0, 0.0], {"omega": 1.6}, period=lambda p: 2 * np.pi / p.omega)
    found = cv.basins(flow, over="omega", at=1.6, plane=("x0", "x1"), points=6)
    assert [a.word for a in found.attractors] == ["cycle", "cycle"]
    for i, j in ((0, 0), (3, 2)):
        start = [found.x[j], found.y[i]]
        end = run(duffing, start, 400 * np.pi / 1.6, 1e-9, omega=1.6)
        assert np.abs(end - flow.attractor(start).states[0]).max() < 1e-4
        assert found.states[found.index[i, j]] == pytest.approx(end, abs=1e-4)
    assert str(found).count("cycle through x0 = ") == 2  # both are called so
    assert set(found.index.ravel().tolist()) == {0, 1}


def test_mirror_images_of_a_forced_flow_are_one_motion_half_a_period_later():
    """Two wells: the same starts are shared out alike with and without the symmetry."""

    def wells(mirror):
        flow = cv.FlowProblem(
            lambda x, p, t: [x[1], -0.3 * x[1] + x[0] - x[0] ** 3 + p.g * np.cos(1.2 * t)],
            [1.0, 0.0], {"g": 0.1}, period=2 * np.pi / 1.2, mirror=mirror,
        )  # fmt: skip
        population = flow.population("g", box=[(-2, 2), (-2, 2)])
        return flow, population.settle(population.starts(32, 0, 0.1), 0.1)

    _, (apart, index, _) = wells(None)
    flow, (motions, together, mirrored) = wells(lambda x: -x)
    assert (len(apart), len(motions)) == (2, 1)
    assert (together == 0).all()
    assert (mirrored == (index != index[0])).all() or (mirrored == (index == index[0])).all()
    problem = flow.attractor([1.0, 0.0], g=0.1).problem("g")
    other = flow.attractor([-1.0, 0.0], g=0.1)
    listed = [one for one in problem.simulated_attractors(0.1) if one["kind"] == "periodic"]
    for orbit in (flow.attractor([1.0, 0.0], g=0.1), other):
        known = flow.known(orbit.problem("g"), orbit.u, 0.1)
        assert known["u"] == pytest.approx(listed[0]["u"], rel=1e-4)


def test_what_a_stiff_flow_settles_on():
    """A third state follows the first one of a van der Pol oscillator within a millionth of its time scale."""
    plain = cv.FlowProblem(born, [1.0, 0.0], {"a": 0.5})
    stiff = cv.FlowProblem(lambda x, p: [*born(x, p), -1e6 * (x[2] - x[0])], [1.0, 0.0, 0.0], {"a": 0.5})
    assert stiff.attractor().period == pytest.approx(plain.attractor().period, rel=1e-6)
    assert kinds(stiff, [[1.0, 0.5, 0.0]], 0.5) == ["periodic"]


def test_in_the_plane_nothing_is_quasi_periodic():
    """At a Hopf point motions come to rest like 1 / sqrt(t)."""
    assert kinds(cv.FlowProblem(born, [1.0, 0.0], {"a": 0.0}), [[1.0, 0.5]], 0.0) == ["slow"]


def test_a_motion_that_goes_round_its_cycle_is_not_taken_for_a_longer_one():
    """Ueda's oscillator with little damping: motions from everywhere come to one cycle of one period, round which they go; after 3, 5 or 13 periods they are
    nearer to where they were than after one."""

    def ueda(x, p, t):
        return [x[1], -0.02 * x[1] - x[0] ** 3 + p.B * np.cos(t)]

    flow = cv.FlowProblem(ueda, [0.0, 0.0], {"B": 2.0}, period=2.0 * np.pi)
    orbit = flow.attractor([2.0, 2.0])
    assert run(ueda, orbit.states[0], 2.0 * np.pi, B=2.0) == pytest.approx(orbit.states[0], abs=1e-6)
    population = flow.population("B", box=[(-4.0, 4.0), (-6.0, 6.0)])
    motions, index, _ = population.settle(population.starts(30, 1, 2.0), 2.0)
    assert [motion.periods for motion in motions] == [1]
    assert not index.any()
