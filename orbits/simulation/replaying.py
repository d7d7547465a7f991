"""Replay: does the simulator, which knows no word, follow a claimed periodic orbit?

Nothing here knows the equations that continuation solves, so it can check them. Derivatives are central differences of the simulated return map,
from one of the orbit's events to itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from orbits.contacts.letters import HIT, SLIP, STICK, TURN
from orbits.flows.catalogue import flow_of
from orbits.flows.protocol import Motion, SimulationError, Simulator
from orbits.flows.trajectory import TWO_PI
from orbits.numbers import SMALLEST
from orbits.settings import REPLAYING, SIMULATING
from orbits.simulation.runs import simulator_of
from orbits.words import Word

LONGEST = 200_000.0  # forcing periods that are waited for


@dataclass(frozen=True)
class Replay:
    """Outcome of a replay.

    Attributes
    ----------
    error : float
        Largest difference between claimed and simulated nodes over one period, the return included; inf if
        the events differ.
    message : str
        "" or a sentence that says where the simulation departs from the claim.
    multipliers : ndarray of complex
        Eigenvalues of the simulated return map's central differences (empty if not asked for or not available).
    tracked : int
        Cycles for which the simulation, started on the orbit, stayed within `REPLAYING.loss` of it (0 if not asked for).
    expected : float
        Cycles for which rounding errors allow that: ln(loss/1e-15)/ln|multiplier|, inf for a stable orbit.
    returned : bool or None
        Whether a start moved off a stable orbit comes back to it (None for others, or if not asked for).
    motion : float
        Where the events differ: largest difference of the positions at the claimed nodes' phases over one
        period. On a border events appear or vanish by rounding alone: the motion still agrees.
    """

    error: float
    message: str
    multipliers: np.ndarray
    tracked: int = 0
    expected: float = np.inf
    returned: bool | None = None
    motion: float = 0.0

    @property
    def matches(self) -> bool:
        """Whether the events are those claimed."""
        return bool(np.isfinite(self.error))


class Round(NamedTuple):
    """Events after the first node, up to and including its return.

    nodes : shape (n, NODE); message : "" or what went otherwise than listed.
    """

    nodes: np.ndarray
    message: str


def replay(orbit: Motion, *, thorough: bool = False, most: int = 200) -> Replay:
    """Replay an orbit of a forced machine: start exactly at its first node and compare events and nodes over one period.

    Parameters
    ----------
    orbit : orbit-like
        With `model`, `params`, `periods`, `nodes` (shape (n, NODE)) and `word`: an `orbits.orbit.Orbit` or an `Attractor`.
    thorough : bool
        Also take multipliers, follow the orbit for as long as they allow and, if it is stable, start off it and see
        whether the motion comes back.
    most : int
        Largest number of cycles simulated for this.

    Returns
    -------
    Replay
    """
    nothing = np.empty(0, complex)
    simulator, word, nodes = simulator_of(orbit.model, orbit.params), orbit.word, orbit.nodes
    if not len(word):
        return _without_events(simulator, orbit)
    there = go_round(simulator, word, nodes[0])
    if there.message:
        return Replay(np.inf, there.message, nothing, motion=_motion(simulator, orbit))
    error = float(np.abs(there.nodes - _following(nodes, orbit.periods)).max())
    if not thorough:
        return Replay(error, "", nothing)
    word, nodes = _from_freest(word, nodes, orbit.periods)
    matrix = monodromy(simulator, word, nodes[0])
    if matrix is None:
        return Replay(
            error, "the return map is not smooth here: a displaced start takes other events", nothing
        )
    multipliers = np.linalg.eigvals(matrix).astype(complex)
    free = len(flow_of(orbit.model).loose(orbit.model, word))  # such a motion may be moved as a whole
    growth = float(np.sort(np.abs(multipliers))[::-1][free])
    expected = np.log(REPLAYING.loss / REPLAYING.rounding) / np.log(growth) if growth > 1.0 else np.inf
    wanted = int(min(most, max(1.0, expected)))
    cycle = simulator, word, nodes, orbit.periods
    returned = _returns(*cycle, growth) if growth < 1.0 - SIMULATING.neutral else None
    return Replay(error, "", multipliers, _tracked(*cycle, wanted), float(expected), returned)


def _without_events(simulator: Simulator, orbit: Motion) -> Replay:
    """A period without an event; the absorber must not slip."""
    model, params, nothing = orbit.model, orbit.params, np.empty(0, complex)
    if model.in_cavity:
        held = model.rest.reserve(params, model.rest.solved(params)) >= 0.0
        return (
            Replay(0.0, "", nothing)
            if held
            else Replay(np.inf, "friction does not hold the absorber", nothing)
        )
    simulator.begin(orbit.word, orbit.nodes[0])
    run = simulator.run(orbit.periods, 1)
    if len(run):
        return Replay(np.inf, f"event 1 is {run.letters[0]}, none was listed", nothing)
    return Replay(float(np.abs(simulator.point - orbit.nodes[0, 1:]).max()), "", nothing)


def go_round(simulator: Simulator, word: Word, node: np.ndarray, times: int = 1) -> Round:
    """Start exactly at the first event of a cycle, of which `node` is the node, and simulate it `times` times.

    Returns
    -------
    Round
        `nodes` has shape (times * n, NODE): events 1 ... n-1, the return to event 0, and so on.
    """
    wanted = times * len(word)
    try:
        simulator.begin(word, node)
        run = simulator.run(np.inf, wanted)
    except SimulationError as error:
        return Round(np.empty((0, len(node))), str(error))
    listed = (*zip(word.events[1:], word.modes[1:]), (word.events[0], word.modes[0])) * times
    for i, (seen, said) in enumerate(zip(run.occurrences, listed)):
        if seen[0] != said[0]:
            return Round(run.nodes[: i + 1], f"event {i + 1} is {seen[0]}, listed was {said[0]}")
        if seen[1] != said[1]:
            leads = f"event {i + 1} ({seen[0]}) leads into mode {seen[1]}, listed was {said[1]}"
            return Round(run.nodes[: i + 1], leads)
    if len(run) < wanted:
        missing = listed[len(run)][0]
        return Round(run.nodes, f"after {len(run)} events {run.reason}, where {missing} was listed")
    return Round(run.nodes, "")


def monodromy(
    simulator: Simulator, word: Word, node: np.ndarray, step: float = REPLAYING.slope
) -> np.ndarray | None:
    """Derivative of the return map at the first node, shape (NODE, NODE), by central differences, extrapolated once.

    Next to an impact of small speed the map is strongly curved: the step is shortened there.

    None if some displaced start goes through other events, however small the step.
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
    """Central difference of the return in entry `j` of the first node."""
    ends = []
    for sign in (1.0, -1.0):
        moved = np.array(node, dtype=float)
        moved[j] += sign * size
        there = go_round(simulator, word, moved)
        if there.message:
            return None
        ends.append(there.nodes[-1])
    return (ends[0] - ends[1]) / (2.0 * size)


