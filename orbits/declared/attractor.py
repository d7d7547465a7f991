"""Attractors of declared machines: simulate, see what returns, and solve for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from orbits.contacts.letters import HOLD, RELEASE, SLIP
from orbits.contacts.wall import HELD, Wall
from orbits.flows.page.solving import SOLVED, newton
from orbits.flows.page.stepper import TWO_PI, SimulationError, Stepper
from orbits.flows.protocol import Record
from orbits.machines.page.machine import Machine
from orbits.orbit import Orbit
from orbits.simulation.page import PageTrajectory, collect, first_state
from orbits.words.of_pages import PageWord

RETURNED = 1e-3  # difference of nodes, relative to 1 + states, at which a motion may have returned
SETTLED = 1e-5  # difference at which it has, if its equations confirm it
LONGEST_WORD = 400
EARLY, SHORT = (
    5,
    4,
)  # a first look after a fifth of the transient, at short cycles first: what attracts and has returned need not be waited for
PLAIN = 40  # events up to which the plainest reading is looked for
REPELS = 1.0 + 1e-6  # an orbit with a larger multiplier repels, and ...
CLOSED = 1e-9  # ... a return to it that is open by more, relative to 1 + states, only passes it by


@dataclass(frozen=True, eq=False)
class DeclaredAttractor:
    """What a start leads to.

    Attributes
    ----------
    machine : Machine
    params : float array (P,)
    kind : str
        "periodic", "chatter" (periodic or not, with infinitely many impacts in finite time), "rest" (a wall holds the body for good, or a
        self-excited machine has no events any more), or "aperiodic" (no period up to the longest that was looked for).
    orbit : Orbit or None
        Of a periodic one.
    trajectory : PageTrajectory
        The last part of the simulation.
    """

    machine: Machine
    params: np.ndarray
    kind: str
    orbit: Orbit | None
    trajectory: PageTrajectory = field(repr=False)

    @property
    def word(self) -> PageWord | None:
        """The periodic orbit's word."""
        return None if self.orbit is None else self.orbit.word

    @property
    def periods(self) -> int:
        """Forcing periods of the orbit; 0 where there is none."""
        return 0 if self.orbit is None else self.orbit.periods

    @property
    def found(self) -> Orbit:
        """The orbit.

        Raises
        ------
        ValueError
            If the attractor is no periodic orbit.
        """
        if self.orbit is None:
            why = {
                "chatter": "impacts pile up on it, so no finite word describes it",
                "rest": "a wall holds the body for good"
                if self.trajectory.held
                else "it has no events from which its period could be counted",
                "aperiodic": "no period was found",
            }[self.kind]
            raise ValueError(
                f"this attractor of {self.machine.name!r} is no orbit that can be continued ({self.kind}: {why}); choose other "
                "parameters or another start, or give a word to machine.orbit"
            )
        return self.orbit

    def problem(self, parameter: str | None = None, symmetric: bool | None = None) -> Any:
        """The orbit as a continuation problem.

        Raises
        ------
        ValueError
            If the attractor is no periodic orbit.
        """
        return self.found.problem(parameter, symmetric)

    def seed(self, problem: Any) -> tuple[np.ndarray, float]:
        """Unknowns and parameter value in `problem`."""
        return self.found.seed(problem)

    def __repr__(self) -> str:
        what = f"word {self.orbit.word.text!r}, periods {self.orbit.periods}" if self.orbit else self.kind
        return f"<Attractor of {self.machine.name}: {what}>"


def find_attractor(
    machine: Machine,
    start: Mapping[str, float] | None = None,
    *,
    transient: int = 100,
    max_period: int = 16,
    patience: int = 4,
    parameters: Mapping[str, float] | None = None,
) -> DeclaredAttractor:
    """Simulate until the motion returns to itself.

    Parameters
    ----------
    machine : Machine
    start : mapping, optional
        States by name and `phase`; what is not given is 0.
    transient : int
        Forcing periods (of a self-excited machine: events) simulated first; twice as many each time nothing has returned.
    max_period : int
        Longest period looked for, in forcing periods (events per cycle: 25 times as many).
    patience : int
        How often the transient is doubled.
    parameters : mapping, optional
        In place of the page's own.
    """
    params = machine.vector(parameters)
    stepper = Stepper(machine, params)
    stepper.start(*first_state(machine, start))
    return attracted(stepper, transient, max_period, patience)


