"""Equations of one's own: scales, corrupting functions, derivatives, symmetries, kinks, sparse Jacobians."""

import re

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import aslinearoperator

import contvines as cv


def of_kind(graph, kind):
    return sorted(point.value for point in graph.of_kind(kind))


def ab(u, p):
    reaction = p * (1.0 - u[0]) * np.exp(u[1])
    return np.array([-u[0] + reaction, -3.0 * u[1] + 14.0 * reaction])


def ab_jacobian(u, p, wrong=0.0):
    e = np.exp(u[1])
    reaction = p * (1.0 - u[0]) * e
    return np.array([[-1.0 - p * e, reaction], [-14.0 * p * e + wrong, -3.0 + 14.0 * reaction]])


def test_functions_that_would_corrupt():
    def changes(u, p):
        u -= p
        return u

    with pytest.raises(ValueError, match="must not change its argument"):
        cv.AlgebraicProblem(changes, [0.0], 0.0)
    buffer = np.zeros(1)

    def hands_out_its_buffer(u, p):
        buffer[0] = float(np.real(u[0])) ** 3 + float(np.real(u[0])) - p
        return buffer

    graph = cv.diagram(cv.AlgebraicProblem(hands_out_its_buffer, [0.0], 0.0), within=(-1.0, 1.0))
    assert graph["B1"].range == (-1.0, 1.0)


def test_given_jacobians_are_checked():
    cv.AlgebraicProblem(ab, [0.1, 0.2], 0.05, jacobian=ab_jacobian)
    with pytest.raises(ValueError, match=r"row 1, column 0.*differences"):
        cv.AlgebraicProblem(ab, [0.1, 0.2], 0.05, jacobian=lambda u, p: ab_jacobian(u, p, 0.01))
    with pytest.raises(ValueError, match="transposed"):
        cv.AlgebraicProblem(ab, [0.1, 0.2], 0.05, jacobian=lambda u, p: ab_jacobian(u, p).T)
    with pytest.raises(ValueError, match=r"shape \(3, 2\); \(2, 2\) is needed"):
        cv.AlgebraicProblem(ab, [0.1, 0.2], 0.05, jacobian=lambda u, p: np.zeros((3, 2)))


def test_a_continuous_symmetry_is_named_and_a_condition_helps():
    def circle(u, p):
        return p * u - u * (u @ u)

    graph = cv.diagram(cv.AlgebraicProblem(circle, [0.0, 0.0], -0.5), within=(-1.0, 1.0))
    assert len(graph) == 1 and "continuous symmetry" in graph["BP1"].note
    problem = cv.AlgebraicProblem(circle, [0.0, 0.0], -0.5, conditions=[lambda u, p: u[1]])
    graph = cv.diagram(problem, within=(-1.0, 1.0))
    assert len(graph) == 2
    np.testing.assert_allclose(graph["B2"].points[:, 0] ** 2, graph["B2"].values, atol=1e-12)


def test_kinks_are_named_and_switches_cross_them():
    assert "kink" in ended(lambda u, p: p - np.abs(u) - 0.1 * u, [1.0], 1.1, (-1.0, 1.5))[0]
    assert "jump near p = 0.3" in ended(lambda u, p: u - p - (p > 0.3), [0.0], 0.0, (-1.0, 1.0))[1]
    switches = {"k": lambda u, p: u[0]}
    for slope, note in ((lambda k: k + 0.1, "nonsmooth fold"), (lambda k: 1.5 + 0.5 * k, "persistence")):
        problem = cv.AlgebraicProblem(
            lambda u, p, s, slope=slope: [p - slope(s["k"]) * u[0]], [1.0], 1.1, switches=switches
        )
        graph = cv.diagram(problem, within=(-1.0, 1.5))
        assert of_kind(graph, "switch") == pytest.approx([0.0], abs=1e-14) and len(graph) == 2
        assert [switch.note for switch in graph.switches] == [note]


def ended(F, u, p, within, **options):
    """What is said at both ends of the branch."""
    return cv.diagram(cv.AlgebraicProblem(F, u, p, **options), within=within)["B1"].ended


def reaches(ends):
    return all("end of the interval" in said for said in ends)


@pytest.mark.parametrize("digits", [16, 8])
def test_a_kink_is_told_from_noise(digits):
    """F rounded to eight digits: a kink is named where there is one, a smooth branch goes on to the end."""

    def rounded(value):
        return [float(np.round(value, digits))]

    said, other = ended(lambda u, p: rounded(p - abs(u[0] - 0.3) - 0.5 * u[0]), [-1.0], 0.8, (0.0, 2.0))
    where = re.search(r"kink near p = (\S+) \(row 0\)", said)
    assert where is not None and float(where[1]) == pytest.approx(0.15, abs=2e-6)
    assert "end of the interval" in other
    assert reaches(ended(lambda u, p: rounded(p - np.sinh(u[0])), [0.0], 0.0, (-2.0, 2.0)))


def stairs(size):
    return lambda u, p: [np.round((p - u[0] ** 2) / size) * size]


def noisy(sigma, draw=0):
    """p = u^2 with noise that does not repeat: a hash of the argument."""

    def F(u, p):
        number = 43758.5453 * np.sin((1e7 + 17 * draw) * u[0] + 3e7 * p)
        return [p - u[0] ** 2 + sigma * (2.0 * (number - np.floor(number)) - 1.0)]

    return F


