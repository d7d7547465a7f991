"""A border behind which nothing is found says what vanishes there, and where simulation goes."""

import pytest

import contvines as cv
from tools.pages.pages import page


def test_a_dead_end_names_the_contact_and_what_simulation_does():
    machine = page("impact_oscillator")
    nodes = [[0.0, 0.8 / (1 - 1.7**2), 0.0]]
    orbit = machine.orbit("", 1, nodes, frequency=1.7, gap=1.0, forcing=0.8)
    graph = cv.diagram(orbit, over="forcing", within=(0.8, 2.0), depth=0)
    (point,) = [p for p in graph.special.values() if p.kind == "wall-graze"]
    assert point.value == pytest.approx(1.7**2 - 1, abs=1e-10)  # the amplitude is the gap
    said = graph.branches[point.branch].problem.dead_end(point)
    assert said.startswith(
        "no motion that goes on from this one was found, neither by the rules of wall 'R' nor"
    )
    assert "simulation stays with this word just below it" in said
    assert "just above it" in said
