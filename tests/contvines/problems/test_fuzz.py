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


def test_an_unknown_that_rounding_has_moved_from_zero_has_no_scale():
    # its first unknown is 1e-29 all along: steps as small never end
    seed, system = next(iter(suitable(5058)))
    assert seed == 5058
    assert system.wrong() == []


def test_a_double_eigenvalue_that_rounding_parts_is_no_event():
    # det F_u is the same all along and both eigenvalues relative to the start's are 1; a pair or two real ones, by rounding
    assert System(5131).wrong() == []


def test_rounding_of_a_badly_conditioned_matrix_is_no_branch_point():
    # x = -3 / (3 p^2 + p), hidden behind matrices whose entries grow like x while their determinant is 3 p^2 + p
    p0 = -1.0 / 6.0
    system = System(5592)
    u0 = system.unknowns(-3.0 / (3.0 * p0**2 + p0), p0)
    graph = cv.diagram(cv.AlgebraicProblem(system.F, u0, p0, scale=[500.0, 1000.0]), within=(-0.3, -0.0004))
    assert {s.kind for s in graph.special.values()} == {"end"}
    assert len(graph) == 1


def test_rounding_far_out_is_no_length():
    # 6 x^2 comes and goes again with another row: only its rounding bends, at 1e15
    assert System(6548).wrong() == []


def test_a_branch_that_is_crossed_at_a_small_angle_while_it_bends_away():
    # x = 0 crosses another branch, whose other unknowns are 24 x^2: beside the crossing that one is met first, and again
    assert System(9879).wrong() == []


def test_a_branch_that_leaves_at_so_small_an_angle_that_its_first_points_count_as_the_same():
    # x (x - 1) (p - 3 x) = 0: x = p / 3 leaves x = 0 at an angle of 0.0016 in units of unknowns of which the largest is 500
    assert System(21265).wrong() == []


def test_signs_far_up_a_pole_are_those_of_rounding():
    # x = p^3 - 1/p, followed to x = -5e4, where the entries of the matrix are 5e9 and its determinant 2e-5
    assert System(51188).wrong() == []


@pytest.mark.parametrize("seed", [60620, 61453])
def test_sizes_that_rounding_makes_are_none(seed):
    # y = 4e-16 at the start, which is a rounded zero; 1e16, where an unknown that cancels in a row has rounded all others away
    assert System(seed).wrong() == []


def test_a_fold_is_no_end_at_a_pole():
    # the distance doubles while the parameter stands still: p^2 = x^2 - x + 1 turns at x = 1/2 and goes on to x = 1.95
    assert System(100208).wrong() == []


def test_a_nearer_point_of_a_bent_branch_is_none_of_the_known_one():
    # p = 1 - 2 x^2 leaves x = 0, bent so much (radius 1/800) that its first point is beside its tangent as far as along it
    assert System(101051).wrong() == []


def test_a_rounded_zero_beside_terms_of_the_parameter_has_no_size():
    # y = -1e-16 in a row in which the other unknown is multiplied by y: 9 p + 3 alone is what it is small beside
    assert System(101437).wrong() == []


def test_a_corner_that_unlike_sizes_hide():
    # x (2 p + 3 x^2 + 3) = 0 behind unknowns hundreds of times as large
    assert System(434).wrong() == []


def test_two_eigenvalues_next_to_nothing_are_no_exchange():
    # x = 1 / (p^2 (p - 1)): two eigenvalues of 1e-5 on either side of zero
    assert System(101778).wrong() == []


def test_two_eigenvalues_next_to_nothing_in_units_of_a_distant_start_are_no_exchange():
    # x = 5 / p, begun near p = 0.05, where the equations are a million times as large
    assert System(201015).wrong() == []
