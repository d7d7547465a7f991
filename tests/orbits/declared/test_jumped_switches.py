"""Impacts that jump over the surface of a switch: quadratic drag turns with the velocity, which a bounce turns at once."""

import math

import pytest
from scipy.optimize import brentq

import contvines as cv
from orbits import Machine, Switch, Wall
from orbits.symbols import cos

GRAVITY, DRAG, RESTITUTION = 0.1, 0.1, 0.8


def ball(**changes):
    """A ball with quadratic drag on a table that shakes."""
    page = {
        "name": "dragged",
        "states": ("y", "v"),
        "parameters": {"amplitude": 0.07, "frequency": 1.0, "drag": DRAG},
        "phase_rate": "frequency",
        "motion": lambda s, phase, p, contact: (s.v, -GRAVITY - p.drag * s.v**2 * contact.up),
        "contacts": [
            Wall("B", lambda s, phase, p: s.y - p.amplitude * cos(phase), {"v": 1.0}, RESTITUTION),
            Switch("up", surface=lambda s, phase, p: s.v),
        ],
    }
    return Machine(**{**page, **changes})


@pytest.fixture(scope="module")
def machine():
    return ball()


def test_the_fold_of_the_dragged_bounce(machine):
    """One bounce a period: up with v0, down with v1, and the table moves with (v0 - e v1)/(1 + e) there, at most A W.

    Up: v = k tan, over v0 in the time atan(v0/k)/sqrt(g c), to the height ln(1 + (v0/k)^2)/(2 c), k^2 = g/c.
    Down from there: v1^2 = k^2 (1 - exp(-2 c h)), in the time atanh(v1/k)/sqrt(g c).
    """
    k, rate = math.sqrt(GRAVITY / DRAG), math.sqrt(GRAVITY * DRAG)

    def landing(v0):
        height = math.log1p((v0 / k) ** 2) / (2 * DRAG)
        return k * math.sqrt(-math.expm1(-2 * DRAG * height))

    v0 = brentq(
        lambda v: (math.atan(v / k) + math.atanh(landing(v) / k)) / rate - 2 * math.pi, 0.1, 1.0, xtol=1e-15
    )
    exact = (v0 - RESTITUTION * landing(v0)) / (1 + RESTITUTION)
    start = machine.attractor({"y": 0.1, "v": 0.33, "phase": -0.8})
    assert start.word.text == "B up-" and start.orbit.real and start.orbit.replay() < 1e-10
    graph = cv.diagram(start, over="amplitude", within=(0.02, 0.09), depth=0)
    assert [p.value for p in graph.of_kind("fold")] == pytest.approx([exact], abs=1e-10)


def test_a_crossing_that_comes_out_of_an_impact():
    """Drag beyond a speed `level`: the impact leaves the speed e v; where that is the level, the jump over it becomes a crossing."""
    machine = Machine(
        name="between",
        states=("x", "v"),
        parameters={"forcing": 0.5, "frequency": 2.4, "damping": 0.1, "level": 0.3, "drag": 0.2},
        phase_rate="frequency",
        motion=lambda s, phase, p, c: (
            s.v,
            p.forcing * cos(phase) - p.damping * s.v - s.x + p.drag * (s.v + p.level) ** 2 * (1 - c.side) / 2,
        ),
        contacts=[
            Wall("R", lambda s, phase, p: 0.1 - s.x, {"v": -1.0}, 0.7),
            Switch("side", surface=lambda s, phase, p: s.v + p.level),
        ],
    )
    graph = cv.diagram(machine.attractor(level=0.16), over="level", within=(0.15, 0.25), depth=0)
    notes = [switch.note for switch in graph.switches]
    assert [note.split(":")[0] for note in notes] == [
        "a crossing of a switch falls into an impact",
        "an impact leaves a switch to be crossed",
    ]
    assert all("persistence" in note for note in notes)
    assert all(branch.stable.all() for branch in graph.branches.values())
    for point in graph.of_kind("switch-graze"):
        orbit = graph.branches[point.branch].problem.orbit(point.u, point.value)
        speeds = [-row[2] for row, event in zip(orbit.nodes, orbit.word.events) if event == "R"]
        assert (
            min(abs(speed - point.value) for speed in speeds) < 1e-10
        )  # the speed after an impact is the level
        assert point.replay < 1e-6
