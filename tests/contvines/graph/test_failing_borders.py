"""A problem that fails at one of its borders: the graph has everything else, and the border names the error.

Word "a" (of `test_borders`): u = p, real for 0.2 < p < 0.5. Beyond p = 0.5 goes on word "b", u = 2 p - 1/2.
"""

from dataclasses import replace

import numpy as np
import pytest

import contvines as cv
from tests.contvines.graph.test_borders import Line, persistent

FAILURE = ZeroDivisionError("no such motion")


class Failing(Line):
    """Fails in one of the questions that a border asks, at the border p = 0.2."""

    def __init__(self, where, error=FAILURE):
        super().__init__("a", 0.0, 1.0, [1.0, -1.0], [0.2, 0.5])
        self.where, self.error = where, error

    def fail(self, where, p):
        if where == self.where and p < 0.3:
            raise self.error

    def beyond(self, point):
        self.fail("beyond", point.value)
        if point.value > 0.3:
            return [persistent(self, point)]
        return [seed_of(Rootless())] if self.where == "root" else []

    def dead_end(self, point):
        self.fail("dead_end", point.value)
        return ""


class Rootless(Line):
    """Word "c", u = -p, real for p < 0.2; it fails when it is asked for a shorter solution."""

    def __init__(self):
        super().__init__("c", 0.0, -1.0, [-1.0], [0.2])

    def root(self, u, p):
        raise ZeroDivisionError("no such motion")


def seed_of(problem):
    found = persistent(problem, None)
    return replace(found, problem=problem, u=np.array([-0.1]), p=0.1)


@pytest.mark.parametrize("where", ["beyond", "dead_end", "root"])
def test_an_error_at_one_border_costs_nothing_else(where):
    graph = cv.diagram(Failing(where), within=(0.0, 1.0))
    assert graph.finished and [branch.description["word"] for branch in graph] == ["a", "b"]
    np.testing.assert_allclose([b.range for b in graph], [(0.2, 0.5), (0.5, 1.0)], atol=1e-13)
    failed, crossed = sorted(
        (point for point in graph.special.values() if point.kind != "end"), key=lambda point: point.value
    )
    assert "ZeroDivisionError: no such motion" in failed.note and crossed.note == ""
    assert [switch.point for switch in graph.switches] == [crossed.label]


@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError, OSError])
def test_an_interrupt_or_a_full_machine_is_no_error_of_a_border(error):
    with pytest.raises(error):
        cv.diagram(Failing("beyond", error()), within=(0.0, 1.0))
