"""First points of a branch that leaves a special point: of that branch, and on its side of a border, however near others are."""

import numpy as np
import pytest

import contvines as cv
from contvines.problems.dense import KERNELS, DenseWork
from contvines.problems.protocol import Kernels, ProblemDefaults

NARROW = 0.05  # part of the distance between the ends of the loop by which it keeps from the outer branch


def loop(width):
    """x (A B + (NARROW width)^2) = 0 with A = p - 16 x^2 and B = p - width - 7 x^2, in units in which it is of order one.

    A = 0 leaves the trivial branch at p = 0, B = 0 at p = width; where they would cross, at 9 x^2 = width, they keep apart: what leaves
    at one place comes back at the other, and an outer branch, beyond that place, is near to both and reaches neither.
    """

    def equations(u, p):
        x = u[0]
        product = (p - 16.0 * x**2) * (p - width - 7.0 * x**2) + (NARROW * width) ** 2
        return np.array([x * product / width**2])

    return cv.AlgebraicProblem(equations, [0.0], -0.5 * width)


@pytest.mark.parametrize("width", [1e-4, 1e-5, 2e-6, 3e-7])
def test_a_small_loop_is_not_taken_for_the_branch_outside_it(width):
    """Both ends solve p (p - width) + (NARROW width)^2 = 0; x^2 is largest where the discriminant of A B + ... = 0 vanishes."""
    graph = cv.diagram(loop(width), within=(-0.5 * width, 1.5 * width), depth=1)
    root = np.sqrt(0.25 - NARROW**2)
    ends = sorted(p.value for p in graph.of_kind("branch-point"))
    assert ends == pytest.approx([(0.5 - root) * width, (0.5 + root) * width], rel=1e-6)
    side = graph["B2"]
    assert np.abs(side.points[:, 0]).max() <= np.sqrt((1.0 - 2.0 * NARROW) * width / 9.0) * (1.0 + 1e-9)
    assert np.abs(side.points[:, 0]).max() >= 0.9 * np.sqrt((1.0 - 2.0 * NARROW) * width / 9.0)


class Walled(ProblemDefaults):
    """x (p - x^2) = 0 between walls at x = -room and room: of the parabola that leaves at p = 0 so much is real."""

    dimension, n_margins, u0, p0 = 1, 1, np.array([0.0]), -0.5

    def __init__(self, room):
        self.data, self.room = self, room
        self.kernels = Kernels(KERNELS.linearise, KERNELS.bordered, self.inspect)

    def workspace(self):
        return DenseWork(1)

    def equations(self, u, p):
        x = u[0]
        return np.array([x * (p - x**2)]), np.array([[p - 3.0 * x**2]]), np.array([x])

    @staticmethod
    def inspect(data, u, p, work, row):
        row[0] = data.room - abs(u[0])

    def margin_kind(self, j):
        return "wall-graze"


@pytest.mark.parametrize("virtual", [False, True])
@pytest.mark.parametrize("room", [1e-2, 1e-3, 3e-4, 1e-5])
def test_a_branch_that_is_real_only_close_to_where_it_leaves(room, virtual):
    """It ends at x = room, where p = room^2, on both sides."""
    graph = cv.diagram(Walled(room), within=(-0.5, 0.5), depth=1, virtual=virtual)
    side = next(branch for branch in graph if branch.seed == "BP1")
    assert side.real
    assert sorted(side.points[[0, -1], 0]) == pytest.approx([-room, room], rel=1e-6)
    assert graph["WG1"].value == pytest.approx(room**2, rel=1e-6)
    assert np.abs(side.points[:, 0]).max() <= room * (1.0 + 1e-6)
