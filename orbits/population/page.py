"""Starts of a declared machine: where they are drawn, and what they settle on, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np

from orbits.attractors.motion import RARE, Motion, wandering
from orbits.attractors.page import RETURNED, look, of_record, returning, skip, still
from orbits.attractors.sweeping import sweep
from orbits.contacts.letters import RELEASE
from orbits.contacts.wall import Wall
from orbits.flows.page.growth import growth
from orbits.flows.page.stepper import TWO_PI, SimulationError, Stepper
from orbits.flows.protocol import Record
from orbits.machines.notation import STARTS
from orbits.machines.page.machine import Machine
from orbits.orbit import Orbit
from orbits.population.sorting import Sorting
from orbits.simulation.page import PageSimulator, PageTrajectory, collect, letter_of, outside

BLOCKS = (10, 10, 20, 40, 80, 160, 320, 640, 1280)
"""Forcing periods (or events) between two looks at a motion."""
EMBEDDED = 4  # forcing periods of the longest unstable cycle looked for
LONGEST = 16  # forcing periods of the longest recurrence looked for
FAR, WIDE = (
    0.01,
    0.5,
)  # largest distance of a cycle from its guess, relative to 1 + states; on a chaotic motion all that is real counts
SURE = 1e-7  # a state so near to a known motion, relative to 1 + states, lies on it
NEAR = 1e-2  # so near, and nearer by half at the next look, it is falling onto it
REACH = 2.0  # a box of starts: so many times what the motion from rest reaches
WARM = 60.0  # forcing periods (or as much time) that tell what a machine reaches
BRIEF = (3, 6)  # values, and starts at each, of a brief look: flights of a page are integrated one by one,
LARGE, FEW = (
    5,
    2,
)  # of a machine with so many states only so many starts: their words are long, and each is followed for seconds
TOLD = 6  # looks after which a motion that does not recur is taken for the one that is known not to
ENOUGH = 20_000  # events of a motion that does not recur: where impacts pile up there are many in a period
WANDERING = ("chaotic", "quasi-periodic", "slow")
RELEASED = 1e-6  # difference of the clocks of two releases that are one


class PageStarts:
    """What `orbits.population.population.Population` asks of the starts of a declared machine."""

    across = 60
    price = 20.0  # flights of a page are integrated
    longest = EMBEDDED
    notation: ClassVar = {"phase": STARTS["phase"]}  # states are shown by the names on the page
    leftward = ""

    def __init__(self, machine: Machine, parameter: str, parameters: Mapping[str, float]) -> None:
        self.machine, self.parameter = machine, parameter
        self.parameters = {k: float(v) for k, v in parameters.items()}
        self.vector(machine.parameters.get(parameter, 1.0))
        self._boxes: dict[float, np.ndarray] = {}
        self.brief = BRIEF if machine.size < LARGE else (BRIEF[0], FEW)
        self.names = (*(["phase"] if machine.forced else []), *machine.states)

    def vector(self, p: float) -> np.ndarray:
        """The parameter vector."""
        return self.machine.vector({**self.parameters, self.parameter: float(p)})

    def gauges(self, names: Sequence[str], params: np.ndarray) -> dict[str, tuple[float, str]]:
        """Plain numbers have none."""
        return {}

    def box(self, p: float) -> np.ndarray:
        """What the page says, else twice what the motion from rest reaches in sixty periods."""
        if p not in self._boxes:
            given = self.machine.starts
            missing = [name for name in self.machine.states if name not in given]
            reached = self._reached(self.vector(p)) if missing else np.zeros(self.machine.size)
            rows = [[0.0, TWO_PI]] if self.machine.forced else []
            for name, reach in zip(self.machine.states, reached):
                rows.append(list(given.get(name, (-REACH * reach, REACH * reach))))
            self._boxes[p] = np.array(rows)
        return self._boxes[p]

    def _reached(self, params: np.ndarray) -> np.ndarray:
        """Largest absolute value of each state on the motion from rest (moved out of the walls), shape (S,)."""
        stepper = Stepper(self.machine, params)
        zero = np.zeros(self.machine.size)
        stepper.start(outside(stepper, zero, 0.0), 0.0)
        try:
            run = collect(stepper, TWO_PI * WARM, 5000)
            clocks = np.linspace(run.clocks[0], run.end, 2000)
            reach = np.abs(run.sample(clocks)).max(axis=0)
        except SimulationError:
            reach = zero
        largest = float(reach.max())
        return np.maximum(reach, 0.1 * largest if largest > 0.0 else 1.0)

    def free(self, points: np.ndarray, params: np.ndarray) -> np.ndarray:
        """Which starts have all gaps open, bool array (m,)."""
        machine = self.machine
        walls = [j for j, contact in enumerate(machine.contacts) if isinstance(contact, Wall)]
        if not walls:
            return np.ones(len(points), dtype=bool)
        clocks = points[:, 0] if machine.forced else np.zeros(len(points))
        states = np.ascontiguousarray(points[:, 1:] if machine.forced else points)
        numbers = np.concatenate([params, np.zeros(len(machine.equations.signed))])
        rows = np.repeat(numbers[None], len(points), axis=0)
        values = machine.compiled.contact_values()(states, np.ascontiguousarray(clocks), rows)
        return np.all(values[:, walls] >= 0.0, axis=1)

    def simulator(self, params: np.ndarray, state: np.ndarray | None = None) -> PageSimulator:
        """A simulator, on a motion if a start of it is given."""
        simulator = PageSimulator(self.machine, params)
        if state is not None:
            point, clock = parted(self.machine, state)
            simulator.start(point, clock / TWO_PI)
        return simulator

    def solver(self, params: np.ndarray, wide: bool = False) -> Callable[[Record, int, int, int], Any]:
        """What makes a cycle of a piece of a record."""
        return partial(of_record, far=WIDE if wide else FAR)

    def closed(self, params: np.ndarray) -> Iterable[Any]:
        """Nothing is known in closed form of equations of one's own."""
        return ()

    def observed(self, state: np.ndarray, p: float) -> dict[str, float]:
        """Measures of the motion through a start."""
        start = state if self.machine.forced else np.append(0.0, state)
        fixed: dict[str, Any] = dict(self.parameters)
        (row,) = sweep(self.machine, self.parameter, [p], start=start, exponents=False, **fixed)
        return dict(row.measures)

    def fleet(self, points: np.ndarray, params: np.ndarray, workers: int | None) -> PageFleet:
        """Starts under way."""
        return PageFleet(self.machine, params, points, self.free(points, params))


