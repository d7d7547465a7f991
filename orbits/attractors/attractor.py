"""Attractors found by simulation, and what is told of their motion: over one cycle, else for as long as its statistics need, with its modulation."""

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
"""Largest relative difference of two observations that agree."""
LASTING = 16  # forcing periods that `Attractor.follow` simulates of a motion that is not periodic
MOST_EVENTS = 100_000
OFTEN = 32
"""A motion that is not periodic is `chatter` if it rests on a wall at least once in so many periods, on average."""
PIECE = 256  # periods simulated at a time: bounds the memory
PERIOD_EVENTS = 400  # per period
INSTANTS = 200  # instants of a cycle
SAMPLES = 48  # instants; events come on top


@dataclass(frozen=True)
class Observation:
    """Statistics of a motion.

    Attributes
    ----------
    periods : float
        Forcing periods observed.
    extremes : dict of float
        Largest displacements; see `orbits.flows.trajectory.Trajectory.extremes`.
    impact_speed : float
        Largest approach speed of an impact.
    impacts_per_period : float
        Mean number of impacts per forcing period.
    contacts : int
        Number of times that impacts accumulated into persistent contact.
    """

    periods: float
    extremes: Mapping[str, float]
    impact_speed: float
    impacts_per_period: float
    contacts: int

    def near(self, other: Observation) -> bool:
        """Whether two observations agree up to `SETTLED`."""
        pairs = (
            *((self.extremes[name], other.extremes[name]) for name in self.extremes),
            (self.impact_speed, other.impact_speed),
            (self.impacts_per_period, other.impacts_per_period),
        )
        return all(abs(a - b) <= SETTLED * max(abs(a), abs(b)) for a, b in pairs)


@dataclass(frozen=True, eq=False)
class Attractor:
    """The motion after a transient.

    Attributes
    ----------
    model : Model or Machine
        The machine.
    params : float array (P,)
        Parameter vector.
    kind : str
        ``periodic``; ``sliding`` (an absorber that hits no wall); ``stuck`` (at rest in its cavity), of a declared machine ``rest`` (a wall holds
        the body permanently, or a self-excited machine comes to rest); ``chatter`` (impacts accumulate into persistent contact, in every cycle
        or every 32 periods on average); ``chaotic``, of a declared machine ``aperiodic`` (no return within the periods simulated).
    periods : int
        Forcing periods of the cycle; 0 at rest, and if the motion is not periodic.
    orbit : Orbit or None
        The solved orbit at the simulated motion; None if no word describes it.
    trajectory : Trajectory
        The last part of the simulation.
    length : int
        Number of events of the cycle, which are the last ones of the trajectory; 0 if the motion is not periodic.
    state : float array (S,)
        A state on the attractor, from which a simulation can continue.
    seen : Observation or None
        Long-time statistics of a motion that is not periodic, if it was observed.
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
        """Events of the cycle, including every slip."""
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
        """Word of the cycle; None for chaos, persistent contact and frictionless motion that hits no wall."""
        return None if self.orbit is None else self.orbit.word

    @property
    def text(self) -> str:
        """The word in its canonical spelling; the list of events if the motion has persistent contact."""
        if self.orbit is not None:
            return self.orbit.spelling
        return (" " if any(len(letter) > 1 for letter in self.letters) else "").join(self.letters)

    @property
    def nodes(self) -> np.ndarray:
        """Nodes of the orbit; see `orbits.cycle.Cycle`."""
        return np.empty((0, self.model.node)) if self.orbit is None else self.orbit.nodes

    @property
    def residual(self) -> float:
        """Largest residual of the orbit's equations; nan without an orbit."""
        return np.nan if self.orbit is None else self.orbit.residual

    @property
    def multipliers(self) -> np.ndarray:
        """Multipliers of the orbit; empty without one."""
        return np.empty(0, complex) if self.orbit is None else self.orbit.multipliers

    @property
    def approaches(self) -> np.ndarray:
        """Approach speeds of the impacts of the cycle, or of the trajectory if the motion is not periodic."""
        return self.trajectory.approaches(self.first)

    @property
    def first(self) -> int:
        """Index of the first event of the cycle in the trajectory; 0 if the motion is not periodic."""
        return len(self.trajectory) - self.length if self.length else 0

    @property
    def impact_speed(self) -> float:
        """Largest approach speed of an impact."""
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
            reason = {
                "chatter": "impacts pile up on it, so no finite word describes it",
                "sliding": "without friction nothing happens on it",
                "rest": "a wall holds the body for good"
                if self.trajectory.held
                else "it has come to rest; contvines.diagram(machine.smooth(state), ...) follows equilibria",
            }.get(self.kind, "no period was found")
            raise ValueError(
                f"this attractor of {self.model.name!r} is no orbit that can be continued ({self.kind}: {reason}); choose other "
                "parameters or another start, or give a word to machine.orbit"
            )
        return self.orbit

    def problem(self, parameter: str | None = None, symmetric: bool | None = None):
        """The attractor as a continuation problem, for `contvines.diagram`.

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
    def _canonical_reading(self) -> tuple[bool, int]:
        """Whether the canonical spelling is that of the mirror image, and the event at which it begins."""
        word = self.found.word
        if not len(word) or word.alphabet.alone is None:  # words of declared machines keep their order
            return False, 0
        read, images = Word.parse(self.text, word.frictionless), (word, word.mirror())
        return next((one is not word, k) for one in images for k in range(len(one)) if one.rotate(k) == read)

    @property
    def guess(self) -> np.ndarray | None:
        """Nodes for a study's `guess`, in the order of the canonical spelling; None without a word."""
        if self.orbit is None:
            return None
        mirrored, place = self._canonical_reading
        return (self.orbit.mirror() if mirrored else self.orbit).rotate(place).nodes

    @property
    def dots(self) -> list[float]:
        """Ordinates of the impacts in a bifurcation picture, from the word's first event on; of the trajectory if the motion is not periodic."""
        run, first = self.trajectory, self.first
        ordinates = np.array(run.shown(first))
        if self.orbit is not None and self.model.forced and len(ordinates) > 1:
            began = self.orbit.nodes[self._canonical_reading[1], 0] - REPLAYING.close
            times = run.clocks[1:][first:][run.hits[first:]] - began
            ordinates = ordinates[np.argsort(times % (2.0 * np.pi * self.periods))]
        return ordinates.tolist()

    def simulator(self) -> Simulator:
        """A simulator at `state`."""
        simulator = simulator_of(self.model, self.params)
        simulator.go_on(self.state)
        return simulator

    def follow(self, periods: float | None = None) -> Trajectory:
        """Simulate from `state` over one cycle, or sixteen periods if the motion is not periodic."""
        return self.simulator().run(
            periods or self.periods or (1 if self.recurrent else LASTING), MOST_EVENTS
        )

    def distance(self, other: Attractor) -> float:
        """Largest difference of the canonical nodes (over rotations, whole periods and the mirror image), relative to 1 + nodes; inf if the words differ."""
        if self.orbit is None or other.orbit is None:
            same = self.orbit is other.orbit and (self.kind, self.periods) == (other.kind, other.periods)
            return 0.0 if same and self.text == other.text else np.inf
        forms = []
        for orbit in (self.orbit, other.orbit):
            problem = orbit.problem(symmetric=False)
            forms.append(problem.canonical(*orbit.seed(problem)))
        one, two = forms
        if one[0] != two[0]:
            return np.inf
        return float(np.abs(one[1] - two[1]).max(initial=0.0) / (1.0 + np.abs(one[1]).max(initial=0.0)))


