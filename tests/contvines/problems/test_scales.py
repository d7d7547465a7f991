"""Units do not matter: the same graph for unknowns, parameter and rows in units from 1e-9 to 1e9, each unknown in its own."""

import numpy as np
import pytest

import contvines as cv
from tools.demos import equilibria as eq
from tools.demos import listed
from tools.demos.demo import NUMBERS

CASES = [demo for demo in listed.DEMOS if demo.name in ("bazykin", "pp2", "ab", "oxidation of CO", "cusp")]
UNITS = [
    (1e9, 1e-9, 1e9),
    ([1e9, 1e-9, 1e4], 1.0, 1.0),
    ([1e-9, 1e9, 1.0], 1e9, [1e9, 1e-9, 1.0]),
]


def points(demo, units, unit, rows):
    """Kind, value and unknowns of the special points, in the units of the source."""
    units, rows = (np.resize(np.asarray(part, dtype=float), len(demo.u)) for part in (units, rows))
    problem = cv.AlgebraicProblem(
        lambda v, q: rows * demo.function(v / units, q / unit), units * demo.u, unit * demo.p
    )
    graph = cv.diagram(problem, within=tuple(unit * end for end in demo.within), depth=2)
    return sorted((s.kind, s.value / unit, *(s.u / units)) for s in graph.special.values())


@pytest.fixture(scope="module")
def plain():
    return {demo.name: points(demo, 1.0, 1.0, 1.0) for demo in CASES}


@pytest.mark.parametrize("demo", CASES, ids=lambda demo: demo.name)
@pytest.mark.parametrize("units", UNITS, ids=str)
def test_special_points_do_not_depend_on_units(plain, demo, units):
    found, expected = points(demo, *units), plain[demo.name]
    assert [row[0] for row in found] == [row[0] for row in expected]
    width = demo.within[1]
    for one, other in zip(found, expected):
        assert one[1] == pytest.approx(other[1], rel=1e-10, abs=1e-12 * width)


def test_eigenvalues_and_coefficients_in_other_units():
    """u' = F: Hopf points, their frequency, and l1 per square of the unit."""

    def of(unit):
        problem = cv.AlgebraicProblem(
            lambda v, q: unit * np.array(eq.ab(v / unit, q, NUMBERS)), [0.0, 0.0], 0.0, spectrum="flow"
        )
        return cv.diagram(problem, within=(0.0, 0.15)).of_kind("hopf")[0]

    one, large = of(1.0), of(1e7)
    assert large.value == pytest.approx(one.value, rel=1e-12)
    assert large.frequency == pytest.approx(one.frequency, rel=1e-9)
    assert large.coefficient * 1e14 == pytest.approx(one.coefficient, rel=1e-5)


def test_where_nothing_can_tell_a_sentence_says_so():
    """u1 is zero all along, alone in its equation and linear there: F(c u1) = c F(u1)."""
    for rate, said in ((0.0, "does not show how large u1 may become"), (1.0, "")):
        problem = cv.AlgebraicProblem(
            lambda u, p, rate=rate: [p * u[0] - u[0] ** 3, rate * u[0] - 3.0 * u[1]], [0.0, 0.0], -1.0
        )
        start = cv.diagram(problem, within=(-1.0, 1.0)).start
        assert said in start and bool(said) == bool(start)


def test_a_two_cycle_begins_without_a_fold():
    """Hassell's map in units of 1e9: beside its flip p is known to 1e-9 only, and turns back there by rounding."""

    problem = cv.MapProblem(lambda x, rate: rate * x / (1.0 + x / 1e9) ** 6, [0.0], 0.5)
    graph = cv.diagram(problem, within=(0.1, 40.0), depth=2)
    assert not graph.of_kind("fold")
    assert graph.of_kind("period-doubling")[0].value == pytest.approx((1.0 - 2.0 / 6.0) ** -6, rel=1e-12)


@pytest.mark.parametrize(("unit", "row"), [(1.0, 1.0), (1e9, 1e9), (1e9, 1e-9)])
def test_a_pair_that_passes_the_axis_is_no_branch_point(unit, row):
    """Eigenvalues p +- i on the zero solution: F_u is nowhere singular."""

    def F(v, q):
        x, y, p = v[0] / unit, v[1] / unit, q / 1e-9
        size = x * x + y * y
        return row * np.array([p * x - y - x * size, x + p * y - y * size])

    graph = cv.diagram(cv.AlgebraicProblem(F, [0.0, 0.0], -1e-9), within=(-1e-9, 1e-9))
    assert {s.kind for s in graph.special.values()} == {"end"}


def test_a_start_where_a_fold_meets_a_hopf_point():
    """The branch x^2 = -p, with eigenvalues x +- i across it."""

    def F(u, p):
        x, y, z = u
        return [p + x * x - y * y, x * y - z, y + x * z]

    graph = cv.diagram(cv.AlgebraicProblem(F, np.zeros(3), 0.0), within=(-1.0, 1.0))
    assert graph["B1"].range == pytest.approx((-1.0, 0.0), abs=1e-9)
