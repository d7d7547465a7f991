"""Find attractors from one start or many: simulate until the motion nearly returns, then solve the equations of the cycle."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.attractors.attractor import Attractor, described, lasting
from orbits.contacts import SLIP
from orbits.flows import simulator_of
from orbits.flows.equations import solved_nodes
from orbits.flows.protocol import SimulationError, Simulator
from orbits.flows.trajectory import TWO_PI, Trajectory
from orbits.orbit import Orbit
from orbits.settings import SIMULATING
from orbits.words import Word

if TYPE_CHECKING:
    from orbits.machines.varying import Varying
    from orbits.orbit import Orbit


DRAWS = 200  # random starts tried at most until one can be simulated
SHORT = 4  # longest cycles of the first search, in forcing periods
FAR = 0.1  # largest distance of a solved cycle from the simulated motion, relative to 1 + states
DRIFTS = 2.0  # factor by which the difference of two returns must change from one look to the next to count as a drift; t^(-1/2) gives 8
MOVES = 8  # times at most that a creeping motion is moved to a wall
PLAIN = 40  # longest word, in events, for which the shortest spelling is sought


def find_attractor(
    model: Varying,
    start: Mapping[str, float] | np.ndarray | None = None,
    *,
    transient: float | None = None,
    max_period: int = 16,
    tolerance: float | None = None,
    patience: int | None = None,
    observed: bool = True,
    **parameters: float,
) -> Attractor:
    """Simulate, discard the transient and identify the attractor; `Varying.attractor` documents the parameters."""
    if max_period < 1:
        raise SimulationError(f"max_period = {max_period}: give a whole number, 1 or above")
    if transient is not None and not (np.isfinite(transient) and transient >= 0.0):
        raise SimulationError(f"transient = {transient}: give a number of forcing periods, 0 or above")
    simulator = simulator_of(model, model.vector(parameters))
    simulator.put(start)
    waiting = simulator.waiting
    length = waiting.transient if transient is None else transient
    tries = waiting.tries if patience is None else patience
    found = attracted(
        simulator, length, max_period, waiting.returned if tolerance is None else tolerance, tries
    )
    return lasting(found) if observed else found


def met(
    model: Varying,
    params: np.ndarray,
    count: int,
    seed: int,
    first: Mapping[str, float] | np.ndarray | None = None,
    **options: int,
) -> Iterator[tuple[Attractor, dict[str, float]]]:
    """Yield attractors and their measures (see `described`) from the start `first` (rest by default) and from seeded random starts; starts inside a wall are skipped."""
    generator = np.random.default_rng(seed)
    values: dict[str, Any] = {**model.named(params), **options}
    for i in range(count):
        start = first if i == 0 else model.random_start(params, generator)
        with suppress(SimulationError):
            yield described(find_attractor(model, start, observed=False, **values))


def goes_on(simulator: Simulator, transient: float, max_period: int, patience: int | None = 0) -> Attractor:
    """Attractor reached from the simulator's present state; the simulator is advanced. `patience`: prolongations of the transient, None for those of a sweep."""
    waiting = simulator.waiting
    tries = waiting.in_sweeps if patience is None else patience
    return attracted(simulator, transient, max_period, waiting.returned, tries)


def beginning_with(orbit: Orbit, transient: float, max_period: int) -> dict[str, float]:
    """Measures of the attractor reached by a simulation that begins on an orbit; empty for an orbit without events."""
    if not len(orbit.nodes):
        return {}
    simulator = simulator_of(orbit.model, orbit.params)
    simulator.begin(orbit.word, orbit.nodes[0])
    return described(goes_on(simulator, transient, max_period))[1]


def different_attractors(
    model: Varying, count: int, seed: int = 0, size: float = 1.0, **options: Any
) -> list[Attractor]:
    """Different attractors reached from random starts; `Varying.attractors` documents the parameters."""
    generator = np.random.default_rng(seed)
    params = model.vector({k: v for k, v in options.items() if k in model.parameter_names})
    found: list[Attractor] = []
    for _ in range(count):
        refused = SimulationError("")
        for _ in range(DRAWS):
            try:
                one = find_attractor(model, model.random_start(params, generator, size), **options)
                break
            except SimulationError as error:
                refused = error
        else:
            raise SimulationError(f"no start with states within {size:g} could be simulated: {refused}")
        if not any(one.distance(other) < SIMULATING.same for other in found):
            found.append(one)
    return found


