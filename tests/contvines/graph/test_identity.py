"""Identity of solutions and branches, apart from any diagram."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import contvines as cv
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings
from contvines.graph.identity import Register, same_form


def logistic(x, r):
    return r * x * (1 - x)


def two_cycle(r):
    root = np.sqrt((r - 3.0) * (r + 1.0))
    return np.array([r + 1.0 - root, r + 1.0 + root]) / (2.0 * r)


PROBLEM = cv.MapProblem(logistic, two_cycle(3.2), 3.2, cycle=2)


@settings(max_examples=40, deadline=None)
@given(st.floats(3.05, 3.4), st.integers(0, 3), st.sampled_from([1, 2, 4]))
def test_a_cycle_is_the_same_from_any_point_and_any_number_of_times(r, turn, repeat):
    cycle = two_cycle(r)
    written = np.roll(np.tile(cycle, repeat), turn)
    problem = cv.MapProblem(logistic, written, r, cycle=2 * repeat)
    assert same_form(problem.canonical(written, r), PROBLEM.canonical(cycle, r))


def test_a_fixed_point_is_not_the_two_cycle():
    fixed = np.full(2, 1.0 - 1.0 / 3.2)
    assert not same_form(PROBLEM.canonical(fixed, 3.2), PROBLEM.canonical(two_cycle(3.2), 3.2))
    assert same_form(
        PROBLEM.canonical(fixed, 3.2), cv.MapProblem(logistic, fixed[:1], 3.2).canonical(fixed[:1], 3.2)
    )


def test_mirror_images_are_one():
    problem = cv.AlgebraicProblem(lambda x, p: p * x - x**3, [0.0], -0.5, mirror=lambda x: -x)
    assert same_form(problem.canonical(np.array([0.5]), 0.25), problem.canonical(np.array([-0.5]), 0.25))
    assert not same_form(problem.canonical(np.array([0.5]), 0.25), problem.canonical(np.array([0.0]), 0.25))


def test_the_end_of_a_branch_belongs_to_it():
    """At a fold, where a branch is cut, no other point of it has the value: its end itself is compared."""
    problem = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1, [1.0], 0.0)
    graph = cv.diagram(problem, within=(-0.6, 0.6))
    branch = graph["B1"]
    register = Register()
    register.add(branch, Engine(branch.problem, (-0.6, 0.6), Settings()))
    for i in (0, -1):
        beyond = float(branch.values[i]) * (1.0 + 1e-8)
        assert register.find(branch.problem, np.array([np.sqrt(1 - beyond**2)]), beyond) is branch
        assert register.find(branch.problem, np.array([-np.sqrt(1 - beyond**2)]), beyond) is None
