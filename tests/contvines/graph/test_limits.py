"""Branches that end where the user says so; what special points tell of their eigenvalues."""

import numpy as np
import pytest
import scipy.sparse as sp

import contvines as cv
from contvines.journal import MemoryJournal


def parabola(u, p):
    return p - u**2


def test_a_function_stops_a_branch_at_its_zero():
    problem = cv.AlgebraicProblem(parabola, [1.0], 1.0, outputs={"square": lambda u, p: u[0] ** 2})
    graph = cv.diagram(problem, within=(-1.0, 4.0), stop={"half": lambda u, p: u[0] - 0.5})
    (branch,) = graph
    assert branch.points.min() == pytest.approx(0.5, abs=1e-14) and branch.range == pytest.approx((0.25, 4.0))
    assert not graph.of_kind("fold")
    assert "stops at US1 (half), p = 0.25" in branch.ended
    graph = cv.diagram(problem, within=(-1.0, 4.0), stop={"measured": ("square", 2.25)})
    assert graph["B1"].points.max() == pytest.approx(1.5, abs=1e-14)


def tree(u, p):
    """A transcritical point at p = 0, and the branch u = p that leaves there."""
    return u * (p - u)


class Cut(MemoryJournal):
    """Is interrupted after so many records, as a run that is killed."""

    left = 3

    def record(self, key, values):
        super().record(key, values)
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt


def test_limits_on_resume(tmp_path):
    """Bounds and stops hold in a run that goes on after an interrupt, and in what is kept of it."""
    problem = cv.AlgebraicProblem(tree, [0.0], -1.0)
    more = {"bounds": {"u0": (-0.5, None)}, "stop": {"far": lambda u, p: u[0] - 0.75}}
    whole = cv.diagram(problem, within=(-1.0, 1.0), **more)
    journal = Cut()
    with pytest.raises(KeyboardInterrupt):
        cv.diagram(problem, within=(-1.0, 1.0), journal=journal, **more)
    graph = cv.diagram(problem, within=(-1.0, 1.0), journal=journal, **more)
    assert str(graph) == str(whole)
    assert sorted(point.value for point in graph.of_kind("user")) == pytest.approx([-0.5, 0.75])
    graph.save(tmp_path / "tree.vines")
    again = cv.load(tmp_path / "tree.vines")
    assert str(again) == str(whole) and again.settings["bounds"] == {"u0": [-0.5, None]}


def test_points_at_the_very_end_of_the_interval():
    """A branch point, a fold, and none of them a little inside."""
    line = cv.AlgebraicProblem(tree, [0.0], -1.0)
    assert "at the end" in str(cv.diagram(line, within=(-1.0, 0.0)))
    assert "at the end" not in str(cv.diagram(line, within=(-1.0, 1e-3)))
    fold = str(cv.diagram(cv.AlgebraicProblem(parabola, [1.0], 1.0), within=(0.0, 2.0)))
    assert "fold" in fold and "at the end" in fold


def test_a_branch_that_creeps_ends_and_says_so():
    problem = cv.AlgebraicProblem(parabola, [1.0], 1.0, scale=1.0)
    graph = cv.diagram(problem, within=(-1.0, 2.0), settings={"max_step": 5e-7, "first_step": 1e-7})
    assert all("creeps near p = " in said for said in graph["B1"].ended)
    assert 600 <= len(graph["B1"]) < 4000


