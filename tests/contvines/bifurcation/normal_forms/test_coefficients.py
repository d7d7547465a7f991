"""Cubic coefficients of diagrams that can be worked out by hand, and their sign, the criticality."""

import mpmath
import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import contvines as cv
from tools.brusselator import brusselator

UNIT = (-1.0, 1.0)


def flow(function, u0, p0=-0.5, within=UNIT, **more):
    return cv.diagram(cv.AlgebraicProblem(function, u0, p0, spectrum="flow", **more), within=within, depth=0)


def word(coefficient):
    return "supercritical" if coefficient < 0.0 else "subcritical"


@pytest.mark.parametrize("a", [0.25, 2.0, -3.0])
def test_fold(a):
    """p = a u^2 turns with the coefficient a at u = 0."""
    problem = cv.AlgebraicProblem(lambda u, p: p - a * u**2, [abs(a) ** -0.5], np.sign(a))
    fold = cv.diagram(problem, within=UNIT)["LP1"]
    assert (fold.value, fold.coefficient) == pytest.approx((0.0, a), rel=1e-6, abs=1e-12)


@pytest.mark.parametrize(("slaved", "own"), [(0.0, -1.0), (0.5, 0.0), (-0.8, 0.3)])
def test_a_pitchfork_with_a_slaved_unknown(slaved, own):
    """x' = p x + x w + c x^3, w' = -w + b x^2: on the centre manifold w = b x^2, so x' = (b + c) x^3."""

    def F(u, p):
        return [p * u[0] + u[0] * u[1] + own * u[0] ** 3, -u[1] + slaved * u[0] ** 2]

    (point,) = flow(F, [0.0, 0.0], scale=1.0).of_kind("branch-point")
    assert point.coefficient == pytest.approx(slaved + own, rel=1e-5)
    assert point.criticality == word(slaved + own)


OMEGA = 1.4


def by_hand(f, g):
    """16 a of Guckenheimer and Holmes, (3.4.11), for r' = a r^3: third derivatives, and products of second ones over omega."""

    def d(part, i, j):
        return part.get((i, j), 0.0) * np.prod(np.arange(1, i + 1)) * np.prod(np.arange(1, j + 1))

    third = d(f, 3, 0) + d(f, 1, 2) + d(g, 2, 1) + d(g, 0, 3)
    second = d(f, 1, 1) * (d(f, 2, 0) + d(f, 0, 2)) - d(g, 1, 1) * (d(g, 2, 0) + d(g, 0, 2))
    return third + (second - d(f, 2, 0) * d(g, 2, 0) + d(f, 0, 2) * d(g, 0, 2)) / OMEGA


@pytest.mark.parametrize("seed", range(4))
def test_a_hopf_point_of_any_plane_system(seed):
    """x' = p x - omega y + f, y' = omega x + p y + g, f and g by their monomials; z of r = |z| sqrt 2 goes with a critical vector of length one: l1 = 2 a / omega."""
    draw = np.random.default_rng(seed)
    powers = [(i, j) for i in range(4) for j in range(4) if 2 <= i + j <= 3]
    f, g = ({power: float(draw.uniform(-1.0, 1.0)) for power in powers} for _ in range(2))

    def F(u, p):
        x, y = u
        nonlinear = (sum(c * x**i * y**j for (i, j), c in part.items()) for part in (f, g))
        return p * u + OMEGA * np.array([-y, x]) + list(nonlinear)

    (point,) = flow(F, [0.0, 0.0], p0=-0.05, within=(-0.1, 0.1), scale=1.0).of_kind("hopf")
    exact = by_hand(f, g) / (8.0 * OMEGA)
    assert point.coefficient == pytest.approx(exact, rel=1e-5) and point.criticality == word(exact)


def of_one_cell(A):
    """l1 of the brusselator at its Hopf point b = 1 + A^2, omega = A, for a critical vector of length one: by SymPy from the same formula."""
    return -(2.0 + A**2) / (2.0 * A * (1.0 + 2.0 * A**2))


def test_a_hopf_point_and_its_eigenvectors():
    def cell(u, b):
        return [2.0 - (b + 1.0) * u[0] + u[0] ** 2 * u[1], b * u[0] - u[0] ** 2 * u[1]]

    graph = flow(cell, [2.0, 0.5], 1.0, (0.5, 8.0))
    (point,) = graph.of_kind("hopf")
    assert point.value == pytest.approx(5.0, rel=1e-13) and point.frequency == pytest.approx(2.0, rel=1e-12)
    assert point.coefficient == pytest.approx(of_one_cell(2.0), rel=1e-6)
    proper(point, np.array([[4.0, 4.0], [-5.0, -4.0]]))
    assert graph.of_kind("end")[0].frequency is None


