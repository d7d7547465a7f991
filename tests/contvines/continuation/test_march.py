"""The loop itself: compiled and interpreted, accuracy of the points, ends of a branch."""

import numpy as np
import pytest

import contvines as cv
from contvines.continuation.engine import Engine
from contvines.continuation.layout import Status
from contvines.continuation.settings import Settings
from contvines.continuation.starts import solve_start
from contvines.continuation.trace import chunks
from contvines.core.library import native
from contvines.problems.protocol import Kernels, ProblemDefaults
from tests.contvines.compiled import Made, in_memory


def linearise(c, u, p, work):
    work[0] = u[0] * u[0] + c[0] * p * p - 1.0
    work[1] = 2.0 * u[0]
    work[2] = 2.0 * c[0] * p
    return abs(work[0])


def bordered(c, work, border, n, step, tangent):
    F, J, Q = work
    det = J * border[1] - Q * border[0]
    step[0] = (-F * border[1] - Q * n) / det
    step[1] = (J * n + F * border[0]) / det
    tangent[0] = -Q / det
    tangent[1] = J / det
    return 1.0 if det > 0.0 else -1.0


def inspect(c, u, p, work, row):
    row[0] = 1.0 + u[0]
    row[1] = 0.0


class Ellipse(ProblemDefaults):
    """u^2 + c p^2 = 1, with a multiplier 1 + u that passes 1 at the folds."""

    dimension, n_multipliers, spectrum, parameter = 1, 1, "map", "p"
    u0, p0 = np.array([1.0]), 0.0

    def __init__(self, kernels, c=1.0):
        self.kernels = kernels
        self.data = in_memory(c) if kernels.compiled else [c]

    def workspace(self):
        return in_memory(0.0, 0.0, 0.0) if self.kernels.compiled else np.zeros(3)


INTERPRETED = Kernels(linearise, bordered, inspect)
KERNELS = {"interpreted": INTERPRETED}
if native():
    KERNELS["compiled"] = Made(linearise, bordered, inspect, (1, 1, 3, 2))
each = pytest.mark.parametrize("kernels", KERNELS.values(), ids=KERNELS)


def run(kernels, within=(-2.0, 2.0), **settings):
    engine = Engine(Ellipse(kernels), within, Settings(**settings))
    return list(chunks(engine, solve_start(engine, [1.0], 0.0)))


@pytest.mark.skipif(not native(), reason="no native core")
def test_compiled_and_interpreted_are_one_algorithm():
    compiled, interpreted = run(KERNELS["compiled"]), run(INTERPRETED)
    assert compiled[-1].status == interpreted[-1].status
    # chunks are shorter where points are dear; each begins with the last point of the one before
    for name, accuracy in (("points", 1e-12), ("tangents", 1e-11), ("signs", 0.0)):
        a, b = (np.concatenate([getattr(c, name)[1:] for c in parts]) for parts in (compiled, interpreted))
        np.testing.assert_allclose(a, b, rtol=0.0, atol=accuracy)


@each
@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("angle", [0.03, 0.1, 0.3])
def test_points_are_exact_at_every_tolerance_and_the_circle_closes(kernels, tolerance, angle):
    parts = run(kernels, tolerance=tolerance, angle=angle, max_step=0.2)
    residual = [np.abs(c.points[:, 0] ** 2 + c.values**2 - 1.0).max() for c in parts]
    assert max(residual) < 1e-12
    assert parts[-1].status == Status.CLOSED
    assert parts[-1].points[-1, 0] == 1.0 and parts[-1].values[-1] == 0.0


@each
def test_neighbouring_tangents_stay_within_twice_the_angle(kernels):
    engine = Engine(Ellipse(kernels), (-2.0, 2.0), Settings(angle=0.05, max_step=0.5))
    part = next(chunks(engine, solve_start(engine, [1.0], 0.0)))
    cosines = ((part.tangents[1:] * part.tangents[:-1]) @ engine.weights).clip(-1.0, 1.0)
    assert np.arccos(cosines).max() <= 0.1 + 1e-9


@each
def test_a_branch_ends_on_the_interval_exactly(kernels):
    points = list(cv.trace(Ellipse(kernels), within=(-0.25, 0.3)))
    assert points[-1].value == 0.3
    assert abs(points[-1].u[0] - np.sqrt(1 - 0.3**2)) < 1e-15
    assert "end of the interval" in points[-1].status
    assert all(not point.status for point in points[:-1])


def test_what_cannot_be_evaluated_ends_a_branch_with_a_sentence():
    def root(u, p):
        return np.array([u[0] - np.sqrt(p - 0.5)]) if np.real(p) >= 0.5 else np.array([np.nan])

    points = list(cv.trace(cv.AlgebraicProblem(root, [1.0], 1.5), within=(0.0, 2.0), direction=-1.0))
    assert "beyond" in points[-1].status or "smallest step" in points[-1].status
    assert abs(points[-1].value - 0.5) < 1e-2


def test_run_away_branch_ends():
    problem = cv.AlgebraicProblem(lambda u, p: u * p - 1.0, [1.0], 1.0)
    points = list(cv.trace(problem, within=(-1.0, 2.0), direction=-1.0))
    assert "run away" in points[-1].status


def test_largest_number_of_points():
    points = list(cv.trace(Ellipse(INTERPRETED), (-2.0, 2.0), settings={"max_points": 30, "first_chunk": 10}))
    assert "largest number of points" in points[-1].status
