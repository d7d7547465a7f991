"""How words change at borders, on made-up border orbits: what mechanics says must come instead, and at which velocities."""

import numpy as np
import pytest

from orbits import Absorber
from orbits.borders.rewriting import edits_at
from orbits.borders.rewriting import rewritten as applied
from orbits.contacts import Grows
from orbits.orbit import Orbit
from orbits.settings import GROWING
from orbits.words import Word

MACHINE = Absorber(restitution=0.7, friction=0.4, gravity=0.3, mass_ratio=0.02)
FLIGHT, EVENT, WALL, DURATION = range(4)
AMPLITUDE = 0.8


def orbit(text, nodes, machine=MACHINE, periods=1):
    params = machine.vector({"amplitude": AMPLITUDE})
    word = Word.parse(text, frictionless=machine.frictionless(params))
    return Orbit(machine, word, periods, np.array(nodes, dtype=float), params)


def rewritten(border, place, column, which=0):
    edit = edits_at(border, 4 * place + column)[which]
    word, nodes, first = applied(border.word, border.nodes, [edit])
    assert len(nodes) == len(word) and first == edit.change.start
    if len(word):
        assert (
            Word.parse(word.text, word.frictionless).modes == word.modes
        )  # events that can follow one another
    return word, nodes, edit


def v_rate(phase):
    return AMPLITUDE * np.cos(phase)


@pytest.mark.parametrize(("place", "wall", "side"), [(1, "L", 1), (0, "R", -1)])
def test_a_turn_that_reaches_a_wall_becomes_an_impact(place, wall, side):
    """Sliding to the left ends at w = 1, to the right at w = -1; the absorber leaves the wall slowly, B+ = v' - w'+."""
    border = orbit("tt", [[0.3, -1.0], [3.4, 1.0]])
    word, nodes, edit = rewritten(border, place, WALL)
    assert word.events == tuple(wall if i == place else "t" for i in range(2)) and word.modes == (1, -1)
    speed = v_rate(nodes[place, 0]) - nodes[place, 1]  # w'+
    assert speed == pytest.approx(-side * GROWING.first) and edit.change.grows is Grows.SPEED
    away = orbit("tt", [[0.3, 1.0], [3.4, -1.0]])  # turns near the walls that were left
    assert edits_at(away, 4 * place + WALL) == []


def test_a_stick_that_reaches_a_wall_becomes_an_impact_and_a_stick():
    border = orbit("ss", [[0.3, -0.9], [1.0, -0.9], [3.4, 1.0], [4.1, 1.0]])
    word, nodes, _ = rewritten(border, 2, WALL)
    assert word.events == ("s", "u", "L", "s", "u") and word.modes[2:4] == (-1, 0)
    assert v_rate(nodes[2, 0]) - nodes[2, 1] == pytest.approx(-GROWING.first)
    assert nodes[3, 0] > nodes[2, 0] and nodes[3, 1] < 1.0
    again, _, _ = rewritten(border, 3, WALL)  # asked at the slip
    assert again == word


@pytest.mark.parametrize("place", [0, 1])
def test_an_impact_without_speed_becomes_a_turn(place):
    border = orbit("LR", [[0.3, v_rate(0.3)], [3.4, v_rate(3.4)]])
    word, nodes, _ = rewritten(border, place, EVENT)
    assert word.events[place] == "t" and word.modes == border.word.modes
    assert nodes[place, 1] == (1.0, -1.0)[place]  # where the wall is


def test_a_stick_of_no_length_inside_a_flight_disappears():
    border = orbit("Rs+L", [[0.3, 0.5], [1.0, 0.1], [1.0 + 1e-9, 0.1], [3.4, -0.5]])
    assert border.word.modes == (1, 0, 1, -1)
    for column in (EVENT, DURATION):
        word, _, edit = rewritten(border, 1, column)
        assert word.events == ("R", "L") and edit.change.grows is Grows.MARGIN
    assert rewritten(border, 0, FLIGHT)[0].events == ("R", "L")  # asked where the flight comes to rest


def test_a_stick_of_no_length_between_opposite_flights_becomes_a_turn():
    border = orbit("Rs-", [[0.3, 0.5], [1.0, 0.1], [1.0 + 1e-9, 0.1]])
    word, _, _ = rewritten(border, 1, DURATION)
    assert word.events == ("R", "t") and word.modes == (1, -1)


def test_a_stick_that_friction_cannot_hold_begins_with_a_turn():
    """It lasts still: what vanishes is the reserve of friction where it begins."""
    border = orbit("Rs-", [[0.3, 0.5], [1.0, 0.1], [2.0, 0.1]])
    word, nodes, edit = rewritten(border, 1, EVENT)
    assert word.events == ("R", "t", "s", "u") and word.modes == (1, -1, 0, -1)
    assert nodes[2, 0] - nodes[1, 0] == pytest.approx(GROWING.first) and edit.change.grows is Grows.GAP


def test_a_turn_that_friction_holds_becomes_a_stick():
    border = orbit("RtRt", [[0.3, 0.5], [1.0, 0.1], [3.0, 0.4], [4.0, 0.2]], periods=2)
    word, nodes, edit = rewritten(border, 1, EVENT)
    assert word.events == ("R", "s", "u", "R", "t") and word.modes == (1, 0, -1, 1, -1)
    assert nodes[1, 0] < nodes[2, 0] and edit.change.grows is Grows.GAP
