"""What a simulation settles on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.attractors.motion import Settled
from orbits.cycles.cycle import Cycle
from orbits.machines.stepping import Machine
from orbits.orbit import Orbit
from orbits.simulation.native import NativeSimulator
from orbits.simulation.return_map import cyclic_distance
from orbits.simulation.trajectory import LETTERS, Trajectory
from orbits.words import Word
from orbits.words.alphabet import shaken

if TYPE_CHECKING:
    from orbits.machines.base import Model


@dataclass(frozen=True, eq=False)
class Attractor(Settled):
    """The motion that is left after a transient.

    Attributes
    ----------
    model : Model
        The machine.
    params : ndarray, shape (P,)
        Parameter vector.
    kind : str
        ``periodic`` (with impacts), ``sliding`` (periodic without impacts), ``stuck``, ``chatter`` (impacts
        pile up into persistent contact, in every cycle or every 32 periods on average) or ``chaotic`` (nothing
        recurs within the periods looked at).
    periods : int
        Forcing periods k until the motion recurs; 0 if it does not.
    codes, modes : ndarray of int8, shape (n,)
        The cycle's events (H = 5 begins a persistent contact) and the modes after them, rotated into canonical order.
    nodes : ndarray, shape (n, NODE)
        (Psi, B+) at impacts and (Psi, w) at other events, then (v, v') in the coupled model; the first phase lies in
        [0, 2 pi), later ones are counted through.
    residual : float
        Largest difference between the first node and its image after one period.
    multipliers : ndarray of complex, shape (NODE,)
        Eigenvalues of the simulated return map's central differences; nan where they could not be taken.
    symmetric : bool
        Whether the orbit equals its mirror image.
    state : ndarray, shape (S,)
        A state on the attractor, from which a simulation goes on.
    impacts_per_period, impact_speed : float
        Impacts per forcing period and fastest approach |w'-|, over the motion looked at: the cycle, or what
        `orbits.attractors.observation` needs where nothing recurs.
    """

    model: Model
    params: np.ndarray
    machine: Machine
    kind: str
    periods: int
    codes: np.ndarray
    modes: np.ndarray
    nodes: np.ndarray
    residual: float
    multipliers: np.ndarray
    symmetric: bool
    state: np.ndarray
    impacts_per_period: float
    impact_speed: float

    def __repr__(self) -> str:
        return f"Attractor({self.kind}, word={self.text!r}, periods={self.periods}, impacts={self.impacts})"

    @property
    def letters(self) -> str:
        """The cycle's events as one string, every slip written."""
        return "".join(LETTERS[code] for code in self.codes)

    @property
    def impacts(self) -> int:
        """Impacts l in one cycle."""
        return int(np.count_nonzero(self.codes < 2))

    @property
    def recurrent(self) -> bool:
        """Whether the motion is periodic (stuck included)."""
        return self.kind == "stuck" or self.periods > 0

    @property
    def word(self) -> Any:
        """The cycle as an `orbits.words.Word`.

        None where the motion has none: chaos, persistent contact, frictionless motion off the walls.
        """
        if not self.recurrent or np.any(self.codes > 4) or (self.kind == "sliding" and not len(self.codes)):
            return None
        alphabet = shaken(self.model.frictionless(self.params))
        return Word(tuple(LETTERS[c] for c in self.codes), tuple(int(m) for m in self.modes), alphabet)

    @property
    def text(self) -> str:
        """The word in the one spelling of its motion; for motions with persistent contact the plain list of events."""
        if self.word is not None:
            return self.word.spelled(self.model.has_mirror(self.params))
        return self.letters if self.periods else ""

    @property
    def cycle(self) -> Cycle:
        """The attractor as plain data, with the word that its events read.

        A motion without impacts is moved so that the mean of its w is the middle between the walls, which continuation pins.

        Raises
        ------
        ValueError
            If the attractor is not periodic or has persistent contact, which no word describes.
        """
        word = self.word
        if word is None:
            raise ValueError(
                f"the attractor is {self.kind}: only periodic motions without persistent contact are orbits"
            )
        nodes = self.model.at_home(self.codes, self.nodes, self.params)
        return Cycle(self.model, word, self.periods, nodes, self.params)

    @property
    def found(self) -> Orbit:
        """The attractor as an orbit, ready for continuation; see `cycle`."""
        return Orbit.of(self.cycle)

    orbit = found

    @property
    def guess(self) -> np.ndarray | None:
        """The nodes as a study's `guess` takes them, read as the word is spelled; None where no word describes the motion."""
        if self.word is None:
            return None
        if not len(self.word):
            return np.empty((0, self.machine.node))  # stuck
        orbit, place = self.found, self._first_place
        if orbit.word.rotate(place) != self._read:
            orbit = orbit.mirror()
        return (orbit.rotate(place) if place else orbit).nodes

    @property
    def _read(self) -> Word:
        """The word as it is spelled."""
        return Word.parse(self.text, self.word.frictionless)

    @property
    def _first_place(self) -> int:
        """Which of the events is the first one of the word as it is spelled."""
        read, images = self._read, (self.word, self.word.mirror())
        return next(k for image in images for k in range(len(image)) if image.rotate(k) == read)

    def follow(self, periods: float | None = None) -> Trajectory:
        """The motion from `state`: over one cycle, or sixteen periods where nothing recurs."""
        length = periods if periods is not None else self.periods or (1 if self.kind == "stuck" else 16)
        simulator = NativeSimulator(self.model, self.params)
        simulator.state = self.state.copy()
        return simulator.run(length, 100_000)

    @property
    def dots(self) -> list[float]:
        """B = (B+ - B-)/2, positive away from the wall, at every impact: from the word's first on.

        B = v' - w', and v' does not change at an impact: B is half the jump of -w'.
        """
        run = self.follow()
        hits = run.codes < 2
        away = 1.0 - 2.0 * run.codes[hits]  # L = 0, R = 1
        jumps = 0.5 * away * (run.rows[hits, 3] - run.rows[hits, 4])
        if self.periods and len(self.nodes):
            first = self._first_place if self.word is not None else 0
            since = run.phases[hits] - self.nodes[first, 0] + 1e-4
            jumps = jumps[np.argsort(since % (2.0 * np.pi * self.periods))]
        return [float(b * self.model.gauge("velocity", self.params)) for b in jumps]

    def distance(self, other: Attractor) -> float:
        """Largest difference of the nodes, over all rotations, shifts by 2 pi and the mirror image.

        Without impacts the mean position is free and left out. inf if the events differ.
        """
        if self.kind != other.kind or self.periods != other.periods or len(self.codes) != len(other.codes):
            return np.inf
        if not len(self.codes):
            return 0.0
        mirror = np.array([1, 0, 2, 3, 4, 5], dtype=np.int8)
        own = self.model.at_home(self.codes, self.nodes, self.params)
        target = self.model.at_home(other.codes, other.nodes, self.params)
        image = self.model.image(self.codes, own, self.params)
        image[:, 0] += np.pi
        images = [(self.codes, self.modes, own)]
        if self.model.has_mirror(self.params):
            images.append((mirror[self.codes], -self.modes, image))
        best = np.inf
        for codes, modes, nodes in images:
            for k in range(len(codes)):
                if np.array_equal(np.roll(codes, -k), other.codes) and np.array_equal(
                    np.roll(modes, -k), other.modes
                ):
                    best = min(best, cyclic_distance(np.roll(nodes, -k, axis=0), target))
        return best
