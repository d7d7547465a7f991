"""A machine has the same branches in every unit: its motions are thousands of micrometres, or thousandths of a metre."""

import math

import pytest

import contvines as cv
from orbits import Machine, Wall
from orbits.symbols import cos

pytest.importorskip("pint")

MASS, STIFFNESS, DAMPING, FORCE, GAP = 4.0, 16e3, 12.0, 40.0, 8e-3


def machine(length, speed):
    """A mass of 4 kg on a spring beside a wall at 8 mm, driven by 40 N."""
    return Machine(
        name="press",
        states=("x", "v"),
        parameters={"gap": "8 mm", "frequency": "9 Hz", "restitution": 0.6},
        units={"x": length, "v": speed, "gap": length, "frequency": "Hz"},
        phase_rate="frequency",
        motion=lambda state, phase, p, contact: (
            state.v,
            (FORCE * cos(phase) - DAMPING * state.v - STIFFNESS * state.x) / MASS,
        ),
        contacts=[
            Wall(
                "R", gap=lambda state, phase, p: p.gap - state.x, push={"v": -1.0}, restitution="restitution"
            )
        ],
    )


@pytest.mark.slow
@pytest.mark.parametrize(("length", "speed"), [("m", "m/s"), ("mm", "mm/s"), ("mm", "m/s"), ("um", "um/s")])
def test_the_branch_ends_where_the_linear_response_reaches_the_wall(length, speed):
    start = machine(length, speed).orbit("R", frequency=10.0)
    graph = cv.diagram(start, over="frequency", within=(8.0, 11.5), depth=0)
    assert {name: point.kind for name, point in graph.special.items()} == {
        "WG1": "wall-graze",
        "PD1": "period-doubling",
        "EP1": "end",
        "EP2": "end",
    }
    # (F/k)^2 = gap^2 ((1 - s)^2 + 4 D^2 s), s the square of the frequency over the natural one
    natural = math.sqrt(STIFFNESS / MASS)
    ratio = DAMPING / (2.0 * MASS * natural)
    half, rest = 1.0 - 2.0 * ratio**2, 1.0 - (FORCE / STIFFNESS / GAP) ** 2
    square = half - math.sqrt(half**2 - rest)
    assert graph["WG1"].value == pytest.approx(natural * math.sqrt(square) / (2.0 * math.pi), rel=1e-9)
    assert not graph.unresolved and len(graph["B1"]) < 500


@pytest.mark.parametrize(("length", "speed"), [("m", "m/s"), ("mm", "mm/s")])
def test_what_simulation_meets_lies_on_its_branch(length, speed):
    """At 8.5 Hz, where all starts lead to two impacts in three periods, and far above the resonance, where few lead to the linear response of
    F/k/sqrt((1 - s)^2 + 4 D^2 s) = 4.6 mm and the others to impacts."""

    def met(at):
        within = (at - 0.02, at + 0.02)
        return cv.atlas(
            machine(length, speed), over="frequency", within=within, values=[at], starts=32, scan=0, depth=0
        )

    (doubled,) = met(8.5).attractors
    assert (doubled.word, doubled.periods, doubled.branch) == ("RR", 3, "B1")
    atlas = met(12.5)
    assert sorted((about.word, about.branch) for about in atlas.attractors) == [("", "B2"), ("R", "B1")]
    square = (25.0 * math.pi) ** 2 / (STIFFNESS / MASS)
    ratio = DAMPING / (2.0 * MASS * math.sqrt(STIFFNESS / MASS))
    size = FORCE / STIFFNESS / math.sqrt((1.0 - square) ** 2 + 4.0 * ratio**2 * square)
    smooth = atlas["B2"]
    near = min(range(len(smooth)), key=lambda i: abs(smooth.values[i] - 12.5))
    assert smooth.orbit(near).measure("max_x") == pytest.approx(
        size / {"m": 1.0, "mm": 1e-3}[length], rel=0.02
    )
