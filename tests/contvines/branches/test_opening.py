"""First points of a branch that leaves a special point: of that branch, and on its side of a border, however near others are; and every point once, in order."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.lines import Line

NARROW = 0.05  # part of the distance between the ends of the loop by which it keeps from the outer branch


@pytest.mark.parametrize("width", [1e-4, 1e-5, 2e-6, 3e-7])
def test_a_small_loop_is_not_taken_for_the_branch_outside_it(width):
    """x (A B + (NARROW width)^2) = 0 with A = p - 16 x^2 and B = p - width - 7 x^2, in units in which it is of order one.

    A = 0 leaves the trivial branch at p = 0, B = 0 at p = width; where they would cross, at 9 x^2 = width, they keep apart: what leaves
    at one place comes back at the other, and an outer branch, beyond that place, is near to both and reaches neither.
    Both ends solve p (p - width) + (NARROW width)^2 = 0; x^2 is largest where the discriminant of A B + ... = 0 vanishes.
    """

    def equations(u, p):
        product = (p - 16.0 * u**2) * (p - width - 7.0 * u**2) + (NARROW * width) ** 2
        return u * product / width**2

    problem = cv.AlgebraicProblem(equations, [0.0], -0.5 * width)
    graph = cv.diagram(problem, within=(-0.5 * width, 1.5 * width), depth=1)
    root = np.sqrt(0.25 - NARROW**2)
    ends = sorted(p.value for p in graph.of_kind("branch-point"))
    assert ends == pytest.approx([(0.5 - root) * width, (0.5 + root) * width], rel=1e-6)
    largest, farthest = np.sqrt((1.0 - 2.0 * NARROW) * width / 9.0), np.abs(graph["B2"].points[:, 0]).max()
    assert 0.9 * largest <= farthest <= largest * (1.0 + 1e-9)


@pytest.mark.parametrize("virtual", [False, True])
@pytest.mark.parametrize("room", [1e-2, 1e-3, 3e-4, 1e-5])
def test_a_branch_that_is_real_only_close_to_where_it_leaves(room, virtual):
    """x (p - x^2) = 0 between walls at x = -room and room: the parabola that leaves at p = 0 ends there, where p = room^2, on both sides."""
    walled = Line(
        lambda u, p: [room - abs(u)],
        lambda u, p: [],
        lambda u, p: (u * (p - u**2), p - 3.0 * u**2, u),
        (0.0, -0.5),
    )
    graph = cv.diagram(walled, within=(-0.5, 0.5), depth=1, virtual=virtual)
    side = next(branch for branch in graph if branch.seed == "BP1")
    assert side.real
    assert sorted(side.points[[0, -1], 0]) == pytest.approx([-room, room], rel=1e-6)
    assert graph["VG1"].value == pytest.approx(room**2, rel=1e-6)
    assert np.abs(side.points[:, 0]).max() <= room * (1.0 + 1e-6)


def test_branch_points_closer_than_roundoff_beside_a_point_of_the_branch():
    """Two pitchforks 6e-13 apart at p = 0, where the trivial branch has a point."""

    def f(u, p):
        return [u[0] * (p - u[0] ** 2 + 0.3 * u[1]), u[1] * (p - 5.683e-13 - u[1] ** 2)]

    steps = {"first_step": 0.5, "max_step": 0.5, "max_branches": 1}
    problem = cv.AlgebraicProblem(f, [0.0, 0.0], -0.5, spectrum="flow")
    branch = cv.diagram(problem, within=(-0.5, 0.5), settings=steps)["B1"]
    assert (np.diff(branch.values) >= -1e-12).all()
    assert (branch.values == 0.5).sum() == 1
