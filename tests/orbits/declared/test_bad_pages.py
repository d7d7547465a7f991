"""Every bad page is refused with a sentence that names the contact and the way out."""

import math
import re

import pytest

from orbits import DryFriction, Switch, Wall, coupled_two
from orbits.flows.page.stepper import SimulationError
from orbits.symbols import cos
from tests.test_refusals import box, rubbing

USUAL = {"forcing": 1.0, "frequency": 1.3, "gap": 1.0}


def wall(letter="R", push=None, **options):
    return Wall(letter, lambda s, phase, p: p.gap - s.x, push or {"v": -1.0}, **options)


LEFT = Wall("L", lambda s, phase, p: p.gap + s.x, {"v": 1.0})


def floor(limit=0.2):
    return DryFriction("floor", lambda s, phase, p: s.v, limit)


def moved(rate, *contacts):
    """Changes of a page: the rate of v, and contacts."""
    change = {"motion": lambda s, phase, p, c: (s.v, rate(s, phase, p, c))}
    return change | ({"contacts": [*contacts]} if contacts else {})


BAD = {
    "motion returns 1 rate for 2 states .x, v.; return one rate per state": {"motion": lambda s, ph, p, c: (s.v,)},
    "motion returns nothing; return one rate per state": {"motion": lambda s, ph, p, c: None},
    "p.mass: the machine declares no such parameter; it has gap": moved(lambda s, ph, p, c: p.mass),
    "state.speed: there is no state of this name; the states are x, v": moved(lambda s, ph, p, c: s.speed),
    r"a comparison \(>\) of a symbol has no single formula.*declare a Switch": moved(lambda s, ph, p, c: -s.x if s.x > 0 else 0.0),
    "the absolute value of a symbol.*Switch": moved(lambda s, ph, p, c: -abs(s.x)),
    "take cos, sin, sqrt, exp ... from orbits.symbols": moved(lambda s, ph, p, c: math.cos(ph)),
    "motion's rate of v does not have the period 2 pi in the phase: at phase = .*lowest frequency": moved(lambda s, ph, p, c: cos(0.5 * ph) - s.x),
    "friction 'floor': motion ignores contact.floor; add the force": {"contacts": [floor()]},
    "friction 'floor': a positive contact.floor must speed its velocity up.*Change the sign": moved(lambda s, ph, p, c: -s.x - c.floor, floor()),
    "friction 'floor': the limit is -0.2; give the largest force, 0 or above": {"motion": rubbing, "contacts": [floor(-0.2)]},
    "friction 'floor' and wall 't' share the letter 't'; give one of them another": {"motion": rubbing, "contacts": [floor(), wall("t")]},
    "share a name; give one of them another": {"motion": rubbing, "contacts": [floor(), Switch("floor", lambda s, ph, p: s.x)]},
    "friction 'floor' and friction 'rail' have the same velocity; declare one DryFriction whose limit is the sum": moved(
        lambda s, ph, p, c: c.floor + c.rail - s.x,
        floor(), DryFriction("rail", lambda s, ph, p: 2 * s.v, 0.1, letters=("t2", "s2", "u2")),
    ),
    "friction 'floor' and switch 'up' change together; leave the switch out.*limit=lambda": moved(
        lambda s, ph, p, c: c.floor - c.up * s.v**2, floor(), Switch("up", lambda s, ph, p: s.v)
    ),
    "switch 'stop': motion ignores contact.stop; use it where": {"contacts": [Switch("stop", lambda s, ph, p: s.x)]},
    "wall 'R': an impulse along push .* does not change the rate of its gap": {"contacts": [wall(push={"x": 1.0})]},
    "wall 'R': restitution = 1.5 is out of range; give a number above 0": {"contacts": [wall(restitution=1.5)]},
    "phase_rate = 'omega' is no parameter; name the forcing's frequency": {"phase_rate": "omega"},
    "mirror: the gap of wall 'R' is not the mirror image: at x = .*set mirror=None": {"mirror": {}},
    r"contacts = Wall.* must be a list, for example \[Wall": {"contacts": wall()},
    "'v' is a state and a parameter; give one of them another name": {"parameters": {"v": 1.0, "frequency": 1.0}},
    "gap = -0.5 is out of range: walls 'R' and 'L' leave no room between them; give gap above 0": {
        "parameters": {**USUAL, "gap": -0.5}, "contacts": [wall(), LEFT]
    },
    "mass = 0 is out of range: motion's rate of v is a number": moved(lambda s, ph, p, c: -s.x / p.mass) | {"parameters": {**USUAL, "mass": 0.0}},
    "mass = 0 is out of range: an impulse at wall 'R' changes the rate of its gap by a number": {
        "parameters": {**USUAL, "mass": 0.0}, "contacts": [wall(push={"v": lambda s, ph, p: -1.0 / p.mass})]
    },
    "moves a mass of 0": {"energy": lambda s, ph, p: s.x},
    "the gap of wall 'R' adds gap in 'kg' to x in 'mm'": {"units": {"gap": "kg", "x": "mm"}},
    "the rate of x, in 'mm/s', is v, in 'mm'; give v in 'mm/s'": {"units": {"x": "mm", "v": "mm"}},
    "units = 'mm' must have a unit for each name": {"units": "mm"},
    "parameters = .'gap'. must have a value for each name": {"parameters": ["gap"]},
}  # fmt: skip


