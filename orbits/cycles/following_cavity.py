"""A claimed orbit of a built-in machine followed by simulation: event by event, position by position."""

from __future__ import annotations

import math

import numpy as np

from orbits.cycles.cycle import Cycle
from orbits.flows.native.sampling import sample
from orbits.machines.states import states_of
from orbits.machines.stepping import PSI, TURNS, W
from orbits.simulation.driver import follow, machine, simulate
from orbits.simulation.replay import one_by_one as followed_one_by_one
from orbits.simulation.replay import replay

DEFINITE = 1e-2  # speed after an event from which a simulation starts without doubt
STRETCHES = 32  # at most so many starts


def by_events(orbit: Cycle) -> float:
    """Largest difference of the nodes; of the absorber at rest, the largest displacement in two periods."""
    if len(orbit.word):
        length, rate = orbit.model.natural_units(orbit.params)
        return float(replay(orbit).error) / max(1.0, length, length * rate)
    motion = sample(orbit, 5)
    start = {"phase": 0.0, "w": 0.0, "w_rate": 0.0}
    start |= {name: float(motion[name][0]) for name in orbit.model.node_names[2:]}
    run = simulate(orbit.model, start, periods=2.0, **orbit.parameters)  # type: ignore[arg-type]
    return float(np.abs(run.sample().w).max())


def one_by_one(orbit: Cycle) -> float:
    """The same with each event reached from the one before."""
    length, rate = orbit.model.natural_units(orbit.params)
    return followed_one_by_one(orbit) / max(1.0, length, length * rate)


def by_positions(orbit: Cycle, points: int = 400) -> float:
    """Largest difference of the relative positions over one period.

    The simulation is started at every definite event and followed to the next one: an impact of vanishing speed has
    infinite derivatives, and a very unstable orbit large ones, so that rounding would grow out of bounds over a period.
    """
    if not len(orbit.word):
        return math.inf
    length, rate = orbit.model.natural_units(orbit.params)
    definite = np.flatnonzero(np.abs(orbit.events.rate_post) > DEFINITE * length * rate)
    places = definite if definite.size else _calm(orbit)
    places = places[:: -(-len(places) // STRETCHES)]
    ends = np.append(places[1:], places[0] + len(orbit.word))
    engine = machine(orbit.model.name)
    states = states_of(engine, orbit.params, orbit.word.codes, orbit.word.mode_codes, orbit.nodes)
    left, right = engine.walls(orbit.params)
    claimed = sample(orbit, points)
    phases = np.append(claimed["phase"], claimed["phase"] + 2.0 * np.pi * orbit.periods)
    positions = np.tile(claimed["w"], 2)
    first = np.searchsorted(claimed["segment"], np.arange(len(orbit.word) + 1))
    first = np.append(first[:-1], first + len(claimed["w"]))  # twice through the cycle

    # claimed positions, the states from which the simulation reaches them, and how far ahead they are
    told, begun, ahead = [], [], []
    for place, end in zip(places, ends, strict=True):
        start, part = states[place].copy(), slice(first[place], first[end])
        start[W] = min(max(start[W], right), left)
        # a segment of no length may end before it begins
        since = np.maximum(phases[part] - phases[part][0], 0.0)
        run = follow(orbit.model, engine, orbit.params, start, float(since[-1]) / (2.0 * np.pi) + 1e-6)
        seen = run.states
        begins = (seen[:, PSI] - seen[0, PSI]) + 2.0 * np.pi * (seen[:, TURNS] - seen[0, TURNS])
        segment = np.searchsorted(begins, since, side="right") - 1
        begun.append(seen[segment])
        ahead.append(np.maximum(since - begins[segment], 0.0))
        told.append(positions[part])
    out = np.empty((sum(map(len, ahead)), 4))
    engine.sample(np.concatenate(begun), orbit.params, np.concatenate(ahead), out)
    return float(np.abs(out[:, 0] - np.concatenate(told)).max()) / length


def _calm(orbit: Cycle) -> np.ndarray:
    """Slips if there are any (friction gives way at a known phase), else all events."""
    slips = [i for i, letter in enumerate(orbit.word.events) if letter == "u"]
    return np.array(slips or range(len(orbit.word)))
