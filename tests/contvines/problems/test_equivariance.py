"""What is called a mirror is tried: it must take solutions to solutions. Whether it does is seen from the formulas."""

import numpy as np
import pytest
import scipy.sparse as sp

import contvines as cv


def has(F, mirror=lambda u: -u, start=(0.0,), p0=-1.0, **options):
    """Whether the equations have this mirror."""
    try:
        cv.AlgebraicProblem(F, np.array(start), p0, mirror=mirror, **options)
    except ValueError as error:
        assert "mirror is no symmetry of F: at u = " in str(error) and " of F at the image is" in str(error)
        return False
    return True


@pytest.mark.parametrize("size, rows", [(1.0, 1.0), (1e-9, 1e9), (1e9, 1e-9)])
def test_odd_equations_have_the_mirror_and_others_have_not(size, rows):
    def cubic(square, constant):
        return lambda u, p: rows * (p * u / size - (u / size) ** 3 + square * (u / size) ** 2 + constant)

    assert has(cubic(0.0, 0.0))
    assert not has(cubic(1e-4, 0.0)) and not has(cubic(0.0, 0.3))


def test_rows_may_be_mixed_as_long_as_it_is_by_constants():
    def mixed(extra):
        def F(u, p):
            a, b = p * u - u**3 + u[::-1]
            return np.array([1e9 * b, 1e-3 * a + 5.0 * b + extra * u[0] ** 2])

        return F

    assert has(mixed(0.0), [1, 0], (0.0, 0.0)) and not has(mixed(1e-3), [1, 0], (0.0, 0.0))


@pytest.mark.parametrize("n", [30, 3000])
def test_a_field_on_a_line_and_its_reflection(n):
    """Bratu's problem is the same read from the other end; with a heat source that grows along the line it is not."""
    laplacian = sp.diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(n, n)).tocsc() * (n + 1.0) ** 2

    def turns(slope):
        return has(
            lambda u, p: laplacian @ u + p * (np.exp(u) + slope * np.arange(n) / n),
            lambda u: u[::-1],
            np.zeros(n),
            1.0,
            jacobian=lambda u, p: laplacian + sp.diags_array(p * np.exp(u)),
        )

    assert turns(0.0) and not turns(1e-3)


def test_a_parameter_may_break_it():
    """p u - u^3 + e is odd for e = 0 alone."""
    problem = cv.AlgebraicProblem(
        lambda u, p: p.p * u - u**3 + p.e, [0.0], {"p": -1.0, "e": 0.0}, mirror=lambda u: -u
    )
    assert cv.diagram(problem, within=(-1.0, 1.0), depth=0).of_kind("symmetry-breaking")
    for other in (problem.against("e"), problem.against("p", {"e": 0.1})):
        with pytest.raises(ValueError, match="mirror is no symmetry of F"):
            cv.diagram(other, within=(-1.0, 1.0))


@pytest.mark.parametrize("mirror", [np.diag([1.0, 0.0]), lambda u: np.array([u[0], 0.0])])
def test_a_projection_is_no_mirror_though_it_commutes_with_the_equations(mirror):
    """R R = R has no inverse: solutions and their images are not equivalent."""

    def apart(u, p):
        return np.array([p * u[0] - u[0] ** 3, -u[1]])

    again = "applied twice a mirror must lead back to u"
    with pytest.raises(ValueError, match=again):
        cv.FlowProblem(lambda x, p: apart(x, p.m), [0.0, 0.0], {"m": -0.5}, mirror=mirror)
    with pytest.raises(ValueError, match=again):
        cv.MapProblem(apart, [0.0, 0.0], 0.5, mirror=mirror)
    for images in ({"mirror": mirror}, {"symmetries": [mirror]}):
        with pytest.raises(ValueError, match="does not lead back to u however often it is applied"):
            cv.AlgebraicProblem(apart, [0.0, 0.0], -0.5, **images)


def test_a_third_of_a_turn_generates_a_group_and_is_no_mirror():
    """z' = p z + z*^2 - z |z|^2 is the same after a third of a turn (Golubitsky, Stewart and Schaeffer 1988)."""
    turn = np.array([[-0.5, -np.sqrt(0.75)], [np.sqrt(0.75), -0.5]])

    def three(u, p):
        square = u[0] ** 2 + u[1] ** 2
        return np.array(
            [(p - square) * u[0] + u[0] ** 2 - u[1] ** 2, (p - square) * u[1] - 2.0 * u[0] * u[1]]
        )

    start = [0.0, 0.0]
    cv.AlgebraicProblem(three, start, -0.5, symmetries=[turn])
    with pytest.raises(ValueError, match="applied twice a mirror must lead back to u"):
        cv.FlowProblem(three, start, -0.5, mirror=turn)