def attracted(stepper: Stepper, transient: int, max_period: int, patience: int) -> DeclaredAttractor:
    """What the motion of a stepper leads to; `find_attractor` says what the numbers are."""
    machine, params = stepper.machine, stepper.params
    early = transient // EARLY
    skip(stepper, early)
    for longest in sorted({min(SHORT, max_period), max_period}):
        run = look(stepper, longest)
        orbit = returning(run, longest, SETTLED)
        if orbit is not None:
            return DeclaredAttractor(machine, params, "periodic", orbit, run)
    for attempt in range(patience + 1):
        skip(stepper, transient * 2**attempt - (0 if attempt else early))
        run = look(stepper, max_period)
        orbit = returning(run, max_period, RETURNED if attempt else SETTLED)
        if orbit is not None:
            return DeclaredAttractor(machine, params, "periodic", orbit, run)
        if run.held or not (run.events or machine.forced):
            return DeclaredAttractor(machine, params, "rest", None, run)
        if run.chatters and attempt:
            break
    kind = "chatter" if run.chatters else "aperiodic"
    return DeclaredAttractor(machine, params, kind, None, run)


def skip(stepper: Stepper, count: int) -> None:
    """Move on by so many forcing periods; of a self-excited machine, by so many events."""
    if stepper.machine.forced:
        until = stepper.base + stepper.clock + TWO_PI * count
        while stepper.advance(until) is not None:
            pass
        return
    for _ in range(count):
        if stepper.advance(stepper.base + stepper.clock + 1e4) is None:
            return


def look(stepper: Stepper, max_period: int) -> PageTrajectory:
    """The run in which a recurrence of up to `max_period` periods is looked for."""
    if stepper.machine.forced:
        return collect(stepper, TWO_PI * (2 * max_period + 1), 50 * max_period + 2000)
    return collect(stepper, 1e4, min(2 * LONGEST_WORD, 50 * max_period))


def settle(stepper: Stepper, transient: int, max_period: int) -> Orbit | None:
    """The periodic orbit to which a stepper's motion settles after a transient, or None."""
    skip(stepper, transient)
    return returning(look(stepper, max_period), max_period, RETURNED)


