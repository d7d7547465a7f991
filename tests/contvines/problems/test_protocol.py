"""The protocol is complete: every kind of problem answers all of it, and what does not is refused with a sentence."""

import numpy as np
import pytest

import contvines as cv
import orbits
from contvines.loci.problem import LocusProblem
from contvines.problems.protocol import MEMBERS, Problem
from orbits.problem import OrbitProblem
from tests.machines import ABSORBER
from tools.pages.pages import page


def checked_by_pyright(
    a: cv.AlgebraicProblem, b: cv.MapProblem, c: LocusProblem, d: OrbitProblem, e: OrbitProblem
) -> list[Problem]:
    """Never called: the type checker compares the signatures."""
    return [a, b, c, d, e]


def problems():
    circle = cv.AlgebraicProblem(lambda u, p: u**2 + p.a**2 - p.r, [1.0], {"a": 0.0, "r": 1.0})
    params = ABSORBER.vector({"amplitude": 0.01})
    return [
        circle,
        LocusProblem(circle, "fold", "r"),
        cv.MapProblem(lambda x, p: p * x * (1.0 - x), [0.5], 2.0),
        OrbitProblem(ABSORBER, orbits.Word((), ()), 1, "amplitude", params),
        OrbitProblem(ABSORBER, orbits.Word.parse("LR"), 1, "amplitude", params),
        page("impact_oscillator").orbit("", frequency=2.0).problem("frequency"),
    ]


@pytest.mark.parametrize("problem", problems(), ids=lambda problem: type(problem).__name__)
def test_every_kind_of_problem_answers_all(problem):
    missing = [name for name in MEMBERS if not hasattr(problem, name)]
    assert not missing
    assert problem.scale_within((0.0, 1.0)).shape == (problem.dimension + 1,)
    direction = np.ones(problem.dimension)
    assert problem.amplitude(3.0 * direction) == pytest.approx(3.0 * problem.amplitude(direction))
