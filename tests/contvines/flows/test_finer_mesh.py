"""Branches whose cycles ask for more intervals on the way: what has been found stays, and goes on on the finer mesh."""

import numpy as np
import pytest

import contvines as cv
from contvines.graph.persistence import same_graph
from tests.contvines.flows.shooting import cycle, nerve, neuron, prey_and_predator, van_der_pol


def flow():
    return cv.FlowProblem(nerve, [-1.0, -0.5], {"current": 0.0, "e": 0.08})


WHOLE = {"over": "current", "within": (0.0, 2.0)}


@pytest.fixture(scope="module")
def told():
    """A graph, and the numbers of points of its cycles that were told on the way."""
    numbers: list[int] = []

    def listen(state):
        words = state.message.split()
        if "B2:" in words:
            numbers.append(int(words[words.index("B2:") + 1]))

    return cv.diagram(flow(), progress=listen, **WHOLE), numbers


def test_cycles_on_a_mesh_that_becomes_too_coarse_are_not_followed_again(told):
    graph, numbers = told
    assert graph.branches["B2"].problem.intervals > 20  # with which cycles begin
    assert numbers == sorted(numbers) and numbers


def test_cycles_from_before_and_behind_are_those_of_a_simulation(told):
    """DOP853 goes once round each; by hand: Hopf points where the trace vanishes, x^2 = 1 - 0.064."""
    graph, _ = told
    x = np.sqrt(1.0 - 0.064)
    hopf = [x**3 / 3 - x + (x + 0.7) / 0.8, -(x**3) / 3 + x + (0.7 - x) / 0.8]
    assert [point.value for point in graph.of_kind("hopf")] == pytest.approx(sorted(hopf), abs=1e-9)
    cycles = graph.branches["B2"]
    for i in range(2, len(cycles) - 2, 20):
        if max(np.abs(cycles.multipliers[i])) < 1e3:
            orbit = cycles.orbit(i)
            assert orbit.replay() < 1e-4  # beside the canards a simulation loses digits
            assert orbit.multipliers == pytest.approx(cycles.multipliers[i], rel=1e-4, abs=1e-6)


def test_folds_of_canards_where_the_parameter_stands_still(told):
    """v -> -v, w -> 7/4 - w, I -> 7/4 - I leaves all as it is. Between the folds and their Hopf points the parameter keeps 15 digits."""
    graph, _ = told
    one, other = graph.of_kind("fold")
    assert one.value + other.value == pytest.approx(1.75, abs=1e-11)
    # the growth along the cycle, the integral of 1 - v^2 - 0.064, is zero at a fold (Liouville)
    x = one.orbit(np.linspace(0.0, one.orbit.period, 20001))[:-1, 0]
    assert np.mean(1.0 - x**2 - 0.064) * one.orbit.period == pytest.approx(0.0, abs=1e-5)
    assert np.abs(np.diff(graph["B2"].stable.astype(int))).sum() == 2  # stable between the folds alone


def test_a_run_with_a_journal_goes_on_on_the_finer_mesh(told, tmp_path):
    graph, _ = told
    for _ in range(2):
        with cv.resume(tmp_path / "x.vines") as journal:
            assert same_graph(cv.diagram(flow(), journal=journal, **WHOLE), graph)


def test_both_sides_of_a_start_come_to_the_same_mesh():
    """Van der Pol's period tends to 2 pi, and to (3 - 2 ln 2) mu (Cartwright, with his terms up to mu^(-1/3))."""
    vdp = cv.FlowProblem(van_der_pol, [1.0, 0.0], {"mu": 1.0}, mirror=lambda x: -x)
    branch = cv.diagram(vdp.attractor(mu=2.0), over="mu", within=(0.01, 100.0)).branches["B1"]
    periods, mu = branch.measure("period"), branch.values
    low, high = int(np.argmin(mu)), int(np.argmax(mu))
    assert periods[low] == pytest.approx(2 * np.pi * (1 + mu[low] ** 2 / 16), abs=1e-7)
    assert periods[high] == pytest.approx((3 - 2 * np.log(2)) * 100 + 7.014 / 100 ** (1 / 3), rel=2e-3)
    assert abs(branch.orbit(low).period_error) < 1e-6
    assert branch.orbit(high).replay() < 1e-4


@pytest.mark.slow
def test_a_branch_that_comes_to_a_cycle_of_half_the_period_ends_there():
    """Hindmarsh's and Rose's neuron: a burst of two spikes becomes one spike, whose period doubling is that of a shooting with DOP853.

    The spikes are so sharp that a step passes by the cycle of half the period, behind which the branch comes back.
    """
    flow = cv.FlowProblem(neuron, [-1.6, -12.0, 0.0], {"current": 0.0})
    graph = cv.diagram(flow, over="current", within=(0.0, 5.0), depth=1)
    branch = graph.branches["B2"]
    labels = [label for _, label in branch.marks]
    assert len(set(labels)) == len(labels) and not graph.of_kind("branch-point")
    assert graph.special[labels[-1]].kind == "period-doubling"
    assert branch.values[-1] == pytest.approx(3.5444385833, abs=1e-8)
    assert branch.orbit(len(branch) - 1).period == pytest.approx(2 * 28.973487936, abs=1e-5)


def test_cycles_near_rounding_have_the_periods_of_shooting_in_logarithms():
    """The prey falls to 1e-14 of its largest number."""

    def in_logarithms(y, p):
        return prey_and_predator(np.exp(y), p) / np.exp(y)

    flow = cv.FlowProblem(prey_and_predator, [0.2, 0.0], {"k": 0.1})
    graph = cv.diagram(flow, over="k", within=(0.1, 10.0))
    cycles = next(b for b in graph if b.description["word"] == "cycle")
    for i in (len(cycles) // 2, len(cycles) - 8):
        orbit = cycles.orbit(i)
        period, _ = cycle(in_logarithms, np.log(orbit.states[0]), orbit.period, k=cycles.values[i])
        assert orbit.period == pytest.approx(period, rel=1e-5)
