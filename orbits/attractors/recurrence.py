"""From a simulated motion to its attractor: recurrence of events, polished to an orbit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from orbits.attractors.attractor import Attractor
from orbits.attractors.creeping import move_on
from orbits.attractors.polish import first_event, is_symmetric, polish, root_length, rotate, touches
from orbits.flows.protocol import SimulationError
from orbits.machines.states import event_states, nodes_of
from orbits.machines.stepping import FAILED, HOLD, MODE, PSI, RATE, REST, TURNS, Machine, V
from orbits.simulation.driver import collect, skip
from orbits.simulation.native import NativeSimulator
from orbits.simulation.return_map import cyclic_distance
from orbits.simulation.trajectory import TWO_PI

if TYPE_CHECKING:
    from orbits.machines.base import Model

EVENTS_PER_PERIOD = 400
TRANSIENT, PATIENCE = 300.0, 2  # forcing periods left out first, and how often they are prolonged fourfold
IN_SWEEPS = 2  # the same at each value of a sweep: weakly damped motions settle late
UNSTABLE = 1e-5
PASSING, CLOSED = 0.99, 1e-9  # a slower recurrence, open by more, passes beside a fold
NEARLY = 1e-3  # nodes of a slow motion differ by less from one recurrence to the next
LONGEST = 200_000  # forcing periods for which a slow or undamped transient is waited for
DRIFTS = 2.0  # times: so much the difference of two returns changes while the motion is followed four times as long; t^(-1/2) gives 8
TO_WALLS = 8  # times that a creeping motion is moved on to a wall
AT_REST = 1e-13  # largest change of a settled oscillator from one look to the next, relative


def attracted(
    simulator: NativeSimulator, transient: float, max_period: int, tolerance: float, patience: int
) -> Attractor:
    """What the motion of a simulator leads to, one that does not recur not yet observed (see `orbits.attractors.observation.lasting`)."""
    model, engine, params = simulator.model, simulator.engine, simulator.params
    return settle(model, engine, params, simulator.state, transient, max_period, tolerance, patience)


def settle(
    model: Model,
    engine: Machine,
    params: np.ndarray,
    state: np.ndarray,
    transient: float = 300,
    max_period: int = 16,
    tolerance: float = 1e-6,
    patience: int = 2,
) -> Attractor:
    """The attractor of a state, which is moved along."""
    state[TURNS] = 0.0
    length = float(transient)
    window = _Window(engine, params)
    attempt, recurring, moved = 0, None, 0
    while True:
        last = attempt >= patience
        status = skip(engine, state, params, state[TURNS] + length, int(EVENTS_PER_PERIOD * (length + 1)))
        if status == FAILED:
            raise SimulationError(
                f"the motion of {model.name!r} is not finite: give parameters of moderate size"
            )
        if status != REST:
            window.record(state, max_period)
        if window.at_rest and not last and _will_slip(model, params):
            length, attempt = 4.0 * (length or window.length), attempt + 1
            continue  # the oscillator is still growing, or between two beats
        if status == REST or window.at_rest:
            if not _comes_to_rest(engine, params, state) and not last:
                length, attempt = 4.0 * (length or window.length), attempt + 1
                continue  # it slips after all
            return _attractor(model, engine, params, "stuck", 0, window, state)
        if not len(window.codes):  # without friction a free motion between the walls has no events
            return _attractor(model, engine, params, "sliding", 1, window, state)
        if moved < TO_WALLS and move_on(
            engine, params, state, window.nodes, window.codes, window.modes, max_period
        ):
            moved += 1
            continue
        found = _recognise(engine, params, window, max_period, tolerance, last)
        before, recurring = recurring, next(iter(_returns(window, max_period, NEARLY)), None)
        # next to a bifurcation a motion may recur but for a drift that fades or grows: it is given time as long as it does; one that
        # stays as it is belongs to a longer cycle, or to narrow bands
        slow = patience > 0 and state[TURNS] < LONGEST and _drifts(before, recurring)
        if found is not None:
            cycle = _cycle(model, engine, params, state, window, *found)
            sizes = np.abs(cycle.multipliers)
            passing = cycle.residual > CLOSED and np.any(sizes > PASSING)
            if not passing and (not np.any(sizes > 1.0 + UNSTABLE) or (last and not slow)):
                return cycle
            state[RATE] *= 1.0 + 1e-6  # a motion that only rounding keeps where it is: help it to leave
        if last and not slow:
            break
        length, attempt = 4.0 * (length or window.length), attempt + 1
    kind = "chatter" if np.any(window.codes == HOLD) else "chaotic"
    return _attractor(model, engine, params, kind, 0, window, state)


def _comes_to_rest(engine: Machine, params: np.ndarray, state: np.ndarray) -> bool:
    """Wait, with the absorber stuck, until its oscillator has settled; False if it slips meanwhile."""
    if not engine.moving_cavity:
        return True  # its cavity moves as prescribed
    length = 64.0
    while state[TURNS] < LONGEST:
        before = state.copy()
        skip(engine, state, params, before[TURNS] + before[PSI] / TWO_PI + length, 1)
        if state[MODE] != 0.0:
            return False
        change = np.abs(state[V:] - before[V:]).max()
        if change <= AT_REST * np.abs(state[V:]).max():
            break
        length *= 2.0
    return True


def _will_slip(model: Model, params: np.ndarray) -> bool:
    """Whether friction cannot hold the absorber once the oscillator has settled."""
    reserve = model.rest.reserve(params, np.linalg.solve(*model.rest.equations(params)))
    return bool(reserve <= -1e-9)


class _Window:
    """The motion looked at: a few periods after the transient."""

    def __init__(self, engine: Machine, params: np.ndarray) -> None:
        self.engine, self.params = engine, params
        self.codes, self.modes = np.empty(0, np.int8), np.empty(0, np.int8)
        self.rows = np.empty((0, engine.row))
        self.nodes = np.empty((0, 2))
        self.length = 0.0
        self.at_rest = False

    def record(self, state: np.ndarray, max_period: int) -> None:
        """Run on for two of the longest recurrences."""
        begin = state[TURNS] + state[PSI] / TWO_PI
        self.length = 2.0 * max_period + 1.0
        most = int(EVENTS_PER_PERIOD * self.length)
        self.codes, self.modes, self.rows, status = collect(
            self.engine, state, self.params, begin + self.length, most
        )
        self.nodes = nodes_of(self.engine, self.params, self.codes, self.modes, self.rows)
        self.at_rest = status == REST or (not len(self.codes) and state[RATE] == 0.0 and state[MODE] == 0.0)


def _recognise(
    engine: Machine, params: np.ndarray, window: _Window, max_period: int, tolerance: float, last: bool
) -> tuple[int, int] | None:
    """Events and periods of the shortest recurrence at the window's end.

    At the last attempt a slowly converging motion may still be recognised: looser, but then the orbit must
    exist and be stable.
    """
    for slack in (tolerance, NEARLY) if last else (tolerance,):
        for length, periods, _ in _returns(window, max_period, slack):
            if slack <= tolerance:
                return length, periods
            codes, modes = window.codes[-length:], window.modes[-length:]
            nodes, residual, multipliers = polish(
                engine, params, codes, modes, window.nodes[-length:], periods
            )
            gap = cyclic_distance(nodes, window.nodes[-length:])
            if residual < 1e-9 and gap < 10.0 * slack and np.all(np.abs(multipliers) < 1.0 + 1e-6):
                return length, periods
    return None


def _returns(window: _Window, max_period: int, slack: float) -> list[tuple[int, int, float]]:
    """Candidates (events, periods, largest difference), shortest first: the last cycle repeats the one before it."""
    codes, modes, nodes = window.codes, window.modes, window.nodes
    n = len(codes)
    if n < 2:
        return []
    found = []
    gaps = (nodes[-1, 0] - nodes[:, 0]) / TWO_PI
    near = (codes == codes[-1]) & (modes == modes[-1]) & (np.abs(gaps - np.round(gaps)) * TWO_PI < slack)
    for j in np.flatnonzero(near)[::-1]:
        periods = int(np.round(gaps[j]))
        length = n - 1 - j
        if periods < 1 or length < 1:
            continue
        if periods > max_period or 2 * length > n:
            break
        here, before = slice(n - length, n), slice(n - 2 * length, n - length)
        if not (np.array_equal(codes[here], codes[before]) and np.array_equal(modes[here], modes[before])):
            continue
        shift = nodes[here] - nodes[before]
        shift[:, 0] -= TWO_PI * periods
        gap = float(np.abs(shift).max())
        if gap < slack:
            found.append((int(length), periods, max(gap, np.finfo(float).tiny)))
    return found


def _drifts(before: tuple[int, int, float] | None, now: tuple[int, int, float] | None) -> bool:
    """Whether two looks have seen one and the same return, with differences that are not alike."""
    if before is None or now is None or before[:2] != now[:2]:
        return False
    return not 1.0 / DRIFTS < now[2] / before[2] < DRIFTS


def _cycle(
    model: Model,
    engine: Machine,
    params: np.ndarray,
    state: np.ndarray,
    window: _Window,
    length: int,
    periods: int,
) -> Attractor:
    """The polished attractor of a recurrence, in canonical order."""
    codes, modes, nodes, rows = (
        column[-length:] for column in (window.codes, window.modes, window.nodes, window.rows)
    )
    kept = ~touches(codes, nodes, np.abs(rows[:, 3]) / np.prod(model.natural_units(params)))
    if not kept.all():
        codes, modes, rows = codes[kept], modes[kept], rows[kept]
        nodes = model.at_home(codes, nodes[kept], params)
    # polish from an impact where there is one, else from a turn: there all unknowns of a node are free
    for wanted in ((0, 1), (2,), (3,), (4, 5)):
        places = np.flatnonzero(np.isin(codes, wanted))
        if len(places):
            break
    speeds = np.abs(rows[places, 4])
    codes, modes, nodes = rotate(codes, modes, nodes, int(places[np.argmax(speeds)]), periods)
    nodes, residual, multipliers = polish(engine, params, codes, modes, nodes, periods)
    root = root_length(codes, modes, nodes, periods)
    if root < len(codes):  # a slow approach that alternates looks like a longer recurrence
        codes, modes, nodes, periods = codes[:root], modes[:root], nodes[:root], periods * root // len(codes)
        nodes, residual, multipliers = polish(engine, params, codes, modes, nodes, periods)
    codes, modes, nodes = rotate(codes, modes, nodes, first_event(codes, modes, nodes), periods)
    impacts = int(np.count_nonzero(codes < 2))
    kind = "chatter" if np.any(codes == HOLD) else "periodic" if impacts else "sliding"
    return _attractor(
        model, engine, params, kind, periods, window, state, codes, modes, nodes, residual, multipliers
    )


def recurring(
    model: Model,
    engine: Machine,
    params: np.ndarray,
    codes: np.ndarray,
    modes: np.ndarray,
    rows: np.ndarray,
    periods: int,
) -> Attractor:
    """The polished cycle next to a piece of a motion that nearly returns after so many forcing periods, stable or not."""
    window = _Window(engine, params)
    window.codes, window.modes, window.rows, window.length = codes, modes, rows, float(periods)
    window.nodes = nodes_of(engine, params, codes, modes, rows)
    state = event_states(engine, modes, rows)[0]
    return _cycle(model, engine, params, state, window, len(codes), periods)


def _attractor(
    model: Model,
    engine: Machine,
    params: np.ndarray,
    kind: str,
    periods: int,
    window: _Window,
    state: np.ndarray,
    codes: np.ndarray | None = None,
    modes: np.ndarray | None = None,
    nodes: np.ndarray | None = None,
    residual: float = 0.0,
    multipliers: np.ndarray | None = None,
) -> Attractor:
    width = engine.node
    codes = np.empty(0, np.int8) if codes is None else codes
    modes = np.empty(0, np.int8) if modes is None else modes
    nodes = np.empty((0, width)) if nodes is None else nodes
    hits = np.abs(window.rows[window.codes < 2, 3])
    rate = (
        np.count_nonzero(codes < 2) / periods
        if periods
        else hits.size / window.length
        if window.length
        else 0.0
    )
    home = model.at_home(codes, nodes, params)
    return Attractor(
        model=model,
        params=params,
        machine=engine,
        kind=kind,
        periods=periods,
        codes=codes,
        modes=modes,
        nodes=nodes,
        residual=residual,
        multipliers=np.full(width, np.nan + 0j) if multipliers is None else multipliers,
        symmetric=model.has_mirror(params)
        and (kind == "stuck" or is_symmetric(codes, modes, home, model.image(codes, home, params))),
        state=state.copy(),
        impacts_per_period=0.0 if kind == "stuck" else float(rate),
        impact_speed=float(hits.max()) if hits.size and kind != "stuck" else 0.0,
    )
