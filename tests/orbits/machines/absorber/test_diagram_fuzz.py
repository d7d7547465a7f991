"""Automatic diagrams of machines at random: they end, every special point has its evidence, and no branch comes twice.

Set CONTVINES_LARGE to draw many more of them.
"""

import os

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber
from orbits.attractors import find_attractor
from orbits.starts.find import polish
from tests.orbits.diagrams import crossed, followed, guard, unique

__all__ = ["guard"]  # a fixture that stops a diagram that hangs

DRAWN = 400 if os.environ.get("CONTVINES_LARGE") else 60


def start(seed):
    """An orbit to begin with and the options of the diagram."""
    rng = np.random.default_rng(seed)
    machine = Absorber(
        restitution=rng.uniform(0.3, 0.95),
        friction=0.0 if seed % 8 == 0 else rng.uniform(0.0, 1.0),
        gravity=rng.uniform(0.05, 0.5),
        mass_ratio=rng.choice([0.0, 0.006, 0.05]),
    )
    amplitude = rng.uniform(0.1, 2.0)
    found = find_attractor(
        machine,
        {"w_rate": 1.0, "phase": rng.uniform(0.0, 6.28)},
        amplitude=amplitude,
        max_period=4,
        patience=1,
    )
    options = {
        "within": (max(0.05, amplitude - 0.4), amplitude + 0.4),
        "depth": int(rng.integers(1, 4)),
        "virtual": bool(rng.random() < 0.3),
    }
    if found.kind == "stuck":
        return machine.orbit("", amplitude=amplitude), options
    if found.word is None or not len(found.codes):
        return None, options
    return polish(found.orbit), options


@pytest.mark.parametrize("seed", range(DRAWN))
def test_diagram(seed):
    orbit, options = start(seed)
    if orbit is None:
        return  # chaos, chatter, or free motion off the walls
    graph = cv.diagram(orbit, over="amplitude", **options)
    assert graph.finished
    assert graph["B1"].real
    followed(graph)
    unique(graph)
    crossed(graph, options["depth"])


@pytest.mark.parametrize("seed", [2, 4, 49])
def test_a_doubled_orbit_comes_back_to_its_root(seed):
    """It is marginal there without being unstable on either side: one point, no fold and no branch point beside it.

    Steps ten times as short find the same points.
    """
    long, short = (
        cv.diagram(orbit, over="amplitude", **options, settings=settings)
        for settings in ({}, {"max_step": 0.003})
        for orbit, options in [start(seed)]
    )
    assert any(point.note.startswith("met from") for point in long.special.values())
    assert not long.of_kind("branch-point")
    ours, theirs = (
        sorted((point.kind, point.real, point.value) for point in graph.special.values())
        for graph in (long, short)
    )
    assert [point[:2] for point in ours] == [point[:2] for point in theirs]
    np.testing.assert_allclose([point[2] for point in ours], [point[2] for point in theirs], atol=1e-8)
