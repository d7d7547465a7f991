"""Every bad page is refused with a sentence that names the contact and the way out."""

import math

import pytest

from orbits import DryFriction, Machine, Switch, Wall
from orbits.symbols import cos


def motion(state, phase, p, contact):
    return state.v, p.forcing * cos(phase) - state.x


def wall(letter="R", push=None, **options):
    return Wall(letter, lambda state, phase, p: p.gap - state.x, push or {"v": -1.0}, **options)


def declared(**changes):
    page = {
        "name": "box",
        "states": ("x", "v"),
        "parameters": {"forcing": 1.0, "frequency": 1.3, "gap": 1.0},
        "phase_rate": "frequency",
        "motion": motion,
        "contacts": [wall()],
    }
    return Machine(**{**page, **changes})


def rubbing(state, phase, p, contact):
    return state.v, p.forcing * cos(phase) - state.x + contact.floor


def floor(**options):
    return DryFriction("floor", lambda state, phase, p: state.v, 0.2, **options)


def stepped(state, phase, p, contact):
    return state.v, -state.x if state.x > 0 else 0.0


BAD = {
    "rates": ({"motion": lambda s, ph, p, c: (s.v,)}, "motion returns 1 rate for 2 states .x, v.; return one rate per state"),
    "parameter": ({"motion": lambda s, ph, p, c: (s.v, p.mass)}, "p.mass: the machine declares no such parameter; it has forcing"),
    "branching": ({"motion": stepped}, r"a comparison \(>\) of a symbol has no single formula.*declare a Switch"),
    "absolute": ({"motion": lambda s, ph, p, c: (s.v, -abs(s.x))}, "the absolute value of a symbol.*Switch"),
    "math": ({"motion": lambda s, ph, p, c: (s.v, math.cos(ph))}, "take cos, sin, sqrt, exp ... from orbits.symbols"),
    "ignored": ({"contacts": [floor()]}, "friction 'floor': motion ignores contact.floor; add the force"),
    "backwards": (
        {"motion": lambda s, ph, p, c: (s.v, -s.x - c.floor), "contacts": [floor()]},
        "friction 'floor': a positive contact.floor must speed its velocity up.*Change the sign",
    ),
    "letters": (
        {"motion": rubbing, "contacts": [floor(), wall("t")]},
        "friction 'floor' and wall 't' share the letter 't'; give one of them another",
    ),
    "push": ({"contacts": [wall(push={"x": 1.0})]}, "wall 'R': an impulse along push .* does not change the rate of its gap"),


    "restitution": ({"contacts": [wall(restitution=1.5)]}, "wall 'R': restitution = 1.5 is out of range; give a number above 0"),

    "rate": ({"phase_rate": "omega"}, "phase_rate = 'omega' is no parameter; name the forcing's frequency"),

    "mirror": ({"mirror": {}}, "mirror: the gap of wall 'R' is not the mirror image: at x = .*set mirror=None"),


    "state": ({"motion": lambda s, ph, p, c: (s.speed, -s.x)}, "state.speed: there is no state of this name; the states are x, v"),

    "list": ({"contacts": wall()}, r"contacts = Wall.* must be a list, for example \[Wall"),




    "twins": ({"motion": rubbing, "contacts": [floor(), Switch("floor", lambda s, ph, p: s.x)]}, "share a name; give one of them another"),
    "same": (
        {"motion": lambda s, ph, p, c: (s.v, c.floor + c.rail - s.x),
         "contacts": [floor(), DryFriction("rail", lambda s, ph, p: 2 * s.v, 0.1, letters=("t2", "s2", "u2"))]},
        "friction 'floor' and friction 'rail' have the same velocity; declare one DryFriction whose limit is the sum",
    ),
    "together": (
        {"motion": lambda s, ph, p, c: (s.v, c.floor - c.up * s.v**2), "contacts": [floor(), Switch("up", lambda s, ph, p: s.v)]},
        "friction 'floor' and switch 'up' change together; leave the switch out.*limit=lambda",
    ),
    "idle": ({"contacts": [Switch("stop", lambda s, ph, p: s.x)]}, "switch 'stop': motion ignores contact.stop; use it where"),

    "negative": (
        {"motion": rubbing, "contacts": [DryFriction("floor", lambda s, ph, p: s.v, -0.2)]},
        "friction 'floor': the limit is -0.2; give the largest force, 0 or above",
    ),
    "subharmonic": (
        {"motion": lambda s, ph, p, c: (s.v, cos(0.5 * ph) - s.x)},
        "motion's rate of v does not have the period 2 pi in the phase: at phase = .*lowest frequency",
    ),
    "both": ({"parameters": {"v": 1.0, "frequency": 1.0}}, "'v' is a state and a parameter; give one of them another name"),

    "nothing": ({"motion": lambda s, ph, p, c: None}, "motion returns nothing; return one rate per state"),


}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_refusals(case):
    changes, sentence = BAD[case]
    with pytest.raises((ValueError, TypeError), match=sentence):
        declared(**changes)
