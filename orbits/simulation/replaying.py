"""Replay: does the simulator, which knows no word, follow a claimed periodic orbit?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from orbits.machines.catalogue import stepper as machine
from orbits.machines.states import nodes_of, state_of
from orbits.machines.stepping import EVENTS_FULL
from orbits.simulation.driver import collect, skip
from orbits.simulation.native_trajectory import TWO_PI, NativeTrajectory
from orbits.simulation.return_map import cyclic_distance, go_round, monodromy

if TYPE_CHECKING:
    from orbits.machines.base import Model
    from orbits.machines.stepping import Machine

DISPLACED, NEAR = 1e-6, 1e-8  # a start off an orbit, and when it counts as back
ILL = 1e-6  # an orbit is known at least as well
SMALLER = (1e-7, 1e-8)  # displacements beside folds, of which no more ...
SHRUNK = 1e-2  # ... than this part is to be left


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
        Cycles for which the simulation, started on the orbit, stayed within `loss` of it (0 if not asked for).
    expected : float
        Cycles for which rounding errors allow that: ln(loss/1e-15)/ln|multiplier|, inf for a stable orbit.
    returned : bool or None
        Whether a start moved off a stable orbit comes back to it (None for others, or if not asked for).
    motion : float
        Where the events differ: largest difference of the positions w at the claimed nodes' phases over one
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


class _Cycle(NamedTuple):
    """A claimed cycle as bare arrays, for a stepper."""

    engine: Machine
    params: np.ndarray
    codes: np.ndarray
    modes: np.ndarray
    nodes: np.ndarray
    periods: int

    def begin(self) -> np.ndarray:
        """The state just after the first event."""
        return state_of(self.engine, self.params, int(self.codes[0]), int(self.modes[0]), self.nodes[0])


def replay(orbit: Any, *, thorough: bool = False, loss: float = 1e-4, most: int = 200) -> Replay:
    """Replay an orbit: start exactly at its first node and compare events and nodes over one period.

    Parameters
    ----------
    orbit : orbit-like
        With `model`, `params`, `periods`, `nodes` (shape (n, NODE)) and `word` (or `codes` and `modes`): an
        `orbits.orbit.Orbit` or an `Attractor`.
    thorough : bool
        Also take multipliers, follow the orbit for as long as they allow and, if it is stable, start off it and see
        whether the motion comes back.
    loss : float
        Distance at which a followed orbit counts as lost.
    most : int
        Largest number of cycles simulated for this.

    Returns
    -------
    Replay
    """
    word = getattr(orbit, "word", None)
    codes = word.codes if word is not None else orbit.codes
    modes = word.mode_codes if word is not None else orbit.modes
    return replay_nodes(
        orbit.model, orbit.params, codes, modes, orbit.nodes, orbit.periods, thorough, loss, most
    )


def replay_nodes(
    model: Model,
    params: np.ndarray,
    codes: np.ndarray,
    modes: np.ndarray,
    nodes: np.ndarray,
    periods: int,
    thorough: bool = False,
    loss: float = 1e-4,
    most: int = 200,
) -> Replay:
    """`replay` from bare arrays: events and modes of shape (n,), nodes of shape (n, NODE)."""
    params = np.asarray(params, dtype=float)
    engine = machine(model.name)
    codes, modes = np.asarray(codes, np.int8), np.asarray(modes, np.int8)
    nothing = np.empty(0, complex)
    if not len(codes):
        return _stuck(model, params)
    nodes = np.asarray(nodes, dtype=float).reshape(len(codes), -1)
    there = go_round(engine, params, codes, modes, nodes[0])
    if there.message:
        motion = _motion(model, _Cycle(engine, params, codes, modes, nodes, periods))
        return Replay(np.inf, there.message, nothing, motion=motion)
    claimed = np.concatenate([nodes[1:], nodes[:1]])
    claimed[-1, 0] += TWO_PI * periods
    error = float(np.abs(there.nodes - claimed).max())
    if not thorough:
        return Replay(error, "", nothing)
    start = _freest(codes)
    codes, modes = np.roll(codes, -start), np.roll(modes, -start)
    nodes = np.roll(nodes, -start, axis=0)
    if start:
        nodes[-start:, 0] += TWO_PI * periods
    matrix = monodromy(engine, params, codes, modes, nodes[0])
    if matrix is None:
        return Replay(
            error, "the return map is not smooth here: a displaced start takes other events", nothing
        )
    multipliers = np.linalg.eigvals(matrix).astype(complex)
    free = 0 if np.any(codes < 2) else 1  # a motion without impacts may be moved as a whole
    growth = float(np.sort(np.abs(multipliers))[::-1][free])
    expected = np.log(loss / 1e-15) / np.log(growth) if growth > 1.0 else np.inf
    wanted = int(min(most, max(1.0, expected)))
    cycle = _Cycle(engine, params, codes, modes, nodes, periods)
    returned = _returns(cycle, growth) if growth < 1.0 - 1e-6 else None
    return Replay(error, "", multipliers, _tracked(cycle, loss, wanted), float(expected), returned)


def _stuck(model: Model, params: np.ndarray) -> Replay:
    """The empty word: the absorber must not slip."""
    held = model.rest.reserve(params, np.linalg.solve(*model.rest.equations(params))) >= 0.0
    sentence = "" if held else "friction does not hold the absorber"
    return Replay(0.0 if held else np.inf, sentence, np.empty(0, complex))


def _motion(model: Model, cycle: _Cycle) -> float:
    engine, params, codes, _, nodes, periods = cycle
    begin = cycle.begin()
    left, right = engine.walls(params)
    if not right <= begin[1] <= left:
        return np.inf
    state = begin.copy()
    until = begin[4] + begin[0] / TWO_PI + periods
    seen = collect(engine, state, params, until, 100 * len(codes) + 1000)
    run = NativeTrajectory.of(model, params, engine, begin, state, seen)
    if run.status == EVENTS_FULL:
        return np.inf
    if nodes[:, 0].min() < nodes[0, 0] or nodes[:, 0].max() > nodes[0, 0] + TWO_PI * periods:
        return np.inf  # time does not run forward through these nodes
    places = np.where(codes == 0, left, np.where(codes == 1, right, nodes[:, 1]))
    there = run.sample(np.append(nodes[:, 0], nodes[0, 0] + TWO_PI * periods))
    return float(np.abs(there.w - np.append(places, places[0])).max())


def _freest(codes: np.ndarray) -> int:
    """An event whose node has no dependent entry: an impact, else a turn, else any."""
    for wanted in ((0, 1), (2,), (3,), (4,)):
        places = np.flatnonzero(np.isin(codes, wanted))
        if len(places):
            return int(places[0])
    return 0


def _tracked(cycle: _Cycle, loss: float, wanted: int) -> int:
    engine, params, codes, modes, nodes, periods = cycle
    there = go_round(engine, params, codes, modes, nodes[0], wanted)
    n = len(codes)
    cycles = len(there.nodes) // n
    claimed = np.roll(nodes, -1, axis=0)
    claimed[-1, 0] += TWO_PI * periods
    for c in range(cycles):
        piece = there.nodes[c * n : (c + 1) * n].copy()
        piece[:, 0] -= TWO_PI * periods * c
        if np.abs(piece - claimed).max() > loss:
            return c
    return cycles


def _returns(cycle: _Cycle, growth: float) -> bool:
    """Start a little off the orbit, wait until multipliers have shrunk that ten millionfold, and compare.

    Beside a border, or where deviations grow a thousandfold before they shrink, the orbit may attract from very near only: smaller
    displacements are tried as well. Where the orbit itself is known less well than that, because it is ill conditioned, starts are to
    come to where the simulation settles that starts on it.
    """
    engine, params, codes, _, nodes, periods = cycle
    cycles = min(200_000.0 / periods, np.ceil(np.log(1e-7) / np.log(max(growth, 1e-3))) + 10.0)

    def later(size: float, wanted: np.ndarray, wait: float = cycles) -> tuple[float, np.ndarray]:
        """The motion from a start so far off, after these cycles, and its distance from the nodes wanted."""
        state = cycle.begin()
        state[2] *= 1.0 + size
        if codes[0] > 1:
            state[0] += size
        engine.launch(state, params)
        skip(engine, state, params, state[4] + wait * periods, int(1000 * (1.0 + wait) * periods))
        return _nearest(cycle._replace(nodes=wanted), state)

    tries = ((DISPLACED, NEAR), (1e-8, 1e-9), (1e-10, 1e-8), (1e-11, 1e-8))
    if any(later(size, nodes)[0] < near for size, near in tries):
        return True
    off, settled = later(0.0, nodes)
    if not off < ILL:
        return False
    if off > NEAR and later(DISPLACED, settled)[0] < NEAR:
        return True
    return any(later(size, nodes)[0] < min(ILL, SHRUNK * later(size, nodes, 0.0)[0]) for size in SMALLER)


def _nearest(cycle: _Cycle, state: np.ndarray) -> tuple[float, np.ndarray]:
    """How near the motion from a state comes to the orbit's nodes, and its own nodes there."""
    engine, params, codes, modes, nodes, periods = cycle
    seen, after, rows, _ = collect(engine, state, params, state[4] + 2.0 * periods + 1.0, 3 * len(codes) + 3)
    found = nodes_of(engine, params, seen, after, rows)
    n, best = len(codes), (np.inf, nodes)
    for k in range(max(0, len(seen) - n + 1)):
        if np.array_equal(seen[k : k + n], codes) and np.array_equal(after[k : k + n], modes):
            here = found[k : k + n].copy()
            if not np.any(codes < 2):
                here[:, 1] += nodes[0, 1] - here[0, 1]
            gap = cyclic_distance(here, nodes)
            if gap < best[0]:
                best = gap, here
    return best
