"""What follows a motion that ceases to be stable: cascades, symmetry breaking, and what is beyond a fold, against closed forms."""

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


@pytest.mark.parametrize(
    ("f", "start", "within", "box", "end", "exact"),
    [
        # a doubling, then x = (p + 1 +- sqrt((p - 3)(p + 1))) / 2 p (R. M. May, Nature 261 (1976) 459)
        (logistic, (0.6, 2.5), (2.2, 3.4), (0.01, 0.99), 3.0,
         lambda p: (p + 1 + np.array([-1, 1]) * np.sqrt((p - 3) * (p + 1))) / (2 * p)),
        # 0 is stable up to 1, then +-sqrt(p - 1); a start on 0 itself would stay there for ever
        (lambda x, p: p * x - x**3, (0.0, 0.5), (0.2, 1.5), (-1.0, 1.0), 1.0, lambda p: [np.sqrt(p - 1.0)]),
        # the lower state ends in a fold; the upper one takes over, a real root of the cubic
        (lambda x, p: x + 0.5 * (p + x - x**3), (-1.1, 0.0), (-0.2, 0.6), (-1.5, 1.5), 2 / np.sqrt(27),
         lambda p: [r.real for r in np.roots([-1, 0, 1, p]) if abs(r.imag) < 1e-12]),
    ],
)  # fmt: skip
def test_what_follows_the_end_of_a_stable_stretch(f, start, within, box, end, exact):
    problem = cv.MapProblem(f, [start[0]], start[1])
    run = Run(cv.diagram(problem, within=within, depth=0), Settings(), NullJournal(), 0, False, None, None)
    adopt(run)
    handover = Handover(run, problem.population(box=[box]))
    (left,) = [one for one in handover.left() if one.side > 0.0]
    assert left.value == pytest.approx(end, abs=1e-9)
    # right beside the end some are too slow to be told
    told = [counted for counted in handover.follow(left) if counted.attractor.kind != "slow"]
    assert told
    for counted in told:
        about, expected = counted.attractor, exact(counted.attractor.value)
        assert (about.kind, about.periods, about.starts, about.share) == ("periodic", len(expected), 0, 0.0)
        assert np.sort(np.abs(counted.u)) == pytest.approx(np.array(expected), abs=1e-8)


def test_what_the_graph_goes_on_with_is_not_followed():
    """With the cycle of two on the graph only its own end, 1 + sqrt(6), is open."""
    graph = cv.diagram(cv.MapProblem(logistic, [0.6], 2.5), within=(2.2, 3.5), depth=1)
    (end,) = loose_ends(graph)
    assert end.value == pytest.approx(1 + np.sqrt(6), abs=1e-9) and end.side == 1.0


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
