"""The first Lyapunov coefficient of many unknowns, against that of one cell in closed form.

Guckenheimer and Holmes, Nonlinear Oscillations, (3.4.11), gives r' = a r^3 of a plane system x' = -omega y + f, y' = omega x + g. With
u = x Re q - y Im q the amplitude is r = 2 |z| for the z of the form z' = i omega z + c z^2 z*, so that l1 = Re c / omega = 4 a / omega.
"""

import numpy as np
import pytest
import scipy.sparse as sp
import sympy

import contvines as cv
from tools.brusselator import brusselator

pytestmark = pytest.mark.slow


def in_the_plane(rates, place, q, omega):
    """l1 of two equations, polynomials in two symbols, for a critical vector q."""
    x, y, u, v = sympy.symbols("x y u v", real=True)
    turned = sympy.Matrix([[q[0].real, -q[0].imag], [q[1].real, -q[1].imag]])
    moved = turned * sympy.Matrix([x, y])
    here = {u: place[0] + moved[0], v: place[1] + moved[1]}
    f, g = turned.inv() * sympy.Matrix([r.subs(here, simultaneous=True) for r in rates(u, v)])

    def d(of, *by):
        return float(sympy.diff(of, *by).subs({x: 0, y: 0}))

    cubic = d(f, x, x, x) + d(f, x, y, y) + d(g, x, x, y) + d(g, y, y, y)
    square = d(f, x, y) * (d(f, x, x) + d(f, y, y)) - d(g, x, y) * (d(g, x, x) + d(g, y, y))
    square += -d(f, x, x) * d(g, x, x) + d(f, y, y) * d(g, y, y)
    return 4.0 * (cubic / 16.0 + square / (16.0 * omega)) / omega


A = 1.5


def of_one_cell(length=1.0):
    """Of the brusselator at b = 1 + A^2, where omega = A; q has this length there."""
    b = 1.0 + A**2
    matrix = np.array([[b - 1.0, A**2], [-b, -(A**2)]])
    values, vectors = np.linalg.eig(matrix)
    q = vectors[:, np.argmax(values.imag)]
    q *= length / np.linalg.norm(q)
    square = np.sum(q * q)
    q = q * np.exp(-0.5j * np.angle(square))
    return in_the_plane(
        lambda u, v: (A - (b + 1) * u + u**2 * v, b * u - u**2 * v), (A, b / A), q.tolist(), A
    )


def test_all_cells_of_a_line_at_once():
    """Without a gradient each of m cells oscillates as one alone, and a critical vector of length one has 1 / m of its square in each."""
    m = 400
    F, jacobian, derivative = brusselator(m, A, 0.4, 0.3)
    b = 2.9
    problem = cv.AlgebraicProblem(
        F, np.tile([A, b / A], m), b, jacobian=jacobian, derivative=derivative, spectrum="flow", leading=6
    )
    graph = cv.diagram(problem, within=(2.9, 3.6), depth=0)
    point = graph.of_kind("hopf")[0]
    assert abs(point.value - (1.0 + A**2)) < 1e-9
    assert point.criticality == "supercritical"
    assert point.coefficient == pytest.approx(of_one_cell(m**-0.5), rel=1e-6)


@pytest.mark.parametrize("unit", [1.0, 1e6, 1e-6])
def test_one_cell_among_damped_ones_in_other_coordinates_and_units(unit):
    """Of m cells one is critical; y = T x makes its vector T q long and spread over three cells."""
    m, k, b = 200, 70, 1.0 + A**2
    damping = np.linspace(0.5, 3.0, m)
    damping[k] = 0.0
    damping, n = np.repeat(damping, 2), 2 * m
    T = sp.csc_array(
        sp.eye_array(n) + sp.diags_array([0.3 * np.ones(n - 2), 0.2 * np.ones(n - 4)], offsets=[-2, -4])
    )
    back = sp.csc_array(sp.linalg.inv(T.tocsc()))
    rest = np.empty(n)

    def states(y):
        return back @ (y / unit)

    def rates(y, p):
        x = states(y)
        u, v, out = x[0::2], x[1::2], np.empty(n)
        rest[0::2], rest[1::2] = A, p / A
        out[0::2], out[1::2] = A - (p + 1.0) * u + u * u * v, p * u - u * u * v
        return unit * (T @ (out - damping * (x - rest)))

    def slopes(y, p):
        x = states(y)
        u, v = x[0::2], x[1::2]
        here, above, below = np.empty(n), np.zeros(n - 1), np.zeros(n - 1)
        here[0::2], here[1::2] = -(p + 1.0) + 2.0 * u * v, -u * u
        above[0::2], below[0::2] = u * u, p - 2.0 * u * v
        return (
            T @ (sp.diags_array([below, here, above], offsets=[-1, 0, 1]) - sp.diags_array(damping)) @ back
        ).tocsc()

    p0 = 3.0
    start = unit * (T @ np.tile([A, p0 / A], m))
    problem = cv.AlgebraicProblem(rates, start, p0, jacobian=slopes, spectrum="flow", leading=6)
    point = cv.diagram(problem, within=(3.0, 3.5), depth=0).of_kind("hopf")[0]
    assert abs(point.value - b) < 1e-8
    block = (T[2 * k :, 2 * k : 2 * k + 2]).toarray()
    matrix = np.array([[b - 1.0, A**2], [-b, -(A**2)]])
    values, vectors = np.linalg.eig(matrix)
    q = vectors[:, np.argmax(values.imag)]
    length = np.linalg.norm(q) / np.linalg.norm(block @ q)
    assert point.coefficient * unit**2 == pytest.approx(of_one_cell(length), rel=1e-6)
