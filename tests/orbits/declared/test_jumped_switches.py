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
