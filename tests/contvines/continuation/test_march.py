"""The loop itself: compiled and interpreted, accuracy of the points, ends of a branch."""

import numpy as np
import pytest

import contvines as cv
from contvines.continuation.engine import Engine
from contvines.continuation.layout import Status
from contvines.continuation.settings import Settings
from contvines.continuation.starts import solve_start
from contvines.continuation.trace import chunks

WITHIN = (-2.0, 2.0)
CIRCLE = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1.0, [1.0], 0.0, scale=1.0)
HYPERBOLA = cv.AlgebraicProblem(lambda u, p: u * p - 1.0, [1.0], 1.0)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("angle", [0.03, 0.1, 0.3])
def test_points_are_exact_at_every_tolerance_and_the_circle_closes(tolerance, angle):
    """Neighbouring tangents stay within twice the angle, the last corrections within the tolerance."""
    engine = Engine(CIRCLE, WITHIN, Settings(tolerance=tolerance, angle=angle, max_step=0.2))
    parts = list(chunks(engine, solve_start(engine, [1.0], 0.0)))
    for part in parts:
        assert np.abs(part.points[:, 0] ** 2 + part.values**2 - 1.0).max() < 1e-12
        assert part.corrections[1:].max() <= tolerance
        cosines = ((part.tangents[1:] * part.tangents[:-1]) @ engine.weights).clip(-1.0, 1.0)
        assert np.arccos(cosines).max() <= 2.0 * angle + 1e-9
    assert parts[-1].status == Status.CLOSED
    assert parts[-1].points[-1, 0] == 1.0 and parts[-1].values[-1] == 0.0


def test_a_branch_ends_on_the_interval_exactly():
    points = list(cv.trace(CIRCLE, within=(-0.25, 0.3)))
    assert points[0].value == 0.0 and points[-1].value == 0.3
    assert abs(points[-1].u[0] - np.sqrt(1 - 0.3**2)) < 1e-15
    assert "end of the interval" in points[-1].status
    assert all(not point.status for point in points[:-1])


@pytest.mark.parametrize(
    ("problem", "settings", "reason"),
    [
        (HYPERBOLA, {}, "run away"),
        (CIRCLE, {"max_points": 30, "first_chunk": 10}, "largest number of points"),
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
