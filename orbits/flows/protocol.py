"""The protocols `Flow` and `Simulator`: the motion of a machine between two events, for solving and for simulation.

Built-in machines implement them with closed forms (`orbits.flows.native`), declared machines with integrated flights (`orbits.flows.page`).

Terms
-----
node
    The unknowns of one event: the clock, then coordinates on the event's surface or the states just after the event, as the flow
    chooses. A cycle with L events has nodes of shape (L, n).
clock
    Of a forced machine the phase of the forcing in radians, counted through (2 pi per forcing period). Of a self-excited machine
    the time; the clock of its nodes is the duration of the flight that follows.
point
    The coordinates of a simulator, positions and velocities in the order of its `names`, at a given time.
time of a simulator
    The clock over 2 pi: forcing periods of a forced machine.
mirror image
    Of a node: all entries but the clock change sign (positions count from the middle between the walls).

A flow (`Flow`) gives equations of cycles, samples and measures of their solutions, and the vanishing event at a border. A simulator
(`Simulator`) moves one motion of a machine on, from event to event. It uses no word, no equations of cycles and no borders. It detects
every event on the way (gaps that close, velocities that vanish, limits of friction, switch surfaces) and applies the laws of the contacts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from enum import IntEnum
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol, TypeVar

import numpy as np

from contvines.shared.near_names import did_you_mean
from orbits.arguments import SMALLEST
from orbits.contacts import Change, Site, Spot
from orbits.flows.equations import Equations, ModelOf
from orbits.flows.trajectory import TWO_PI, Trajectory
from orbits.settings import GROWING

if TYPE_CHECKING:
    from orbits.contacts import Mode
    from orbits.machines.varying import Varying
    from orbits.words import Word

ModelSeen = TypeVar("ModelSeen", bound="Varying", covariant=True)
Run = TypeVar("Run", bound=Trajectory)


class Motion(Protocol[ModelSeen]):
    """A cycle as flows receive it: word, nodes and parameters (fulfilled by `orbits.cycle.Cycle`)."""

    @property
    def model(self) -> ModelSeen: ...
    @property
    def word(self) -> Word: ...
    @property
    def periods(self) -> int: ...
    @property
    def nodes(self) -> np.ndarray: ...
    @property
    def params(self) -> np.ndarray: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    @property
    def durations(self) -> np.ndarray: ...


class SimulationError(ValueError):
    """An impossible start or length of a run, or a motion that cannot go on; the message gives the remedy."""


def checked_start(start: Mapping[str, float], allowed: Sequence[str]) -> dict[str, float]:
    """Return the entries of a start as numbers.

    Raises
    ------
    SimulationError
        If a name is unknown or a value is not finite.
    """
    for key, value in start.items():
        if key not in allowed:
            raise SimulationError(
                f"start has no entry {key!r}{did_you_mean(key, allowed)}; it may have {', '.join(allowed)}"
            )
        if not math.isfinite(float(value)):
            raise SimulationError(f"start: {key} = {value!r} is not finite; give a number")
    return {key: float(value) for key, value in start.items()}


class Waiting(NamedTuple):
    """How long a simulated motion is followed until it settles.

    Attributes
    ----------
    transient : float
        Length left out first: forcing periods (of a self-excited machine: events).
    tries, in_sweeps : int
        How often the transient is prolonged if nothing recurs, for a single motion and at each value of a sweep.
    longer : int
        Factor of each prolongation.
    returned : float
        Largest difference between a point and its return, relative to 1 + size of the points.
    early : int
        A first search for short cycles begins after the transient divided by this; 0: no such search.
    slow : float
        Longest wait, in forcing periods, for a motion that recurs except for a growing or decaying drift.
    events : float
        Largest number of events.
    """

    transient: float
    tries: int
    in_sweeps: int
    longer: int
    returned: float
    early: int
    slow: float
    events: float


class Census(NamedTuple):
    """How starts are sampled.

    Attributes
    ----------
    across : int
        Starts along an edge of a picture of basins.
    brief : (int, int)
        Of a brief search: number of parameter values, and of starts at each.
    price : float
        Cost of simulating one forcing period, relative to a machine in closed form.
    longest, embedded : int
        Longest recurrence to search for, and longest unstable cycle, in forcing periods.
    """

    across: int
    brief: tuple[int, int]
    price: float
    longest: int
    embedded: int


class Outcome(IntEnum):
    """Result of following one motion: it recurs, rests for ever, has left the range of numbers, or is still undecided."""

    WANDERING = 0
    SETTLED = 1
    AT_REST = 2
    LOST = 3


class Batch(NamedTuple):
    """Many motions, run until they recur.

    Attributes
    ----------
    outcomes, periods : int array (n,)
        `Outcome` of each motion, and the forcing periods after which it recurs.
    gaps : float array (n,)
        Smallest difference between a state and its return.
    states, points : float array (n, S), (n, d)
        States and points at the end, at a whole forcing period.
    lasted : float array (n,)
        Forcing periods for which each motion was followed.
    growth : float
        Cost, in forcing periods, of computing a Lyapunov exponent.
    """

    outcomes: np.ndarray
    periods: np.ndarray
    gaps: np.ndarray
    states: np.ndarray
    points: np.ndarray
    lasted: np.ndarray
    growth: float


class Simulator(Protocol[ModelOf, Run]):
    """Moves one motion of a machine on, at given parameters, from event to event.

    A motion that cannot begin or cannot go on (not finite, or no contact law continues it) raises `SimulationError`.

    Attributes
    ----------
    names : tuple of str
        Coordinates of a point.
    hard : bool array (d,)
        Coordinates that walls limit by themselves.
    watched : (float, int)
        Periods and events of the run that is searched for near returns.
    waiting : Waiting
        How long a motion is followed until it settles.
    observed : (float, float)
        Forcing periods for which a motion that does not recur is observed, at first and at most; 0: only the run that was searched.
    modulated : float
        Forcing periods in which its modulation is measured.
    resting, wandering : str
        Kinds of attractors at rest, and of those that do not recur.
    roomy : bool
        Whether there are enough dimensions for two incommensurate frequencies.
    count : float
        Events so far, if they are counted.
    state : float array (S,)
        State from which `go_on` continues in another simulation.
    """

    model: ModelOf
    params: np.ndarray
    names: tuple[str, ...]
    forced: bool
    hard: np.ndarray
    watched: ClassVar[tuple[float, int]]
    waiting: ClassVar[Waiting]
    observed: ClassVar[tuple[float, float]]
    modulated: ClassVar[float]
    resting: ClassVar[str]
    wandering: ClassVar[str]
    roomy: bool
    count: float
    state: np.ndarray

    @property
    def modes(self) -> Mode:
        """Modes of the contacts."""
        ...

    @property
    def time(self) -> float:
        """Time: the clock over 2 pi."""
        ...

    @property
    def point(self) -> np.ndarray:
        """Present coordinates."""
        ...

    @property
    def mirrored(self) -> bool:
        """Whether the machine equals its mirror image: the `image` of a point, half a period later, is then a point of the same machine."""
        return self.model.has_mirror(self.params)

    def image(self, point: np.ndarray) -> np.ndarray:
        """Return a point mirrored about the middle between the walls."""
        image = -point
        image[0] += 2.0 * float(self.model.middle(self.params))
        return image

    def start(self, point: np.ndarray, time: float = 0.0, modes: tuple[int, ...] | None = None) -> None:
        """Begin at a point; the modes of the contacts follow from it if they are not given."""
        ...

    def put(self, start: Mapping[str, float] | np.ndarray | None) -> None:
        """Begin at a start by names, or at a state."""
        ...

    def state_of(self, start: Mapping[str, float] | np.ndarray | None) -> np.ndarray:
        """Return the state of a start."""
        ...

    def go_on(self, state: np.ndarray, nudge: float = 0.0) -> None:
        """Begin at the final `state` of another simulation, perturbed by `nudge`."""
        ...

    def run(self, periods: float, most: int) -> Run:
        """Move on by `periods` or at most `most` events, and return the motion."""
        ...

    def begin(self, word: Word, node: np.ndarray) -> None:
        """Begin just after the first event of a cycle with this word, at the unknowns `node`."""
        ...

    def follow(self, until: float) -> None:
        """Move on to the time `until`, applying every event on the way."""
        ...

    def go_round(self, word: Word, periods: int, index: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Move on by one period of a cycle: forcing periods, or, of a self-excited machine, until the events of its word are over.

        Parameters
        ----------
        word : Word
        periods : int
        index : int, optional
            Place of the parameter by which to differentiate.

        Returns
        -------
        by_state : float array (d, d)
            Derivatives of the new point by the old one.
        by_value : float array (d,)
            Derivatives by the parameter. Both are NaN without an index, or if the simulator cannot differentiate.
        """
        self.follow(self.time + periods)
        n = len(self.names)
        return np.full((n, n), np.nan), np.full(n, np.nan)

    def struck(self, point: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the counterpart, across the impact, of a point within `near` of a wall.

        Returns
        -------
        (point, direction) or None
            The point just after the impact of a point just before it, or the other way round, and the direction away from the wall; None
            for a point that is not at a wall.
        """
        ...

    def skip(self, count: float) -> bool:
        """Move on by `count` forcing periods (self-excited: events) without keeping them; return whether that many happened."""
        ...

    def look(self, longest: int) -> Run:
        """Run long enough to find a recurrence of up to `longest` forcing periods (self-excited: 25 times as many events)."""
        ...

    def rests(self, run: Run, last: bool) -> bool | None:
        """Return whether the motion has come to rest for good; None if undecided, which is not possible with `last`."""
        ...

    def move_on(self, run: Run, longest: int) -> bool:
        """Move a creeping motion to the place where its creep ends; return whether it was moved."""
        return False

    def push(self) -> None:
        """Perturb a motion that may stay on an unstable one only because of exact numbers."""

    def section(self) -> tuple[str, np.ndarray]:
        """Move on to the next whole forcing period (self-excited: the next event); return that event's letter and the point there."""
        self.follow(math.floor(self.time) + 1.0)
        return "", self.point

    def box(self) -> np.ndarray:
        """Return the smallest and largest phase and coordinates of random starts, shape (n, 2); without phase for a self-excited machine."""
        ...

    def free(self, points: np.ndarray) -> np.ndarray:
        """Return which starts lie outside the walls, bool array (m,)."""
        return np.ones(len(points), dtype=bool)

    def settle_all(self, points: np.ndarray, longest: int, workers: int | None) -> Batch | None:
        """Run all starts together until they recur within `longest` forcing periods; None if this is not faster than one by one."""
        return None

    def settle_longer(
        self, batch: Batch, chosen: np.ndarray, longest: int, periods: float, workers: int | None
    ) -> None:
        """Run the motions `chosen` (bool array (n,)) of a batch, which have not recurred, for up to `periods` more; the batch is changed in place."""

    def growth(self) -> tuple[float, float]:
        """Return the largest Lyapunov exponent per forcing period, and its standard error."""
        ...


def later(
    simulator: Simulator,
    point: np.ndarray,
    length: float,
    time: float = 0.0,
) -> np.ndarray:
    """Return the point after a `length` of time on the motion through a point; NaN if the motion fails."""
    try:
        simulator.start(point, time)
        simulator.follow(time + length)
    except SimulationError:
        return np.full(len(point), np.nan)
    return simulator.point


class Vanishing(NamedTuple):
    """The event that vanishes at a border.

    Attributes
    ----------
    site : Site
        Word of the border orbit and place of the event whose margin vanishes.
    watched : int
        Index of the contact that is touched in the flight after the event, or one of `orbits.words.alphabet.Watch`.
    touch : (float, ndarray) or None
        Place of the touch in the flight: clock since the event before, and the other entries of a node there.
    """

    site: Site
    watched: int
    touch: tuple[float, np.ndarray] | None = None


class Flow(Protocol[ModelOf]):
    """Everything that depends on how a machine moves between two events.

    Attributes
    ----------
    angles : tuple of str
        Measures in radians modulo 2 pi.
    closed_form : bool
        Whether flights are known in closed form, as proofs need it.
    resolution : float
        Two motions whose `positions` differ by less are the same.
    seconds : str
        Column name of the time in samples.
    measure_names : callable
        Names of all measures of a machine.
    measures : callable
        (model, word, periods, nodes (m, L, n), params (m, P), names) -> measures by name, each of shape (m,).
    """

    angles: ClassVar[tuple[str, ...]]
    closed_form: ClassVar[bool]
    resolution: ClassVar[float]
    seconds: ClassVar[str]
    measure_names: Callable[[ModelOf], tuple[str, ...]]
    measures: Callable[[ModelOf, Word, int, np.ndarray, np.ndarray, Sequence[str]], dict[str, np.ndarray]]

    def census(self, model: ModelOf) -> Census:
        """Return how starts of this machine are sampled."""
        ...

    def coordinates(self, model: ModelOf) -> tuple[str, ...]:
        """Return the names of a simulator's coordinates."""
        ...

    def position_entries(self, model: ModelOf) -> tuple[int, ...]:
        """Return the entries of a node that hold `positions`: indices of `coordinates`, counted from 1."""
        ...

    def points(self, motion: Motion[ModelOf]) -> np.ndarray:
        """Return the simulator's coordinates just after the events, shape (L, d)."""
        ...

    def equations(
        self,
        model: ModelOf,
        word: Word,
        periods: int,
        parameter: str,
        params: np.ndarray,
        symmetric: bool = False,
        units: tuple[float, float] | None = None,
    ) -> Equations:
        """Return the equations of the cycles with this word, against `parameter`."""
        ...

    def loose(self, model: ModelOf, word: Word) -> tuple[int, ...]:
        """Return the entries of a node along which every motion with this word can be shifted as a whole."""
        ...

    def strobed(self, motion: Motion[ModelOf]) -> np.ndarray:
        """Return the coordinates of a motion without events, once per forcing period."""
        ...

    def default_measure(self, model: ModelOf) -> str:
        """Return the measure shown if none is chosen."""
        ...

    def simulated_names(self, model: ModelOf) -> tuple[str, ...]:
        """Return the names of the measures that a simulation gives."""
        ...

    def swept(self, model: ModelOf) -> tuple[str, ...]:
        """Return the names of the measures in a picture of a sweep."""
        ...

    def in_units(self, model: ModelOf, params: np.ndarray, values: dict[str, float]) -> dict[str, float]:
        """Convert measures to the units in which they are shown."""
        ...

    def described(self, motion: Motion[ModelOf]) -> dict[str, Any]:
        """Return the JSON-able description of the events."""
        ...

    def kind(self, motion: Motion[ModelOf]) -> str:
        """Return "stuck" if nothing moves that could hit, "sliding" if a shaken absorber hits no wall, else "periodic"."""
        ...

    def restitution(self, motion: Motion[ModelOf], place: int) -> float:
        """Return the coefficient of restitution of the impact at a place."""
        ...

    def without_events(self, motion: Motion[ModelOf]) -> np.ndarray | None:
        """Return the nodes of the motion after its last event has vanished; None if that is the absorber at rest."""
        ...

    # ------------------------------------------------------------------ between the events
    def flown(self, motion: Motion[ModelOf], places: np.ndarray, ahead: np.ndarray) -> np.ndarray:
        """Return coordinates, shape (m, d), at clocks `ahead` (m,) after the events `places`, as if no other event happened."""
        ...

    def columns(self, motion: Motion[ModelOf], table: np.ndarray) -> dict[str, np.ndarray]:
        """Return the columns of a sample by name, from coordinates (m, d)."""
        return dict(zip(self.coordinates(motion.model), table.T))

    def sample(self, motion: Motion[ModelOf], points: int = 400) -> dict[str, np.ndarray]:
        """Sample one period at about `points` instants, at least two per flight: each event appears with the states before and after it."""
        lasting = motion.durations
        durations = np.maximum(lasting, 0.0)
        counts = np.maximum(2, np.rint(points * durations / max(float(lasting.sum()), SMALLEST))).astype(int)
        ends = np.cumsum(counts)
        segment = np.repeat(np.arange(len(counts)), counts)
        ahead = (np.arange(ends[-1]) - (ends - counts)[segment]) * (durations / (counts - 1))[segment]
        ahead[ends - 1] = durations
        forced = motion.model.forced
        begins = motion.nodes[:, 0] if forced else np.cumsum(lasting) - lasting
        clock = begins[segment] + ahead
        return {
            self.seconds: (clock - clock[0]) / motion.model.phase_speed(motion.params),
            **({"phase": clock} if forced else {}),
            **self.columns(motion, self.flown(motion, segment, ahead)),
            "segment": segment,
        }

    def at_phases(self, motion: Motion[ModelOf], phases: np.ndarray) -> np.ndarray:
        """Return the coordinates of a forced motion at phases from 0 on, shape (m, d)."""
        whole, first = TWO_PI * motion.periods, motion.nodes[0, 0]
        wanted = (phases - first) % whole
        wanted[wanted >= whole] = 0.0  # for a phase just below zero
        begins = np.maximum.accumulate(motion.nodes[:, 0] - first)
        places = np.searchsorted(begins, wanted, side="right") - 1
        return self.flown(motion, places, wanted - begins[places])

    def positions(self, motion: Motion[ModelOf], instants: int) -> np.ndarray:
        """Return the coordinates that no impulse changes, at equal phases from phase zero on, shape (periods * instants, c).

        Motions are compared by them: they are equal if their positions differ by less than `resolution`.
        """
        count = instants * motion.periods
        phases = np.arange(count) * (TWO_PI * motion.periods / count)
        return self.at_phases(motion, phases)[:, [entry - 1 for entry in self.position_entries(motion.model)]]

    # ------------------------------------------------------------------ at borders
    def vanishing(self, motion: Motion[ModelOf], index: int, unit: int) -> Vanishing | None:
        """Return the event that vanishes with margin `index` of a border orbit, over its whole cycle; None if no word follows."""
        ...

    def placed(self, motion: Motion[ModelOf], found: Vanishing, place: int, change: Change) -> np.ndarray:
        """Return the nodes of the new events of a changed word.

        At the border the old and the new word describe the same motion, so every new event lies at an old event or where the margin vanished.
        """
        rows = [self.node_at(motion, place, spot, found) for spot in change.spots]
        return np.array(rows) if rows else motion.nodes[:0]

    def node_at(self, motion: Motion[ModelOf], place: int, spot: Spot, found: Vanishing) -> np.ndarray:
        """Return the node of a spot; the clock of an event inserted into a self-excited motion counts from the flight's start."""
        forced, nodes = motion.model.forced, motion.nodes
        if spot.node is None:
            assert found.touch is not None
            ahead, row = found.touch
            row = np.append((float(nodes[place, 0]) if forced else 0.0) + ahead, row)
        else:
            row = nodes[spot.node].copy()
            if spot.clock is not None:
                row[0] = nodes[spot.clock, 0]
            if spot.between:
                row[0] = (0.5 if forced else 1.0) * (row[0] + nodes[spot.node + 1, 0])
        row[0] += spot.later * GROWING.first
        return row
