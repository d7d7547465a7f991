"""The absorber on its oscillator, inclined: against a page of the same machine, energy and hand-made formulas."""

import json

import numpy as np
import pytest

import contvines as cv
from orbits import Coupled, DryFriction, Machine
from orbits.problem import rebuild
from orbits.symbols import cos, sin
from tests.machines import STRONG
from tools.pages.pages import page

NUMBERS = STRONG | {"damping": 1.0}
INCLINED = Coupled(forcing=2.47, slope=0.1, **NUMBERS)


def inclined_page():
    """The same machine by its equations of motion, with the oscillator counted from where it rests without its absorber."""
    level = page("coupled")

    def motion(state, phase, p, contact):
        *others, last = level.equations.formulas_of_motion(state, phase, p, contact)
        return *others, last + p.gravity * sin(p.slope)

    def limit(state, phase, p):
        return p.friction * p.gravity * cos(p.slope)

    return Machine(
        name="inclined",
        states=level.states,
        parameters=level.parameters | {"slope": 0.1},
        phase_rate="frequency",
        motion=motion,
        contacts=[*level.contacts[:2], DryFriction("floor", lambda s, phase, p: s.v1 - s.v2, limit)],
    )


def test_the_page_has_the_same_orbits_and_special_points():
    own = INCLINED.attractor({"q1": 1.0, "q2": 1.0}, frequency=0.985).orbit
    settings = {"over": "frequency", "within": (0.98, 0.992), "depth": 0}
    there = inclined_page().orbit(own.spelling, own.periods, frequency=0.985)
    assert sorted(map(abs, there.multipliers)) == pytest.approx(sorted(map(abs, own.multipliers)), abs=1e-9)
    graphs = [cv.diagram(orbit, **settings) for orbit in (own, there)]
    (kinds, values), (others, elsewhere) = (
        zip(*sorted((p.kind, p.value) for p in graph.special.values())) for graph in graphs
    )
    assert kinds == others and len(kinds) > 1 and values == pytest.approx(elsewhere, abs=1e-10)


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
