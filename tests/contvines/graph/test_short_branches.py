"""Short branches beyond borders, branches that only pass by, and such that are none; with the toy of the borders' tests."""

import numpy as np
import pytest

import contvines as cv
from contvines.problems.protocol import Seed
from tests.contvines.graph.test_borders import Line


@pytest.mark.parametrize("gap", [1e-9, 1e-7, 3e-6, 0.02])
def test_a_branch_that_passes_by_does_not_begin_at_the_border(gap):
    """Word "b" lasts from 1/2 + gap to 0.9: a seed on it is real and close, but nothing joins it to the border at 1/2."""

    def passing(line, point):
        other = Line("b", -0.5, 2.0, [1.0, -1.0], [0.5 + gap, 0.9])
        return Seed(other, np.array([0.56]), 0.53, None, "border", "persistence", True)

    graph = cv.diagram(Line("a", 0.0, 1.0, [-1.0], [0.5], [passing]), within=(0.0, 1.0))
    assert list(graph.branches) == ["B1"] and not graph.switches
    assert [point.value for point in graph.special.values() if point.kind != "end"] == pytest.approx([0.5])
    assert "does not begin here" in graph["VG1"].note


@pytest.mark.parametrize("width", [2e-3, 2e-4, 3e-5])
def test_a_short_branch_on_which_the_parameter_hardly_moves_is_followed(width):
    """Word "b": u from 1/2 to 1/2 + width, while p changes by 1e-9 of that, as where the speed of an impact grows from nothing."""

    class Steep(Line):
        def equations(self, u, p):
            return np.array([p - 0.5 - 1e-9 * (u[0] - 0.5)]), np.array([[-1e-9]]), np.array([1.0])

        def margins(self, u, p):
            return np.array([u[0] - 0.5, 0.5 + width - u[0]])

    def steep(line, point):
        other = Steep("b", 0.0, 1.0, [1.0, 1.0], [0.0, 0.0])
        return Seed(other, np.array([0.5 + 1e-7]), 0.5 + 1e-16, None, "border", "persistence", True)

    graph = cv.diagram(Line("a", 0.0, 1.0, [-1.0], [0.5], [steep]), within=(0.0, 1.0))
    assert graph["B2"].description["word"] == "b"
    ends = sorted(float(u) for u in graph["B2"].points[[0, -1], 0])
    assert ends == pytest.approx([0.5, 0.5 + width], abs=1e-9)
