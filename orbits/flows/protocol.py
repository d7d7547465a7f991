"""What happens between two events: one protocol, fulfilled by closed forms (`orbits.flows.native`) and by integrated flights (`orbits.flows.page`).

The solving half, in words
--------------------------
1. A *node* is an event in as many numbers as a motion has unknowns there: the phase (of a self-excited machine the duration of the flight
   that follows), then coordinates on the event's surface or the states after it, as the flow likes. The mirror image of a node has all but
   the first with the other sign (`image`: positions are counted from the middle between the walls); a motion is the same after a turn of 2 pi in the first.
2. `equations` are F(u, p) = 0 for the cycles with one word: sizes, units, kernels (`contvines.problems.protocol`) with Newton's method and a
   look at one solution beside them (`Equations`). They know how unknowns and nodes go together and say which margin to follow along a locus.
   Margins come as the word's alphabet orders them (`Alphabet.watched`).
   `coordinates` are what simulators call a point, `census` says how many starts of them are simulated.
3. `loose` are the entries of a node along which any motion with a word may be shifted as a whole.
4. `sample` has a motion over time, `positions` what no impulse moves, at equal phases from phase zero on, shape (m, c): motions are compared
   by it, and are one where they differ by less than `resolution`. `position_entries` are the entries of a node to which these belong, places among
   `coordinates` counted from 1. `points` are the simulator's coordinates just after the events, shape (L, d).
   `strobed` has a motion without events once per period.
5. `measures` of many solutions at once, their names, which are angles, and the one that is shown first; `simulated_names` are those that a
   simulation tells, `swept` those that a picture of a sweep shows, `in_units` has them in the units that are shown. `described` is what JSON has of events. `kind` is
   "stuck" where nothing moves that could be hit, "sliding" where a shaken absorber hits no wall, else "periodic".
6. At a border, `vanishing` says what the vanishing margin watches, where, and what the laws of the contacts need to know of it; `placed` are
   the nodes of the events that they propose; `without_events` the node of a motion that has lost its last event (None: that is at rest).
   `restitution` is that of an impact. Of equations, `approach` is the speed with which an impact leaves its wall, and `through_flights` are the
   derivatives of a round's flights (with the mirror, where a round is half a cycle).
7. `closed_form` says whether flights are known in closed form, so that something can be proved of them.

The stepping half, in words
---------------------------
A *simulator* moves one motion of a machine on at given parameters, from event to event. It knows no word, no equation of cycles and no border.

1. Time is counted in forcing periods (of a self-excited machine: in 2 pi of its time), whole ones included. A *point* is where the motion is at a
   given time: the coordinates `names`, positions and velocities.
2. ``start(point, time, modes=None)`` puts the motion there. What is in contact, and how it slides, follows from the point unless it is given.
   ``put`` does so with a start as users give it, ``go_on`` with the ``state`` in which another simulation has ended.
3. ``follow(until)`` moves it on; what may happen (gaps that close, velocities that vanish, limits of friction that are reached, switches that
   are crossed) is looked for all the way, and the laws of the contacts are applied. No event, hop or touch is passed unseen.
4. ``run(length, most)`` does the same for a while or so many events, and keeps the motion (`orbits.flows.trajectory`).
5. A motion that cannot go on (it leaves the range of numbers, or a law does not continue it) or cannot begin raises `SimulationError`.
6. ``struck(point, near)`` tells the two points that are one motion at a wall: just before and just after the impact.
7. ``mirrored`` says that the ``image`` of a point, half a period later, is a point of the same machine. ``hard`` says which coordinates walls limit by themselves.
   ``watched`` is (periods, events) of the motion in which near returns are looked for, ``waiting`` how long it is followed until it settles,
   ``observed`` for how many periods what does not recur is looked at, at first and at most (0: no more than that by which it is recognised),
   ``modulated`` for how many its modulation. ``resting`` and ``wandering`` are what attractors at rest and such that do not recur are called, ``roomy`` says whether there is room for two incommensurate frequencies, ``count`` how many events there were, where they are counted.
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
    """What a flow is asked about: word, nodes and parameters of a cycle (`orbits.cycle.Cycle`)."""

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
    """A start or a length of a run that cannot be, or a motion that does not go on; the sentence says the way out."""


def checked_start(start: Mapping[str, float], allowed: Sequence[str]) -> dict[str, float]:
    """The entries of a start as numbers.

    Raises
    ------
    SimulationError
        If a name is unknown or a value not finite.
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
    """How long a motion is followed until what it settles on is seen.

    Attributes
    ----------
    transient : float
        Forcing periods (of a self-excited machine: events) that are left out first.
    tries, in_sweeps : int
        How often they are prolonged where nothing recurs, and at each value of a sweep.
    longer : int
        So many times.
    returned : float
        Largest difference of points, relative to 1 + points, of a motion that has returned.
    early : int
        Part of the transient after which a first look is had, at short cycles; 0: none.
    slow : float
        Forcing periods for which a motion is waited for that recurs but for a drift which fades or grows.
    events : float
        After so many a motion is followed no further.
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
        Values, and starts at each, of a brief look.
    price : float
        What a simulated forcing period costs, as a multiple of one of a machine in closed form.
    longest, embedded : int
        Forcing periods of the longest recurrence that is looked for, and of the longest unstable cycle.
    """

    across: int
    brief: tuple[int, int]
    price: float
    longest: int
    embedded: int


