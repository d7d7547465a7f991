"""Responses by simulation where a diagram has no stable branch: of a machine file, at fewer values, against the closed form."""

from typing import Any

import numpy as np
import pytest

import contvines as cv
from contvines.command.run import _shows_response
from contvines.survey.completion import simulated
from orbits import Machine, Wall
from orbits.symbols import cos

DAMPING = 0.05

machine = Machine(
    name="far_stop",
    states=("x", "v"),
    parameters={"frequency": 1.5},
    phase_rate="frequency",
    motion=lambda s, phase, p, contact: (s.v, cos(phase) - 2.0 * DAMPING * s.v - s.x),
    contacts=[Wall("R", lambda s, phase, p: 50.0 - s.x, {"v": -1.0}, 0.5)],
    response="max_x",
    starts={"x": (-1.0, 1.0), "v": (-1.0, 1.0)},
)


def test_a_linear_answer_beside_a_branch_that_ends():
    """x'' + 2 d x' + x = cos wt has the amplitude ((1 - w^2)^2 + (2 d w)^2)^(-1/2)."""
    graph = cv.diagram(machine.orbit("", frequency=1.5), over="frequency", within=(1.4, 1.6), depth=0)
    graph.within = (1.4, 2.4)
    assert _shows_response(graph, None) and not _shows_response(graph, "max_v")
    starts: Any = machine.population("frequency")
    met = simulated(graph, starts)
    values = sorted({value for value, *_ in met})
    assert 5 <= len(values) <= 15 and values[0] > 1.6 and values[-1] < 2.4
    for value, low, mean, high in met:
        answer = np.hypot(1.0 - value**2, 2.0 * DAMPING * value) ** -1.0
        assert low == mean == high == pytest.approx(answer, rel=1e-6)