@pytest.mark.parametrize("sentence", BAD)
def test_refusals(sentence):
    with pytest.raises((ValueError, TypeError), match=sentence):
        box(**BAD[sentence])


VALUES = {
    "clearance_1 = -5 mm is out of range: walls 'L1' and 'R1' leave no room between them; give clearance_1 above 0 mm": -5.0,
    "clearance_2 = 0 mm is out of range: walls 'L2' and 'R2'": 0.0,
    "oscillator_mass = -3.8 kg is out of range: the mass that moves with q_rate is above 0": -3.8,
    "absorber_mass_2 = 0 kg is out of range: the mass that moves with x2_rate is above 0": 0.0,
    "restitution_1 = 1.2 is out of range: the restitution of wall 'L1' is above 0 and at most 1": 1.2,
    "restitution_2 = 0 is out of range": 0.0,
    "friction_1 = -0.1 is out of range: the limit of friction 'floor1' is 0 or above": -0.1,
    "frequency = 0: a forcing frequency is above 0": 0.0,
    "contact_time = -1 ms is out of range: an impact lasts longer than 0": -1.0,
}  # fmt: skip


@pytest.mark.parametrize("sentence", VALUES)
def test_values_that_no_machine_can_have(sentence):
    with pytest.raises(ValueError, match=re.escape(sentence)):
        coupled_two.vector({sentence.split()[0]: VALUES[sentence]})


def test_a_formula_that_is_no_number_is_named_with_its_line_and_the_state():
    def motion(s, phase, p, contact):
        push = p.forcing / s.x
        return s.v, push * contact.beyond

    sentence = "division by zero.*push = p.forcing / s.x.*x = 0, v = 0, phase = 0.*start elsewhere"
    with pytest.raises(SimulationError, match=sentence):
        box(motion=motion, contacts=[Switch("beyond", lambda s, phase, p: s.x - p.gap)]).attractor()


def test_two_walls_part_with_two_parameters():
    """A cavity from -left to gap: its room is their sum, whatever the sign of either. One wall leaves all of one side: a body is pressed to it."""
    assert box(parameters={**USUAL, "gap": -0.5}).vector()[2] == -0.5
    other = Wall("L", lambda s, phase, p: p.left + s.x, {"v": 1.0})
    machine = box(parameters={**USUAL, "left": 1.0}, contacts=[wall(), other])
    assert machine.vector({"gap": -0.5})[2] == -0.5
    with pytest.raises(ValueError, match="gap = -1.5 is out of range: walls 'R' and 'L' leave no room"):
        machine.vector({"gap": -1.5})
