"""Points of codimension two of textbook systems, against closed forms and solves in many digits."""

import numpy as np
import pytest

import contvines as cv
from contvines.loci.codimension_two import find
from tests.contvines.loci.systems import generalized_henon, generalized_henon_at


def points(problem, over, within, second, span, label, bounds=None):
    graph = cv.diagram(problem, over=over, within=within, depth=0)
    locus = cv.locus(graph[label], over=second, within=span, bounds=bounds or within)
    return locus, [(point.kind, *point.value) for _, point in find(locus)]


def nearest(found, kind, value):
    return min((p for p in found if p[0] == kind), key=lambda p: abs(p[1] - value[0]) + abs(p[2] - value[1]))


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


def test_the_cusp_is_a_cusp():
    problem = cv.AlgebraicProblem(
        lambda u, p: np.array([p.a + p.b * u[0] - u[0] ** 3]),
        [-1.2],
        {"a": -0.5, "b": 1.0},
        parameter="a",
        spectrum="flow",
    )
    locus, found = points(problem, "a", (-1, 1), "b", (-0.5, 1.5), "LP1")
    assert [kind for kind, *_ in found] == ["cusp"]
    assert found[0][1:] == pytest.approx((0.0, 0.0), abs=1e-12)
    for a, b in locus.values:
        assert 27 * a**2 == pytest.approx(4 * b**3, abs=1e-11)


def test_delayed_logistic_with_a_source():
    # x' = r x (1 - y) + e, y' = x: at a Neimark-Sacker point r x = 1 (the determinant is r x), so e = x - (1 - x) = 2/r - 1
    problem = cv.MapProblem(
        lambda x, p: np.array([p.r * x[0] * (1 - x[1]) + p.e, x[0]]),
        [0.4, 0.4],
        {"r": 1.7, "e": 0.0},
        parameter="r",
    )
    locus, _ = points(problem, "r", (1.2, 3.0), "e", (-0.3, 0.5), "NS1")
    for r, e in locus.values:
        assert e == pytest.approx(2 / r - 1, abs=1e-12)


def test_generalized_henon_resonances():
    _, found = points(generalized_henon(), "be", (0.1, 1.5), "al", (-0.5, 3.0), "NS1")
    for kind, trace in (("resonance-1-3", -1.0), ("resonance-1-2", -2.0)):
        _, be, al = generalized_henon_at(trace)
        assert nearest(found, kind, (be, al))[1:] == pytest.approx((be, al), abs=1e-10)


def test_first_lyapunov_coefficients_against_closed_forms():
    from contvines.bifurcation.normal_forms.coefficients import Forms
    from contvines.bifurcation.normal_forms.critical import normal_form

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
    # Hopf normal form with cubic part s (x^2 + y^2): |q| = 1 gives c = 2 s
    w, s = 1.7, -0.4
    flow = cv.AlgebraicProblem(
        lambda u, p: np.array([-w * u[1], w * u[0]]) + u * (p + s * (u[0] ** 2 + u[1] ** 2)),
        [0.0, 0.0],
        0.0,
        spectrum="flow",
    )
    assert Forms(flow, np.zeros(2), 0.0).lyapunov(1j * w)[0].value == pytest.approx(2 * s / w, abs=1e-11)
    # Bogdanov-Takens normal form
    a, b = 0.7, -1.3
    planar = cv.AlgebraicProblem(
        lambda u, p: np.array([u[1], p + a * u[0] ** 2 + b * u[0] * u[1]]), [0.0, 0.0], 0.0, spectrum="flow"
    )
    found = normal_form("bogdanov-takens", Forms(planar, np.zeros(2), 0.0), [])
    assert found == pytest.approx({"a": a, "b": b}, abs=1e-11)
