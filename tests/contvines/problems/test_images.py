"""Groups of images from their generators."""

import numpy as np
import pytest

import contvines as cv
from contvines.problems.images import images_of, smallest_image


def test_a_quarter_turn_and_a_reflection_generate_the_square():
    turn, flip = np.array([[0.0, -1.0], [1.0, 0.0]]), np.diag([1.0, -1.0])
    images = images_of([lambda u: turn @ u, lambda u: flip @ u], 2)
    assert len(images) == 7
    u = np.array([0.3, 0.7])
    for image in images:
        assert smallest_image(image(u), images, np.ones(2)) == pytest.approx([-0.7, -0.3])


def cells(u, p):
    """Demo enz of AUTO: two coupled cells with s / (1 + s + s^2) each."""
    r = u / (1 + u + u**2)
    return p - u + u[::-1] - u - 100 * r


def folds_of_unlike_cells():
    """s0 at the turning points of the solutions with x != y, by a scan.

    With s = x + y and t = x y the difference of the equations is 3 (s^2 + s (1 + t) + 1 - t + t^2) = 100 (t - 1), their sum s0.
    """
    t = np.linspace(1.0 + 1e-9, 60.0, 2_000_001)
    c = 1 - t + t**2 - 100 * (t - 1) / 3
    with np.errstate(invalid="ignore"):
        s = 0.5 * (-(1 + t) + np.sqrt((1 + t) ** 2 - 4 * c))
        root = np.sqrt(s**2 / 4 - t)
    t, s, root = (values[np.isfinite(root)] for values in (t, s, root))
    x, y = s / 2 + root, s / 2 - root
    s0 = s / 2 + 50 * (x / (1 + x + x**2) + y / (1 + y + y**2))
    inner = np.flatnonzero(np.diff(np.sign(np.diff(s0)))) + 1
    return s0[inner]


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.01, 0.03, 0.1])
@pytest.mark.parametrize("mirror", [None, [1, 0]])
def test_no_false_folds_beside_the_pitchforks_of_two_cells(mirror, step):
    options = {} if mirror is None else {"mirror": mirror}
    problem = cv.AlgebraicProblem(cells, [0.0, 0.0], 0.0, parameter="s0", spectrum="flow", **options)
    graph = cv.diagram(problem, within=(0.0, 50.0), settings={"max_step": step})
    # alike: s0 = x + 100 x / (1 + x + x^2); 1 + 100 r' = 0 at folds, 3 + 100 r' = 0 at pitchforks, r' = (1 - x^2) / (1 + x + x^2)^2
    D = np.polynomial.Polynomial([1, 1, 1])

    def alike(coupling):
        roots = (coupling * D**2 + 100 * np.polynomial.Polynomial([1, 0, -1])).roots()
        x = roots[(abs(roots.imag) < 1e-9) & (roots.real > 0)].real
        return x + 100 * x / D(x)

    both = folds_of_unlike_cells()
    assert len(both) == 2
    folds = np.sort([*alike(1), *(both if mirror else np.repeat(both, 2))])
    assert np.sort([p.value for p in graph.of_kind("fold")]) == pytest.approx(folds, abs=1e-9)
    forks = graph.of_kind("symmetry-breaking" if mirror else "branch-point")
    assert np.sort([p.value for p in forks]) == pytest.approx(np.sort(alike(3)), abs=1e-11)


def test_a_permutation_is_a_mirror_of_maps_too():
    # Kopel's duopoly: alike x = y = 1 - 1/mu, J = (1/2) [[1, 2 - mu], [2 - mu, 1]]: (1/2) (1 - 2 + mu) = 1 across at mu = 3
    def kopel(x, p):
        return 0.5 * x + 0.5 * p * x[::-1] * (1 - x[::-1])

    problem = cv.MapProblem(kopel, [0.5, 0.5], 2.0, parameter="mu", mirror=[1, 0])
    graph = cv.diagram(problem, within=(1.5, 3.8), depth=1)
    (point,) = graph.of_kind("symmetry-breaking")
    assert point.value == pytest.approx(3.0, abs=1e-11)
    assert len(graph.branches) == 2  # of two mirror images one is traced
    side = next(branch for branch in graph if branch.seed == point.label)
    for (x, y), mu in zip(side.points, side.values):  # x + y = 1 + 1/mu, x y = (1 + 1/mu) / mu
        assert x + y == pytest.approx(1 + 1 / mu, abs=1e-9)
        assert x * y == pytest.approx((1 + 1 / mu) / mu, abs=1e-9)
