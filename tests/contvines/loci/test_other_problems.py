"""Loci and witnesses of problems whose kernels are plain Python: sparse equations, declared machines; what simulation finds."""

import numpy as np
import pytest
import scipy.sparse as sp

import contvines as cv

pytestmark = pytest.mark.slow


def test_loci_of_sparse_equations_are_those_of_dense_ones():
    # N cells that do not know one another: u_i' = a + b u_i - u_i^3 - i/10; each fold is a fold of one cell in closed form
    shifts = np.arange(6) / 10

    def f(u, p):
        return p.a + p.b * u - u**3 - shifts

    def jacobian(u, p):
        return sp.diags(p.b - 3 * u**2, format="csc")

    u0 = [np.roots([-1.0, 0.0, 1.0, -1.5 - s])[-3:] for s in shifts]
    start = [float(np.real(r[np.argmin(abs(np.imag(r)))])) for r in u0]
    problem = cv.AlgebraicProblem(
        f, start, {"a": -1.5, "b": 1.0}, parameter="a", jacobian=jacobian, spectrum="flow"
    )
    assert problem.functions.structure != "dense"
    graph = cv.diagram(problem, over="a", within=(-1.6, 0.6), depth=0)
    folds = graph.of_kind("fold")
    first = min(folds, key=lambda point: abs(point.value - 2 / 27**0.5))
    locus = cv.locus(first, over="b", within=(0.4, 1.3))
    for a, b in locus.values:
        assert a == pytest.approx(2 * (b / 3) ** 1.5, abs=1e-11)  # the cell without a shift folds first
    found = problem.kernels.matrix
    assert found is not None


def test_loci_of_a_declared_machine_are_their_closed_forms():
    pytest.importorskip("heyoka")
    from contvines.loci.linear import Linearisation
    from tests.contvines.loci.test_absorber_loci import closed_form
    from tools.pages.pages import page

    graph = cv.diagram(
        page("absorber").orbit("LR", amplitude=0.55), over="amplitude", within=(0.2, 0.8), depth=0
    )
    point = graph["SB1"]
    line = Linearisation(point.problem)
    line.at(point.u, point.value)
    matrix = point.problem.kernels.matrix
    before = matrix(point.problem.data, line.work)
    point.problem.kernels.transpose(
        point.problem.data, line.work, np.zeros(point.problem.dimension), line.other
    )
    assert np.array_equal(matrix(point.problem.data, line.other), before.T)
    for label, kind in (("LP1", "fold"), ("SB1", "symmetry-breaking")):
        locus = cv.locus(graph[label], over="friction", within=(0.35, 0.65))
        for p, q in locus.values:
            assert p == pytest.approx(closed_form(kind, friction=q), abs=1e-12)


def test_witnesses_name_what_is_stable():
    henon = cv.MapProblem(
        lambda x, p: np.array([1 + x[1] - p.a * x[0] ** 2, p.b * x[0]]),
        [0.6, 0.2],
        {"a": 0.2, "b": 0.3},
        parameter="a",
    )
    # doublings at a = 3 (1 - b)^2 / 4 and (1 - b)^2 + (1 + b)^2 / 4
    assert [m["word"] for m in henon.witness(0.1)] == ["1-cycle"]
    assert [m["word"] for m in henon.witness(0.5)] == ["2-cycle"]
    flow = cv.AlgebraicProblem(
        lambda u, p: np.array([p.a + p.b * u[0] - u[0] ** 3]),
        [-1.2],
        {"a": 0.0, "b": 1.0},
        parameter="a",
        spectrum="flow",
    )
    both = sorted(m["u"][0] for m in flow.witness(0.1))
    roots = sorted(np.roots([-1, 0, 1, 0.1]).real)
    assert both == pytest.approx([roots[0], roots[2]], abs=1e-6)
    assert flow.witness(0.9)[0]["kind"] == "equilibrium" and len(flow.witness(0.9)) == 1
    wheel = cv.AlgebraicProblem(
        lambda u, p: np.array([u[1], -u[0] + p * u[1] - u[0] ** 2 * u[1]]), [0.0, 0.1], 0.5, spectrum="flow"
    )
    assert [m["kind"] for m in wheel.witness(0.5)] == ["oscillation"]
    assert "equilibrium" in [m["kind"] for m in wheel.witness(-0.5)]