def test_bounds_of_measures():
    problem = cv.AlgebraicProblem(parabola, [1.0], 1.0)
    graph = cv.diagram(problem, within=(-1.0, 9.0), bounds={"u0": (-1.0, 2.0)})
    assert (graph["B1"].points.min(), graph["B1"].points.max()) == pytest.approx((-1.0, 2.0), abs=1e-14)
    assert graph.of_kind("fold")[0].value == pytest.approx(0.0, abs=1e-15)
    assert len(cv.diagram(problem, within=(-1.0, 9.0), bounds={"u0": (None, 2.0)}).of_kind("user")) == 1
    with pytest.raises(ValueError, match=r"at the start u0 = 1 is outside of its bounds \[2, 3\]"):
        cv.diagram(problem, within=(-1.0, 9.0), bounds={"u0": (2.0, 3.0)})
    with pytest.raises(ValueError, match="no measure 'u7'"):
        cv.diagram(problem, within=(-1.0, 9.0), bounds={"u7": (2.0, 3.0)})
    with pytest.raises(ValueError, match="two numbers"):
        cv.diagram(problem, within=(-1.0, 9.0), bounds={"u0": 3.0})
    with pytest.raises(ValueError, match="the smaller one"):
        cv.diagram(problem, within=(-1.0, 9.0), bounds={"u0": (3.0, 2.0)})


def brusselator(u, b):
    return np.array([2.0 - (b + 1.0) * u[0] + u[0] ** 2 * u[1], b * u[0] - u[0] ** 2 * u[1]])


def test_frequency_and_eigenvectors_at_a_hopf_point():
    """The Brusselator with A = 2 has its Hopf point at B = 1 + A^2 with omega = A."""
    graph = cv.diagram(cv.AlgebraicProblem(brusselator, [2.0, 0.5], 1.0, spectrum="flow"), within=(0.5, 8.0))
    (point,) = graph.of_kind("hopf")
    assert point.value == pytest.approx(5.0, rel=1e-13) and point.frequency == pytest.approx(2.0, rel=1e-12)
    matrix = np.array([[4.0, 4.0], [-5.0, -4.0]])
    np.testing.assert_allclose(matrix @ point.eigenvectors, point.eigenvectors * point.multipliers, atol=1e-9)
    assert graph.of_kind("end")[0].frequency is None


def test_angle_and_eigenvectors_of_a_cycle():
    """The delayed logistic map: a Neimark-Sacker point at r = 2 with multipliers exp(+-i pi/3)."""
    problem = cv.MapProblem(lambda x, r: np.array([r * x[0] * (1.0 - x[1]), x[0]]), [0.3, 0.3], 1.5)
    (point,) = cv.diagram(problem, within=(1.2, 2.4)).of_kind("neimark-sacker")
    assert point.frequency == pytest.approx(np.pi / 3.0, rel=1e-10)
    matrix = np.array([[1.0, -1.0], [1.0, 0.0]])
    np.testing.assert_allclose(matrix @ point.eigenvectors, point.eigenvectors * point.multipliers, atol=1e-9)


def test_eigenvectors_of_a_sparse_jacobian():
    n = 30
    second = sp.diags_array([np.ones(n - 1), -2.0 * np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1]).tocsc()
    problem = cv.AlgebraicProblem(
        lambda u, p: second @ u + p,
        np.zeros(n),
        0.0,
        jacobian=lambda u, p: second,
        derivative=lambda u, p: np.ones(n),
        spectrum="flow",
        leading=3,
    )
    point = cv.diagram(problem, within=(0.0, 1.0)).of_kind("end")[0]
    np.testing.assert_allclose(second @ point.eigenvectors, point.eigenvectors * point.multipliers, atol=1e-7)


def test_where_one_eigenvalue_leaves_as_another_enters():
    """The symmetry of a triangle: x' = p z + conj(z)^2 has three branches through 0 along which eigenvalues change places."""

    def triangle(u, p):
        x, y = u
        return [p * x + x * x - y * y, p * y - 2.0 * x * y]

    # start on one of the branches, x = -p: no count of eigenvalues changes at p = 0
    graph = cv.diagram(
        cv.AlgebraicProblem(triangle, [0.5, 0.0], -0.5, spectrum="flow"), within=(-1.0, 1.0), depth=1
    )
    assert [s.value for s in graph.of_kind("branch-point")] == pytest.approx([0.0], abs=1e-10)
    assert len(graph) == 4
