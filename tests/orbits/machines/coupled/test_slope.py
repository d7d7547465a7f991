"""The absorber on its oscillator, inclined: against a page of the same machine, the inclined cavity, energy and hand-made formulas."""

import json

import numpy as np
import pytest

import contvines as cv
from orbits import Cavity, Coupled, DryFriction, Machine, Wall
from orbits.problem import rebuild
from orbits.symbols import cos, sin

NUMBERS = {"damping": 1.0, "mass_ratio": 0.006, "restitution": 0.76, "friction": 0.5, "gravity": 0.211}
INCLINED = Coupled(forcing=2.47, slope=0.1, **NUMBERS)


def page():
    """The same machine by its equations of motion, with the oscillator counted from where it rests without its absorber."""

    def motion(state, phase, p, contact):
        q1, q2, v1, v2 = state
        base = p.mass_ratio * p.forcing * (sin(phase) + p.mass_ratio * p.damping * p.frequency * cos(phase))
        spring = q1 + p.mass_ratio * p.damping * v1
        return v1, v2, base - spring + p.mass_ratio * contact.floor, p.gravity * sin(p.slope) - contact.floor

    def wall(letter, side):
        push = {"v1": lambda state, phase, p: -side * p.mass_ratio, "v2": side}
        return Wall(letter, lambda state, phase, p: 1 - side * (state.q1 - state.q2), push, "restitution")

    floor = DryFriction(
        "floor", lambda s, phase, p: s.v1 - s.v2, lambda s, phase, p: p.friction * p.gravity * cos(p.slope)
    )
    return Machine(
        name="inclined",
        states=("q1", "q2", "v1", "v2"),
        parameters={"forcing": 2.47, "frequency": 1.0, "slope": 0.1, **NUMBERS},
        phase_rate="frequency",
        motion=motion,
        contacts=[wall("L", 1), wall("R", -1), floor],
    )


def test_the_page_has_the_same_orbits_and_special_points():
    own = INCLINED.attractor({"q1": 1.0, "q2": 1.0}, frequency=0.985).orbit
    settings = {"over": "frequency", "within": (0.98, 0.992), "depth": 0}
    there = page().orbit(own.spelling, own.periods, frequency=0.985)
    assert sorted(map(abs, there.multipliers)) == pytest.approx(sorted(map(abs, own.multipliers)), abs=1e-9)
    graphs = [cv.diagram(orbit, **settings) for orbit in (own, there)]
    points = [sorted((p.kind, p.value) for p in graph.special.values()) for graph in graphs]
    assert len(points[0]) == len(points[1]) > 1
    for (kind, value), (other, elsewhere) in zip(*points):
        assert kind == other and value == pytest.approx(elsewhere, abs=1e-10)


def test_a_light_absorber_is_the_inclined_cavity():
    # without an absorber that matters the oscillator moves as q1 = C sin(Omega tau)
    eps, omega = 1e-11, 0.7
    light = Coupled(
        forcing=0.9 / eps * (1.0 - omega**2), frequency=omega, damping=0.0, mass_ratio=eps,
        restitution=0.7, friction=0.3, gravity=0.2, slope=0.25,
    )  # fmt: skip
    cavity = Cavity(restitution=0.7, friction=0.3, gravity=0.2, slope=0.25, frequency=omega)
    alone = cavity.attractor({"w": 0.1}, amplitude=0.9).orbit
    phase = alone.nodes[:, 0]
    guess = np.column_stack([alone.nodes, 0.9 * np.sin(phase), 0.9 * omega * np.cos(phase)])
    orbit = light.orbit(alone.spelling, alone.periods, guess)
    assert np.abs(orbit.nodes[:, :2] - alone.nodes).max() < 1e-8
    own = sorted((abs(m) for m in orbit.multipliers), key=lambda m: abs(m - 1.0))[
        2:
    ]  # the oscillator's are 1
    assert sorted(own) == pytest.approx(sorted(map(abs, alone.multipliers)), abs=1e-7)


def test_it_rests_up_to_the_angle_of_friction():
    still = INCLINED.changed(forcing=0.0)
    for slope, rests in ((np.arctan(0.5) - 1e-5, True), (np.arctan(0.5) + 1e-5, False)):
        run = still.changed(slope=slope).simulate({"q1": 0.0, "q2": -0.2}, periods=400)
        assert (run.codes.size == 0) is rests
    # shaken, it slips down first: (1 + eps) Omega^2 |q1| = (1 + eps) g (mu cos(slope) - sin(slope))
    response = INCLINED.changed(forcing=0.3, frequency=0.9).stuck_response()
    expected = 1.006 * (0.211 * (0.5 * np.cos(0.1) - np.sin(0.1)) - 0.9**2 * response.amplitude)
    assert response.reserve == pytest.approx(expected, abs=1e-14)


def test_a_file_from_before_the_slope_is_read():
    level = Coupled(forcing=2.47, **NUMBERS)
    problem = level.symmetric_orbit(frequency=0.99).problem("frequency")
    old = json.loads(json.dumps(problem.describe()))
    del old["model"]["slope"]
    old["params"] = old["params"][:8]
    again = rebuild(old)
    assert again is not None and np.array_equal(again.params, problem.params)


def test_a_certificate_proves_an_inclined_orbit():
    pytest.importorskip("flint")
    from orbits.proofs.checker import verify

    proof = INCLINED.attractor({"q1": 1.0, "q2": 1.0}, frequency=0.985).orbit.prove()
    assert proof.real and proof.stable
    verify(proof.certificate())
