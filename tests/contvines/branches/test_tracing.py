"""A half of a branch that comes back to a symmetry: what rounding makes of the solutions next to the meeting is no part of it."""

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.detect import Detector
from contvines.bifurcation.located import Located, Role
from contvines.branches.tracing import trace_half
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings
from contvines.journal import NullJournal

BEND = 1e-3


class Misled(Detector):
    """Tells of a fold at some x, shortly before the meeting, as rounding may."""

    x = 0.0

    def look(self, chunk, scan, real=True):
        events = super().look(chunk, scan, real)
        if events and events[-1].role is Role.MEETING:
            point = self.engine.at_value(np.array([self.x]), BEND * self.x**2)
            place = events[-1].position - 1e-9
            events.insert(-1, Located(place, "fold", 0, point, (0.0, 0.0), 1e-16))
        return events


@pytest.mark.parametrize(("x", "kinds"), [(1e-6, []), (1e-2, ["fold"])])
def test_turns_beside_a_meeting_that_rounding_may_have_made_are_left_out(x, kinds):
    """p = BEND x^2: so near to x = 0 that the parameter does not tell it, a turn is no fold; further away it may be one."""
    problem = cv.AlgebraicProblem(
        lambda u, p: np.array([u[0] * (p - BEND * u[0] ** 2)]), [0.5], 0.25 * BEND, mirror=np.array([[-1.0]])
    )
    engine = Engine(problem, (-0.1, 0.1), Settings())
    watch = Misled(engine)
    watch.x = x
    start = engine.at_value(np.array([0.5]), 0.25 * BEND)
    start = start._replace(tangent=-np.sign(start.tangent[0]) * start.tangent)  # towards x = 0
    half = trace_half(engine, start, watch, NullJournal(), "")
    assert [event.kind for _, event in half.events[:-1]] == kinds
    assert half.events[-1][1].role is Role.MEETING
    assert abs(half.at(len(half) - 1)[0][0]) < 1e-8
    np.testing.assert_array_equal(half.first, start.u)