class Outcome(IntEnum):
    """What became of a motion: it recurs, is at rest for ever, left the range of numbers, or does none of these yet."""

    WANDERING = 0
    SETTLED = 1
    AT_REST = 2
    LOST = 3


class Batch(NamedTuple):
    """Many motions that were run until they recur.

    Attributes
    ----------
    outcomes, periods : int array (n,)
        `Outcome` of each, and forcing periods of its recurrence.
    gaps : float array (n,)
        Least difference of a return.
    states, points : float array (n, S), (n, d)
        Where they are at the end, at a whole forcing period.
    lasted : float array (n,)
        Forcing periods for which each was followed.
    growth : float
        Forcing periods that the growth of small differences takes.
    """

    outcomes: np.ndarray
    periods: np.ndarray
    gaps: np.ndarray
    states: np.ndarray
    points: np.ndarray
    lasted: np.ndarray
    growth: float


class Simulator(Protocol[ModelOf, Run]):
    """A motion on its way; the contract is at the top of this module."""

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
    def modes(self) -> Mode: ...
    @property
    def time(self) -> float: ...
    @property
    def point(self) -> np.ndarray: ...
    @property
    def mirrored(self) -> bool:
        """Whether the machine equals its mirror image."""
        return self.model.has_mirror(self.params)

    def image(self, point: np.ndarray) -> np.ndarray:
        """A point mirrored about the middle between the walls."""
        image = -point
        image[0] += 2.0 * float(self.model.middle(self.params))
        return image

    def start(self, point: np.ndarray, time: float = 0.0, modes: tuple[int, ...] | None = None) -> None: ...

    def put(self, start: Mapping[str, float] | np.ndarray | None) -> None:
        """Begin at a start by names, or at a state."""
        ...

    def state_of(self, start: Mapping[str, float] | np.ndarray | None) -> np.ndarray:
        """The state of a start."""
        ...

    def go_on(self, state: np.ndarray, nudge: float = 0.0) -> None:
        """Begin where another simulation has ended, changed a little."""
        ...

    def run(self, periods: float, most: int) -> Run:
        """Move on and keep the motion."""
        ...

    def begin(self, word: Word, node: np.ndarray) -> None:
        """Put the motion just after the first event of a cycle with this word, of which `node` are the unknowns."""
        ...

    def follow(self, until: float) -> None:
        """Move on."""
        ...

    def go_round(self, word: Word, periods: int, index: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Move on by a period of a cycle: so many forcing periods, of a self-excited machine until its word has passed.

        Returns
        -------
        by_state : float array (d, d)
            Derivatives of the point by the one before.
        by_value : float array (d,)
            By the parameter with this index; both NaN where no index is given, or the simulator does not know them.
        """
        self.follow(self.time + periods)
        n = len(self.names)
        return np.full((n, n), np.nan), np.full(n, np.nan)

    def struck(self, point: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Of a point at a wall the other one there, just after the impact or just before it, and the direction away from the wall; None elsewhere."""
        ...

    def skip(self, count: float) -> bool:
        """Move on by so many forcing periods, of a self-excited machine so many events; whether there were as many."""
        ...

    def look(self, longest: int) -> Run:
        """The run in which a recurrence of up to so many forcing periods (25 times as many events) is looked for."""
        ...

    def rests(self, run: Run, last: bool) -> bool | None:
        """Whether the motion has come to rest for good; None where that is yet to be seen, unless it is the last look."""
        ...

    def move_on(self, run: Run, longest: int) -> bool:
        """Move a motion that creeps to where that ends; whether it does."""
        return False

    def push(self) -> None:
        """Help a motion to leave another one that repels, on which only rounding keeps it."""

    def section(self) -> tuple[str, np.ndarray]:
        """Move on to the next whole forcing period, of a self-excited machine to the next event: that event, and the point there."""
        self.follow(math.floor(self.time) + 1.0)
        return "", self.point

    def box(self) -> np.ndarray:
        """Smallest and largest value of phase and coordinates among which starts are drawn, shape (n, 2); no phase of a self-excited machine."""
        ...

    def free(self, points: np.ndarray) -> np.ndarray:
        """Which starts lie outside the walls, bool array (m,)."""
        return np.ones(len(points), dtype=bool)

    def settle_all(self, points: np.ndarray, longest: int, workers: int | None) -> Batch | None:
        """Run starts, all at once, until they recur after at most so many forcing periods; None where nothing is gained by that."""
        return None

    def settle_longer(
        self, batch: Batch, here: np.ndarray, longest: int, periods: float, workers: int | None
    ) -> None:
        """Run those of a batch (bool array (n,)) that have not recurred for so many more periods; the batch is changed in place."""

    def growth(self) -> tuple[float, float]:
        """Largest Lyapunov exponent of the motion, per forcing period, and its standard error."""
        ...


def later(
    simulator: Simulator,
    point: np.ndarray,
    length: float,
    time: float = 0.0,
) -> np.ndarray:
    """Where the motion through a point is so much later; NaN where it does not get there."""
    try:
        simulator.start(point, time)
        simulator.follow(time + length)
    except SimulationError:
        return np.full(len(point), np.nan)
    return simulator.point


class Vanishing(NamedTuple):
    """What vanishes at a border.

    Attributes
    ----------
    site : Site
        The border orbit's word, seen from the event to which the margin belongs.
    watched : int
        Index of the contact that is met in the flight after the event, or one of `orbits.words.alphabet.Watch`.
    touch : (float, ndarray) or None
        Where in the flight: clock ahead of the event before, and the other entries of a node there.
    """

    site: Site
    watched: int
    touch: tuple[float, np.ndarray] | None = None


class Flow(Protocol[ModelOf]):
    """What a flow answers; see the top of this module."""

    angles: ClassVar[tuple[str, ...]]
    closed_form: ClassVar[bool]
    resolution: ClassVar[float]
    seconds: ClassVar[str]
    """What a sample calls the time."""
    measure_names: Callable[[ModelOf], tuple[str, ...]]
    measures: Callable[[ModelOf, Word, int, np.ndarray, np.ndarray, Sequence[str]], dict[str, np.ndarray]]
    """Of model, word, periods, nodes (m, L, n), params (m, P) and the names that are wanted."""

    def census(self, model: ModelOf) -> Census: ...
    def coordinates(self, model: ModelOf) -> tuple[str, ...]: ...
    def position_entries(self, model: ModelOf) -> tuple[int, ...]: ...
    def points(self, motion: Motion[ModelOf]) -> np.ndarray: ...

    def equations(
        self,
        model: ModelOf,
        word: Word,
        periods: int,
        parameter: str,
        params: np.ndarray,
        symmetric: bool = False,
        units: tuple[float, float] | None = None,
    ) -> Equations: ...

    def loose(self, model: ModelOf, word: Word) -> tuple[int, ...]: ...
    def strobed(self, motion: Motion[ModelOf]) -> np.ndarray: ...
    def default_measure(self, model: ModelOf) -> str: ...
    def simulated_names(self, model: ModelOf) -> tuple[str, ...]: ...
    def swept(self, model: ModelOf) -> tuple[str, ...]: ...
    def in_units(self, model: ModelOf, params: np.ndarray, values: dict[str, float]) -> dict[str, float]: ...
    def described(self, motion: Motion[ModelOf]) -> dict[str, Any]: ...
    def kind(self, motion: Motion[ModelOf]) -> str: ...
    def restitution(self, motion: Motion[ModelOf], place: int) -> float: ...
    def without_events(self, motion: Motion[ModelOf]) -> np.ndarray | None: ...

    # ------------------------------------------------------------------ between the events
    def flown(self, motion: Motion[ModelOf], places: np.ndarray, ahead: np.ndarray) -> np.ndarray:
        """Coordinates, shape (m, d), so long (clock, shape (m,)) after the events `places`, whatever happens on the way."""
        ...

    def columns(self, motion: Motion[ModelOf], table: np.ndarray) -> dict[str, np.ndarray]:
        """By name what a sample has of coordinates (m, d)."""
        return dict(zip(self.coordinates(motion.model), table.T))

    def sample(self, motion: Motion[ModelOf], points: int = 400) -> dict[str, np.ndarray]:
        """About so many instants of one period, at least two per flight: events are included with what is before and after them."""
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
        """Coordinates of a forced motion at phases from 0 on, shape (m, d)."""
        whole, first = TWO_PI * motion.periods, motion.nodes[0, 0]
        wanted = (phases - first) % whole
        wanted[wanted >= whole] = 0.0  # of a phase just below zero
        begins = np.maximum.accumulate(motion.nodes[:, 0] - first)
        places = np.searchsorted(begins, wanted, side="right") - 1
        return self.flown(motion, places, wanted - begins[places])

    def positions(self, motion: Motion[ModelOf], instants: int) -> np.ndarray:
        """What no impulse moves, at so many equal phases of each forcing period, shape (periods * instants, c)."""
        count = instants * motion.periods
        phases = np.arange(count) * (TWO_PI * motion.periods / count)
        return self.at_phases(motion, phases)[:, [entry - 1 for entry in self.position_entries(motion.model)]]

    # ------------------------------------------------------------------ at borders
    def vanishing(self, motion: Motion[ModelOf], index: int, unit: int) -> Vanishing | None: ...

    def placed(self, motion: Motion[ModelOf], found: Vanishing, place: int, change: Change) -> np.ndarray:
        """The nodes of a change's new events: at the border the old and the new description are the same motion, so they are where the margin vanished."""
        rows = [self.node_at(motion, place, spot, found) for spot in change.spots]
        return np.array(rows) if rows else motion.nodes[:0]

    def node_at(self, motion: Motion[ModelOf], place: int, spot: Spot, found: Vanishing) -> np.ndarray:
        """The node of a spot; an event that is inserted into a self-excited motion has the clock from the flight's start."""
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
