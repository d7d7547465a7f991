"""Attractors of declared machines: simulate, see what returns, and solve for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from contvines.shared.modulation import BAND, SILENT, modulation_of
from orbits.attractors.motion import Settled, wandering
from orbits.contacts.letters import HIT, HOLD, RELEASE, SLIP
from orbits.contacts.wall import HELD, Wall
from orbits.flows.page.cycle_equations import SOLVED
from orbits.flows.page.growth import growth
from orbits.flows.page.stepper import TWO_PI, Stepper
from orbits.flows.protocol import Record
from orbits.flows.solving import solved_at
from orbits.machines.page.machine import Machine
from orbits.orbit import Orbit
from orbits.simulation.page import PageSimulator, PageTrajectory, collect
from orbits.words import Word

RETURNED = 1e-3  # difference of nodes, relative to 1 + states, at which a motion may have returned
SETTLED = 1e-5  # difference at which it has, if its equations confirm it
EXACT = 1e-13  # last step of Newton's method
LONGEST_WORD = 400
LATE = 50  # of the last part of a motion, by which it is told whether it has come to rest
PER_PERIOD = 100  # instants, for the largest state in each forcing period
SAMPLES = 2000  # of a motion without a period, for its extremes
TRANSIENT, PATIENCE = 100.0, 4  # forcing periods (or events) left out first, and how often twice as many are
ENOUGH = 50_000  # events after which a motion is not followed any further
IN_SWEEPS = 0  # the same at each value of a sweep
EARLY, SHORT = 5, 4
"""A first look comes after a fifth of the transient, at short cycles first: what attracts and has returned need not be waited for."""
PLAIN = 40  # events up to which the plainest reading is looked for
REPELS = 1.0 + 1e-6  # an orbit with a larger multiplier repels, and ...
CLOSED = 1e-9  # ... a return to it that is open by more, relative to 1 + states, only passes it by


@dataclass(frozen=True, eq=False)
class PageAttractor(Settled):
    """What a start of a declared machine leads to.

    Attributes
    ----------
    model : Machine
    params : float array (P,)
    kind : str
        "periodic", "chatter" (periodic or not, with infinitely many impacts in finite time), "rest" (a wall holds the body for good, or a
        self-excited machine comes to rest), or "aperiodic" (no period up to the longest that was looked for).
    orbit : Orbit or None
        Of a periodic one.
    trajectory : PageTrajectory
        The last part of the simulation.
    state : float array (n + 1,)
        Clock and states reached.
    """

    model: Machine
    params: np.ndarray
    kind: str
    orbit: Orbit | None
    trajectory: PageTrajectory = field(repr=False)
    state: np.ndarray = field(repr=False)

    @property
    def machine(self) -> Machine:
        """The machine."""
        return self.model

    @property
    def word(self) -> Word | None:
        """The periodic orbit's word."""
        return None if self.orbit is None else self.orbit.word

    @property
    def text(self) -> str:
        """The word as text; empty where there is none."""
        return "" if self.orbit is None else self.orbit.word.text

    @property
    def periods(self) -> int:
        """Forcing periods of the orbit; 0 where there is none."""
        return 0 if self.orbit is None else self.orbit.periods

    @property
    def impacts(self) -> int:
        """Impacts of the orbit; 0 where there is none."""
        return 0 if self.orbit is None else self.orbit.impacts

    @property
    def recurrent(self) -> bool:
        """Whether the motion is a periodic orbit."""
        return self.orbit is not None

    @property
    def symmetric(self) -> bool:
        """Whether the orbit equals its mirror image."""
        return self.orbit is not None and self.orbit.symmetric

    @property
    def guess(self) -> np.ndarray | None:
        """The nodes as a study's `guess` takes them."""
        return None if self.orbit is None else self.orbit.nodes

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
                else "it has come to rest; contvines.diagram(machine.smooth(state), ...) follows equilibria",
                "aperiodic": "no period was found",
            }[self.kind]
            raise ValueError(
                f"this attractor of {self.model.name!r} is no orbit that can be continued ({self.kind}: {why}); choose other "
                "parameters or another start, or give a word to machine.orbit"
            )
        return self.orbit

    @property
    def approaches(self) -> list[float]:
        """Approach speeds of the impacts of the cycle, or of the last part of the run: the gap's rate after each over restitution."""
        run, machine = self.trajectory, self.model
        speeds = []
        first = 0 if self.orbit is None else max(len(run) - len(self.orbit.word), 0)
        for k in range(first, len(run)):
            contact, kind, _ = run.events[k]
            if kind != HIT:
                continue
            clock = run.clocks[k + 1] if machine.forced else 0.0
            numbers = machine.compiled.numbers(run.params, run.modes[k + 1])
            rate, restitution = machine.compiled.rebound(contact).one(
                run.states[k + 1], float(clock), numbers
            )
            speeds.append(float(rate / restitution))
        return speeds

    def distance(self, other: PageAttractor) -> float:
        """Largest difference of the canonical nodes, relative to 1 + nodes; inf if the words differ."""
        if self.orbit is None or other.orbit is None:
            return 0.0 if self.orbit is other.orbit and self.kind == other.kind else np.inf
        one, two = (x.found.problem(symmetric=False).canonical(*_seed(x.found)) for x in (self, other))
        return (
            np.inf
            if one[0] != two[0]
            else float(np.abs(one[1] - two[1]).max() / (1.0 + np.abs(one[1]).max()))
        )

    def __repr__(self) -> str:
        what = f"word {self.text!r}, periods {self.periods}" if self.orbit else self.kind
        return f"<Attractor of {self.model.name}: {what}>"


