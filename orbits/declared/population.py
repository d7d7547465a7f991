"""Many starts of a declared machine and what they settle on, each motion once.

It is what `contvines` asks of a machine for atlases and basins: the contract is that of `orbits.population`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from orbits.attractors.distinct import alike, distinct
from orbits.attractors.embedded import embedded_cycles
from orbits.attractors.low_discrepancy import low_discrepancy
from orbits.attractors.motion import RARE, SOLVED, Motion, wandering
from orbits.attractors.returning import returning_cycles
from orbits.contacts.letters import RELEASE
from orbits.contacts.wall import Wall
from orbits.declared.attractor import RETURNED, look, of_record, returning, skip
from orbits.declared.orbit import DeclaredOrbit
from orbits.declared.sweep import sweep
from orbits.flows.page.growth import growth
from orbits.flows.page.stepper import TWO_PI, SimulationError, Stepper
from orbits.machines.notation import STARTS
from orbits.machines.page.machine import Machine
from orbits.simulation.page import PageSimulator, Trajectory, collect, letter_of, outside

BLOCKS = (20, 20, 40, 80, 160, 320, 640, 1280)  # forcing periods (or events) between two looks at a motion
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
BRIEF = (3, 6)  # values, and starts at each, of a brief look: flights of a page are integrated one by one
TOLD = 5  # looks after which a motion that does not recur is taken for the one that is known not to
WANDERING = ("chaotic", "quasi-periodic", "slow")
RELEASED = 1e-6  # difference of the clocks of two releases that are one
DRAWS = 64  # times as many starts are drawn at most to find those outside the walls


class DeclaredPopulation:
    """Starts of a declared machine against one of its parameters.

    Parameters
    ----------
    machine : Machine
    parameter : str
    parameters : mapping
        In place of the page's own.

    Raises
    ------
    ValueError
        If the machine has no such parameter.
    """

    def __init__(
        self, machine: Machine, parameter: str, parameters: Mapping[str, float] | None = None
    ) -> None:
        self.machine, self.parameter = machine, parameter
        self.parameters = {k: float(v) for k, v in dict(parameters or {}).items() if k != parameter}
        machine.vector({**self.parameters, parameter: machine.parameters.get(parameter, 1.0)})
        self._boxes: dict[float, np.ndarray] = {}
        self.work = 0.0
        """Forcing periods simulated so far, those that solve for cycles included; of a self-excited machine its time over 2 pi."""

    @property
    def about(self) -> dict[str, Any]:
        """The machine's page and settings."""
        return self.machine.settings()

    @property
    def notation(self) -> dict[str, str]:
        """Labels of axes by name of coordinate; states are shown by the names on the page."""
        return {"phase": STARTS["phase"]}

    across = 60  # starts each way in a picture of basins where no number is given

    @property
    def brief(self) -> tuple[int, int]:
        """Values, and starts at each, of a brief look."""
        return BRIEF

    @property
    def names(self) -> tuple[str, ...]:
        """Coordinates of a start: the phase of a forced machine, then its states."""
        return (*(["phase"] if self.machine.forced else []), *self.machine.states)

    def vector(self, p: float) -> np.ndarray:
        """All parameters at the value `p` of the one that varies, shape (P,)."""
        return self.machine.vector({**self.parameters, self.parameter: float(p)})

    def box(self, p: float) -> np.ndarray:
        """Smallest and largest coordinate of the starts, shape (n, 2).

        What the page says (``starts=``), else twice what the motion from rest reaches in sixty periods.
        """
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

    def starts(self, count: int, seed: int, p: float) -> np.ndarray:
        """Low-discrepancy starts in the box and outside the walls, shape (count, n).

        Raises
        ------
        ValueError
            If the walls leave nearly none of the box.
        """
        box = self.box(p)
        kept: list[np.ndarray] = []
        drawn = 0
        while sum(map(len, kept)) < count:
            if drawn > DRAWS * max(count, 2):
                raise ValueError(
                    f"the walls of {self.machine.name!r} leave nearly none of the box of starts at {self.parameter} = {p:g}; "
                    "say in the page where starts are drawn: Machine(..., starts={'x': (low, high)})"
                )
            points = box[:, 0] + low_discrepancy(len(box), count, seed, drawn) * (box[:, 1] - box[:, 0])
            drawn += len(points)
            kept.append(points[self._free(points, self.vector(p))])
        return np.concatenate(kept)[:count]

    def _free(self, points: np.ndarray, params: np.ndarray) -> np.ndarray:
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

    def settle(self, starts: np.ndarray, p: float) -> tuple[list[Motion], np.ndarray, np.ndarray]:
        """Simulate all starts and recognise what they settle on.

        Parameters
        ----------
        starts : float array (m, n)
        p : float

        Returns
        -------
        motions : list of Motion
            In the order of their first start. Starts inside a wall are ``impossible``.
        index : int array (m,)
        mirrored : bool array (m,)
        """
        starts = np.asarray(starts, dtype=float)
        sorting = _Sorting(self, self.vector(p))
        free = self._free(starts, sorting.params)
        found = [
            sorting.sort(start) if ok else sorting.plain("impossible") for start, ok in zip(starts, free)
        ]
        return sorting.motions, np.array([k for k, _ in found]), np.array([side for _, side in found])

    def embedded(self, state: np.ndarray, p: float) -> list[tuple[Any, np.ndarray]]:
        """Unstable cycles that the chaotic motion through a start passes near, each once, as problems with their unknowns."""
        simulator = PageSimulator(self.machine, self.vector(p))
        point, clock = self._parted(state)
        simulator.start(point, clock / TWO_PI)
        cycles = list(embedded_cycles(simulator, EMBEDDED, partial(of_record, far=WIDE)))
        self.work += simulator.time + SOLVED * len(cycles)
        return distinct(cycles, self.parameter, p)

    def returning(self, starts: np.ndarray, p: float) -> list[tuple[Any, np.ndarray]]:
        """Cycles, stable or not, to which Newton's method leads from starts, each once; of a self-excited machine none."""
        if not self.machine.forced:
            return []
        simulator, starts = PageSimulator(self.machine, self.vector(p)), np.asarray(starts, dtype=float)
        cycles = list(returning_cycles(simulator, starts, self.box(p), EMBEDDED, partial(of_record, far=FAR)))
        self.work += SOLVED * (len(starts) + len(cycles))
        return distinct(cycles, self.parameter, p)

    def closed(self, p: float) -> list[tuple[Any, np.ndarray]]:
        """Motions known in closed form: none of a machine with equations of its own."""
        return []

    def observed(self, state: np.ndarray | None, p: float) -> dict[str, float]:
        """Measures of the motion through a start; see `orbits.declared.sweep.measure_names`."""
        if state is None:
            return {}
        start = state if self.machine.forced else np.append(0.0, state)
        fixed: dict[str, Any] = dict(self.parameters)
        (row,) = sweep(self.machine, self.parameter, [p], start=start, **fixed)
        return dict(row.measures)

    def _parted(self, start: np.ndarray) -> tuple[np.ndarray, float]:
        """States and phase of a start."""
        return (start[1:], float(start[0])) if self.machine.forced else (start, 0.0)


