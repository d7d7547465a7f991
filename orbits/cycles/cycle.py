"""A cycle: a periodic motion as plain data, and its other descriptions."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np

from orbits.cycles.identity import is_symmetric, root_orbit
from orbits.machines.base import Model
from orbits.machines.events import EventTable, event_table
from orbits.words import Word


@dataclass(frozen=True, eq=False, repr=False)
class Cycle:
    """Word, nodes and parameters of a periodic motion P_l^k; whether it solves anything is not asked here.

    Attributes
    ----------
    model : Model
        The machine.
    word : Word
        Its events over the whole period; the empty word is the absorber at rest in its cavity.
    periods : int
        Forcing periods k.
    nodes : float array (L, n)
        Per event (Psi, B+) at impacts and (Psi, w) elsewhere; the coupled machine adds v and v'.
    params : float array (P,)
        Parameter vector, in the order of `model.parameter_names`.
    """

    model: Model
    word: Word
    periods: int
    nodes: np.ndarray = field(repr=False)
    params: np.ndarray = field(repr=False)

    @classmethod
    def at_rest(cls, model: Model, params: np.ndarray) -> Self:
        """The cycle without events."""
        return cls(model, Word((), ()), 1, np.zeros((0, model.node)), params)

    @classmethod
    def of(cls, cycle: Cycle) -> Self:
        """The same data seen as another kind of cycle."""
        return cls(cycle.model, cycle.word, cycle.periods, cycle.nodes, cycle.params)

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value:.10g}" for name, value in self.parameters.items())
        return f"{type(self).__name__}({self.model.name}, word={self.spelling!r}, periods={self.periods}, {values})"

    # ------------------------------------------------------------------ facts
    @property
    def spelling(self) -> str:
        """The word as people are told it: one spelling for one motion; `word` begins where the nodes do."""
        return self.word.spelled(self.model.has_mirror(self.params))

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name."""
        return dict(zip(self.model.parameter_names, (float(value) for value in self.params), strict=True))

    @property
    def impacts(self) -> int:
        """Impacts per period of the orbit."""
        return self.word.impacts

    @property
    def period(self) -> float:
        """Duration in dimensionless time tau."""
        return 2.0 * np.pi * self.periods / self.parameters["frequency"]

    @cached_property
    def symmetric(self) -> bool:
        """Whether the orbit equals its mirror image after half its period."""
        return self.model.has_mirror(self.params) and is_symmetric(
            self.word, self.periods, self.nodes, image=self._image
        )

    @cached_property
    def events(self) -> EventTable:
        """Positions and velocities at the events; arrays of shape (L,)."""
        table = event_table(self.model, self.word, self.nodes[None], self.params[None])
        return EventTable(**{name: values[0] for name, values in vars(table).items()})

    @property
    def durations(self) -> np.ndarray:
        """Duration of each segment in radians of the forcing phase, shape (L,)."""
        if not len(self.word):
            return np.zeros(0)
        phases = self.nodes[:, 0]
        durations = np.empty(len(phases))
        np.subtract(phases[1:], phases[:-1], out=durations[:-1])
        durations[-1] = phases[0] + 2.0 * np.pi * self.periods - phases[-1]
        return durations

    # ------------------------------------------------------------------ other descriptions of it
    def root(self) -> Self:
        """The shortest orbit of which this one is a repetition."""
        word, periods, nodes = root_orbit(self.word, self.periods, self.nodes)
        return replace(self, word=word, periods=periods, nodes=nodes)

    def repeat(self, times: int) -> Self:
        """The same orbit, written `times` times."""
        turn = 2.0 * np.pi * self.periods
        parts = []
        for copy in range(times):
            part = self.nodes.copy()
            part[:, 0] += copy * turn
            parts.append(part)
        word, periods = self.word.repeat(times), self.periods * times
        return replace(self, word=word, periods=periods, nodes=np.concatenate(parts))

    def mirror(self) -> Self:
        """The mirror image: L and R change places, half a forcing period later.

        Raises
        ------
        ValueError
            If it is no motion of this machine.
        """
        if not self.model.has_mirror(self.params):
            raise ValueError(
                f"the model {self.model.name!r} has no mirror symmetry with these parameters: the image of "
                f"{self.word.text!r} is not one of its orbits"
            )
        nodes = self._image
        nodes[:, 0] += np.pi
        return replace(self, word=self.word.mirror(), nodes=nodes)

    @property
    def _image(self) -> np.ndarray:
        return self.model.image(self.word.codes, self.nodes, self.params)

    def rotate(self, places: int) -> Self:
        """The same orbit, read from the event `places` further on."""
        n = len(self.word)
        if n == 0:
            return self
        nodes = np.roll(self.nodes, -places, axis=0)
        turns = np.arange(n) + places
        nodes[:, 0] += (turns // n) * 2.0 * np.pi * self.periods
        return replace(self, word=self.word.rotate(places), nodes=nodes)
