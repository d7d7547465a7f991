"""How far the simulated motion leaves a claimed orbit: by events where they are distinct, by positions at a border.

At a border two events coincide or one has no strength, so the event list of the simulation is a matter of rounding there;
the motion itself is not.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from orbits.contacts.letters import HIT
from orbits.cycles.cycle import Cycle
from orbits.flows.protocol import SimulationError
from orbits.settings import REPLAYING, SIMULATING
from orbits.simulation.runs import simulator_of
from orbits.words.alphabet import Watch

TURN = 2.0 * np.pi
BACKWARD = (
    -TURN * np.finfo(float).eps ** 0.5
)  # what vanishes at a border like a root has half of the digits: rounding of a flight's duration
STRETCHES = 32  # at most so many starts
POINTS = 400  # instants of a period at which positions are compared

Known = Callable[[], tuple[np.ndarray, np.ndarray]]


def deviation(orbit: Cycle, known: Known) -> float:
    """Largest deviation of the simulation over one period of an orbit; `known` tells its margins and multipliers, if that matters.

    Times and states are compared, event by event. At a border, where rounding alone makes events appear or vanish, and on very
    unstable orbits positions are compared at many instants as well, stretch by stretch, and the smaller
    deviation counts. Where rounding grows within a period until the events differ, though multipliers are small, each event is
    reached from the one before. Infinite if the simulation does something else. Lengths and speeds count in units of the machine's own size.
    """
    if np.any(orbit.durations < BACKWARD):
        return math.inf
    if not len(orbit.word):
        return by_positions(orbit, known)
    error = by_events(orbit)
    if error < REPLAYING.agreed:
        return error
    if not math.isfinite(error):
        margins, multipliers = known()
        if not (np.any(np.abs(margins) < REPLAYING.close) or np.any(np.abs(multipliers) > REPLAYING.wild)):
            return max(by_events(orbit, place, 1) for place in range(len(orbit.word)))
    return min(error, by_positions(orbit, known))


def by_events(orbit: Cycle, first: int = 0, count: int | None = None) -> float:
    """Largest difference of the times and states of so many events (all of a period) after one at which the simulation starts; infinite if they are others."""
    n = len(orbit.word)
    wanted = (first + 1 + np.arange(count or n)) % n
    simulator = simulator_of(orbit.model, orbit.params)
    word = orbit.word.rotate(first)
    try:
        simulator.begin(word, orbit.nodes[first])
        begun = simulator.time
        record = simulator.run(2.0 * float(orbit.durations.sum()) / TURN + 1.0, len(wanted))
    except SimulationError:
        return math.inf
    if record.occurrences[:] != [(orbit.word.events[i], orbit.word.modes[i]) for i in wanted]:
        return math.inf
    late = TURN * (record.times - begun) - np.cumsum(np.roll(orbit.durations, -first)[: len(wanted)])
    apart = record.points - orbit.flow.points(orbit)[wanted]
    length, rate = orbit.model.natural_units(orbit.params)
    return float(max(np.abs(late).max(), np.abs(apart).max() / max(1.0, length, length * rate)))


def by_positions(orbit: Cycle, known: Known) -> float:
    """Largest difference of the positions at many instants of a period.

    The simulation is started at every definite event and followed to the next one: an impact of vanishing speed has
    infinite derivatives, and a very unstable orbit large ones, so that rounding would grow out of bounds over a period.
    """
    n, model, motion = len(orbit.word), orbit.model, orbit.flow.sample(orbit, POINTS)
    names = orbit.flow.coordinates(model)
    columns = [entry - 1 for entry in orbit.flow.position_entries(model)]
    claimed = np.tile(np.column_stack([motion[names[k]] for k in columns]), (2, 1))
    clock = motion["phase"] if orbit.forced else motion["time"]
    clock = np.append(clock, clock + orbit.durations.sum() if n else clock)
    first = np.searchsorted(motion["segment"], np.arange(max(n, 1) + 1))
    first = np.append(first[:-1], first + len(motion["segment"]))  # twice through the cycle
    places = _definite(orbit, known()[0]) if n else [0]
    simulator, worst = simulator_of(model, orbit.params), 0.0
    for place, end in zip(places, [*places[1:], places[0] + max(n, 1)]):
        part = slice(first[place], first[end])
        since = np.maximum(
            clock[part] - clock[part][0], 0.0
        )  # a segment of no length may end before it begins
        try:
            if n:
                simulator.begin(orbit.word.rotate(place), orbit.nodes[place])
            else:
                here = np.array([motion[name][0] for name in names])
                simulator.start(here, float(clock[0]) / TURN)
            begun = simulator.time
            run = simulator.run(float(since[-1]) / TURN + SIMULATING.whole, 100 * n + 1000)
            there = run.coordinates(begun + since / TURN)[:, columns]
        except (SimulationError, ValueError):  # it does not go on for so long
            return math.inf
        worst = max(worst, float(np.abs(there - claimed[part]).max()))
    return worst / model.natural_units(orbit.params)[0]


def _definite(orbit: Cycle, margins: np.ndarray) -> list[int]:
    """Events of some strength, between flights that are not short; all between such flights where every impact is soft."""
    n, columns = len(orbit.word), orbit.word.alphabet.columns
    strong = np.resize(margins[columns.index(Watch.STRENGTH) :: len(columns)], n) > REPLAYING.definite
    long = np.minimum(orbit.durations, np.roll(orbit.durations, 1)) > REPLAYING.close
    hits = np.array([orbit.word.letter(i).kind == HIT for i in range(n)])
    if not strong[hits].any():
        strong = strong | hits.any()
    places = np.flatnonzero(strong & long)
    if not places.size:
        places = np.flatnonzero(long) if long.any() else np.arange(n)
    return places[:: -(-len(places) // STRETCHES)].tolist()
