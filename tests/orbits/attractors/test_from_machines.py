"""Attractors asked of the machine itself: what it settles on, and the graph that begins there."""

import pytest

import contvines as cv
from tests.machines import ABSORBER


def test_a_diagram_begins_at_an_attractor():
    attractor = ABSORBER.attractor(amplitude=0.6)
    graph = cv.diagram(attractor, over="amplitude", within=(0.55, 0.65), depth=0)
    orbit = ABSORBER.orbit("LR", amplitude=0.6)
    assert attractor.text == orbit.word.text == "LR"
    assert graph["B1"].orbit(0).word.text == "LR"
    assert abs(attractor.orbit.nodes - orbit.nodes).max() < 1e-8


def test_different_attractors_are_each_listed_once():
    found = ABSORBER.attractors(30, seed=1, amplitude=0.3)
    assert sorted(one.text for one in found) == ["LR", "tt"]


def test_simulation_is_asked_of_the_machine():
    run = ABSORBER.simulate({"w_rate": 1.0}, periods=3, amplitude=0.6)
    assert run.end[4] + run.end[0] / 6.283185307179586 == pytest.approx(3.0, abs=1e-9)