def _seed(orbit: Orbit) -> tuple[np.ndarray, float]:
    return orbit.seed(orbit.problem(symmetric=False))


def lasting(found: PageAttractor) -> PageAttractor:
    """Nothing more is seen of a motion that does not recur in the long run."""
    return found


def attracted(
    simulator: PageSimulator, transient: float, max_period: int, tolerance: float, patience: int
) -> PageAttractor:
    """What the motion of a simulator leads to: simulated until it returns to itself.

    Parameters
    ----------
    simulator : PageSimulator
        Moved on.
    transient : float
        Forcing periods (of a self-excited machine: events) simulated first; twice as many each time nothing has returned.
    max_period : int
        Longest period looked for, in forcing periods (events per cycle: 25 times as many).
    tolerance : float
        Not needed: what nearly returns is solved for.
    patience : int
        How often the transient is doubled.
    """
    stepper, transient = simulator.stepper, int(transient)
    machine, params = stepper.machine, stepper.params
    early = transient // EARLY
    skip(stepper, early)
    for longest in sorted({min(SHORT, max_period), max_period}):
        run = look(stepper, longest)
        orbit = returning(run, longest, SETTLED)
        if orbit is not None:
            return PageAttractor(machine, params, "periodic", orbit, run, simulator.state)
    attempt = 0
    while True:
        skip(stepper, transient * 2**attempt - (0 if attempt else early))
        run = look(stepper, max_period)
        orbit = returning(run, max_period, RETURNED if attempt else SETTLED)
        if orbit is not None:
            return PageAttractor(machine, params, "periodic", orbit, run, simulator.state)
        if run.held or not (run.events or machine.forced):
            kind = "rest" if run.held or still(run) else "aperiodic"
            return PageAttractor(machine, params, kind, None, run, simulator.state)
        if attempt == patience or (run.chatters and attempt) or stepper.count > ENOUGH:
            kind = "chatter" if run.chatters else "aperiodic"
            return PageAttractor(machine, params, kind, None, run, simulator.state)
        attempt += 1


def still(run: PageTrajectory) -> bool:
    """Whether a self-excited motion has come to rest, without a wall that holds it."""
    if run.machine.forced or run.events or run.held:
        return False
    states = run.onwards(np.linspace(0.0, TWO_PI, LATE))
    return bool((np.ptp(states, axis=0) <= SETTLED * (1.0 + np.abs(states).max(axis=0))).all())


def skip(stepper: Stepper, count: int) -> bool:
    """Move on by so many forcing periods; of a self-excited machine, by so many events, and say whether there were as many."""
    if stepper.machine.forced:
        until = stepper.base + stepper.clock + TWO_PI * count
        while stepper.advance(until) is not None:
            pass
        return True
    return all(stepper.advance(stepper.base + stepper.clock + 1e4) is not None for _ in range(count))


def look(stepper: Stepper, max_period: int) -> PageTrajectory:
    """The run in which a recurrence of up to `max_period` periods is looked for."""
    if stepper.machine.forced:
        return collect(stepper, TWO_PI * (2 * max_period + 1), 50 * max_period + 2000)
    return collect(stepper, 1e4, min(2 * LONGEST_WORD, 50 * max_period))


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
    word = Word(tuple(run.letters[-length:]), tuple(run.modes[-length:]), machine.alphabet)
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
        run.states[last],
        run.status,
    )
    return solved(part, last - first, periods, far)


