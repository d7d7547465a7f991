"""Where a turn and a stick fall together the unknowns of a machine file are known to half of their digits: its border says how well.

The equations of the built-in machine stay regular there.
"""

import numpy as np
import pytest

import contvines as cv
import orbits
from tools.pages.pages import page

VALUES = {
    "damping": 0.8745771352957669,
    "mass_ratio": 0.0067354908145554546,
    "restitution": 0.7248680989676445,
    "friction": 0.5822193878683691,
    "gravity": 0.2686563668024473,
    "forcing": 3.1321977900753164,
}


def branch_of(graph: cv.Graph, word: str) -> cv.Branch:
    """The last branch of a word."""
    return [branch for branch in graph if branch.description["word"] == word][-1]


@pytest.mark.slow
def test_the_branch_beyond_a_border_is_known_by_its_stated_error() -> None:
    """Other steps, of other intervals, end at other places beside the border."""
    whole = {"over": "frequency", "within": (0.985, 1.02), "depth": 0}
    own = cv.diagram(orbits.Coupled(**VALUES).orbit("LR", frequency=1.01), **whole)
    exact = min(own[label].value for _, label in branch_of(own, "LtsRts").marks)
    sliding = branch_of(cv.diagram(page("coupled").orbit("LR", frequency=1.01, **VALUES), **whole), "LttRtt")
    first = sliding.orbit(int(np.argmin(abs(sliding.values - 0.995))))
    for low in np.linspace(0.97, 0.99, 8).tolist():
        graph = cv.diagram(
            first, over="frequency", within=(low, 0.996), depth=0, settings={"max_branches": 3}
        )
        marked = [graph[label] for _, label in branch_of(graph, "LtsRts").marks]
        border = min(marked, key=lambda point: point.value)
        assert abs(border.value - exact) <= border.location_error < 1e-9
        assert branch_of(graph, "LsRs").values.max() == pytest.approx(exact, abs=1e-9)
