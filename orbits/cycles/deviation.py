"""How far the simulated motion leaves a claimed orbit: by events where they are distinct, by positions at a border.

At a border two events coincide or one has no strength, so the event list of the simulation is a matter of rounding there;
the motion itself is not.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from orbits.cycles.cycle import Cycle
from orbits.flows.native.sampling import sample
from orbits.machines.states import states_of
from orbits.machines.stepping import PSI, TURNS, W
from orbits.simulation.driver import follow, machine, simulate
from orbits.simulation.replay import one_by_one, replay

AT_BORDER = 1e-4  # margins below this may make two events one
DEFINITE = 1e-2  # speed after an event from which a simulation starts without doubt
WILD = 1e3  # multipliers above this blow rounding up within a period
STRETCHES = 32  # at most so many starts
AGREED = 1e-9  # deviations below this need no second look


def replay_error(orbit: Cycle, known: Callable[[], tuple[np.ndarray, np.ndarray]]) -> float:
    """Largest deviation of the simulation over one period of an orbit; `known` tells its margins and multipliers, if that matters.

    Nodes are compared, event by event. At a border, where rounding alone makes events appear or vanish, and on very
    unstable orbits the relative position w is compared at many instants as well, stretch by stretch, and the smaller
    deviation counts. Where rounding grows within a period until the events differ, though multipliers are small, each event is
    reached from the one before. Infinite if the simulation does something else. Lengths and speeds count in units of the machine's own size.
    """
    if not len(orbit.word):
        return _from_rest(orbit)
    length, rate = orbit.model.natural_units(orbit.params)
    size = max(1.0, length, length * rate)
    error = float(replay(orbit).error) / size
    if error < AGREED:
        return error
    if not math.isfinite(error):
        margins, multipliers = known()
        if not (np.any(np.abs(margins) < AT_BORDER) or np.any(np.abs(multipliers) > WILD)):
            return one_by_one(orbit) / size
    return min(error, position_error(orbit) / length)


def _from_rest(orbit: Cycle) -> float:
    """Largest relative displacement in a simulation of two periods of the absorber at rest."""
    motion = sample(orbit, 5)
    start = {"phase": 0.0, "w": 0.0, "w_rate": 0.0}
    start |= {name: float(motion[name][0]) for name in orbit.model.node_names[2:]}
    run = simulate(orbit.model, start, periods=2.0, **orbit.parameters)  # type: ignore[arg-type]
    return float(np.abs(run.sample().w).max())


def position_error(orbit: Cycle, points: int = 400) -> float:
    """Largest difference of the relative positions over one period.

    The simulation is started at every definite event and followed to the next one: an impact of vanishing speed has
    infinite derivatives, and a very unstable orbit large ones, so that rounding would grow out of bounds over a period.
    """
    speeds = np.abs(orbit.events.rate_post)
    definite = np.flatnonzero(speeds > DEFINITE * math.prod(orbit.model.natural_units(orbit.params)))
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
    return float(np.abs(out[:, 0] - np.concatenate(told)).max())


def _calm(orbit: Cycle) -> np.ndarray:
    """Slips if there are any (friction gives way at a known phase), else all events."""
    slips = [i for i, letter in enumerate(orbit.word.events) if letter == "u"]
    return np.array(slips or range(len(orbit.word)))