def _following(nodes: np.ndarray, periods: int) -> np.ndarray:
    """The nodes of a cycle from the second one on, up to the return of the first."""
    claimed = np.roll(nodes, -1, axis=0)
    claimed[-1, 0] += TWO_PI * periods
    return claimed


def _motion(simulator: Simulator, orbit: Motion) -> float:
    """Largest difference of the positions at the phases of the nodes, the return of the first included."""
    flow, phases = flow_of(orbit.model), orbit.nodes[:, 0]
    last = phases[0] + TWO_PI * orbit.periods
    if phases.min() < phases[0] or phases.max() > last:
        return np.inf  # time does not run forward through these nodes
    columns = [entry - 1 for entry in flow.position_entries(orbit.model)]
    claimed = flow.points(orbit)[:, columns]
    try:
        simulator.begin(orbit.word, orbit.nodes[0])
        run = simulator.run(orbit.periods, 100 * len(orbit.word) + 1000)
        seen = run.coordinates(np.append(phases, last) / TWO_PI)[:, columns]
    except (SimulationError, ValueError):
        return np.inf
    return float(np.abs(seen - np.concatenate([claimed, claimed[:1]])).max())


def _from_freest(word: Word, nodes: np.ndarray, periods: int) -> tuple[Word, np.ndarray]:
    """The cycle from an event whose node has no dependent entry: an impact, else a turn, else any."""
    kinds = [word.letter(i).kind for i in range(len(word))]
    first = next((kinds.index(kind) for kind in (HIT, TURN, STICK, SLIP) if kind in kinds), 0)
    nodes = np.roll(nodes, -first, axis=0)
    if first:
        nodes[-first:, 0] += TWO_PI * periods
    return word.rotate(first), nodes


