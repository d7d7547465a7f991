"""What every automatic diagram must satisfy, whatever its machine; and a guard against diagrams that hang."""

import signal
from dataclasses import replace

import numpy as np
import pytest

from contvines.bifurcation.kinds import BORDERS
from orbits.cycles.identity import canonical
from orbits.starts.find import polish

SECONDS = 1800.0  # of processor time: a guard against hanging, far above what any diagram here takes


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