def parted(machine: Machine, start: np.ndarray) -> tuple[np.ndarray, float]:
    """States and phase of a start."""
    return (start[1:], float(start[0])) if machine.forced else (start, 0.0)


@dataclass(frozen=True, eq=False)
class _Marks:
    """States just after the events of a known motion, by which another motion is seen to have fallen onto it."""

    place: int  # among the motions
    mirrored: bool
    rows: dict[str, np.ndarray]  # per letter (m, n)
    known: np.ndarray  # which columns count


class PageFleet:
    """Starts of a declared machine, one after the other; one that falls onto a known motion is followed no further."""

    def __init__(self, machine: Machine, params: np.ndarray, points: np.ndarray, free: np.ndarray) -> None:
        self.machine, self.points, self.free = machine, points, free
        self.stepper = Stepper(machine, params)
        self.marks: list[_Marks] = []
        self.work = 0.0

    def sort(self, i: int, sorting: Sorting) -> None:
        """Which motion start number i reaches, and whether its mirror image."""
        if not self.free[i]:
            return sorting.plain(i, "impossible")
        stepper = self.stepper
        begin = 0.0
        try:
            stepper.start(*parted(self.machine, self.points[i]))
            begin = stepper.base + stepper.clock
            self._followed(i, stepper, sorting)
        except SimulationError:
            sorting.plain(i, "escaped")
        finally:
            self.work += (stepper.base + stepper.clock - begin) / TWO_PI
        return None

    def _followed(self, i: int, stepper: Stepper, sorting: Sorting) -> None:
        before: tuple[_Marks | None, float] = (None, np.inf)
        begun = stepper.count
        for looks, block in enumerate(BLOCKS):
            goes_on = skip(stepper, block)
            marks, gap = self._nearest(stepper)
            if marks is not None and (gap < SURE or (marks is before[0] and gap < 0.5 * before[1])):
                return sorting.assign(i, marks.place, marks.mirrored)
            before = marks, gap
            if goes_on and (looks < 2 or (marks is not None and looks < 5)):
                continue
            run = look(stepper, LONGEST)
            if still(run):
                return self._rests(i, run, sorting)
            orbit = returning(run, LONGEST, RETURNED)
            if orbit is not None:
                return self._add(orbit, i, stepper, sorting)
            if run.held:
                return sorting.plain(i, "stuck", state=_start(stepper))
            if _chatters(run):
                return sorting.plain(i, "chatter", periods=0, state=_start(stepper))
            if looks >= TOLD and any(m.kind in WANDERING for m in sorting.motions):
                break
            if stepper.count - begun > ENOUGH:
                break
        known = next((k for k, m in enumerate(sorting.motions) if m.kind in WANDERING), None)
        if known is not None:
            return sorting.assign(i, known)
        exponent, error = growth(stepper)
        state = _start(stepper)
        kind = wandering(exponent, error, self.machine.size > 2)
        if kind == "slow":  # neighbours come together: it may recur, but late
            orbit = returning(look(stepper, RARE), RARE, RETURNED)
            if orbit is not None:
                return self._add(orbit, i, stepper, sorting)
        return sorting.plain(i, kind, exponent=exponent, error=error, state=state)

    def _rests(self, i: int, run: PageTrajectory, sorting: Sorting) -> None:
        """A self-excited motion that comes to rest: at an equilibrium, where one is found."""
        from orbits.flows.page.smooth import rest_near

        rest = rest_near(self.machine, run.modes[-1], run.params, run.last)
        if rest is None:
            return sorting.plain(i, "stuck", state=_start(self.stepper))
        place, problem, u = sorting.known(rest, "stuck", 0)
        if place < 0:
            place = sorting.add(rest, Motion("stuck", "", 0, problem, u, state=_start(self.stepper)))
        return sorting.assign(i, place)

    def _row(self, stepper: Stepper) -> np.ndarray:
        if not self.machine.forced:
            return stepper.state.copy()
        return np.concatenate([[np.cos(stepper.clock), np.sin(stepper.clock)], stepper.state])

    def _nearest(self, stepper: Stepper) -> tuple[_Marks | None, float]:
        """The known motion that the next event lies nearest to, and how far from it, relative to 1 + states."""
        if not self.marks:
            return None, np.inf
        here = stepper.base + stepper.clock
        whole = TWO_PI * (np.floor(here / TWO_PI) + 1.0)
        until = whole + TWO_PI * LONGEST if self.machine.forced else here + 1e4
        event = stepper.advance(until)
        letter = "" if event is None else letter_of(self.machine, event)
        row = self._row(stepper)
        best: tuple[_Marks | None, float] = (None, np.inf)
        for marks in self.marks:
            rows = marks.rows.get(letter)
            if rows is None:
                continue
            gap = float((np.abs(rows - row) * marks.known).max(axis=1).min()) / (
                1.0 + float(np.abs(row).max())
            )
            if gap < min(NEAR, best[1]):
                best = marks, gap
        return best

    def _add(self, orbit: Orbit, i: int, stepper: Stepper, sorting: Sorting) -> None:
        root = orbit.root()
        kind = root.flow.kind(root)
        place, problem, u = sorting.known(root, kind, root.periods)
        if place >= 0:
            return sorting.assign(i, place, self._side(place, stepper))
        motion = Motion(kind, root.word.text, root.periods, problem, u, state=_start(stepper))
        place = sorting.add(root, motion)
        self.marks.append(self._marks(place, root, False))
        if self.machine.has_mirror(root.params) and not root.symmetric:
            self.marks.append(self._marks(place, root.mirror(), True))
        return sorting.assign(i, place)

    def _side(self, place: int, stepper: Stepper) -> bool:
        marks, _ = self._nearest(stepper)
        return marks is not None and marks.place == place and marks.mirrored

    def _marks(self, place: int, orbit: Orbit, mirrored: bool) -> _Marks:
        loose = [entry - 1 for entry in orbit.flow.loose(orbit.model, orbit.word)]
        states = orbit.nodes[:, 1:]
        rows = states
        if self.machine.forced:
            phases = orbit.nodes[:, :1]
            rows = np.hstack([np.cos(phases), np.sin(phases), states])
        known = np.ones(rows.shape[1])
        known[[rows.shape[1] - states.shape[1] + j for j in loose]] = 0.0
        letters = orbit.word.events or ("",)
        table = {
            letter: rows[[k for k, own in enumerate(letters) if own == letter]] for letter in set(letters)
        }
        return _Marks(place, mirrored, table, known)


def _chatters(run: PageTrajectory) -> bool:
    """Whether a wall takes hold again and again at the same clock: the motion recurs, with infinitely many impacts in between."""
    releases = np.array(
        [clock for clock, (_, kind, _) in zip(run.clocks[1:], run.events, strict=True) if kind == RELEASE]
    )
    for step in range(1, len(releases) // 2 + 1):
        spans = releases[step:] - releases[:-step]
        turns = np.round(spans / TWO_PI) * TWO_PI if run.machine.forced else spans[-1]
        if np.all(np.abs(spans - turns)[-step:] < RELEASED) and np.ptp(spans[-step:]) < RELEASED:
            return True
    return False


def _start(stepper: Stepper) -> np.ndarray:
    """The state as a start: with the phase of a forced machine before it."""
    return (
        np.append(stepper.clock % TWO_PI, stepper.state) if stepper.machine.forced else stepper.state.copy()
    )
