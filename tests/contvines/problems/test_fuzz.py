"""Random polynomial systems against resultants; ``python -m tools.fuzz.systems 500`` asks for more."""

from functools import cache
from itertools import islice

import pytest

import contvines as cv
from tools.fuzz.systems import System, suitable

pytestmark = pytest.mark.slow


@cache
def drawn():
    return list(islice(suitable(0), 12))


@pytest.mark.parametrize("number", range(12))
def test_all_branches_and_branch_points_and_no_others(number):
    _, system = drawn()[number]
    assert system.wrong() == []


SEEDS = {
    5058: "an unknown that rounding has moved from zero has no scale: it is 1e-29 all along, and steps as small never end",
    5131: "a double eigenvalue that rounding parts is no event: det F_u is the same all along, both eigenvalues relative to the start's are 1",
    6548: "rounding far out is no length: 6 x^2 comes and goes again with another row, and only its rounding bends, at 1e15",
    9879: "a branch that is crossed at a small angle while it bends away: x = 0 crosses another one, whose other unknowns are 24 x^2",
    21265: "x (x - 1) (p - 3 x) = 0: x = p / 3 leaves x = 0 at an angle of 0.0016, so that its first points count as the same",
    51188: "signs far up a pole are those of rounding: x = p^3 - 1/p, followed to -5e4, where the determinant is 2e-5 beside entries of 5e9",
    60620: "sizes that rounding makes are none: y = 4e-16 at the start, which is a rounded zero",
    61453: "sizes that rounding makes are none: 1e16, where an unknown that cancels in a row has rounded all others away",
    100208: "a fold is no end at a pole: the distance doubles while the parameter stands still, and p^2 = x^2 - x + 1 turns at x = 1/2",
    101051: "a nearer point of a bent branch is none of the known one: p = 1 - 2 x^2 leaves x = 0 with radius 1/800",
    101437: "a rounded zero beside terms of the parameter has no size: y = -1e-16 in a row in which the other unknown is multiplied by y",
    434: "a corner that unlike sizes hide: x (2 p + 3 x^2 + 3) = 0 behind unknowns hundreds of times as large",
    101778: "two eigenvalues next to nothing are no exchange: x = 1 / (p^2 (p - 1)), two eigenvalues of 1e-5 on either side of zero",
    3054: "1 / (x + 1) = p, scales of 0.03 learned on x = 0.38: the distance doubles as towards a pole long before x = 2.62 is met",
    201015: "nor in units of a distant start: x = 5 / p, begun near p = 0.05, where the equations are a million times as large",
}


@pytest.mark.parametrize("seed", SEEDS)
def test_what_one_drawing_has_shown(seed):
    assert System(seed).wrong() == [], SEEDS[seed]


def test_rounding_of_a_badly_conditioned_matrix_is_no_branch_point():
    # x = -3 / (3 p^2 + p), hidden behind matrices whose entries grow like x while their determinant is 3 p^2 + p
    p0 = -1.0 / 6.0
    system = System(5592)
    u0 = system.unknowns(-3.0 / (3.0 * p0**2 + p0), p0)
    graph = cv.diagram(cv.AlgebraicProblem(system.F, u0, p0, scale=[500.0, 1000.0]), within=(-0.3, -0.0004))
    assert {s.kind for s in graph.special.values()} == {"end"}
    assert len(graph) == 1