def attracted(
    simulator: Simulator, transient: float, max_period: int, tolerance: float, patience: int
) -> Attractor:
    """Attractor reached from the simulator's present state: simulate until the motion returns to itself, and solve for the cycle.

    `orbits.attractors.attractor.lasting` completes the kind of a motion that does not return.

    Parameters
    ----------
    simulator : Simulator
        Advanced.
    transient : float
        Forcing periods (of a self-excited machine: events) simulated first; prolonged each time no return is found.
    max_period : int
        Longest period sought, in forcing periods (events per cycle: 25 times as many).
    tolerance : float
        Largest difference of points, relative to 1 + points, that counts as a return. After the first attempt near returns count, too, if the
        solved cycle attracts.
    patience : int
        Number of prolongations of the transient.
    """
    waiting, model, start_time = simulator.waiting, simulator.model, simulator.time
    early = transient // waiting.early if waiting.early else 0
    if early:
        simulator.skip(early)
        for longest in sorted({min(SHORT, max_period), max_period}):
            run = simulator.look(longest)
            for found in _candidates(simulator, run, longest, tolerance):
                if _attracts(found[0]):
                    return _attractor(simulator, run, *found[:2])
    attempt, moved, length, before = 0, 0, transient - early, None
    while True:
        last = attempt >= patience
        simulator.skip(length)
        run = simulator.look(max_period)
        rests = simulator.rests(run, last)
        if rests:
            rest = Orbit.at_rest(model, simulator.params) if model.in_cavity else None
            periods = 0 if rest is None else rest.periods  # a sticking absorber moves with its cavity
            return Attractor(
                model, simulator.params, simulator.resting, periods, rest, run, 0, simulator.state.copy()
            )
        if rests is None:
            attempt, length = attempt + 1, waiting.longer * (length or run.lasted)
            continue
        if model.in_cavity and not len(run):  # frictionless motion between the walls: no events
            return Attractor(model, simulator.params, "sliding", 1, None, run, 0, simulator.state.copy())
        if moved < MOVES and simulator.move_on(run, max_period):
            moved += 1
            continue
        # Near a bifurcation a motion may return but for a drift that decays or grows: continue as long as the drift changes.
        # A difference that stays the same belongs to a longer cycle or to narrow chaotic bands.
        latest = next(iter(returns(run, max_period, SIMULATING.nearly)), None)
        drifts, before = _drifts(before, latest), latest
        waited = patience > 0 and simulator.time - start_time < waiting.slow and drifts
        last = last and not waited
        for near in (tolerance, SIMULATING.nearly) if last or attempt else (tolerance,):
            for found in _candidates(simulator, run, max_period, near):
                if _attracts(found[0]) or (last and found[2] <= SIMULATING.closed):
                    return _attractor(simulator, run, *found[:2])
                simulator.push()
        if run.held or not (len(run) or model.forced):
            last = True
        if last or simulator.count > waiting.events:
            kind = simulator.resting if run.held else "chatter" if run.chatters else simulator.wandering
            return Attractor(model, simulator.params, kind, 0, None, run, 0, simulator.state.copy())
        attempt, length = attempt + 1, waiting.longer * (length or run.lasted)


Found = tuple[Orbit | int, int, float]
"""An orbit, or the number of events of a cycle that no word describes; its forcing periods; difference of the last two returns."""


def recurring(simulator: Simulator, run: Trajectory, max_period: int, near: float) -> Orbit | None:
    """The shortest cycle at the end of a run whose equations have a solution there, and which attracts or has been reached exactly; None if there is none."""
    for orbit, _, gap in _candidates(simulator, run, max_period, near):
        if isinstance(orbit, Orbit) and (gap <= SIMULATING.closed or _attracts(orbit)):
            return plainest(orbit)
    return None


def _candidates(simulator: Simulator, run: Trajectory, max_period: int, near: float) -> Iterator[Found]:
    """Yield cycles at the end of a run whose equations have a solution there, the shortest first."""
    if not len(run):
        yield from _eventless(simulator, run, max_period, near)
        return
    if near >= SIMULATING.nearly and run.piled.any():
        return  # between two rests on a wall a near return is no cycle
    tried = 0
    for length, periods, gap in returns(run, max_period, near):
        if run.piled[-length:].any():
            yield length, periods, gap
            return
        if tried and length % tried:
            continue
        tried = length
        orbit = _solved(run, len(run) - length, len(run), periods, FAR)
        if orbit is not None:
            yield orbit, orbit.periods, gap


def _attracts(found: Orbit | int) -> bool:
    """Whether no multiplier lies outside the unit circle; a cycle without a word was reached by simulation, so it attracts."""
    return isinstance(found, int) or not np.any(np.abs(found.multipliers) > 1.0 + SIMULATING.neutral)


def _attractor(simulator: Simulator, run: Trajectory, found: Orbit | int, periods: int) -> Attractor:
    model, params, state = simulator.model, simulator.params, simulator.state.copy()
    if isinstance(found, int):
        return Attractor(model, params, "chatter", periods, None, run, found, state)
    kind = found.flow.kind(found) if len(found.word) else "periodic"
    return Attractor(model, params, kind, found.periods, plainest(found), run, len(found.word), state)


