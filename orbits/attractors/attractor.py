"""What a simulation settles on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from contvines.shared.motions import BAND, SILENT, modulation_of, wandering
from orbits.flows import flow_of, simulator_of
from orbits.flows.protocol import Simulator
from orbits.flows.trajectory import TWO_PI, Trajectory
from orbits.machines.varying import Varying
from orbits.orbit import Orbit
from orbits.settings import REPLAYING, SIMULATING
from orbits.words import Word

if TYPE_CHECKING:
    from orbits.machines.varying import Varying


SETTLED = 0.01
"""Largest relative change of two observations that tell the same."""
LASTING = 16  # forcing periods of a motion that does not recur
MOST_EVENTS = 100_000


@dataclass(frozen=True)
class Observation:
    """Statistics of a motion.

    Attributes
    ----------
    periods : float
        Forcing periods looked at.
    extremes : dict of float
        How far it goes; see `orbits.flows.trajectory.Trajectory.extremes`.
    impact_speed : float
        Fastest approach.
    impacts_per_period : float
        Mean number of impacts per forcing period.
    contacts : int
        How often impacts piled up into persistent contact.
    """

    periods: float
    extremes: Mapping[str, float]
    impact_speed: float
    impacts_per_period: float
    contacts: int

    def near(self, other: Observation) -> bool:
        """Whether two observations tell the same, up to `SETTLED`."""
        pairs = (
            *((self.extremes[name], other.extremes[name]) for name in self.extremes),
            (self.impact_speed, other.impact_speed),
            (self.impacts_per_period, other.impacts_per_period),
        )
        return all(abs(a - b) <= SETTLED * max(abs(a), abs(b)) for a, b in pairs)


@dataclass(frozen=True, eq=False)
class Attractor:
    """The motion that is left after a transient.

    Attributes
    ----------
    model : Model or Machine
        The machine.
    params : float array (P,)
        Parameter vector.
    kind : str
        ``periodic``; ``sliding`` (an absorber that hits no wall); ``stuck`` (at rest in its cavity), of a declared machine ``rest`` (a wall holds
        the body for good, or a self-excited machine comes to rest); ``chatter`` (impacts pile up into persistent contact, in every cycle
        or every 32 periods on average); ``chaotic``, of a declared machine ``aperiodic`` (nothing recurs within the periods looked at).
    periods : int
        Forcing periods until the motion recurs; 0 where it rests or does not.
    orbit : Orbit or None
        The solved orbit next to the simulated motion; None where no word describes that.
    trajectory : Trajectory
        The last part of the simulation.
    length : int
        Events of the trajectory until the motion recurs, the last ones; 0 if it does not.
    state : float array (S,)
        A state on the attractor, from which a simulation goes on.
    seen : Observation or None
        What a motion that does not recur does in the long run, where it was followed.
    """

    model: Varying
    params: np.ndarray
    kind: str
    periods: int
    orbit: Orbit | None
    trajectory: Trajectory = field(repr=False)
    length: int
    state: np.ndarray = field(repr=False)
    seen: Observation | None = field(default=None, repr=False)

    def __repr__(self) -> str:
        if not self.recurrent and not self.letters:
            return f"Attractor({self.kind}, impacts_per_period={self.impacts_per_period:.4g})"
        return f"Attractor({self.kind}, word={self.text!r}, periods={self.periods}, impacts={self.impacts})"

    @property
    def letters(self) -> tuple[str, ...]:
        """The cycle's events, every slip written."""
        if self.orbit is not None:
            return self.orbit.word.events
        return tuple(self.trajectory.letters[len(self.trajectory) - self.length :])

    @property
    def impacts(self) -> int:
        """Impacts in one cycle."""
        if self.orbit is not None:
            return self.orbit.impacts
        return int(np.count_nonzero(self.trajectory.hits[len(self.trajectory) - self.length :]))

    @property
    def recurrent(self) -> bool:
        """Whether the motion is periodic (the absorber at rest included)."""
        return self.orbit is not None or self.periods > 0

    @property
    def symmetric(self) -> bool:
        """Whether it equals its mirror image."""
        return self.orbit is not None and self.orbit.symmetric

    @property
    def word(self) -> Word | None:
        """The cycle's word; None where no word describes the motion: chaos, persistent contact, frictionless motion off the walls."""
        return None if self.orbit is None else self.orbit.word

    @property
    def text(self) -> str:
        """The word in the one spelling of its motion; of motions with persistent contact the plain list of events."""
        if self.orbit is not None:
            return self.orbit.spelling
        return (" " if any(len(letter) > 1 for letter in self.letters) else "").join(self.letters)

    @property
    def nodes(self) -> np.ndarray:
        """The orbit's nodes; see `orbits.cycle.Cycle`."""
        return np.empty((0, self.model.node)) if self.orbit is None else self.orbit.nodes

    @property
    def residual(self) -> float:
        """Largest residual of the orbit's equations; nan without an orbit."""
        return np.nan if self.orbit is None else self.orbit.residual

    @property
    def multipliers(self) -> np.ndarray:
        """Multipliers of the orbit; none without one."""
        return np.empty(0, complex) if self.orbit is None else self.orbit.multipliers

    @property
    def approaches(self) -> np.ndarray:
        """Approach speeds of the impacts of the cycle, or of the last part of the run."""
        return self.trajectory.approaches(self.first)

    @property
    def first(self) -> int:
        """The first event of the trajectory that belongs to the cycle; 0 where nothing recurs."""
        return len(self.trajectory) - self.length if self.length else 0

    @property
    def impact_speed(self) -> float:
        """Fastest approach of an impact."""
        return self.seen.impact_speed if self.seen else float(self.approaches.max(initial=0.0))

    @property
    def impacts_per_period(self) -> float:
        """Impacts per forcing period, of a self-excited machine per unit of time."""
        if self.seen is not None:
            return self.seen.impacts_per_period
        run = self.trajectory
        if self.orbit is not None or self.periods:
            lasted = self.periods if self.model.forced or self.orbit is None else self.orbit.period
            return self.impacts / lasted if lasted else 0.0
        lasted = run.lasted if self.model.forced else 2.0 * np.pi * run.lasted
        return run.impacts / lasted if lasted > 0.0 else 0.0

    @property
    def found(self) -> Orbit:
        """The attractor as an orbit, ready for continuation.

        Raises
        ------
        ValueError
            If no word describes it.
        """
        if self.orbit is None:
            why = {
                "chatter": "impacts pile up on it, so no finite word describes it",
                "sliding": "without friction nothing happens on it",
                "rest": "a wall holds the body for good"
                if self.trajectory.held
                else "it has come to rest; contvines.diagram(machine.smooth(state), ...) follows equilibria",
            }.get(self.kind, "no period was found")
            raise ValueError(
                f"this attractor of {self.model.name!r} is no orbit that can be continued ({self.kind}: {why}); choose other "
                "parameters or another start, or give a word to machine.orbit"
            )
        return self.orbit

    def problem(self, parameter: str | None = None, symmetric: bool | None = None):
        """The attractor as a continuation problem, so that it can be handed to `contvines.diagram`.

        Raises
        ------
        ValueError
            If it is no orbit that can be continued.
        """
        return self.found.problem(parameter, symmetric)

    def seed(self, problem: Any) -> tuple[np.ndarray, float]:
        """Unknowns and parameter value in `problem`."""
        return self.found.seed(problem)

    @cached_property
    def _reading(self) -> tuple[bool, int]:
        """Whether the orbit's word is spelled in the mirror image, and from which event on."""
        word = self.found.word
        if not len(word) or word.alphabet.alone is None:  # words of declared machines stand as they are read
            return False, 0
        read, images = Word.parse(self.text, word.frictionless), (word, word.mirror())
        return next((one is not word, k) for one in images for k in range(len(one)) if one.rotate(k) == read)

    @property
    def guess(self) -> np.ndarray | None:
        """The nodes as a study's `guess` takes them, read as the word is spelled; None where no word describes the motion."""
        if self.orbit is None:
            return None
        mirrored, place = self._reading
        return (self.orbit.mirror() if mirrored else self.orbit).rotate(place).nodes

    @property
    def dots(self) -> list[float]:
        """What a picture shows of the impacts of the cycle, from the word's first event on, or of the last part of the run."""
        run, first = self.trajectory, self.first
        shown = np.array(run.shown(first))
        if self.orbit is not None and self.model.forced and len(shown) > 1:
            began = self.orbit.nodes[self._reading[1], 0] - REPLAYING.close
            since = run.clocks[1:][first:][run.hits[first:]] - began
            shown = shown[np.argsort(since % (2.0 * np.pi * self.periods))]
        return shown.tolist()

    def simulator(self) -> Simulator:
        """A simulator on the motion, at `state`."""
        simulator = simulator_of(self.model, self.params)
        simulator.go_on(self.state)
        return simulator

    def follow(self, periods: float | None = None) -> Trajectory:
        """The motion from `state`: over one cycle, or sixteen periods where nothing recurs."""
        return self.simulator().run(
            periods or self.periods or (1 if self.recurrent else LASTING), MOST_EVENTS
        )

    def distance(self, other: Attractor) -> float:
        """Largest difference of the canonical nodes, relative to 1 + nodes: over all rotations, whole periods and the mirror image; inf if the words differ."""
        if self.orbit is None or other.orbit is None:
            alike = self.orbit is other.orbit and (self.kind, self.periods) == (other.kind, other.periods)
            return 0.0 if alike and self.text == other.text else np.inf
        forms = []
        for orbit in (self.orbit, other.orbit):
            problem = orbit.problem(symmetric=False)
            forms.append(problem.canonical(*orbit.seed(problem)))
        one, two = forms
        if one[0] != two[0]:
            return np.inf
        return float(np.abs(one[1] - two[1]).max(initial=0.0) / (1.0 + np.abs(one[1]).max(initial=0.0)))


