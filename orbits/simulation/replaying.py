"""Replay: compare a claimed periodic orbit with an event-driven simulation, which uses neither its word nor its equations.

`replay` compares an orbit of a forced machine with the simulation in all respects: events, nodes, multipliers (central differences of the
simulated return map from one of the orbit's events to itself), and whether the simulation stays on the orbit. `deviation` is a single number
for any orbit: the largest difference at the events, or, at a border, of the positions. At a border two events coincide or one has no
strength, so that rounding decides which events the simulation lists; the motion itself hardly changes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

import numpy as np

from orbits.arguments import SMALLEST
from orbits.contacts import HIT, SLIP, STICK, TURN
from orbits.flows import flow_of, simulator_of
from orbits.flows.protocol import Motion, SimulationError, Simulator
from orbits.flows.trajectory import TWO_PI, Trajectory
from orbits.settings import REPLAYING, SIMULATING
from orbits.words import Word
from orbits.words.alphabet import Watch

LONGEST = 200_000.0  # longest simulation, in forcing periods, until a displaced start has returned
BACKWARD = (
    -TWO_PI * np.finfo(float).eps ** 0.5
)  # smallest duration of a flight that may be zero: one that vanishes like a square root at a border has half of the digits
STRETCHES = 32  # starts per period at most
POINTS = 400  # instants per period at which positions are compared

Known = Callable[[], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Replay:
    """Outcome of a replay.

    Attributes
    ----------
    error : float
        Largest difference between claimed and simulated nodes over one period, the return included; inf if
        the events differ.
    message : str
        First difference between simulated and claimed events; "" if there is none.
    multipliers : ndarray of complex
        Eigenvalues of the simulated return map's central differences (empty if not asked for or not available).
    tracked : int
        Cycles for which the simulation, started on the orbit, stayed within `REPLAYING.loss` of it (0 if not asked for).
    expected : float
        Cycles until rounding errors have grown to `loss`: ln(loss/1e-15)/ln|multiplier|; inf for a stable orbit.
    returned : bool or None
        Whether a start displaced from a stable orbit returns to it (None for others, or if not asked for).
    motion : float
        If the events differ: largest difference of the positions at the claimed nodes' phases over one
        period. It is small at a border, where events appear or vanish by rounding.
    """

    error: float
    message: str
    multipliers: np.ndarray = field(default_factory=lambda: np.empty(0, complex))
    tracked: int = 0
    expected: float = np.inf
    returned: bool | None = None
    motion: float = 0.0

    @property
    def matches(self) -> bool:
        """Whether the events are those claimed."""
        return bool(np.isfinite(self.error))


class Round(NamedTuple):
    """Simulation from the first event of a cycle on (None if it cannot start); `message`: its first difference from the word, "" if none."""

    run: Trajectory | None
    message: str


def go_round(
    simulator: Simulator, word: Word, node: np.ndarray, wanted: int, periods: float = math.inf
) -> Round:
    """Simulate from the first event of a cycle, with its `node`, through the next `wanted` events (1 ... n-1, then event 0 again, and so on).

    `periods` limits the simulation, in forcing periods.
    """
    try:
        simulator.begin(word, node)
        run = simulator.run(periods, wanted)
    except SimulationError as error:
        return Round(None, str(error))
    n = len(word)
    listed = [(word.events[i % n], word.modes[i % n]) for i in range(1, wanted + 1)]
    for i, (event, claim) in enumerate(zip(run.occurrences, listed)):
        if event[0] != claim[0]:
            return Round(run, f"event {i + 1} is {event[0]}, listed was {claim[0]}")
        if event[1] != claim[1]:
            return Round(run, f"event {i + 1} ({event[0]}) leads into mode {event[1]}, listed was {claim[1]}")
    if len(run) < wanted:
        return Round(run, f"after {len(run)} events {run.reason}, where {listed[len(run)][0]} was listed")
    return Round(run, "")


# ---------------------------------------------------------------------- one number
def deviation(orbit: Motion, examined: Known) -> float:
    """Largest deviation of the simulation from an orbit over one period; inf if it follows another motion.

    Times and states are compared event by event. If these deviate, for an orbit at a border or with large multipliers, positions are
    compared as well, at many instants and stretch by stretch, and the smaller deviation is returned. If the events differ although
    no margin is small and no multiplier large (rounding grows within the period), each event is simulated from the one before.
    Lengths and speeds are in units of the machine's own size. `known()` returns margins and multipliers; it is called only if they are needed.
    """
    if np.any(orbit.durations < BACKWARD):
        return math.inf
    if not len(orbit.word):
        return by_positions(orbit, examined)
    error = by_events(orbit)
    if error < REPLAYING.agreed:
        return error
    if not math.isfinite(error):
        margins, multipliers = examined()
        if not (np.any(np.abs(margins) < REPLAYING.close) or np.any(np.abs(multipliers) > REPLAYING.wild)):
            return max(by_events(orbit, place, 1) for place in range(len(orbit.word)))
    return min(error, by_positions(orbit, examined))


def by_events(orbit: Motion, first: int = 0, count: int | None = None) -> float:
    """Largest difference of times and states over `count` events (default: one period) after event `first`, at which the simulation starts; inf if the events differ."""
    wanted = (first + 1 + np.arange(count or len(orbit.word))) % len(orbit.word)
    longest = 2.0 * float(orbit.durations.sum()) / TWO_PI + 1.0
    simulator, word = simulator_of(orbit.model, orbit.params), orbit.word.rotate(first)
    run, message = go_round(simulator, word, orbit.nodes[first], len(wanted), longest)
    if run is None or message:
        return math.inf
    late = run.clocks[1:] - run.clocks[0] - np.cumsum(orbit.durations[wanted - 1])
    differences = run.points - flow_of(orbit.model).points(orbit)[wanted]
    length, rate = orbit.model.natural_units(orbit.params)
    return float(max(np.abs(late).max(), np.abs(differences).max() / max(1.0, length, length * rate)))


def by_positions(orbit: Motion, examined: Known) -> float:
    """Largest difference of the positions at many instants of a period.

    The simulation is restarted at each definite event: an impact of vanishing speed has infinite derivatives, and a very
    unstable orbit large ones, so that rounding would grow too much over a whole period.
    """
    n, model, flow = len(orbit.word), orbit.model, flow_of(orbit.model)
    motion, names = flow.sample(orbit, POINTS), flow.coordinates(model)
    columns = _positions(orbit)
    claimed = np.tile(np.column_stack([motion[names[k]] for k in columns]), (2, 1))
    clock = motion["phase"] if model.forced else motion["time"]
    clock = np.append(clock, clock + orbit.durations.sum() if n else clock)
    first = np.searchsorted(motion["segment"], np.arange(max(n, 1) + 1))
    first = np.append(first[:-1], first + len(motion["segment"]))  # two rounds of the cycle
    places = _definite(orbit, examined()[0]) if n else [0]
    simulator, worst = simulator_of(model, orbit.params), 0.0
    for place, end in zip(places, [*places[1:], places[0] + max(n, 1)]):
        part = slice(first[place], first[end])
        times = np.maximum(
            clock[part] - clock[part][0], 0.0
        )  # a segment of no length may end before it begins
        if n:
            begin = partial(simulator.begin, orbit.word.rotate(place), orbit.nodes[place])
        else:
            state = np.array([motion[name][0] for name in names])
            begin = partial(simulator.start, state, float(clock[0]) / TWO_PI)
        worst = max(
            worst, _largest_difference(simulator, begin, times, claimed[part], columns, 100 * n + 1000)
        )
    return worst / model.natural_units(orbit.params)[0]


def _positions(orbit: Motion) -> list[int]:
    """Indices of the positions among the coordinates."""
    return [entry - 1 for entry in flow_of(orbit.model).position_entries(orbit.model)]


def _largest_difference(
    simulator: Simulator,
    begin: Callable[[], None],
    times: np.ndarray,
    claimed: np.ndarray,
    columns: list[int],
    most: int,
) -> float:
    """Largest difference of simulated positions from the claimed ones, shape (m, c), at the clock times `times` after `begin`; inf if the simulation ends earlier."""
    try:
        begin()
        start_time = simulator.time
        run = simulator.run(float(times[-1]) / TWO_PI + SIMULATING.whole_period, most)
        positions = run.coordinates(start_time + times / TWO_PI)[:, columns]
    except (SimulationError, ValueError):
        return math.inf
    return float(np.abs(positions - claimed).max())


def _definite(orbit: Motion, margins: np.ndarray) -> list[int]:
    """Events with a speed well above zero between flights that are not short; if all impacts are slow, all events between such flights."""
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


# ---------------------------------------------------------------------- comparison in all respects
def replay(orbit: Motion, *, thorough: bool = False, most: int = 200) -> Replay:
    """Simulate an orbit of a forced machine from its first node, and compare events and nodes over one period.

    Parameters
    ----------
    orbit : orbit-like
        With `model`, `params`, `periods`, `nodes` (shape (n, NODE)) and `word`: an `orbits.orbit.Orbit` or an `Attractor`.
    thorough : bool
        Also compute multipliers, simulate for as many cycles as they allow and, if the orbit is stable, test whether a
        displaced start returns to it.
    most : int
        Largest number of cycles simulated for this.

    Returns
    -------
    Replay
    """
    simulator, word, nodes = simulator_of(orbit.model, orbit.params), orbit.word, orbit.nodes
    if not len(word):
        return _without_events(simulator, orbit)
    run, message = go_round(simulator, word, nodes[0], len(word))
    if run is None or message:
        return Replay(np.inf, message, motion=_motion(simulator, orbit))
    error = float(np.abs(run.nodes - _next_nodes(nodes, orbit.periods)).max())
    if not thorough:
        return Replay(error, "")
    word, nodes = _from_freest(word, nodes, orbit.periods)
    matrix = monodromy(simulator, word, nodes[0])
    if matrix is None:
        return Replay(error, "the return map is not smooth here: a displaced start takes other events")
    multipliers = np.linalg.eigvals(matrix).astype(complex)
    free = len(
        flow_of(orbit.model).loose(orbit.model, word)
    )  # directions in which the whole motion can be shifted
    growth = float(np.sort(np.abs(multipliers))[::-1][free])
    expected = np.log(REPLAYING.loss / REPLAYING.rounding) / np.log(growth) if growth > 1.0 else np.inf
    wanted = int(min(most, max(1.0, expected)))
    cycle = simulator, word, nodes, orbit.periods
    returned = _returns(*cycle, growth) if growth < 1.0 - SIMULATING.neutral else None
    return Replay(error, "", multipliers, _tracked(*cycle, wanted), float(expected), returned)


def _without_events(simulator: Simulator, orbit: Motion) -> Replay:
    """Replay of an orbit without events; of a built-in machine, friction must hold the absorber."""
    model, params = orbit.model, orbit.params
    if model.in_cavity:
        sticks = model.rest.reserve(params, model.rest.solved(params)) >= 0.0
        return Replay(0.0, "") if sticks else Replay(np.inf, "friction does not hold the absorber")
    simulator.begin(orbit.word, orbit.nodes[0])
    run = simulator.run(orbit.periods, 1)
    if len(run):
        return Replay(np.inf, f"event 1 is {run.letters[0]}, none was listed")
    return Replay(float(np.abs(simulator.point - orbit.nodes[0, 1:]).max()), "")


def monodromy(
    simulator: Simulator, word: Word, node: np.ndarray, step: float = REPLAYING.slope
) -> np.ndarray | None:
    """Derivative of the return map at the first node, shape (NODE, NODE), by central differences, extrapolated once.

    Near an impact of small speed the map is strongly curved, so that shorter steps are tried, too.
    None if a displaced start has other events at every step.
    """
    result = np.empty((len(node), len(node)))
    for j in range(len(node)):
        best = np.inf
        for size in (step, 0.1 * step, 0.01 * step, 0.001 * step):
            coarse = _slope(simulator, word, node, j, size)
            fine = None if coarse is None else _slope(simulator, word, node, j, 0.5 * size)
            if coarse is None or fine is None:
                continue
            error = float(np.abs(fine - coarse).max()) ** 2 + REPLAYING.rounding / size
            if error < best:
                best, result[:, j] = error, (4.0 * fine - coarse) / 3.0
            if error < REPLAYING.slope_error:
                break
        if best == np.inf:
            return None
    return result


def _slope(simulator: Simulator, word: Word, node: np.ndarray, j: int, size: float) -> np.ndarray | None:
    """Central difference of the return map by entry `j` of the first node; None if a displaced start has other events."""
    ends = []
    for sign in (1.0, -1.0):
        displaced = np.array(node, dtype=float)
        displaced[j] += sign * size
        run, message = go_round(simulator, word, displaced, len(word))
        if run is None or message:
            return None
        ends.append(run.nodes[-1])
    return (ends[0] - ends[1]) / (2.0 * size)


def _next_nodes(nodes: np.ndarray, periods: int) -> np.ndarray:
    """Nodes of a cycle from the second to the return of the first."""
    claimed = np.roll(nodes, -1, axis=0)
    claimed[-1, 0] += TWO_PI * periods
    return claimed


def _motion(simulator: Simulator, orbit: Motion) -> float:
    """Largest difference of the positions at the phases of the nodes, including the return of the first."""
    times = np.append(orbit.nodes[:, 0] - orbit.nodes[0, 0], TWO_PI * orbit.periods)
    if times.min() < 0.0 or times.max() > times[-1]:
        return np.inf  # time does not run forward through these nodes
    columns, word = _positions(orbit), orbit.word
    claimed = flow_of(orbit.model).points(orbit)[:, columns]
    begin = partial(simulator.begin, word, orbit.nodes[0])
    return _largest_difference(
        simulator, begin, times, np.append(claimed, claimed[:1], axis=0), columns, 100 * len(word) + 1000
    )


def _from_freest(word: Word, nodes: np.ndarray, periods: int) -> tuple[Word, np.ndarray]:
    """Rotate the cycle to an event whose node has independent entries: an impact, else a turn, else any."""
    kinds = [word.letter(i).kind for i in range(len(word))]
    first = next((kinds.index(kind) for kind in (HIT, TURN, STICK, SLIP) if kind in kinds), 0)
    nodes = np.roll(nodes, -first, axis=0)
    if first:
        nodes[-first:, 0] += TWO_PI * periods
    return word.rotate(first), nodes


def _tracked(simulator: Simulator, word: Word, nodes: np.ndarray, periods: int, wanted: int) -> int:
    """Number of simulated rounds, of `wanted` ones, that stay on the orbit."""
    n, claimed = len(word), _next_nodes(nodes, periods)
    run = go_round(simulator, word, nodes[0], wanted * n).run
    found = nodes[:0] if run is None else run.nodes
    for c in range(len(found) // n):
        piece = found[c * n : (c + 1) * n].copy()
        piece[:, 0] -= TWO_PI * periods * c
        if np.abs(piece - claimed).max() > REPLAYING.loss:
            return c
    return len(found) // n


def _returns(simulator: Simulator, word: Word, nodes: np.ndarray, periods: int, growth: float) -> bool:
    """Whether a displaced start returns to a stable orbit, after as many cycles as its multipliers need for a factor of 1e-7.

    Near a border, or if deviations grow a thousandfold before they decay, the orbit may attract only from very near, so smaller
    displacements are tried, too. If the orbit is so ill conditioned that its own error is larger, displaced starts must come to the
    motion on which a simulation from the orbit itself settles.
    """
    cycles = min(
        LONGEST / periods, np.ceil(np.log(REPLAYING.forgotten) / np.log(max(growth, SMALLEST))) + 10.0
    )

    def distance_after(size: float, wanted: np.ndarray, wait: float = cycles) -> tuple[float, np.ndarray]:
        """Distance from the wanted nodes after `wait` cycles from a start displaced by `size`, and the simulated nodes."""
        simulator.begin(word, nodes[0])
        simulator.go_on(simulator.state, size)
        simulator.skip(wait * periods)
        return _nearest(simulator, word, wanted, periods)

    displaced, back = REPLAYING.displaced, REPLAYING.returned
    tries = ((displaced, back), *REPLAYING.nearer)
    if any(distance_after(size, nodes)[0] < near for size, near in tries):
        return True
    distance, settled = distance_after(0.0, nodes)
    if not distance < displaced:
        return False
    if distance > back and distance_after(displaced, settled)[0] < back:
        return True
    return any(
        distance_after(size, nodes)[0]
        < min(displaced, REPLAYING.shrunk * distance_after(size, nodes, 0.0)[0])
        for size in REPLAYING.beside_folds
    )


def _nearest(simulator: Simulator, word: Word, nodes: np.ndarray, periods: int) -> tuple[float, np.ndarray]:
    """Smallest distance of the simulated motion from the orbit's nodes, and the simulated nodes there."""
    n, best = len(word), (np.inf, nodes)
    run = simulator.run(2.0 * periods + 1.0, 3 * n + 3)
    listed, occurrences, found = [*zip(word.events, word.modes)], [*run.occurrences], run.nodes
    for k in range(max(0, len(occurrences) - n + 1)):
        if occurrences[k : k + n] == listed:
            simulated = found[k : k + n].copy()
            for j in flow_of(simulator.model).loose(simulator.model, word):
                simulated[:, j] += nodes[0, j] - simulated[0, j]
            gap = simulated - nodes
            gap[:, 0] -= TWO_PI * np.round(gap[:, 0] / TWO_PI)
            distance = float(np.abs(gap).max())
            if distance < best[0]:
                best = distance, simulated
    return best
