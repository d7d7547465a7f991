"""What a simulation settles on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.flows.catalogue import simulator_of
from orbits.flows.protocol import Simulator
from orbits.flows.trajectory import Trajectory
from orbits.orbit import Orbit
from orbits.settings import REPLAYING
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
        """The orbit's nodes; see `orbits.cycles.cycle.Cycle`."""
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