OFTEN = 32
"""A motion that does not recur is `chatter` if it rests on a wall at least once in so many periods, on average."""
PIECE = 256  # periods simulated at a time: bounds the memory
PERIOD_EVENTS = 400  # per period
INSTANTS = 200  # instants of a cycle
SAMPLES = 48  # instants; events come on top


def observe(found: Attractor, least: float = 0.0) -> Observation:
    """Statistics of a motion from `found.state`, which stays as it is.

    A motion that recurs is followed over one cycle. Another one is followed until its largest values and its mean
    number of impacts have changed by less than 1 % while the time of observation doubled: a modulated motion
    grows, bursts and fades over tens or hundreds of periods, and a few of them show only a part of that. Where a simulation
    takes long, the last part of that by which the motion was recognised must do, or `least` periods where these are asked for.
    """
    simulator = found.simulator()
    first, longest = simulator.observed
    tally = _Tally(simulator)
    if found.recurrent:
        seen = tally.go_on(
            (found.periods or 1) + SIMULATING.whole, INSTANTS
        )  # the event it starts with comes again
        speed = seen.impact_speed if found.impacts else 0.0
        return replace(seen, impact_speed=speed, impacts_per_period=found.impacts_per_period)
    if not longest:
        return tally.go_on(least) if least else tally.add(found.trajectory)
    length, before = first, tally.go_on(first)
    while tally.moving and length < longest:
        length *= 2.0
        now = tally.go_on(length)
        if now.near(before):
            return now
        before = now
    return before


