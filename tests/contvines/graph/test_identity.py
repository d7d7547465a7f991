"""Identity of solutions and branches, apart from any diagram."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import contvines as cv
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings
from contvines.graph.identity import Register, same_form


def two_cycle(r):
    root = np.sqrt((r - 3.0) * (r + 1.0))
    return np.array([r + 1.0 - root, r + 1.0 + root]) / (2.0 * r)


def logistic(points, r):
    """The canonical form of a cycle of the logistic map."""
    problem = cv.MapProblem(lambda x, r: r * x * (1 - x), points, r, cycle=len(points))
    return problem.canonical(points, r)


@settings(max_examples=40)
@given(st.floats(3.05, 3.4), st.integers(0, 3), st.sampled_from([1, 2, 4]))
def test_a_cycle_is_the_same_from_any_point_and_any_number_of_times_and_no_fixed_point(r, turn, repeat):
    cycle, fixed = two_cycle(r), np.full(2, 1.0 - 1.0 / r)
    assert same_form(logistic(np.roll(np.tile(cycle, repeat), turn), r), logistic(cycle, r))
    assert not same_form(logistic(fixed, r), logistic(cycle, r))
    assert same_form(logistic(fixed, r), logistic(fixed[:1], r))


def test_mirror_images_are_one():
    problem = cv.AlgebraicProblem(lambda x, p: p * x - x**3, [0.0], -0.5, mirror=lambda x: -x)
    one, other, rest = (problem.canonical(np.array([x]), 0.25) for x in (0.5, -0.5, 0.0))
    assert same_form(one, other) and not same_form(one, rest)


def test_the_end_of_a_branch_belongs_to_it():
    """At a fold, where a branch is cut, no other point of it has the value: its end itself is compared."""
    problem = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1, [1.0], 0.0)
    branch = cv.diagram(problem, within=(-0.6, 0.6))["B1"]
    register = Register()
    register.add(branch, Engine(branch.problem, (-0.6, 0.6), Settings()))
    for i in (0, -1):
        beyond = float(branch.values[i]) * (1.0 + 1e-8)
        u = np.array([np.sqrt(1 - beyond**2)])
        assert register.find(branch.problem, u, beyond) is branch
        assert register.find(branch.problem, -u, beyond) is None
