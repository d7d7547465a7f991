"""Machines that are in no example, against an integrator that shares nothing with the engine: DOP853 with events, from node to node.

A gear pair with backlash and dry friction (Kahraman and Singh, J. Sound Vib. 142 (1990) 49, with friction added): its teeth touch on either
side, and between the two crossings of a side the motion turns. Two blocks on a belt, joined by a spring that only pulls, which hit one another
(after Galvanetto and Bishop, Int. J. Mech. Sci. 36 (1994) 683): self-excited, with two frictions, a wall between two masses and a switch.
"""

import pytest

import contvines as cv
from orbits import DryFriction, Machine, Switch, Wall
from orbits.symbols import cos
from tools.pages.independent import deviation

pytestmark = pytest.mark.slow


def gear_pair():
    def motion(state, phase, p, contact):
        x, v = state
        ahead, behind = (1 + contact.drive) / 2, (1 - contact.back) / 2
        mesh = p.stiffness * ((x - p.backlash) * ahead + (x + p.backlash) * behind)
        return v, p.load + p.forcing * cos(phase) - 2 * p.damping * v - mesh + contact.rub

    numbers = {"load": 0.1, "forcing": 0.3, "frequency": 0.8, "damping": 0.03}
    return Machine(
        name="gear",
        states=("x", "v"),
        parameters={**numbers, "stiffness": 1.0, "backlash": 0.5, "friction": 0.02},
        phase_rate="frequency",
        motion=motion,
        contacts=[
            Switch("drive", lambda state, phase, p: state.x - p.backlash),
            Switch("back", lambda state, phase, p: state.x + p.backlash),
            DryFriction("rub", lambda state, phase, p: state.v, "friction"),
        ],
    )


def blocks_on_a_belt():
    def limit(velocity):
        def law(state, phase, p):
            sliding = p.belt - getattr(state, velocity)
            return p.least + (1 - p.least) / (1 + p.weakening * sliding**2)

        return law

    def motion(state, phase, p, contact):
        x1, x2, v1, v2 = state
        link = p.coupling * (x2 - x1) * (1 + contact.taut) / 2
        one = -x1 - 2 * p.damping * v1 + link + contact.first
        return v1, v2, one, -p.ratio * x2 - 2 * p.damping * v2 - link + contact.second

    numbers = {"belt": 1.0, "damping": 0.02, "least": 0.4, "weakening": 3.0, "coupling": 0.4, "ratio": 1.3}
    return Machine(
        name="two_blocks",
        states=("x1", "x2", "v1", "v2"),
        parameters={**numbers, "gap": 2.0, "restitution": 0.6},
        motion=motion,
        contacts=[
            DryFriction("first", lambda s, phase, p: s.v1 - p.belt, limit("v1")),
            DryFriction("second", lambda s, phase, p: s.v2 - p.belt, limit("v2"), letters=("t2", "s2", "u2")),
            Wall("H", lambda s, phase, p: p.gap + s.x2 - s.x1, {"v1": -1.0, "v2": 1.0}, "restitution"),
            Switch("taut", lambda s, phase, p: s.x2 - s.x1),
        ],
    )


def test_a_gear_pair_turns_between_the_crossings_of_a_side():
    machine = gear_pair()
    assert machine.alphabet.rides == {(0, 2), (1, 2)}
    orbit = machine.attractor(frequency=0.8).orbit
    assert (
        orbit.word.canonical().events
        == machine.word("back- t back+ drive+ t drive-", orbit.params).canonical().events
    )
    assert deviation(orbit, machine.equations.formulas_of_motion) < 1e-8
    # past two folds the far side of the backlash is only just reached
    graph = cv.diagram(orbit, over="frequency", within=(0.79, 0.95), depth=0)
    (graze,) = [p for p in graph.special.values() if p.kind == "switch-graze"]
    there = graph.branches[graze.branch].problem.orbit(graze.u, graze.value)
    assert deviation(there, machine.equations.formulas_of_motion) < 1e-8


def test_two_blocks_on_a_belt_that_hit_one_another():
    machine = blocks_on_a_belt()
    orbit = machine.attractor({"x1": 0.5, "x2": 0.6, "v1": 0.2}).orbit
    assert orbit.word.text == "H s2 taut+ u2- s taut- u-"
    assert orbit.real and orbit.stable and orbit.replay() < 1e-10
    assert deviation(orbit, machine.equations.formulas_of_motion) < 1e-8