def lasting(found: Attractor, seen: Observation | None = None) -> Attractor:
    """The attractor with its kind and impacts as `observe` sees them; one that recurs, or rests, is returned as it is."""
    simulator = found.simulator()
    if found.recurrent or found.kind == simulator.resting or not simulator.observed[1]:
        return found
    seen = seen or observe(found)
    kind = "chatter" if seen.contacts * OFTEN >= seen.periods else simulator.wandering
    return replace(found, kind=kind, seen=seen)


def measure_names(model: Varying) -> tuple[str, ...]:
    """Measures in a sweep's rows.

    How far the motion goes: ``max_abs_q1`` of the oscillator and ``max_abs_w`` in the cavity (in the reduced model, whose cavity is shaken as
    prescribed, ``C2``, the squared amplitude of its motion), of a declared machine ``max_`` and ``min_`` of its first state. The fastest
    approach ``impact_speed``, of a declared machine ``approach_speed``; ``impacts_per_period``: per forcing period, of a self-excited machine per unit
    of time. Where more than the absorber moves, and is forced, of motions that do not recur ``modulated_low``, ``modulated_mean``,
    ``modulated_high``: of the largest displacements in each forcing period, and ``silent``: the share of the periods without an impact.
    """
    return flow_of(model).simulated_names(model)