def proper(point, matrix, close=1e-9):
    """Its eigenvectors are those of the matrix."""
    vectors = point.eigenvectors
    np.testing.assert_allclose(matrix @ vectors, vectors * point.multipliers, atol=close)


@pytest.mark.slow
def test_all_cells_of_a_line_at_once():
    """Without a gradient each of m cells oscillates as one alone, and a critical vector of length one has 1 / m of its square in each."""
    m, A, b = 400, 1.5, 2.9
    F, jacobian, derivative = brusselator(m, A, 0.4, 0.3)
    own = {"jacobian": jacobian, "derivative": derivative, "leading": 6}
    point = flow(F, np.tile([A, b / A], m), b, (2.9, 3.6), **own).of_kind("hopf")[0]
    assert abs(point.value - (1.0 + A**2)) < 1e-9
    assert point.criticality == "supercritical"
    assert point.coefficient == pytest.approx(of_one_cell(A) / m, rel=1e-6)


def test_eigenvectors_of_a_sparse_jacobian():
    second = sp.diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(30, 30)).tocsc()
    own = {"jacobian": lambda u, p: second, "derivative": lambda u, p: np.ones(30), "leading": 3}
    point = flow(lambda u, p: second @ u + p, np.zeros(30), 0.0, (0.0, 1.0), **own).of_kind("end")[0]
    proper(point, second, 1e-7)


@settings(max_examples=15)
@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_flip_of_a_general_map(q, c):
    """x -> -(1 + p) x + q x^2 + c x^3 has Kuznetsov's coefficient q^2 + c (theorem 4.3: f_xx^2/4 + f_xxx/6)."""
    exact = q * q + c
    assume(abs(exact) > 0.05)
    problem = cv.MapProblem(lambda x, p: -(1.0 + p) * x + q * x**2 + c * x**3, [0.0], -0.2)
    point = cv.diagram(problem, within=(-0.3, 0.1), depth=0)["PD1"]
    assert point.value == pytest.approx(0.0, abs=1e-13)
    assert point.coefficient == pytest.approx(exact, rel=1e-4, abs=1e-4)
    assert point.criticality == word(-exact)


def test_flip_beside_other_doublings():
    """The third doubling of x -> x + K (q - x^2), 1e-9 of q from the second: g^2/4 + h/6 of the fourth iterate with derivatives -1, g, h."""
    K = 1e4
    problem = cv.MapProblem(lambda x, p: [x[0] + K * (p.q - x[0] ** 2)], [0.3], {"q": 0.09})
    point = cv.diagram(problem, over="q", within=(-1.0, 0.1), depth=2)["PD3"]

    def fourth(x, q):
        for _ in range(4):
            x = x + K * (q - x**2)
        return x

    with mpmath.workdps(60):

        def doubling(x, q):
            return fourth(x, q) - x, mpmath.diff(lambda x: fourth(x, q), x) + 1

        x, q = mpmath.findroot(doubling, (float(point.u[0]), point.value))
        second, third = (float(mpmath.diff(lambda x: fourth(x, q), x, n)) for n in (2, 3))
    assert point.value == pytest.approx(float(q), abs=1e-17)
    assert point.coefficient == pytest.approx(second**2 / 4 + third / 6, rel=1e-3)
    assert point.criticality == "supercritical"


def test_a_neimark_sacker_point_and_its_eigenvectors():
    """The delayed logistic map at r = 2, with multipliers exp(+-i pi/3): the coefficient by SymPy from Kuznetsov's formula, q of length one."""
    problem = cv.MapProblem(lambda x, r: [r * x[0] * (1.0 - x[1]), x[0]], [0.3, 0.3], 1.5)
    (point,) = cv.diagram(problem, within=(1.2, 2.4)).of_kind("neimark-sacker")
    assert point.frequency == pytest.approx(np.pi / 3.0, rel=1e-10)
    assert point.coefficient == pytest.approx(-1.0, abs=1e-9) and point.criticality == "supercritical"
    proper(point, np.array([[1.0, -1.0], [1.0, 0.0]]))
