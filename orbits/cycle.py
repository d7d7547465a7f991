"""A cycle: a periodic motion as plain data, and its equivalent descriptions."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import TYPE_CHECKING, Self

import numpy as np

from orbits.flows import flow_of
from orbits.flows.native.measures import EventTable, events_of
from orbits.flows.protocol import Flow
from orbits.settings import EVENTS, SIMULATING
from orbits.words import Word

if TYPE_CHECKING:
    from orbits.machines.varying import Varying


@dataclass(frozen=True, eq=False, repr=False)
class Cycle:
    """Word, nodes and parameters of a periodic motion P_l^k; it is not tested here whether it solves equations.

    Attributes
    ----------
    model : Model or Machine
        The machine.
    word : Word
        Its events over the whole period; the empty word is a motion without events: of a built-in machine the absorber at rest.
    periods : int
        Forcing periods k; 1 for a self-excited machine.
    nodes : float array (L, n)
        One row per event. Of a built-in machine (Psi, B+) at impacts and (Psi, w) elsewhere; the coupled machine adds v and v'. Of a declared
        machine the phase (of a self-excited machine: the duration of the flight that follows) and the states after the event.
    params : float array (P,)
        Parameter vector, in the order of `model.parameter_names`.
    """

    model: Varying
    word: Word
    periods: int
    nodes: np.ndarray = field(repr=False)
    params: np.ndarray = field(repr=False)

    @classmethod
    def at_rest(cls, model: Varying, params: np.ndarray) -> Self:
        """Return the cycle without events of a built-in machine."""
        return cls(model, Word((), ()), 1, np.zeros((0, model.node)), params)

    @classmethod
    def of(cls, cycle: Cycle) -> Self:
        """Return the same data as an object of this class."""
        return cls(cycle.model, cycle.word, cycle.periods, cycle.nodes, cycle.params)

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value:.10g}" for name, value in self.parameters.items())
        return f"{type(self).__name__}({self.model.name}, word={self.spelling!r}, periods={self.periods}, {values})"

    # ------------------------------------------------------------------ facts
    @property
    def flow(self) -> Flow:
        """The flow of the machine."""
        return flow_of(self.model)

    @property
    def forced(self) -> bool:
        """Whether the machine is forced; otherwise the first entry of a node is a duration."""
        return self.model.forced

    @property
    def spelling(self) -> str:
        """The word as printed: one spelling for one motion; `word` itself begins at the first node."""
        return self.word.spelled(self.model.has_mirror(self.params))

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name."""
        return self.model.named(self.params)

    @property
    def impacts(self) -> int:
        """Impacts per period of the orbit."""
        return self.word.impacts

    @property
    def period(self) -> float:
        """Length of the period, in the machine's own time."""
        if not self.forced:
            return float(self.nodes[:, 0].sum())
        return 2.0 * np.pi * self.periods / float(self.model.phase_speed(self.params))

    @cached_property
    def symmetric(self) -> bool:
        """Whether the orbit equals its mirror image after half its period."""
        if not self.model.has_mirror(self.params):
            return False
        if self._strobed:
            return self._its_own_image()
        return is_symmetric(
            self.word,
            self.periods,
            self.nodes,
            size_of_one(self.nodes),
            forced=self.forced,
            image=self.model.image(self.word, self.nodes, self.params),
        )

    @cached_property
    def events(self) -> EventTable:
        """Positions and velocities at the events of a built-in machine; arrays of shape (L,)."""
        return events_of(self)

    @property
    def durations(self) -> np.ndarray:
        """Clock of each flight, shape (L,): radians of the forcing phase, or time of a self-excited machine."""
        if not self.forced:
            return self.nodes[:, 0].copy()
        phases = self.nodes[:, 0]
        if not len(phases):
            return np.zeros(0)
        durations = np.empty(len(phases))
        np.subtract(phases[1:], phases[:-1], out=durations[:-1])
        durations[-1] = phases[0] + 2.0 * np.pi * self.periods - phases[-1]
        return durations

    # ------------------------------------------------------------------ other descriptions of it
    def root(self) -> Self:
        """Return the shortest orbit that this one repeats."""
        same = size_of_one(self.nodes)
        if len(self.word):
            word, periods, nodes = root_orbit(
                self.word, self.periods, self.nodes, forced=self.forced, same=same
            )
            return replace(self, word=word, periods=periods, nodes=nodes)
        if self.periods == 1:
            return self
        recurs = np.abs(self.flow.strobed(self)[1:] - self.nodes[0, 1:]).max(axis=1) < same
        divisors = [k for k in range(1, self.periods) if self.periods % k == 0 and recurs[k - 1]]
        return replace(self, periods=min(divisors, default=self.periods))

    def repeat(self, times: int) -> Self:
        """Return the same orbit, written `times` times."""
        turn = 2.0 * np.pi * self.periods if self.forced else 0.0
        parts = []
        for copy in range(times):
            part = self.nodes.copy()
            part[:, 0] += copy * turn
            parts.append(part)
        word, periods = self.word.repeat(times), self.periods * times if self.forced else self.periods
        return replace(self, word=word, periods=periods, nodes=np.concatenate(parts))

    def mirror(self) -> Self:
        """Return the mirror image: contacts change places, half a forcing period later.

        Raises
        ------
        ValueError
            If the image is no motion of this machine.
        """
        if not self.model.has_mirror(self.params):
            raise ValueError(
                f"the machine {self.model.name!r} has no mirror symmetry with these parameters: the image of "
                f"{self.word.text!r} is not one of its orbits"
            )
        nodes = self.model.image(self.word, self.nodes, self.params)
        nodes[:, 0] += np.pi if self.forced else 0.0
        image = replace(self, word=self.word.mirror(), nodes=nodes)
        return replace(image, nodes=self.flow.without_events(image)) if self._strobed else image

    @property
    def _strobed(self) -> bool:
        """Whether it is a forced motion without events, with nodes at phase zero."""
        return self.forced and not len(self.word) and len(self.nodes) > 0

    def _its_own_image(self) -> bool:
        """Return whether a motion without events is symmetric; its image may begin in any of its forcing periods."""
        if not (self.word.mirror_symmetric_halves and self.periods % 2):
            return False
        image, own = (self.flow.without_events(one) for one in (self.mirror(), self))
        if image is None or own is None:
            return False
        turned = (np.roll(image[:, 1:], places, axis=0) for places in range(self.periods))
        return any(np.abs(one - own[:, 1:]).max() < size_of_one(self.nodes) for one in turned)

    def rotate(self, places: int) -> Self:
        """Return the same orbit, beginning `places` events later."""
        n = len(self.word)
        if n == 0:
            return self
        nodes = np.roll(self.nodes, -places, axis=0)
        if self.forced:
            nodes[:, 0] += ((np.arange(n) + places) // n) * 2.0 * np.pi * self.periods
        return replace(self, word=self.word.rotate(places), nodes=nodes)


def size_of_one(nodes: np.ndarray) -> float:
    """Return the distance below which nodes (L, n + 1) are equal, for states of any size."""
    return SIMULATING.one * (1.0 + float(np.abs(nodes[:, 1:]).max(initial=0.0)))


def root_orbit(
    word: Word, periods: int, nodes: np.ndarray, *, forced: bool = True, same: float = SIMULATING.one
) -> tuple[Word, int, np.ndarray]:
    """Return word, periods and nodes (l, n) of the shortest orbit that this one repeats; without events one node per forcing period."""
    repetitions = word.repetitions if len(word) else len(nodes)
    for times in range(min(repetitions, periods) if forced else repetitions, 1, -1):
        if repetitions % times or (forced and periods % times):
            continue
        length = len(nodes) // times
        shifted = nodes[length:].copy()
        if forced:
            shifted[:, 0] -= 2.0 * np.pi * (periods // times)
        if np.abs(shifted - nodes[:-length]).max() < same:
            return word.head(length), periods // times if forced else periods, nodes[:length]
    return word, periods, nodes


def is_symmetric(
    word: Word,
    periods: int,
    nodes: np.ndarray,
    same: float = SIMULATING.one,
    *,
    forced: bool = True,
    image: np.ndarray | None = None,
) -> bool:
    """Return whether the orbit equals its mirror image after half its period.

    `image` are the mirrored nodes, at the same phases; by default all states change sign.
    """
    if not len(word):
        return not len(nodes)  # at rest; forced motions without events are treated in `Cycle.symmetric`
    if not (word.mirror_symmetric_halves and (periods % 2 == 1 or not forced)):
        return False
    half = len(word) // 2
    image = (-nodes if image is None else image)[:half].copy()
    image[:, 0] = nodes[:half, 0] + (np.pi * periods if forced else 0.0)
    return bool(np.max(np.abs(image - nodes[half:])) < same)


@cache
def _direction(size: int) -> np.ndarray:
    """Return a direction on which different orbits have different projections, twice in a row so that its rotations are slices."""
    return np.tile(np.sin(np.arange(1, size + 1) * np.sqrt(2.0)) + 0.1, 2)


def canonical(
    word: Word,
    periods: int,
    nodes: np.ndarray,
    mirror: bool = True,
    *,
    forced: bool = True,
    same: float = SIMULATING.one,
) -> tuple[Hashable, np.ndarray]:
    """Return key (word and periods) and vector of the orbit's canonical form.

    The vector lists cosine and sine of the phase (or the duration) and the other unknowns of each node. Of all rotations (and mirror images,
    if the machine has them) with the canonical word, it is the one with the largest projection on a fixed direction.
    """
    word, periods, nodes = root_orbit(word, periods, nodes, forced=forced, same=same)
    target = word.canonical(mirror)
    image: float | np.ndarray = -1.0  # half a forcing period later cosine and sine change their signs, too
    if forced:
        flat = np.empty((len(nodes), nodes.shape[1] + 1))
        np.cos(nodes[:, 0], out=flat[:, 0])
        np.sin(nodes[:, 0], out=flat[:, 1])
        flat[:, 2:] = nodes[:, 1:]
    else:
        flat, image = nodes, np.r_[1.0, np.full(nodes.shape[1] - 1, -1.0)]
    readings = word.readings(mirror)
    if not len(word):
        readings = [(mirrored, k) for mirrored, _ in readings for k in range(len(nodes))]
    best, best_score = readings[0], -np.inf
    if len(readings) > 1:
        size, images = flat.size, (flat.ravel(), (image * flat).ravel())
        direction = _direction(size)
        for reading in readings:
            turn = size - reading[1] * flat.shape[1]
            score = float(direction[turn : turn + size] @ images[reading[0]])
            if score > best_score + EVENTS.zero:
                best, best_score = reading, score
    mirrored, place = best
    turned = np.concatenate([flat[place:], flat[:place]]) if place else flat
    return (target.events, target.modes, periods), (image * turned if mirrored else turned).ravel()