def returning(run: PageTrajectory, max_period: int, near: float) -> Orbit | None:
    """The shortest cycle at the end of a run whose equations confirm it: not one that repels, beside which the run has only passed."""
    machine = run.machine
    if any(kind in (HOLD, RELEASE) for _, kind, _ in run.events[-LONGEST_WORD:]):
        return None
    if not run.events:
        return _eventless(run, max_period, near)
    letters, modes = run.letters, run.modes[1:]
    clocks, states = run.clocks[1:], run.states[1:]
    size = 1.0 + float(np.abs(states).max())
    scale = near * size
    total = len(letters)
    last_tried = None
    for length in range(1, min(total // 2, LONGEST_WORD) + 1):
        if (
            letters[-length:] != letters[-2 * length : -length]
            or modes[-length:] != modes[-2 * length : -length]
        ):
            continue
        gap = np.abs(states[-length:] - states[-2 * length : -length]).max()
        if gap > scale:
            continue
        periods = 1
        if machine.forced:
            turns = (clocks[-1] - clocks[-1 - length]) / TWO_PI
            periods = round(turns)
            if periods < 1 or periods > max_period or abs(turns - periods) > scale:
                continue
        if last_tried is not None and length % last_tried:
            continue
        last_tried = length
        orbit = solved(run, length, periods)
        if orbit is not None and (gap <= CLOSED * size or not np.any(np.abs(orbit.multipliers) > REPELS)):
            return orbit
    return None


def solved(run: PageTrajectory, length: int, periods: int, far: float = 0.1) -> Orbit | None:
    """The last `length` events of a run as an orbit, if its equations have a solution within `far` of them; see `polished`."""
    machine = run.machine
    word = PageWord(tuple(run.letters[-length:]), tuple(run.modes[-length:]), machine.alphabet)
    clocks = run.clocks[-length:]
    if machine.forced:
        first = clocks - TWO_PI * np.floor(clocks[0] / TWO_PI)
    else:
        first = np.append(np.diff(clocks), clocks[0] - run.clocks[-length - 1])
    nodes = np.column_stack([first, run.states[-length:]])
    return polished(Orbit(machine, word, periods, nodes, run.params), far)


def of_record(record: Record, first: int, last: int, periods: int, far: float) -> Orbit | None:
    """The cycle next to events `first` to `last` - 1 of a record; see `solved`."""
    run, stop = record.source, last + 1
    part = PageTrajectory(
        run.machine,
        run.params,
        run.clocks[:stop],
        run.states[:stop],
        run.modes[:stop],
        run.events[:last],
        float(run.clocks[last]),
        run.status,
    )
    return solved(part, last - first, periods, far)


def polished(orbit: Orbit, far: float = 0.1) -> Orbit | None:
    """The orbit with the same word next to a guess; None if there is none within `far` (relative to 1 + states)."""
    word = orbit.word
    problem = orbit.system(symmetric=False)
    p = problem.value(orbit.params)
    u, _, residual, _ = newton(problem, problem.reduce(orbit.nodes), p)
    nodes = problem.expand(u)
    near = far * (1.0 + np.abs(orbit.nodes[:, 1:]).max())
    moved = nodes - orbit.nodes
    for entry in orbit.flow.loose(orbit.model, word):  # shifted as a whole it is the same motion
        moved[:, entry] -= moved[:, entry].mean()
    if not residual < SOLVED or np.abs(moved).max() > near:
        return None
    found = Orbit(orbit.model, word, orbit.periods, nodes, orbit.params)
    return plainest(found.root()) if found.real else None


def plainest(orbit: Orbit) -> Orbit:
    """The orbit read from the event from which its word is written shortest, never from a slip."""
    if not 1 < len(orbit.word) <= PLAIN:
        return orbit
    places = [i for i in range(len(orbit.word)) if orbit.word.letter(i).kind != SLIP]
    texts = [(len(text), text, i) for i in places for text in (orbit.word.rotate(i).text,)]
    found = orbit.rotate(min(texts)[2])
    if found.model.forced:  # the first phase within the first period
        found.nodes[:, 0] -= TWO_PI * np.floor(found.nodes[0, 0] / TWO_PI)
    return found


def _eventless(run: PageTrajectory, max_period: int, near: float) -> Orbit | None:
    """The shortest cycle of a forced motion without events, once per forcing period at phase zero; see `returning`."""
    machine = run.machine
    mode = run.modes[-1]
    held = any(isinstance(c, Wall) and m == HELD for c, m in zip(machine.contacts, mode))
    if not machine.forced or held:
        return None
    word = PageWord((), (mode,), machine.alphabet)
    first, last = (
        int(turn(clock / TWO_PI)) for turn, clock in ((np.ceil, run.clocks[0]), (np.floor, run.end))
    )
    states = run.sample(TWO_PI * np.arange(first, last + 1))
    size = 1.0 + float(np.abs(states).max())
    for periods in range(1, min(max_period, len(states) - 1) + 1):
        gap = float(np.abs(states[-1] - states[-1 - periods]).max())
        if not gap <= near * size:
            continue
        orbit = polished(Orbit(machine, word, periods, np.array([[0.0, *states[-1]]]), run.params))
        if orbit is not None and (gap <= CLOSED * size or not np.any(np.abs(orbit.multipliers) > REPELS)):
            return orbit
    return None


def random_start(machine: Machine, generator: np.random.Generator, size: float = 1.0) -> dict[str, float]:
    """States within +-size and a phase."""
    start = {name: float(generator.uniform(-size, size)) for name in machine.states}
    if machine.forced:
        start["phase"] = float(generator.uniform(0.0, TWO_PI))
    return start


def find_attractors(
    machine: Machine,
    count: int,
    seed: int = 0,
    size: float = 1.0,
    parameters: Mapping[str, float] | None = None,
) -> list[DeclaredAttractor]:
    """The different attractors that `count` random starts (states within +-`size`) lead to; those of one motion once.

    Raises
    ------
    SimulationError
        If no start can be simulated.
    """
    generator = np.random.default_rng(seed)
    found: list[DeclaredAttractor] = []
    forms: list[Any] = []
    refused: SimulationError | None = None
    for _ in range(count):
        for _ in range(200):
            start = random_start(machine, generator, size)
            try:
                attractor = find_attractor(machine, start, parameters=parameters)
                break
            except SimulationError as error:
                refused = error
        else:
            raise SimulationError(f"no start with states within {size:g} could be simulated: {refused}")
        if attractor.orbit is None:
            form: Any = (attractor.kind, None)
        else:
            problem = attractor.problem(symmetric=False)
            form = problem.canonical(*attractor.seed(problem))
        if not any(_same(form, other) for other in forms):
            forms.append(form)
            found.append(attractor)
    return found


def witness(machine: Machine, params: np.ndarray, starts: int) -> list[dict[str, Any]]:
    """Word, periods and kind of what random starts lead to, sorted; empty where nothing can be simulated."""
    parameters = dict(zip(machine.parameter_names, map(float, params)))
    try:
        found = find_attractors(machine, starts, 7, parameters=parameters)
    except SimulationError:
        return []
    named = {(a.word.canonical().text if a.word is not None else "", a.periods, a.kind): a for a in found}
    return [{"word": word or None, "periods": periods, "kind": kind} for word, periods, kind in sorted(named)]


def _same(one: Any, other: Any) -> bool:
    if one[0] != other[0] or (one[1] is None) != (other[1] is None):
        return False
    return one[1] is None or bool(np.abs(one[1] - other[1]).max() < 1e-6 * (1.0 + np.abs(one[1]).max()))
