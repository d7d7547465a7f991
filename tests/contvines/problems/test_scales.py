"""Units do not matter: the same graph for unknowns, parameter and rows in units from 1e-9 to 1e9, each unknown in its own."""

import json

import numpy as np
import pytest

import contvines as cv
from contvines.problems.extents import of_rounding, weighed
from contvines.problems.scales import in_fields
from tools.demos import equilibria as eq
from tools.demos import listed, maps
from tools.demos.demo import NUMBERS
from tools.demos.make_table import TABLE

CASES = {
    "bazykin": (eq.bazykin, [1.5, 1.2], 0.2, (0.05, 1.2)),
    "pp2": (eq.pp2, [0.0, 0.0], 0.0, (0.1, 1.0)),
    "ab": (eq.ab, [0.0, 0.0], 0.0, (0.0, 0.15)),
    "oxidation": (eq.oxidation, [0.0014673, 0.826167, 0.123119], 1.92373, (0.5, 1.95)),
    "cusp": (eq.cusp, [1.0], 0.0, (-1.0, 1.0)),
}
UNITS = [
    (1e-9, 1.0, 1.0),
    (1e9, 1e-9, 1e9),
    (1e-9, 1e9, 1e-9),
    ([1e9, 1e-9, 1e4], 1.0, 1.0),
    ([1e-9, 1e9, 1.0], 1e9, [1e9, 1e-9, 1.0]),
]


def points(f, u, p, within, units, unit, rows):
    """Kind, value and unknowns of the special points, in the units of the source."""
    n = len(u)
    units, rows = (np.resize(np.asarray(part, dtype=float), n) for part in (units, rows))
    problem = cv.AlgebraicProblem(
        lambda v, q: rows * np.array(f(v / units, q / unit, NUMBERS)), units * u, unit * max(p, within[0])
    )
    graph = cv.diagram(problem, within=(within[0] * unit, within[1] * unit), depth=2)
    return sorted((s.kind, s.value / unit, *(s.u / units)) for s in graph.special.values())


@pytest.fixture(scope="module")
def plain():
    return {name: points(*case, 1.0, 1.0, 1.0) for name, case in CASES.items()}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("units", UNITS, ids=str)
def test_special_points_do_not_depend_on_units(plain, name, units):
    found, expected = points(*CASES[name], *units), plain[name]
    assert [row[0] for row in found] == [row[0] for row in expected]
    width = CASES[name][3][1]
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


@pytest.mark.parametrize(("unit", "value"), [(1e-9, 1e9), (1e9, 1e-9)])
def test_cycles_of_maps(unit, value):
    problem = cv.MapProblem(
        lambda x, r: unit * np.array(maps.logistic(x / unit, r / value, NUMBERS)), [0.5 * unit], 2.5 * value
    )
    graph = cv.diagram(problem, within=(2.0 * value, 3.5 * value), depth=2)
    flips = [s.value / value for s in graph.of_kind("period-doubling")]
    assert flips == pytest.approx([3.0, 1.0 + np.sqrt(6.0)], rel=1e-12)


STARTS_AT_ZERO = [
    ("chu", "flow"),
    ("hamiltonian", "flow"),
    ("lrz", "flow"),
    ("burgers", "map"),
    ("gauss", "map"),
]


@pytest.mark.parametrize(("unit", "value"), [(1e9, 1e-9), (1e-9, 1e9)])
@pytest.mark.parametrize(("name", "kind"), STARTS_AT_ZERO)
def test_starts_at_zero_tell_their_scale(name, kind, unit, value):
    """Of unknowns that are zero, and in which the equations may be linear there, the equations have to tell what is large."""
    (demo,) = (demo for demo in [*listed.DEMOS, *maps.DEMOS] if demo.name == name)
    make = cv.AlgebraicProblem if kind == "flow" else cv.MapProblem
    options = {"spectrum": "flow", **demo.options} if kind == "flow" else demo.options
    problem = make(
        lambda v, q: unit * np.array(demo.equations(v / unit, q / value, NUMBERS)),
        unit * np.array(demo.u),
        value * demo.p,
        **options,
    )
    graph = cv.diagram(problem, within=tuple(value * np.array(demo.within)), depth=demo.depth)
    found = sorted((s.kind, s.value / value) for s in graph.special.values() if s.kind != "end")
    expected = sorted((row["kind"], row["value"]) for row in json.loads(TABLE.read_text())[name])
    assert [kind for kind, _ in found] == [kind for kind, _ in expected]
    assert [p for _, p in found] == pytest.approx([p for _, p in expected], rel=1e-10, abs=1e-12)


