"""Automatic diagrams of coupled machines at random, over frequency and forcing; the checks are those of the reduced machine.

Set CONTVINES_LARGE to draw many more of them.
"""

import os

import numpy as np
import pytest

import contvines as cv
from orbits import Coupled
from orbits.attractors import find_attractor
from orbits.starts.find import polish
from tests.orbits.diagrams import crossed, followed, guard, unique

__all__ = ["guard"]  # a fixture that stops a diagram that hangs

DRAWN = 260 if os.environ.get("CONTVINES_LARGE") else 24
TURNING = [436]  # a fold right behind a border
TOUCHING = [497, 583, 604]  # two branches with a gap that is narrower than a step


def start(seed):
    """An orbit to begin with and the options of the diagram."""
    rng = np.random.default_rng(1000 + seed)
    eps = float(rng.choice([0.002, 0.006, 0.05, 0.3]))
    machine = Coupled(
        restitution=rng.uniform(0.3, 0.95),
        friction=0.0 if seed % 6 == 0 else rng.uniform(0.05, 1.0),
        gravity=rng.uniform(0.05, 0.5),
        mass_ratio=eps,
        damping=rng.uniform(0.3, 2.0),
        forcing=rng.uniform(1.0, 4.0),
        excitation=str(rng.choice(["exact", "truncated"])),
    )
    width = 0.3 * np.sqrt(eps)  # of the resonance, roughly
    machine = machine.changed(frequency=1.0 + rng.uniform(-width, width))
    first = {"w": rng.uniform(-0.9, 0.9), "v": rng.uniform(0.2, 1.5), "phase": rng.uniform(0.0, 6.28)}
    found = find_attractor(machine, first, max_period=4, patience=1)
    over = "frequency" if seed % 3 else "forcing"
    reach = width if over == "frequency" else 1.0
    middle = getattr(machine, over)
    options = {
        "over": over,
        "within": (max(0.2, middle - reach), middle + reach),
        "depth": int(rng.integers(1, 3)),
        "virtual": bool(rng.random() < 0.25),
    }
    if found.kind == "stuck":
        return machine.orbit(""), options
    if found.word is None or not len(found.codes):
        return None, options
    return polish(found.orbit), options


@pytest.mark.parametrize("seed", [*range(DRAWN), *TURNING, *TOUCHING])
def test_diagram(seed):
    orbit, options = start(seed)
    if orbit is None:
        return  # chaos, chatter, or free motion off the walls
    graph = cv.diagram(orbit, **options)
    assert graph.finished
    assert graph["B1"].real
    followed(graph)
    unique(graph)
    crossed(graph, options["depth"])


@pytest.mark.parametrize("seed", [497, 604])
def test_a_narrow_gap_does_not_depend_on_the_step(seed):
    """Steps ten times as short find the same special points, at the same places."""
    long, short = (
        cv.diagram(orbit, **options, settings=settings)
        for settings in ({}, {"max_step": 0.003, "angle": 0.01})
        for orbit, options in [start(seed)]
    )
    ours, theirs = (
        sorted((point.kind, point.value, decided(point)) for point in graph.special.values())
        for graph in (long, short)
    )
    assert [point[::2] for point in ours] == [point[::2] for point in theirs]
    np.testing.assert_allclose([point[1] for point in ours], [point[1] for point in theirs], atol=1e-8)


def decided(point):
    """Whether a point is real; None on a border, where the last bit of the parameter says it (margins change by 9000 times its change)."""
    margins = [margin.value for margin in point.orbit.margins] if point.orbit.word.text else [1.0]
    return None if abs(min(margins)) < 1e-9 else point.real


def test_a_light_absorber_begins_to_slip():
    """Mass ratio 0.002: the oscillator settles over a thousand periods, and the stick-slip motion is still found."""
    machine = Coupled(
        restitution=0.55,
        friction=0.8,
        gravity=0.475,
        mass_ratio=0.002,
        damping=1.2,
        forcing=1.015,
        frequency=1.01,
    )
    graph = cv.diagram(machine.orbit(""), over="frequency", within=(0.98, 1.02), depth=0)
    assert [branch.description["impacts"] for branch in graph] == [0, 0, 0]
    slips = [point for point in graph.special.values() if point.kind == "stick"]
    # the linear response shakes with the acceleration mu g there: Omega^2 X = mu g with the mass 1 + eps
    assert len(slips) == 2
    for point in slips:
        omega, eps, damping = point.value, 0.002, 1.2
        drag = eps * damping * omega
        response = eps * 1.015 * abs(1.0 + 1j * drag) / abs(1.0 - (1.0 + eps) * omega**2 + 1j * drag)
        assert omega**2 * response == pytest.approx(0.8 * 0.475, rel=1e-10)
        assert point.replay < 1e-6


def test_a_growing_oscillator_is_not_called_stuck():
    """Friction holds for hundreds of periods, until the light absorber's oscillator shakes enough."""
    machine = Coupled(
        restitution=0.35, friction=0.82, gravity=0.453, mass_ratio=0.002, damping=1.11, forcing=2.66, frequency=1.0058
    )  # fmt: skip
    assert not machine.stuck_response().real
    for v in (0.2, 0.3, 0.45):
        assert find_attractor(machine, {"v": v}).kind != "stuck"