def observe(found: Attractor, least: float = 0.0) -> Observation:
    """Compute statistics of a motion, simulated from `found.state`.

    A periodic motion is simulated over one cycle. Any other is simulated until its extremes and its mean number of impacts change by less
    than 1 % when the time of observation doubles: a modulated motion grows, bursts and decays over tens or hundreds of periods.
    For machines whose simulation is slow, `least` periods are simulated, or, if that is 0, the trajectory of the attractor is used.
    """
    simulator = found.simulator()
    first, longest = simulator.observed
    tally = _Tally(simulator)
    if found.recurrent:
        observed = tally.go_on(
            (found.periods or 1) + SIMULATING.whole_period, INSTANTS
        )  # so that the first event is met again
        speed = observed.impact_speed if found.impacts else 0.0
        return replace(observed, impact_speed=speed, impacts_per_period=found.impacts_per_period)
    if not longest:
        return tally.go_on(least) if least else tally.add(found.trajectory)
    length, before = first, tally.go_on(first)
    while tally.moving and length < longest:
        length *= 2.0
        latest = tally.go_on(length)
        if latest.near(before):
            return latest
        before = latest
    return before


def lasting(found: Attractor, observed: Observation | None = None) -> Attractor:
    """Return the attractor with kind and impacts from its long-time statistics; periodic motions and rest are returned unchanged."""
    simulator = found.simulator()
    if found.recurrent or found.kind == simulator.resting or not simulator.observed[1]:
        return found
    observed = observed or observe(found)
    kind = "chatter" if observed.contacts * OFTEN >= observed.periods else simulator.wandering
    return replace(found, kind=kind, seen=observed)


