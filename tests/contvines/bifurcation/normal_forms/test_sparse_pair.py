"""The first Lyapunov coefficient of many unknowns, against that of one cell in closed form.

Guckenheimer and Holmes, Nonlinear Oscillations, (3.4.11), gives r' = a r^3 of a plane system x' = -omega y + f, y' = omega x + g. With
u = x Re q - y Im q the amplitude is r = 2 |z| for the z of the form z' = i omega z + c z^2 z*, so that l1 = Re c / omega = 4 a / omega.
"""

import numpy as np
import pytest
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