def returns(run: Trajectory, max_period: int, near: float) -> Iterator[tuple[int, int, float]]:
    """Yield candidates (events, forcing periods, largest difference relative to 1 + points), the shortest first, for which the last cycle repeats the one before."""
    n, labels = len(run), run.labels
    if n < 2:
        return
    clocks, points, forced = run.clocks[1:], run.points, run.model.forced
    size = 1.0 + float(np.abs(points).max())
    same = labels[: n - 1] == labels[-1]
    turns = (clocks[-1] - clocks[: n - 1]) / TWO_PI
    whole = np.round(turns) if forced else np.ones(n - 1)
    if forced:
        same &= (np.abs(turns - whole) * TWO_PI < near * size) & (whole >= 1)
    for j in np.flatnonzero(same)[::-1]:
        length, periods = n - 1 - int(j), int(whole[j])
        if periods > max_period or 2 * length > n:
            return
        last, before = slice(n - length, n), slice(n - 2 * length, n - length)
        if not np.array_equal(labels[last], labels[before]):
            continue
        gap = float(np.abs(points[last] - points[before]).max()) / size
        if forced:
            late = clocks[last] - clocks[before] - TWO_PI * periods
            gap = max(gap, float(np.abs(late).max()) / size)
        if gap < near:
            yield length, periods, max(gap, np.finfo(float).tiny)


def _drifts(before: tuple[int, int, float] | None, latest: tuple[int, int, float] | None) -> bool:
    """Whether two successive looks found the same return with a difference that grows or decays."""
    if before is None or latest is None or before[:2] != latest[:2]:
        return False
    return not 1.0 / DRIFTS < latest[2] / before[2] < DRIFTS


def solved(run: Trajectory, first: int, last: int, periods: int, far: float) -> Orbit | None:
    """Solve for the orbit through events `first` to `last` - 1 of a run; None if there is no real solution within `far` of them (see `polished`)."""
    orbit = _solved(run, first, last, periods, far)
    return None if orbit is None else plainest(orbit)


def _solved(run: Trajectory, first: int, last: int, periods: int, far: float) -> Orbit | None:
    """Like `solved`, but the orbit begins at event `first`, so that its multipliers need no new linearisation."""
    word, nodes = run.cycle(first, last)
    if run.model.forced:
        nodes[:, 0] -= TWO_PI * np.floor(nodes[0, 0] / TWO_PI)
    return polished(Orbit(run.model, word, periods, nodes, run.params), far)


def polished(orbit: Orbit, far: float = FAR) -> Orbit | None:
    """Solve for the real orbit with the word of a guess, reduced to its primitive period; None if there is none within `far` (relative to 1 + states)."""
    nodes = solved_nodes(orbit.system(symmetric=False), orbit.nodes, orbit.params)
    if nodes is None:
        return None
    change = nodes - orbit.nodes
    for entry in orbit.flow.loose(orbit.model, orbit.word):  # a shift of the whole motion does not count
        change[:, entry] -= change[:, entry].mean()
    if np.abs(change).max() > far * (1.0 + np.abs(orbit.nodes[:, 1:]).max()):
        return None
    found = Orbit(orbit.model, orbit.word, orbit.periods, nodes, orbit.params)
    if not found.real:
        return None
    root = found.root()
    return found if root.periods == found.periods and len(root.nodes) == len(found.nodes) else root


def plainest(orbit: Orbit) -> Orbit:
    """Rotate an orbit to the event (no slip) at which its word has the shortest spelling, in the first forcing period."""
    word = orbit.word
    if len(word) > 1:
        places = [i for i in range(len(word)) if word.letter(i).kind != SLIP] or [0]
        orbit = orbit.rotate(min(places, key=lambda i: _spelling_key(orbit, i)))
    if orbit.forced and len(word):  # an orbit without events begins at phase zero
        orbit.nodes[:, 0] -= TWO_PI * np.floor(orbit.nodes[0, 0] / TWO_PI)
    return orbit


def _spelling_key(orbit: Orbit, place: int) -> tuple[int, str | tuple[str, ...], float]:
    """Sort key of a spelling: length and text of the word from an event on, then its phase."""
    word, phase = orbit.word.rotate(place), float(orbit.nodes[place, 0]) % TWO_PI
    return (len(word.text), word.text, phase) if len(word) <= PLAIN else (0, word.events, phase)


def _eventless(simulator: Simulator, run: Trajectory, max_period: int, near: float) -> Iterator[Found]:
    """Yield cycles of a motion without events: of a forced machine from its states at phase zero, of a self-excited one the cycle near its state."""
    model, params = run.model, run.params
    word = Word((), (simulator.modes,), model.alphabet)
    if not model.forced:
        from orbits.flows.page.smooth import cycle_near

        found = cycle_near(model, word, params, simulator.point)
        orbit = None if found is None else polished(Orbit(model, word, 1, found[None], params))
        if orbit is not None:
            yield orbit, 1, 0.0
        return
    times = np.arange(np.ceil(run.clocks[0] / TWO_PI), np.floor(run.finish / TWO_PI) + 1.0)
    states = run.coordinates(times)
    size = 1.0 + float(np.abs(states).max())
    for periods in range(1, min(max_period, len(states) - 1) + 1):
        gap = float(np.abs(states[-1] - states[-1 - periods]).max()) / size
        if gap <= near:
            orbit = polished(Orbit(model, word, periods, np.array([[0.0, *states[-1]]]), params))
            if orbit is not None:
                yield orbit, orbit.periods, gap