def polished(orbit: Orbit, far: float = 0.1) -> Orbit | None:
    """The orbit with the same word next to a guess; None if there is none within `far` (relative to 1 + states)."""
    word = orbit.word
    problem = orbit.system(symmetric=False)
    p = problem.value(orbit.params)
    u, residual = solved_at(problem, problem.reduce(orbit.nodes), p, EXACT)
    nodes = problem.expand(u)[: len(orbit.nodes)]
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
    if held:
        return None
    word = Word((), (mode,), machine.alphabet)
    if not machine.forced:
        return _free(run, word)
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


def _free(run: PageTrajectory, word: Word) -> Orbit | None:
    """The cycle on which a self-excited motion without events settles; None where it comes to rest or is none."""
    from orbits.flows.page.smooth import cycle_near

    found = cycle_near(run.machine, word, run.params, run.states[-1])
    return None if found is None else polished(Orbit(run.machine, word, 1, found[None], run.params))


def measure_names(machine: Machine) -> tuple[str, ...]:
    """Measures in a sweep's rows: `max_` and `min_` of the first state, `approach_speed`, `impacts_per_period` (of a self-excited machine: per unit of time);
    where it is forced, of motions that do not recur the band of the largest first states in a period and the share of the periods without an impact."""
    first = machine.states[0]
    forced = (*BAND, SILENT) if machine.forced else ()
    return (f"max_{first}", f"min_{first}", "approach_speed", "impacts_per_period", *forced)


def modulated(found: PageAttractor, measures: Mapping[str, float]) -> str:
    """How a motion is modulated, chaotic by its largest Lyapunov exponent; empty where it recurs or nothing shakes."""
    if not modulation_of(measures):
        return ""
    simulator = PageSimulator(found.model, found.params)
    simulator.go_on(found.state)
    return modulation_of(measures, wandering(*growth(simulator.stepper), True) == "chaotic")


def _band(run: PageTrajectory) -> dict[str, float]:
    """Of the largest first state in each forcing period: lowest, mean and highest; the share of the periods without an impact."""
    first, last = np.ceil(run.clocks[0] / TWO_PI), np.floor(run.end / TWO_PI)
    periods = int(last - first)
    if periods < 1:
        return {}
    x = run.sample(TWO_PI * np.linspace(first, last, PER_PERIOD * periods, endpoint=False))[:, 0]
    tops = x.reshape(periods, PER_PERIOD).max(axis=1)
    hits = run.clocks[1:][[kind == HIT for _, kind, _ in run.events]]
    busy = np.unique(np.floor(hits / TWO_PI))
    silent = 1.0 - np.count_nonzero((busy >= first) & (busy < last)) / periods
    return dict(zip((*BAND, SILENT), (float(tops.min()), float(tops.mean()), float(tops.max()), silent)))


def described(found: PageAttractor) -> tuple[PageAttractor, dict[str, float]]:
    """The attractor and its measures by name; see `measure_names`."""
    machine, orbit, first = found.model, found.orbit, found.model.states[0]
    run, speeds = found.trajectory, found.approaches
    if orbit is not None:
        taken = orbit.measures(f"max_{first}", f"min_{first}")
        span = orbit.periods if machine.forced else orbit.period
    else:
        x = run.sample(np.linspace(run.clocks[0], run.end, SAMPLES))[:, 0]
        taken = {f"max_{first}": float(x.max()), f"min_{first}": float(x.min())}
        span = (run.end - run.clocks[0]) / (TWO_PI if machine.forced else 1.0)
    own = {
        "approach_speed": max(speeds, default=0.0),
        "impacts_per_period": len(speeds) / span if span > 0.0 else 0.0,
    }
    if machine.forced:
        own |= dict.fromkeys((*BAND, SILENT), np.nan) | (_band(run) if found.kind == "aperiodic" else {})
    return found, {**taken, **own}


def dots(found: PageAttractor, measures: Mapping[str, float]) -> list[float]:
    """What a picture shows: the page's response, or the approach speed of every impact; of a machine without walls the first state's extremes."""
    response = found.model.response
    if response is not None and response in measures and response != "approach_speed":
        return [measures[response]]
    if any(isinstance(contact, Wall) for contact in found.model.contacts):
        return found.approaches
    first = found.model.states[0]
    return [measures[f"max_{first}"], measures[f"min_{first}"]]
