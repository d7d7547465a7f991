"""Automatic diagrams of machines at random: they end, every special point has its evidence, and no branch comes twice.

Set CONTVINES_LARGE to draw many more of them.
"""

import os
import signal
from dataclasses import replace

import numpy as np
import pytest

import contvines as cv
from contvines.events.kinds import BORDERS
from orbits import Absorber
from orbits.attractors import find_attractor
from orbits.cycles.identity import canonical
from orbits.starts.find import polish

DRAWN = 400 if os.environ.get("CONTVINES_LARGE") else 60
SECONDS = 300.0  # of processor time: a guard against hanging, far above what any diagram here takes


@pytest.fixture(autouse=True)
def guard():
    """Stop a diagram that hangs."""
    if not hasattr(signal, "SIGVTALRM"):
        yield
        return

    def stop(*_):
        raise TimeoutError("the diagram hangs")

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS)
    yield
    signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    signal.signal(signal.SIGVTALRM, before)


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


def followed(graph):
    """Real special points are solutions that the simulator follows."""
    for point in graph.special.values():
        assert point.residual < 1e-9, point
        if not (point.real and graph[point.branch].real):
            continue
        assert point.location_error < 1e-8, point
        wild = len(point.multipliers) and np.abs(point.multipliers).max() > 1e3
        assert point.replay is not None, point
        assert point.replay < (1e-3 if wild else 2e-5), point


def crossed(graph, depth):
    """At the borders of real branches the motion goes on: a switch, or one more would pass the depth."""
    for point in graph.special.values():
        branch = graph[point.branch]
        if (
            point.kind not in BORDERS
            or not branch.real
            or any(s.point == point.label for s in graph.switches)
        ):
            continue
        if (
            np.abs(point.multipliers).max(initial=0.0) > 1e8
        ):  # too unstable to be solved for beside the border
            continue
        outward = replace(point, tangent=-point.tangent if point.index == 0 else point.tangent)
        seeds = point.problem.beyond(outward)
        assert seeds or point.problem.dead_end(outward) in point.note, point
        assert seeds or point.note, point
        assert not any(seed.persistence for seed in seeds), (point, [seed.note for seed in seeds])


def unique(graph):
    """No real orbit lies on two branches."""
    branches = [b for b in graph.branches.values() if b.real and b.points.shape[1] > 1]
    for i, one in enumerate(branches):
        place = int(np.argmax(np.minimum(*_room(one))))
        value = float(one.values[place])
        key, vector = one.problem.canonical(one.points[place], value)
        for other in branches[i + 1 :]:
            low, high = other.range
            if graph.settings["virtual"] or not low < value < high or _close_multiplier(one, place):
                continue
            for q in np.flatnonzero((other.values[:-1] - value) * (other.values[1:] - value) <= 0.0):
                if other.values[q] == other.values[q + 1]:
                    continue
                t = (value - other.values[q]) / (other.values[q + 1] - other.values[q])
                guess = (1.0 - t) * other.points[q] + t * other.points[q + 1]
                solved = polish(other.problem.orbit(guess, value))
                if solved is None:
                    continue
                there, near = canonical(solved.word, solved.periods, solved.nodes)
                assert there != key or np.abs(near - vector).max() > 1e-6, (one.label, other.label, value)


def _room(branch):
    steps = np.arange(len(branch))
    return steps, steps[::-1]


def _close_multiplier(branch, place):
    """Next to a branch point two branches do share an orbit."""
    return len(branch.multipliers[place]) and np.abs(branch.multipliers[place] - 1.0).min() < 1e-3