def test_where_nothing_can_tell_a_sentence_says_so():
    """u1 is zero all along, alone in its equation and linear there: F(c u1) = c F(u1)."""
    problem = cv.AlgebraicProblem(lambda u, p: [p * u[0] - u[0] ** 3, -3.0 * u[1]], [0.0, 0.0], -1.0)
    assert "nothing tells how large u1 may become" in cv.diagram(problem, within=(-1.0, 1.0)).start
    told = cv.AlgebraicProblem(lambda u, p: [p * u[0] - u[0] ** 3, u[0] - 3.0 * u[1]], [0.0, 0.0], -1.0)
    assert cv.diagram(told, within=(-1.0, 1.0)).start == ""


def test_a_two_cycle_begins_without_a_fold():
    """Hassell's map in units of 1e9: beside its flip p is known to 1e-9 only, and turns back there by rounding."""

    def f(x, rate):
        return rate * x / (1.0 + x / 1e9) ** 6

    graph = cv.diagram(cv.MapProblem(f, [0.0], 0.5), within=(0.1, 40.0), depth=2)
    assert not graph.of_kind("fold")
    assert graph.of_kind("period-doubling")[0].value == pytest.approx((1.0 - 2.0 / 6.0) ** -6, rel=1e-12)


def test_what_weighs_as_much():
    """x is known to be 3: y by the linear terms of a row, z by its square, v and w by their product."""
    matrix = np.zeros((5, 5))
    matrix[0, :2], matrix[1, 0], matrix[2, 0] = [2.0, -1e6], 5.0, 7.0
    matrix[3, 3:] = [1.0, -4.0]

    def f(d):
        x, y, z, v, w = d
        return np.array([2.0 * x - 1e6 * y, 5.0 * x + z * z / 1e8, 7.0 * x - v * w, v - 4.0 * w, 0.0])

    known = np.array([True, False, False, False, False])
    lengths, told = weighed(f, matrix, np.array([3.0, 1.0, 1.0, 1.0, 1.0]), known)
    assert told.all()
    assert lengths[1] == pytest.approx(6e-6)
    for length, expected in zip(lengths[2:], (np.sqrt(15e8), np.sqrt(84.0), np.sqrt(21.0 / 4.0))):
        assert 0.5 < length / expected < 4.0


def test_rounding_is_no_bend():
    """sin(1 + u) - sin(1) makes stairs of u below 1e-16; u and the parameter have the scale 1."""
    problem = cv.AlgebraicProblem(lambda u, p: np.sin(1.0 + u) - np.sin(1.0) - p, [0.0], 0.0)
    assert 0.01 < problem.functions.lengths[0] < 100.0


@pytest.mark.parametrize("unit", [1.0, 1e9, 1e-9])
def test_a_zero_that_rounding_has_moved_is_no_size(unit):
    """y = x^2 + p x - 2 at x = root 2 is 4e-16 by rounding: it becomes 0.1 to 60 along the branch, in any unit."""

    def F(u, p):
        x, y = u[0], u[1] / unit
        return np.array(
            [3.0 * p * x**2 - x**3 + 2.0 * x + 3.0 * (y - p * x - x**2 + 2.0), y - p * x - x**2 + 2.0]
        )

    for rounded in (0.0, 4e-16, -4e-16):
        problem = cv.AlgebraicProblem(F, [np.sqrt(2.0), rounded * unit], 0.0)
        assert 0.1 < problem.scale_within((-2.0, 2.0))[1] / unit < 1e3


def test_a_small_unknown_of_a_row_of_its_own_is_no_rounding():
    """y = 1e-17 x is not felt by the row of x, but by its own."""
    problem = cv.AlgebraicProblem(
        lambda u, p: [p - u[0] + u[0] ** 3 + u[1], u[1] - 1e-17 * u[0]], [0.1, 1e-18], 0.099
    )
    assert 1e-19 < problem.scale_within((-1.0, 1.0))[1] < 1e-15


def test_an_unknown_that_cancels_decides_nothing():
    """2 (u0 + u1) - u0 - u0 - 5 u1 is -3 u1; where u0 is 1e16 rounding takes u1 from it, which looks as if they were multiplied."""
    problem = cv.AlgebraicProblem(
        lambda u, p: [2.0 * (u[0] + u[1]) - u[0] - u[0] - 5.0 * u[1], p * u[0] + p - 1.0 + u[1]],
        [0.0, 0.0],
        1.0,
    )
    assert not problem.functions.known.any()


