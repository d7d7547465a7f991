"""Points of codimension two of textbook systems, against closed forms and solves in many digits."""

import numpy as np
import pytest

import contvines as cv


def test_henon_loci_are_parabolas():
    def henon(x, p):
        return np.array([1 + x[1] - p.a * x[0] ** 2, p.b * x[0]])

    problem = cv.MapProblem(henon, [0.6, 0.2], {"a": 0.2, "b": 0.3}, parameter="a")
    graph = cv.diagram(problem, over="a", within=(-0.5, 1.0), depth=1)
    # fold 4 a = -(1 - b)^2, doubling 4 a = 3 (1 - b)^2, second doubling 4 a = (1 - b)^2 + 4 (1 + b)^2 ... of b = 0.3
    closed = {"LP1": lambda b: -((1 - b) ** 2) / 4, "PD1": lambda b: 3 * (1 - b) ** 2 / 4}
    closed["PD2"] = lambda b: (1 - b) ** 2 + (1 + b) ** 2 / 4
    for label, form in closed.items():
        locus = cv.locus(graph[label], over="b", within=(0.1, 0.6))
        for a, b in locus.values:
            assert a == pytest.approx(form(b), abs=1e-12)


def test_first_lyapunov_coefficient_of_the_delayed_logistic_map():
    from contvines.bifurcation.normal_forms.coefficients import Forms

    # delayed logistic map at r = 2: Kuznetsov's textbook example 4.? has theta0 = pi/3 and a negative coefficient;
    # the value follows from the same formula with B((x, y), (u, v)) = (-2 (x v + y u), 0), C = 0, in exact arithmetic
    problem = cv.MapProblem(lambda x, p: np.array([p * x[0] * (1 - x[1]), x[0]]), [0.5, 0.5], 2.0)
    d, _ = Forms(problem, np.array([0.5, 0.5]), 2.0).lyapunov(np.exp(1j * np.pi / 3))
    m = np.exp(1j * np.pi / 3)
    A = np.array([[1.0, -1.0], [1.0, 0.0]])
    q = np.array([m, 1.0]) / np.sqrt(2.0)
    values, vectors = np.linalg.eig(A.T)
    p = vectors[:, np.argmin(abs(values - m.conj()))]
    p = p / np.vdot(p, q).conj()

    def B(a, b):
        return np.array([-2.0 * (a[0] * b[1] + a[1] * b[0]), 0.0])

    h20 = np.linalg.solve(m**2 * np.eye(2) - A, B(q, q))
    h11 = np.linalg.solve(np.eye(2) - A, B(q, q.conj()))
    exact = 0.5 * (m.conj() * np.vdot(p, 2 * B(q, h11) + B(q.conj(), h20))).real
    assert d.value == pytest.approx(exact, abs=1e-10)
