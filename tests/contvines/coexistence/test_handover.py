"""What follows a motion that ceases to be stable: cascades, symmetry breaking, and where chaos ends, against closed forms."""

import numpy as np
import pytest

import contvines as cv
from contvines.coexistence.places import Handover, loose_ends
from contvines.continuation.settings import Settings
from contvines.graph.builder import adopt
from contvines.graph.run import Run
from contvines.journal import NullJournal


def logistic(x, p):
    return p * x * (1 - x)


def run_on(graph):
    run = Run(graph, Settings(), NullJournal(), 0, False, None, None)
    adopt(run)
    return run


def followed(problem, within, box):
    """All that follows the motions of a diagram without depth, past the ends of their stability."""
    graph = cv.diagram(problem, within=within, depth=0)
    handover = Handover(run_on(graph), problem.population(box=box))
    return [(end, handover.follow(end)) for end in handover.left()]


def test_a_fixed_point_that_doubles_hands_over_to_the_cycle_of_two():
    """x -> p x (1 - x) doubles at 3; then x = (p + 1 +- sqrt((p - 3)(p + 1))) / 2 p (R. M. May, Nature 261 (1976) 459)."""
    problem = cv.MapProblem(logistic, [0.6], 2.5)
    ((end, found),) = followed(problem, (2.2, 3.4), [(0.01, 0.99)])
    assert end.value == pytest.approx(3.0, abs=1e-9) and end.side == 1.0
    told = [counted for counted in found if counted.attractor.kind != "slow"]  # right beside the doubling
    assert told
    for counted in told:
        p, about = counted.attractor.value, counted.attractor
        assert (about.kind, about.periods, about.starts, about.share) == ("periodic", 2, 0, 0.0)
        root = np.sqrt((p - 3) * (p + 1))
        assert counted.u is not None
        assert np.sort(counted.u) == pytest.approx(
            [(p + 1 - root) / (2 * p), (p + 1 + root) / (2 * p)], abs=1e-8
        )


def test_what_the_graph_goes_on_with_is_not_followed():
    """With the cycle of two on the graph only its own end, 1 + sqrt(6), is open."""
    graph = cv.diagram(cv.MapProblem(logistic, [0.6], 2.5), within=(2.2, 3.5), depth=1)
    (end,) = loose_ends(graph)
    assert end.value == pytest.approx(1 + np.sqrt(6), abs=1e-9) and end.side == 1.0


def test_a_symmetric_motion_hands_over_to_what_has_lost_the_symmetry():
    """x -> p x - x^3: 0 is stable up to 1, then +-sqrt(p - 1). A start on 0 itself would stay there for ever."""
    problem = cv.MapProblem(lambda x, p: p * x - x**3, [0.0], 0.5)
    ((end, found),) = followed(problem, (0.2, 1.5), [(-1.0, 1.0)])
    assert end.value == pytest.approx(1.0, abs=1e-9)
    near = [c for c in found if c.attractor.kind == "periodic"]
    assert near
    for counted in near:
        p = counted.attractor.value
        assert counted.u is not None and abs(counted.u[0]) == pytest.approx(np.sqrt(p - 1.0), abs=1e-6)


def test_the_motion_beyond_a_fold_is_found():
    """x -> x + 0.5 (p + x - x^3): the lower state ends in a fold at p = 2 / sqrt(27); the upper one takes over, a real root of the cubic."""
    problem = cv.MapProblem(lambda x, p: x + 0.5 * (p + x - x**3), [-1.1], 0.0)
    fold = 2 / np.sqrt(27)
    ends = [
        (e, f)
        for e, f in followed(problem, (-0.2, 0.6), [(-1.5, 1.5)])
        if abs(e.value - fold) < 1e-9 and e.side > 0
    ]
    ((_, found),) = ends
    for counted in found:
        (upper,) = [r.real for r in np.roots([-1, 0, 1, counted.attractor.value]) if abs(r.imag) < 1e-12]
        assert counted.u is not None and counted.u[0] == pytest.approx(upper, abs=1e-8)


@pytest.mark.slow
def test_an_atlas_goes_down_a_cascade_of_its_own_accord():
    """Starts at 2.6 alone: the doublings at 3, 1 + sqrt(6) and 3.5440903596 (published to ten digits) are on the atlas."""
    population = cv.MapProblem(logistic, [0.6], 2.6).population(box=[(0.01, 0.99)])
    graph = cv.atlas(population, within=(2.55, 3.56), values=[2.6], starts=4, depth=0, scan=8)
    doublings = np.array([point.value for point in graph.of_kind("period-doubling")])
    for value in (3.0, 1 + np.sqrt(6), 3.5440903596):
        assert np.abs(doublings - value).min() < 1e-9
    assert graph.settings["unfollowed"] == 0
    assert all(a.starts or a.share == 0.0 for a in graph.attractors)