@dataclass(frozen=True, eq=False)
class _Marks:
    """States just after the events of a known motion, by which another motion is seen to have fallen onto it."""

    place: int  # among the motions
    mirrored: bool
    rows: dict[str, np.ndarray]  # per letter (m, n)
    known: np.ndarray  # which columns count


class _Sorting:
    """The starts of one census, sorted by the motions they reach."""

    def __init__(self, population: DeclaredPopulation, params: np.ndarray) -> None:
        self.population, self.machine, self.params = population, population.machine, params
        self.motions: list[Motion] = []
        self.forms: list[tuple[Any, np.ndarray] | None] = []
        self.marks: list[_Marks] = []

    def plain(self, kind: str, **facts: Any) -> tuple[int, bool]:
        """The motion of a kind that is not told apart any further."""
        for k, motion in enumerate(self.motions):
            if motion.kind == kind and self.forms[k] is None:
                return k, False
        self.motions.append(Motion(kind, **facts))
        self.forms.append(None)
        return len(self.motions) - 1, False

    def sort(self, start: np.ndarray) -> tuple[int, bool]:
        """Which motion a start reaches, and whether its mirror image."""
        stepper = Stepper(self.machine, self.params)
        begin = 0.0
        try:
            stepper.start(*self.population._parted(start))
            begin = stepper.base + stepper.clock
            return self._followed(stepper)
        except SimulationError:
            return self.plain("escaped")
        finally:
            self.population.work += (stepper.base + stepper.clock - begin) / TWO_PI

    def _followed(self, stepper: Stepper) -> tuple[int, bool]:
        before: tuple[_Marks | None, float] = (None, np.inf)
        for looks, block in enumerate(BLOCKS):
            skip(stepper, block)
            marks, gap = self._nearest(stepper)
            if marks is not None and (gap < SURE or (marks is before[0] and gap < 0.5 * before[1])):
                return marks.place, marks.mirrored
            before = marks, gap
            if looks < 1 or (marks is not None and looks < 4):
                continue
            run = look(stepper, LONGEST)
            orbit = returning(run, LONGEST, RETURNED)
            if orbit is not None:
                return self._add(orbit, stepper)
            if run.held or not (run.events or self.machine.forced):
                return self.plain("stuck", state=_start(stepper))
            if _chatters(run):
                return self.plain("chatter", periods=0, state=_start(stepper))
            if looks >= TOLD and any(m.kind in WANDERING for m in self.motions):
                break
        known = next((k for k, m in enumerate(self.motions) if m.kind in WANDERING), None)
        if known is not None:
            return known, False
        exponent, error = growth(stepper)
        state = _start(stepper)
        kind = wandering(exponent, error, self.machine.size > 2)
        if kind == "slow":  # neighbours come together: it may recur, but late
            orbit = returning(look(stepper, RARE), RARE, RETURNED)
            if orbit is not None:
                return self._add(orbit, stepper)
        return self.plain(kind, exponent=exponent, error=error, state=state)

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

    def _add(self, orbit: DeclaredOrbit, stepper: Stepper) -> tuple[int, bool]:
        root = orbit.root()
        problem = root.problem(self.population.parameter)
        u, p = root.seed(problem)
        form = problem.canonical(u, p)
        for k, known in enumerate(self.forms):
            if known is not None and alike(form, known):
                return k, self._side(k, stepper)
        place = len(self.motions)
        kind = "periodic" if len(root.word) or self._moves(root) else "stuck"
        self.motions.append(Motion(kind, root.word.text, root.periods, problem, u, state=_start(stepper)))
        self.forms.append(form)
        self.marks.append(self._marks(place, root, False))
        if self.machine.has_mirror(root.params) and not root.symmetric:
            self.marks.append(self._marks(place, root.mirror(), True))
        return place, False

    def _side(self, place: int, stepper: Stepper) -> bool:
        marks, _ = self._nearest(stepper)
        return marks is not None and marks.place == place and marks.mirrored

    def _moves(self, orbit: DeclaredOrbit) -> bool:
        """Whether any state of a motion without events changes."""
        return bool(
            np.any(np.ptp(np.array([orbit.sample(50)[s] for s in self.machine.states]), axis=1) > 1e-9)
        )

    def _marks(self, place: int, orbit: DeclaredOrbit, mirrored: bool) -> _Marks:
        loose = orbit.system(symmetric=False).loose
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


def _chatters(run: Trajectory) -> bool:
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
