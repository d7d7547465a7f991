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


TURN = np.array([[-0.5, -np.sqrt(0.75)], [np.sqrt(0.75), -0.5]])


def apart(u, p):
    return np.array([p * u[0] - u[0] ** 3, -u[1]])


def three(u, p):
    """z' = p z + z*^2 - z |z|^2 is the same after a third of a turn (Golubitsky, Stewart and Schaeffer 1988)."""
    x, y = u
    own = p - x * x - y * y
    return np.array([own * x + x * x - y * y, own * y - 2.0 * x * y])


@pytest.mark.parametrize(
    ("F", "mirror"),
    [(apart, np.diag([1.0, 0.0])), (apart, lambda u: np.array([u[0], 0.0])), (three, TURN)],
    ids=["a projection", "a projection as a function", "a third of a turn"],
)
def test_what_is_no_mirror_though_it_commutes_with_the_equations(F, mirror):
    """Of a projection, R R = R, solutions and their images are not equivalent; a third of a turn generates a group."""
    start, again = [0.0, 0.0], "applied twice a mirror must lead back to u"
    with pytest.raises(ValueError, match=again):
        cv.FlowProblem(lambda x, p: F(x, p.m), start, {"m": -0.5}, mirror=mirror)
    with pytest.raises(ValueError, match=again):
        cv.MapProblem(F, start, 0.5, mirror=mirror)
    for images in ({"mirror": mirror}, {"symmetries": [mirror]}):
        if F is three:
            cv.AlgebraicProblem(F, start, -0.5, **images)
            continue
        with pytest.raises(ValueError, match="does not lead back to u however often it is applied"):
            cv.AlgebraicProblem(F, start, -0.5, **images)
