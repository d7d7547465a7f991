"""Points of codimension two of textbook systems, against closed forms and solves in many digits."""

import mpmath as mp
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


def co(u, p):
    x, y, s = u
    z = 1 - x - y - s
    return np.array(
        [5 * z * z - 2 * x * x - 10 * x * y, p.q2 * z - 0.1 * y - 10 * x * y, 0.0675 * (z - p.k * s)]
    )


@pytest.fixture(scope="module")
def oxidation():
    problem = cv.AlgebraicProblem(
        co, [0.0016, 0.52, 0.1], {"q2": 0.8, "k": 0.4}, parameter="q2", spectrum="flow"
    )
    graph = cv.diagram(problem, over="q2", within=(0.5, 2.0), depth=0)
    return cv.chart(graph, over="k", within=(0.05, 2.5))


def _co_mp(v):
    x, y, s, q2, k = v
    z = 1 - x - y - s
    F = [5 * z * z - 2 * x * x - 10 * x * y, q2 * z - y / 10 - 10 * x * y, mp.mpf("0.0675") * (z - k * s)]
    J = mp.matrix(3)
    J[0, 0], J[0, 1], J[0, 2] = -10 * z - 4 * x - 10 * y, -10 * z - 10 * x, -10 * z
    J[1, 0], J[1, 1], J[1, 2] = -q2 - 10 * y, -q2 - mp.mpf("0.1") - 10 * x, -q2
    J[2, 0], J[2, 1], J[2, 2] = (-mp.mpf("0.0675"),) * 2 + (-mp.mpf("0.0675") * (1 + k),)
    return F, J


@pytest.mark.slow
def test_co_oxidation_bogdanov_takens_is_a_double_zero(oxidation):
    # characteristic polynomial l^3 - t l^2 + m l - d: d = m = 0 at a Bogdanov-Takens point
    found = oxidation.of_kind("bogdanov-takens")
    assert len(found) == 2
    for point in found:

        def system(*v):
            F, J = _co_mp(v)
            minors = sum(J[i, i] * J[j, j] - J[i, j] * J[j, i] for i, j in ((0, 1), (0, 2), (1, 2)))
            return [*F, mp.det(J), minors]

        with mp.workdps(30):
            exact = mp.findroot(system, [*map(mp.mpf, point.u), *map(mp.mpf, point.value)])
            assert float(exact[3]) == pytest.approx(point.value[0], abs=1e-11)
            assert float(exact[4]) == pytest.approx(point.value[1], abs=1e-11)
        assert sorted(oxidation[label].kind for label in point.on) == ["fold", "hopf"]
    # printed by MatCont's tutorial and others to five digits
    assert sorted(p.value for p in found)[0] == pytest.approx((1.16120, 0.72234), abs=1e-5)


def test_co_oxidation_has_one_cusp_and_two_generalized_hopf_points(oxidation):
    assert len(oxidation.of_kind("cusp")) == 1 and len(oxidation.of_kind("generalized-hopf")) == 2
    # printed by BifurcationKit's test test/COModel.jl
    hopf = sorted(p.value for p in oxidation.of_kind("generalized-hopf"))
    assert hopf[0] == pytest.approx((0.8913189828755895, 0.23248736), abs=1e-8)
    assert hopf[1] == pytest.approx((0.924255, 0.305879), abs=1e-6)
    # F = 0, J v = 0, J^T w = 0 and w.B(v, v) = 0, B(v, v) = d/dh J(u + h v) v
    point = oxidation.of_kind("cusp")[0]

    def system(*a):
        F, J = _co_mp(a[:5])
        v, w = mp.matrix([1, *a[5:7]]), mp.matrix([1, *a[7:9]])
        h = mp.mpf(10) ** -15
        ends = [_co_mp([*(u + s * h * d for u, d in zip(a[:3], v)), *a[3:5]])[1] * v for s in (1, -1)]
        return [*F, *(J * v), *(J.T * w), (w.T * (ends[0] - ends[1]))[0] / h]

    J = np.array(_co_mp([*map(mp.mpf, point.u), *map(mp.mpf, point.value)])[1].tolist(), dtype=float)
    left, _, right = np.linalg.svd(J)
    v, w = right[-1] / right[-1, 0], left[:, -1] / left[0, -1]
    with mp.workdps(40):
        exact = mp.findroot(system, [*point.u, *point.value, *v[1:], *w[1:]], tol=1e-50, solver="mdnewton")
        assert [float(exact[3]), float(exact[4])] == pytest.approx(point.value, abs=1e-11)
    # where BifurcationKit's test detects it, to three digits
    assert point.value[1] == pytest.approx(0.35665351, rel=2e-3)
    assert len({locus.kind for locus in oxidation.loci.values()}) == 2
    assert len(oxidation.loci) == 2  # every fold is on one curve, every Hopf point on another


def test_lorenz_84_zero_hopf():
    def flow(u, p):
        x, y, z = u
        return np.array(
            [-y * y - z * z - 0.25 * x + 0.25 * p.F, x * y - 4 * x * z - y + p.G, 4 * x * y + x * z - z]
        )

    problem = cv.AlgebraicProblem(
        flow, [1.0, 0.05, 0.0], {"F": 1.0, "G": 0.5}, parameter="F", spectrum="flow"
    )
    _, found = points(problem, "F", (0.5, 6.0), "G", (0.0, 3.0), "HB1")
    kind, F, G = nearest(found, "zero-hopf", (1.68, 1.68))

    def system(x, y, z, F, G):
        J = mp.matrix([[-0.25, -2 * y, -2 * z], [y - 4 * z, x - 1, -4 * x], [4 * y + z, 4 * x, x - 1]])
        trace = J[0, 0] + J[1, 1] + J[2, 2]  # eigenvalues 0, +-i omega: determinant and trace vanish
        return [
            -y * y - z * z - x / 4 + F / 4,
            x * y - 4 * x * z - y + G,
            4 * x * y + x * z - z,
            mp.det(J),
            trace,
        ]

    with mp.workdps(30):
        x0 = mp.mpf(9) / 8  # the trace is 2 x - 2.25
        exact = mp.findroot(system, [x0, mp.mpf("-0.03"), mp.mpf("0.37"), mp.mpf(F), mp.mpf(G)])
        assert (float(exact[3]), float(exact[4])) == pytest.approx((F, G), abs=1e-10)


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
