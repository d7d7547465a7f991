"""The loop itself: compiled and interpreted, accuracy of the points, ends of a branch."""

import numpy as np
import pytest

import contvines as cv
from contvines.continuation.layout import Status
from contvines.core.library import native
from tests.contvines.continuation.curves import INTERPRETED, KERNELS, circle, each

WITHIN = (-2.0, 2.0)


@pytest.mark.skipif(not native(), reason="no native core")
def test_compiled_and_interpreted_are_one_algorithm():
    runs = [circle(kernels).chunks(WITHIN) for kernels in KERNELS.values()]
    assert runs[0][-1].status == runs[1][-1].status
    # chunks are shorter where points are dear; each begins with the last point of the one before
    for name, accuracy in (("points", 1e-12), ("tangents", 1e-11), ("signs", 0.0)):
        a, b = (np.concatenate([getattr(c, name)[1:] for c in parts]) for parts in runs)
        np.testing.assert_allclose(a, b, rtol=0.0, atol=accuracy)


@each
@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("angle", [0.03, 0.1, 0.3])
def test_points_are_exact_at_every_tolerance_and_the_circle_closes(kernels, tolerance, angle):
    parts = circle(kernels).chunks(WITHIN, tolerance=tolerance, angle=angle, max_step=0.2)
    for part in parts:
        assert np.abs(part.points[:, 0] ** 2 + part.values**2 - 1.0).max() < 1e-12
    assert parts[-1].status == Status.CLOSED
    assert parts[-1].points[-1, 0] == 1.0 and parts[-1].values[-1] == 0.0


@each
def test_neighbouring_tangents_stay_within_twice_the_angle(kernels):
    curve = circle(kernels)
    tangents = curve.chunks(WITHIN, angle=0.05, max_step=0.5)[0].tangents
    cosines = ((tangents[1:] * tangents[:-1]) @ curve.engine(WITHIN).weights).clip(-1.0, 1.0)
    assert np.arccos(cosines).max() <= 0.1 + 1e-9


@each
def test_a_branch_ends_on_the_interval_exactly(kernels):
    points = list(cv.trace(circle(kernels), within=(-0.25, 0.3)))
    assert points[-1].value == 0.3
    assert abs(points[-1].u[0] - np.sqrt(1 - 0.3**2)) < 1e-15
    assert "end of the interval" in points[-1].status
    assert all(not point.status for point in points[:-1])


HYPERBOLA = cv.AlgebraicProblem(lambda u, p: u * p - 1.0, [1.0], 1.0)


@pytest.mark.parametrize(
    ("problem", "settings", "reason"),
    [
        (HYPERBOLA, {}, "run away"),
        (circle(INTERPRETED), {"max_points": 30, "first_chunk": 10}, "largest number of points"),
    ],
)
def test_other_ends(problem, settings, reason):
    points = list(cv.trace(problem, within=WITHIN, direction=-1.0, settings=settings))
    assert reason in points[-1].status


class Helix(cv.AlgebraicProblem):
    """An angle, and its sine as the second unknown; the parameter is its cosine. A turn later it is the same solution."""

    period_shift = np.array([2.0 * np.pi, 0.0])


def test_a_turn_later_the_branch_has_come_back():
    helix = Helix(
        lambda u, p: np.array([p - np.cos(u[0]), u[1] - np.sin(u[0])]),
        [1.0, np.sin(1.0)],
        np.cos(1.0),
        scale=1.0,
    )
    points = list(cv.trace(helix, within=WITHIN, settings={"max_step": 0.2}))
    angles = np.array([point.u[0] for point in points])
    way = np.sign(angles[1] - 1.0)
    assert points[-1].u == pytest.approx([1.0 + way * 2.0 * np.pi, np.sin(1.0)], abs=1e-12)
    assert points[-1].value == points[0].value
    assert np.all(way * np.diff(angles) >= 0.0)
