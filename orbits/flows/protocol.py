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
from collections.abc import Mapping, Sequence
from enum import IntEnum
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeVar

import numpy as np

from contvines.core.table import KernelFunctions
from contvines.shared.near_names import did_you_mean
from orbits.contacts.letters import Change, Site
from orbits.flows.trajectory import ModelOf, Trajectory

if TYPE_CHECKING:
    from orbits.contacts.letters import Mode
    from orbits.machines.varying import Varying
    from orbits.words import Word

ModelFor = TypeVar("ModelFor", bound="Varying", contravariant=True)
Run = TypeVar("Run", bound=Trajectory)
Data = TypeVar("Data")
Work = TypeVar("Work")
DataFor = TypeVar("DataFor", contravariant=True)
WorkFor = TypeVar("WorkFor", contravariant=True)


class Motion(Protocol[ModelOf]):
    """What a flow is asked about: word, nodes and parameters of a cycle (`orbits.cycles.cycle.Cycle`)."""

    @property
    def model(self) -> ModelOf: ...
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
    work, followed, growth : float
        Forcing periods simulated, for which one that does not recur was followed, and that the growth of small differences takes.
    """

    outcomes: np.ndarray
    periods: np.ndarray
    gaps: np.ndarray
    states: np.ndarray
    points: np.ndarray
    work: float
    followed: float
    growth: float


class Simulator(Protocol[ModelOf, Run]):
    """A motion on its way; the contract is at the top of this module."""

    @property
    def model(self) -> ModelOf: ...
    @property
    def params(self) -> np.ndarray: ...
    @property
    def names(self) -> tuple[str, ...]: ...
    @property
    def forced(self) -> bool: ...
    @property
    def mirrored(self) -> bool: ...
    @property
    def hard(self) -> np.ndarray: ...
    @property
    def watched(self) -> tuple[float, int]: ...
    @property
    def waiting(self) -> Waiting: ...
    @property
    def observed(self) -> tuple[float, float]: ...
    @property
    def modulated(self) -> float: ...
    @property
    def modes(self) -> Mode: ...
    @property
    def resting(self) -> str: ...
    @property
    def wandering(self) -> str: ...
    @property
    def roomy(self) -> bool: ...
    @property
    def count(self) -> float: ...
    @property
    def time(self) -> float: ...
    @property
    def point(self) -> np.ndarray: ...

    def image(self, point: np.ndarray) -> np.ndarray: ...

    def start(self, point: np.ndarray, time: float = 0.0, modes: tuple[int, ...] | None = None) -> None: ...

    @property
    def state(self) -> np.ndarray: ...

    def put(self, start: Mapping[str, float] | np.ndarray | None) -> None: ...

    def state_of(self, start: Mapping[str, float] | np.ndarray | None) -> np.ndarray: ...

    def go_on(self, state: np.ndarray, nudge: float = 0.0) -> None: ...

    def run(self, periods: float, most: int) -> Run: ...

    def begin(self, word: Word, node: np.ndarray) -> None:
        """Put the motion just after the first event of a cycle with this word, of which `node` are the unknowns."""
        ...

    def follow(self, until: float) -> None: ...

    def go_round(self, word: Word, periods: int, index: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Move on by a period of a cycle: so many forcing periods, of a self-excited machine until its word has passed.

        Returns
        -------
        by_state : float array (d, d)
            Derivatives of the point by the one before.
        by_value : float array (d,)
            By the parameter with this index; both NaN where no index is given, or the simulator does not know them.
        """
        ...

    def struck(self, point: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None: ...

    def skip(self, count: float) -> bool:
        """Move on by so many forcing periods, of a self-excited machine so many events; whether there were as many."""
        ...

    def look(self, longest: int) -> Trajectory:
        """The run in which a recurrence of up to so many forcing periods (25 times as many events) is looked for."""
        ...

    def rests(self, run: Run, last: bool) -> bool | None:
        """Whether the motion has come to rest for good; None where that is yet to be seen, unless it is the last look."""
        ...

    def move_on(self, run: Run, longest: int) -> bool:
        """Move a motion that creeps to where that ends; whether it does."""
        ...

    def push(self) -> None:
        """Help a motion to leave another one that repels, on which only rounding keeps it."""
        ...

    def section(self) -> tuple[str, np.ndarray]:
        """Move on to the next whole forcing period, of a self-excited machine to the next event: that event, and the point there."""
        ...

    def box(self) -> np.ndarray:
        """Smallest and largest value of phase and coordinates among which starts are drawn, shape (n, 2); no phase of a self-excited machine."""
        ...

    def free(self, points: np.ndarray) -> np.ndarray:
        """Which starts lie outside the walls, bool array (m,)."""
        ...

    def settle_all(self, points: np.ndarray, longest: int, workers: int | None) -> Batch | None:
        """Run starts, all at once, until they recur after at most so many forcing periods; None where nothing is gained by that."""
        ...

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


PLAIN = (1.0, 1.0)
"""Length and rate of unknowns that are counted in the machine's own units."""


class Vanishing(NamedTuple):
    """What vanishes at a border.

    Attributes
    ----------
    site : Site
        The border orbit's word, seen from the event to which the margin belongs.
    watched : int
        Index of the contact that is met in the flight after the event, or one of `orbits.words.alphabet.Watch`.
    touch : (float, ndarray) or None
        Where in the flight: clock ahead of the event before, and the flow's own coordinates there.
    """

    site: Site
    watched: int
    touch: tuple[float, np.ndarray] | None = None


class Approach(NamedTuple):
    """The speed with which an impact leaves its wall, in units of the unknowns, and how it depends on them.

    Attributes
    ----------
    speed : float
    slopes : ndarray, shape (n,)
        By the entries of the node.
    by_parameter : float
    push : ndarray, shape (n,)
        Direction of the node in which it is changed.
    """

    speed: float
    slopes: np.ndarray
    by_parameter: float
    push: np.ndarray


class Kernels(KernelFunctions, Protocol[DataFor, WorkFor]):
    """What is worked out of equations: Newton's method, and a look at one solution; in full `contvines.problems.protocol`."""

    def newton(
        self,
        data: DataFor,
        u: np.ndarray,
        p: float,
        work: WorkFor,
        border: np.ndarray,
        step: np.ndarray,
        tangent: np.ndarray,
        tolerance: float,
        limit: int,
    ) -> tuple[float, int, float]: ...
    def examine(self, data: DataFor, u: np.ndarray, p: float, work: WorkFor, row: np.ndarray) -> float: ...


class Equations(Protocol[Data, Work]):
    """The equations of the cycles with one word, against one parameter.

    Attributes
    ----------
    length, dimension, n_multipliers, n_margins : int
        Unknown nodes (half the word's, of a symmetric cycle), unknowns, multipliers, margins.
    twist, shift : float
        Closure: the first node returns with its phase plus `shift`, all else times `twist`.
    movable : bool
        Whether solutions may be shifted as a whole, but for the mirror that holds them.
    period_shift : float array (N,) or None
        What a turn of the forcing adds to the unknowns.
    path : float array (2, P)
        How the numbers follow the parameter (`orbits.machines.path`).
    units : (float, float)
        Length and rate in which the unknowns are counted; `unit` is what one of each entry of the nodes is, shape (L, n).
    began : float
        The value of the parameter in the parameter vector.
    data, kernels
        What a continuation is handed.
    """

    @property
    def length(self) -> int: ...
    @property
    def dimension(self) -> int: ...
    @property
    def n_multipliers(self) -> int: ...
    @property
    def n_margins(self) -> int: ...
    @property
    def twist(self) -> float: ...
    @property
    def shift(self) -> float: ...
    @property
    def movable(self) -> bool: ...
    @property
    def period_shift(self) -> np.ndarray | None: ...
    @property
    def path(self) -> np.ndarray: ...
    @property
    def units(self) -> tuple[float, float]: ...
    @property
    def unit(self) -> np.ndarray: ...
    @property
    def params(self) -> np.ndarray: ...
    @property
    def data(self) -> Data: ...
    @property
    def kernels(self) -> Kernels[Data, Work]: ...
    @property
    def began(self) -> float: ...
    @property
    def scratch(self) -> Work: ...
    def workspace(self) -> Work: ...
    def values(self, p: float | np.ndarray) -> np.ndarray: ...
    def value(self, params: np.ndarray) -> float: ...
    def expand(self, u: np.ndarray, p: float | np.ndarray | None = None) -> np.ndarray: ...
    def reduce(self, nodes: np.ndarray) -> np.ndarray: ...
    def to_multipliers(self, spectrum: np.ndarray) -> np.ndarray: ...
    def approach(self, u: np.ndarray, p: float, place: int, near: float) -> Approach: ...
    def through_flights(self, u: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray | None] | None: ...


class Flow(Protocol[ModelFor]):
    """What a flow answers; see the top of this module."""

    @property
    def angles(self) -> tuple[str, ...]: ...
    @property
    def closed_form(self) -> bool: ...
    @property
    def resolution(self) -> float: ...

    def census(self, model: ModelFor) -> Census: ...
    def coordinates(self, model: ModelFor) -> tuple[str, ...]: ...
    def position_entries(self, model: ModelFor) -> tuple[int, ...]: ...
    def points(self, motion: Motion[ModelFor]) -> np.ndarray: ...

    def equations(
        self,
        model: ModelFor,
        word: Word,
        periods: int,
        parameter: str,
        params: np.ndarray,
        symmetric: bool = False,
        units: tuple[float, float] | None = None,
    ) -> Equations: ...

    def loose(self, model: ModelFor, word: Word) -> tuple[int, ...]: ...
    def sample(self, motion: Motion[ModelFor], points: int) -> dict[str, np.ndarray]: ...
    def positions(self, motion: Motion[ModelFor], instants: int) -> np.ndarray: ...
    def image(self, motion: Motion[ModelFor]) -> np.ndarray: ...
    def strobed(self, motion: Motion[ModelFor]) -> np.ndarray: ...
    def measure_names(self, model: ModelFor) -> tuple[str, ...]: ...
    def default_measure(self, model: ModelFor) -> str: ...
    def measures(
        self,
        model: ModelFor,
        word: Word,
        periods: int,
        nodes: np.ndarray,
        params: np.ndarray,
        wanted: Sequence[str],
    ) -> dict[str, np.ndarray]: ...
    def simulated_names(self, model: ModelFor) -> tuple[str, ...]: ...
    def swept(self, model: ModelFor) -> tuple[str, ...]: ...
    def in_units(self, model: ModelFor, params: np.ndarray, values: dict[str, float]) -> dict[str, float]: ...
    def described(self, motion: Motion[ModelFor]) -> dict[str, Any]: ...
    def kind(self, motion: Motion[ModelFor]) -> str: ...
    def vanishing(self, motion: Motion[ModelFor], index: int, unit: int) -> Vanishing | None: ...
    def placed(
        self, motion: Motion[ModelFor], found: Vanishing, place: int, change: Change
    ) -> np.ndarray: ...
    def restitution(self, motion: Motion[ModelFor], place: int) -> float: ...
    def without_events(self, motion: Motion[ModelFor]) -> np.ndarray | None: ...