def measure_names(model: Varying) -> tuple[str, ...]:
    """Names of the measures in the rows of a sweep.

    - Displacements: ``max_abs_q1`` of the oscillator and ``max_abs_w`` in the cavity (in the reduced model, whose cavity has a prescribed
      motion, ``C2``, the squared amplitude of that motion); of a declared machine ``max_`` and ``min_`` of its first state.
    - Impacts: the largest approach speed ``impact_speed`` (of a declared machine ``approach_speed``), and ``impacts_per_period`` (of a
      self-excited machine per unit of time).
    - Modulation, of forced machines in which more than the absorber moves, for motions that are not periodic: ``modulated_low``,
      ``modulated_mean``, ``modulated_high`` of the largest displacements in each forcing period, and ``silent``, the share of the periods
      without an impact.
    """
    return flow_of(model).simulated_names(model)


def described(found: Attractor, least: float = 0.0) -> tuple[Attractor, dict[str, float]]:
    """Return the attractor with kind and impacts from its long-time statistics (see `observe`), and its measures by name (see `measure_names`)."""
    model, params, orbit, flow = found.model, found.params, found.orbit, flow_of(found.model)
    names = measure_names(model)
    numbers = dict.fromkeys(names, np.nan)
    speed = next(name for name in names if name.endswith("_speed"))
    if orbit is not None and len(orbit.nodes) and not flow.loose(model, orbit.word):
        own = flow.measure_names(model)
        taken = orbit.measures(*(name for name in names if name in own))
        numbers |= {speed: 0.0, **taken, "impacts_per_period": found.impacts_per_period}
        return found, numbers
    observed = observe(found, least)
    rate = observed.impacts_per_period / (1.0 if model.forced else 2.0 * np.pi)
    numbers |= {**observed.extremes, speed: observed.impact_speed, "impacts_per_period": rate}
    simulator = found.simulator()
    if BAND[0] in names and not found.recurrent and found.kind != simulator.resting:
        periods = simulator.modulated
        run = simulator.run(periods, int(PERIOD_EVENTS * (periods + 1))) if periods else found.trajectory
        numbers |= modulation(run).measures
    return lasting(found, observed), flow.in_units(model, params, numbers)


def modulated(found: Attractor, measures: Mapping[str, float]) -> str:
    """Name of the modulation of a motion, with ``chaotic`` decided by its largest Lyapunov exponent; empty for periodic motions and if only the absorber moves."""
    if not modulation_of(measures):
        return ""
    return modulation_of(measures, wandering(*found.simulator().growth(), True) == "chaotic")


class _Tally:
    """Statistics of a motion that is simulated piece by piece."""

    def __init__(self, simulator: Simulator) -> None:
        self.simulator, self.moving = simulator, True
        self.seen = Observation(0.0, {}, 0.0, 0.0, 0)

    def go_on(self, length: float, per_period: int = 0) -> Observation:
        """Simulate until `length` periods have been observed in all."""
        while self.moving and self.seen.periods < length - SIMULATING.whole_period:
            piece = min(PIECE, length - self.seen.periods)
            run = self.simulator.run(piece, int(PERIOD_EVENTS * (piece + 1.0)))
            self.moving = run.lasted > 0.0 and not run.stopped
            self.add(run, per_period)
        return self.seen

    def add(self, run: Trajectory, per_period: int = 0) -> Observation:
        """Add one piece to the statistics."""
        total, extremes = self.seen, run.extremes(per_period)
        for name, value in total.extremes.items():
            extremes[name] = (min if name.startswith("min_") else max)(value, extremes[name])
        impacts = round(total.impacts_per_period * total.periods) + run.impacts
        periods = total.periods + run.lasted
        speed = max(total.impact_speed, float(run.approaches().max(initial=0.0)))
        rate = impacts / periods if periods > 0.0 else 0.0
        self.seen = Observation(periods, extremes, speed, rate, total.contacts + run.chatters)
        return self.seen


class Modulation(NamedTuple):
    """Modulation of a response over forcing periods.

    Attributes
    ----------
    low, mean, high : float
        Smallest, mean and largest value of the largest displacement in a period, dimensionless.
    silent : float
        Share of the periods without an impact.
    """

    low: float
    mean: float
    high: float
    silent: float

    @property
    def measures(self) -> dict[str, float]:
        """Measures by name."""
        return dict(zip((*BAND, SILENT), self))

    @property
    def kind(self) -> str:
        """Name of the modulation; see `contvines.shared.motions.modulation_of`."""
        return modulation_of(self.measures)


def modulation(run: Trajectory) -> Modulation:
    """Modulation over the whole forcing periods of a trajectory."""
    periods = max(1, int(run.lasted + SIMULATING.whole_period))
    clocks, sizes = run.responses(SAMPLES)
    place = ((clocks - run.clocks[0]) / TWO_PI).astype(int)
    tops = np.full(periods, -np.inf)
    np.maximum.at(tops, place[place < periods], sizes[place < periods])
    hits = ((run.clocks[1:][run.hits] - run.clocks[0]) / TWO_PI).astype(int)
    silent = 1.0 - np.unique(hits[hits < periods]).size / periods
    return Modulation(float(tops.min()), float(tops.mean()), float(tops.max()), float(silent))