def test_rounding_of_terms_that_cancel_is_no_bend():
    """4 x, as 6 x^2 + 4 x - 6 x^2 with other terms between: far out, and rounded, it seems to bend."""

    def F(u, p):
        x, z = u
        return np.array([6.0 * x**2 + 4.0 * x - 3.0 * x * (z + 2.0 * x + 1.0), z + 2.0 * x + 1.0 - p * x])

    problem = cv.AlgebraicProblem(F, [0.0, -1.0], 0.0)
    assert 0.01 < problem.functions.lengths[0] < 100.0


@pytest.mark.parametrize("unit", [1.0, 1e9, 1e-9])
def test_the_length_of_a_bend_in_any_unit(unit):
    """|x + 1| - |x - 1|, smoothed: linear to x = 1, with stairs of rounding below 1e-16."""

    def F(u, p):
        x = u / unit
        size = [2.0 * y * np.arctan(10.0 * y) / np.pi for y in (x + 1.0, x - 1.0)]
        return 2.0 * x / 7.0 - 3.0 / 14.0 * (size[0] - size[1])

    problem = cv.AlgebraicProblem(F, [0.0], 0.0)
    assert 0.5 < problem.functions.lengths[0] / unit < 2.0


def test_fields_of_unlike_sizes_keep_their_sizes():
    small, large = np.linspace(1.0, 9.0, 15), np.linspace(1e4, 9e4, 15)
    mixed = np.ravel(np.column_stack([small, large]))
    found = in_fields(mixed)
    assert found[::2] == pytest.approx(np.full(15, np.sqrt((small**2).mean())))
    assert found[1::2] == pytest.approx(np.full(15, np.sqrt((large**2).mean())))


@pytest.mark.parametrize(("unit", "row"), [(1.0, 1.0), (1e9, 1e9), (1e9, 1e-9)])
def test_a_pair_that_passes_the_axis_is_no_branch_point(unit, row):
    """Eigenvalues p +- i on the zero solution: F_u is nowhere singular."""

    def F(v, q):
        x, y, p = v[0] / unit, v[1] / unit, q / 1e-9
        size = x * x + y * y
        return row * np.array([p * x - y - x * size, x + p * y - y * size])

    graph = cv.diagram(cv.AlgebraicProblem(F, [0.0, 0.0], -1e-9), within=(-1e-9, 1e-9))
    assert {s.kind for s in graph.special.values()} == {"end"}


def test_nor_is_it_beside_an_eigenvalue_that_is_next_to_nothing():
    """The feedback system adaptx in units of 1e-9: one real eigenvalue is 1e-10 of the others, and F_u is singular nowhere."""
    (demo,) = (demo for demo in listed.DEMOS if demo.name == "adaptx")
    found = points(demo.equations, np.array(demo.u), demo.p, demo.within, 1e-9, 1.0, 1.0)
    assert {row[0] for row in found} == {"end"}


@pytest.mark.parametrize("unit", [1.0, 1e9, 1e-9])
def test_nor_is_one_that_only_the_parameter_outweighs(unit):
    """9 p + 3 = 0 at the start, and x is multiplied by y: where y is rounding, so is what x does. Along the branch 9 p + 3 = -6 y + ..."""

    def F(u, p):
        x, y = u[0], u[1] / unit
        return np.array([9.0 * p + 3.0 + 2.0 * x * y + 12.0 * y - 4.0 * y**3, x + 3.0 - y**2])

    for rounded in (0.0, 1.1e-16, -1.1e-16):
        problem = cv.AlgebraicProblem(F, [-3.0, rounded * unit], -1.0 / 3.0)
        assert 0.1 < problem.scale_within((-2.0, 2.0))[1] / unit < 10.0


@pytest.mark.parametrize("residue", [1e-16, -2.5e-30, 1e-200])
def test_a_zero_that_rounding_has_moved_is_one_however_small(residue):
    """x y + y^2 = 0, x = 3: the second unknown is zero, whatever digits its root was computed with; the first one is not."""
    found = of_rounding(
        lambda u: np.array([u[0] * u[1] + u[1] ** 2 + u[0] - 3.0, u[0] - 3.0]), np.array([3.0, residue])
    )
    assert found.tolist() == [False, True]