def _tracked(simulator: Simulator, word: Word, nodes: np.ndarray, periods: int, wanted: int) -> int:
    there = go_round(simulator, word, nodes[0], wanted)
    n, claimed = len(word), _following(nodes, periods)
    for c in range(len(there.nodes) // n):
        piece = there.nodes[c * n : (c + 1) * n].copy()
        piece[:, 0] -= TWO_PI * periods * c
        if np.abs(piece - claimed).max() > REPLAYING.loss:
            return c
    return len(there.nodes) // n


def _returns(simulator: Simulator, word: Word, nodes: np.ndarray, periods: int, growth: float) -> bool:
    """Start a little off the orbit, wait until multipliers have shrunk that ten millionfold, and compare.

    Beside a border, or where deviations grow a thousandfold before they shrink, the orbit may attract from very near only: smaller
    displacements are tried as well. Where the orbit itself is known less well than that, because it is ill conditioned, starts are to
    come to where the simulation settles that starts on it.
    """
    cycles = min(
        LONGEST / periods, np.ceil(np.log(REPLAYING.forgotten) / np.log(max(growth, SMALLEST))) + 10.0
    )

    def later(size: float, wanted: np.ndarray, wait: float = cycles) -> tuple[float, np.ndarray]:
        """The motion from a start so far off, after these cycles, and its distance from the nodes wanted."""
        simulator.begin(word, nodes[0])
        simulator.go_on(simulator.state, size)
        simulator.skip(wait * periods)
        return _nearest(simulator, word, wanted, periods)

    displaced, back = REPLAYING.displaced, REPLAYING.back
    tries = ((displaced, back), *REPLAYING.nearer)
    if any(later(size, nodes)[0] < near for size, near in tries):
        return True
    off, settled = later(0.0, nodes)
    if not off < displaced:
        return False
    if off > back and later(displaced, settled)[0] < back:
        return True
    return any(
        later(size, nodes)[0] < min(displaced, REPLAYING.shrunk * later(size, nodes, 0.0)[0])
        for size in REPLAYING.beside_folds
    )


def _nearest(simulator: Simulator, word: Word, nodes: np.ndarray, periods: int) -> tuple[float, np.ndarray]:
    """How near the motion comes to the orbit's nodes, and its own nodes there."""
    n, best = len(word), (np.inf, nodes)
    run = simulator.run(2.0 * periods + 1.0, 3 * n + 3)
    listed, seen, found = [*zip(word.events, word.modes)], [*run.occurrences], run.nodes
    for k in range(max(0, len(seen) - n + 1)):
        if seen[k : k + n] == listed:
            here = found[k : k + n].copy()
            for j in flow_of(simulator.model).loose(simulator.model, word):
                here[:, j] += nodes[0, j] - here[0, j]
            gap = here - nodes
            gap[:, 0] -= TWO_PI * np.round(gap[:, 0] / TWO_PI)
            distance = float(np.abs(gap).max())
            if distance < best[0]:
                best = distance, here
    return best
