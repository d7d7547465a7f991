"""Every bad page is refused with a sentence that names the contact and the way out."""

import math
import re

import pytest

from orbits import DryFriction, Machine, Switch, Wall, coupled_two
from orbits.symbols import cos


def motion(state, phase, p, contact):
    return state.v, p.forcing * cos(phase) - state.x


def wall(letter="R", push=None, **options):
    return Wall(letter, lambda state, phase, p: p.gap - state.x, push or {"v": -1.0}, **options)


USUAL = {"forcing": 1.0, "frequency": 1.3, "gap": 1.0}
LEFT = Wall("L", lambda state, phase, p: p.gap + state.x, {"v": 1.0})


def declared(**changes):
    page = {
        "name": "box",
        "states": ("x", "v"),
        "parameters": USUAL,
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

    "overlap": (
        {"parameters": {**USUAL, "gap": -0.5}, "contacts": [wall(), LEFT]},
        "gap = -0.5 is out of range: walls 'R' and 'L' leave no room between them; give gap above 0",
    ),
    "no mass": (
        {"parameters": {**USUAL, "mass": 0.0}, "motion": lambda s, ph, p, c: (s.v, -s.x / p.mass)},
        "mass = 0 is out of range: motion's rate of v is a number",
    ),
    "no mass at the wall": (
        {"parameters": {**USUAL, "mass": 0.0}, "contacts": [wall(push={"v": lambda s, ph, p: -1.0 / p.mass})]},
        "mass = 0 is out of range: an impulse at wall 'R' changes the rate of its gap by a number",
    ),
    "units of a distance": ({"units": {"gap": "kg", "x": "mm"}}, "the gap of wall 'R' adds gap in 'kg' to x in 'mm'"),
    "units of a rate": ({"units": {"x": "mm", "v": "mm"}}, "the rate of x, in 'mm/s', is v, in 'mm'; give v in 'mm/s'"),
    "a unit for all": ({"units": "mm"}, "units = 'mm' must have a unit for each name"),
    "a list": ({"parameters": ["gap"]}, "parameters = .'gap'. must have a value for each name"),
    "nothing": ({"motion": lambda s, ph, p, c: None}, "motion returns nothing; return one rate per state"),


}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_refusals(case):
    changes, sentence = BAD[case]
    with pytest.raises((ValueError, TypeError), match=sentence):
        declared(**changes)


def test_a_stop_beyond_the_place_of_rest_presses():
    """One wall leaves all of one side: a negative gap is a body that is pressed to it."""
    assert declared(parameters={**USUAL, "gap": -0.5}).vector()[2] == -0.5


VALUES = {
    "clearance_1": (-5.0, "clearance_1 = -5 mm is out of range: walls 'L1' and 'R1' leave no room between them; give clearance_1 above 0 mm"),
    "clearance_2": (0.0, "clearance_2 = 0 mm is out of range: walls 'L2' and 'R2'"),
    "oscillator_mass": (-3.8, "oscillator_mass = -3.8 kg is out of range: the mass that moves with q_rate is above 0"),
    "absorber_mass_2": (0.0, "absorber_mass_2 = 0 kg is out of range: the mass that moves with x2_rate is above 0"),
    "restitution_1": (1.2, "restitution_1 = 1.2 is out of range: the restitution of wall 'L1' is above 0 and at most 1"),
    "restitution_2": (0.0, "restitution_2 = 0 is out of range"),
    "friction_1": (-0.1, "friction_1 = -0.1 is out of range: the limit of friction 'floor1' is 0 or above"),
    "frequency": (0.0, "frequency = 0: a forcing frequency is above 0"),
    "contact_time": (-1.0, "contact_time = -1 ms is out of range: an impact lasts longer than 0"),
}  # fmt: skip


@pytest.mark.parametrize("name", VALUES)
def test_values_that_no_machine_can_have(name):
    value, sentence = VALUES[name]
    with pytest.raises(ValueError, match=re.escape(sentence)):
        coupled_two.vector({name: value})


def test_two_walls_part_with_two_parameters():
    """A cavity from -left to gap: its room is their sum, whatever the sign of either."""
    machine = declared(
        parameters={**USUAL, "left": 1.0},
        contacts=[wall(), Wall("L", lambda s, ph, p: p.left + s.x, {"v": 1.0})],
    )
    assert machine.vector({"gap": -0.5})[2] == -0.5
    with pytest.raises(ValueError, match="gap = -1.5 is out of range: walls 'R' and 'L' leave no room"):
        machine.vector({"gap": -1.5})