@pytest.mark.parametrize(
    "F",
    [*map(stairs, (1e-8, 1e-6, 1e-5)), *map(noisy, (1e-8, 1e-6)), *(noisy(1e-5, draw) for draw in range(4))],
)
def test_stated_errors_are_those_that_noise_allows(F):
    """The fold of p = u^2 at 0, and nothing beside it; both sides of it are reached."""
    graph = cv.diagram(cv.AlgebraicProblem(F, [1.0], 1.0), within=(-1.0, 1.5), depth=0)
    assert reaches(graph["B1"].ended)
    (fold,) = graph.of_kind("fold")
    assert abs(fold.value) <= fold.location_error < 3e-4
    assert not graph.of_kind("branch-point")


@pytest.mark.parametrize("radius", [0.05, 0.01, 0.001])
def test_a_small_circle_through_two_branch_points_is_cheap(radius):
    calls = [0]

    def jacobian(u, p):
        calls[0] += 1
        return [[3.0 * u[0] ** 2 + (p - 0.5) ** 2 - radius**2]]

    problem = cv.AlgebraicProblem(
        lambda u, p: u * (u**2 + (p - 0.5) ** 2 - radius**2), [0.0], 0.0, jacobian=jacobian
    )
    graph = cv.diagram(problem, within=(0.0, 1.0))
    assert len(graph) == 2 and not graph.of_kind("fold")
    found = sorted(point.value for point in graph.of_kind("branch-point"))
    assert found == pytest.approx([0.5 - radius, 0.5 + radius], abs=1e-12)
    assert calls[0] < 25 * sum(len(branch) for branch in graph)


@pytest.mark.parametrize("form", [np.array, sp.csr_array, lambda m: aslinearoperator(np.array(m)), list])
@pytest.mark.parametrize("named", [False, True])
def test_a_jacobian_given_as_derivative_is_refused_with_the_way_out(form, named):
    def derivative(u, p):
        return form([[2.0 * u[0], 0.0], [-1.0, 1.0]])

    given = {"p": derivative} if named else derivative
    with pytest.raises(ValueError, match=r"shape \([24],.*jacobian=") as raised:
        cv.AlgebraicProblem(lambda u, p: [u[0] ** 2 - p, u[1] - u[0]], [1.0, 1.0], 1.0, derivative=given)
    assert "sequence" not in str(raised.value)


def table(u, p):
    if np.real(p) < 0.5:
        raise RuntimeError("the table ends")
    return u - p**2


@pytest.mark.parametrize(
    ("F", "options", "sentence"),
    [
        (table, {}, "RuntimeError: the table ends"),
        (lambda u, p: u - np.sqrt(p - 0.5) - 1.0, {}, "F is not finite in row 0"),
        (
            lambda u, p: u**2 - p,
            {"jacobian": lambda u, p: [[2.0 * u[0] if p > 0.5 else -u[0]]]},
            "jacobian disagrees with F in row 0, column 0",
        ),
    ],
)
def test_what_becomes_wrong_is_named_where_the_branch_ends(F, options, sentence):
    graph = cv.diagram(cv.AlgebraicProblem(F, [1.0], 1.0, **options), within=(0.0, 1.5))
    assert graph["B1"].values.min() == pytest.approx(0.5, abs=1e-2)
    assert any(sentence in said for said in graph["B1"].ended)


def test_a_branch_is_left_before_what_is_not_finite():
    def F(u, p):
        with np.errstate(all="ignore"):
            return [u[0] - p, u[1] - np.log(p)]

    problem = cv.AlgebraicProblem(F, [1.0, 0.0], 1.0)
    graph = cv.diagram(problem, within=(-1.0, 2.0), bounds={"u1": (-5.0, None)})
    assert graph["B1"].values.min() == pytest.approx(np.exp(-5.0), rel=1e-12)


def test_a_branch_may_end_where_its_equations_do():
    # u = (1 + p)^2 by a root that becomes complex beyond the end of the interval, and has no derivative there
    assert reaches(ended(lambda u, p: np.emath.sqrt(u) - p - 1.0, [1.0], 0.0, (-1.0, 1.0)))


def test_an_even_function_tells_how_large_its_unknown_is():
    """p = cosh(u) - 1 with u of the order of ten million."""
    problem = cv.AlgebraicProblem(lambda u, p: np.cosh(u * 1e-7) - 1.0 - p, [0.0], 0.0)
    graph = cv.diagram(problem, within=(-1.0, 2.0))
    assert of_kind(graph, "fold") == pytest.approx([0.0], abs=1e-9)
    assert len(graph["B1"]) < 200


@pytest.mark.parametrize("size", [1e-7, 1e7])
def test_an_unknown_that_is_zero_is_as_large_as_it_weighs_where_it_is_even(size):
    problem = cv.AlgebraicProblem(
        lambda u, p: [u[0] - p + (u[1] / size) ** 2, u[1] * (u[0] - 0.3)], [1.0, 0.0], 1.0
    )
    graph = cv.diagram(problem, within=(-1.0, 2.0))
    assert len(graph.branches) == 2
    assert of_kind(graph, "branch-point") == pytest.approx([0.3], abs=1e-9)
    assert sum(len(branch) for branch in graph) < 400
