"""Branches that come back to their start, as they are or a period later."""

import numpy as np
import pytest

import contvines as cv
from contvines.continuation.engine import Engine
from contvines.continuation.layout import Status
from contvines.continuation.settings import Settings
from contvines.continuation.starts import solve_start
from contvines.continuation.trace import chunks


class Helix(cv.AlgebraicProblem):
    """An angle, and its sine as the second unknown; the parameter is its cosine. A turn later it is the same solution."""

    period_shift = np.array([2.0 * np.pi, 0.0])

    def __init__(self):
        super().__init__(
            lambda u, p: np.array([p - np.cos(u[0]), u[1] - np.sin(u[0])]),
            [1.0, np.sin(1.0)],
            np.cos(1.0),
            scale=1.0,
        )


def test_a_turn_later_the_branch_has_come_back():
    engine = Engine(Helix(), (-2.0, 2.0), Settings(max_step=0.2))
    start = solve_start(engine, [1.0, np.sin(1.0)], np.cos(1.0))
    parts = list(chunks(engine, start))
    last = parts[-1]
    assert last.status == Status.CLOSED
    way = np.sign(parts[0].points[1, 0] - 1.0)
    assert last.points[-1] == pytest.approx([1.0 + way * 2.0 * np.pi, np.sin(1.0)], abs=1e-12)
    assert last.values[-1] == parts[0].values[0]
    angles = np.concatenate([part.points[:, 0] for part in parts])
    assert np.all(way * np.diff(angles) >= 0.0) and way * (angles[-1] - 1.0) == pytest.approx(2.0 * np.pi)