def described(found: Attractor, least: float = 0.0) -> tuple[Attractor, dict[str, float]]:
    """The attractor with its kind and impacts as it is observed (see `observe`), and its measures by name (see `measure_names`)."""
    model, params, orbit, flow = found.model, found.params, found.orbit, flow_of(found.model)
    names = measure_names(model)
    known = dict.fromkeys(names, np.nan)
    speed = next(name for name in names if name.endswith("_speed"))
    if orbit is not None and len(orbit.nodes) and not flow.loose(model, orbit.word):
        own = flow.measure_names(model)
        taken = orbit.measures(*(name for name in names if name in own))
        known |= {speed: 0.0, **taken, "impacts_per_period": found.impacts_per_period}
        return found, known
    seen = observe(found, least)
    rate = seen.impacts_per_period / (1.0 if model.forced else 2.0 * np.pi)
    known |= {**seen.extremes, speed: seen.impact_speed, "impacts_per_period": rate}
    simulator = found.simulator()
    if BAND[0] in names and not found.recurrent and found.kind != simulator.resting:
        periods = simulator.modulated
        run = simulator.run(periods, int(PERIOD_EVENTS * (periods + 1))) if periods else found.trajectory
        known |= modulation(run).measures
    return lasting(found, seen), flow.in_units(model, params, known)


def modulated(found: Attractor, measures: Mapping[str, float]) -> str:
    """How a motion is modulated, chaotic by its largest Lyapunov exponent; empty where it recurs or nothing but the absorber moves."""
    if not modulation_of(measures):
        return ""
    return modulation_of(measures, wandering(*found.simulator().growth(), True) == "chaotic")


class _Tally:
    """A motion simulated piece by piece, and what has been seen of it so far."""

    def __init__(self, simulator: Simulator) -> None:
        self.simulator, self.moving = simulator, True
        self.seen = Observation(0.0, {}, 0.0, 0.0, 0)

    def go_on(self, length: float, per_period: int = 0) -> Observation:
        """Simulate until `length` periods have been seen in all."""
        while self.moving and self.seen.periods < length - SIMULATING.whole:
            piece = min(PIECE, length - self.seen.periods)
            run = self.simulator.run(piece, int(PERIOD_EVENTS * (piece + 1.0)))
            self.moving = run.lasted > 0.0 and not run.stopped
            self.add(run, per_period)
        return self.seen

    def add(self, run: Trajectory, per_period: int = 0) -> Observation:
        """What has been seen with one more piece."""
        seen, extremes = self.seen, run.extremes(per_period)
        for name, value in seen.extremes.items():
            extremes[name] = (min if name.startswith("min_") else max)(value, extremes[name])
        impacts = round(seen.impacts_per_period * seen.periods) + run.impacts
        periods = seen.periods + run.lasted
        speed = max(seen.impact_speed, float(run.approaches().max(initial=0.0)))
        rate = impacts / periods if periods > 0.0 else 0.0
        self.seen = Observation(periods, extremes, speed, rate, seen.contacts + run.chatters)
        return self.seen


class Modulation(NamedTuple):
    """Of a motion, over forcing periods.

    Attributes
    ----------
    low, mean, high : float
        Of the largest displacement in a period, in the machine's own numbers.
    silent : float
        Share of the periods without an impact.
    """

    low: float
    mean: float
    high: float
    silent: float

    @property
    def measures(self) -> dict[str, float]:
        """By name."""
        return dict(zip((*BAND, SILENT), self))

    @property
    def kind(self) -> str:
        """See `contvines.shared.motions.modulation_of`."""
        return modulation_of(self.measures)


def modulation(run: Trajectory) -> Modulation:
    """Of the whole forcing periods of a run."""
    periods = max(1, int(run.lasted + SIMULATING.whole))
    clocks, sizes = run.responses(SAMPLES)
    place = ((clocks - run.clocks[0]) / TWO_PI).astype(int)
    tops = np.full(periods, -np.inf)
    np.maximum.at(tops, place[place < periods], sizes[place < periods])
    hits = ((run.clocks[1:][run.hits] - run.clocks[0]) / TWO_PI).astype(int)
    silent = 1.0 - np.unique(hits[hits < periods]).size / periods
    return Modulation(float(tops.min()), float(tops.mean()), float(tops.max()), float(silent))
