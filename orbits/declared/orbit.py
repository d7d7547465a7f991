"""DeclaredOrbit: one periodic motion of a declared machine, its nodes, its stability, and whether the machine can follow it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from orbits.cycles.claim import Claim
from orbits.cycles.identity import is_symmetric, root_orbit, size_of_one
from orbits.declared.deviation import deviation
from orbits.doors import above
from orbits.flows.page.cycle_equations import DeclaredSystem
from orbits.flows.page.margins import margin_name, per_node
from orbits.flows.page.measures import measure, names
from orbits.flows.page.sampling import sample, strobed
from orbits.flows.page.solving import examined
from orbits.machines.page.machine import Machine
from orbits.proofs.obstacles import ProofError
from orbits.words.margins import Margin
from orbits.words.of_pages import PageWord


@dataclass(frozen=True, eq=False)
class DeclaredOrbit(Claim):
    """A periodic orbit.

    Attributes
    ----------
    machine : Machine
    word : PageWord
        Its events over the whole period.
    periods : int
        Forcing periods; 1 for a self-excited machine.
    nodes : float array (L, n + 1)
        Per event the phase (of a self-excited machine: the duration of the flight that follows) and the states after it.
    params : float array (P,)
    """

    machine: Machine
    word: PageWord
    periods: int
    nodes: np.ndarray = field(repr=False)
    params: np.ndarray = field(repr=False)

    @classmethod
    def of(cls, system: DeclaredSystem, u: np.ndarray, p: float) -> DeclaredOrbit:
        """A solution of some equations as an orbit."""
        return cls(system.machine, system.word, system.periods, system.expand(u), system.values(p))

    # ------------------------------------------------------------------ facts
    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name."""
        return dict(zip(self.machine.parameter_names, map(float, self.params)))

    @property
    def impacts(self) -> int:
        """Impacts per period of the orbit."""
        return self.word.impacts

    @property
    def period(self) -> float:
        """Duration."""
        if not self.machine.forced:
            return float(self.nodes[:, 0].sum())
        return 2.0 * np.pi * self.periods / self.parameters[str(self.machine.phase_rate)]

    @cached_property
    def symmetric(self) -> bool:
        """Whether the orbit equals its mirror image after half its period."""
        same, forced = size_of_one(self.nodes), self.machine.forced
        alike = len(self.word) > 0 and is_symmetric(self.word, self.periods, self.nodes, same, forced=forced)
        return alike and self.machine.has_mirror(self.params)

    @cached_property
    def _examined(self) -> tuple[float, np.ndarray, np.ndarray]:
        problem = self.system(symmetric=False)
        residual, spectrum, margins = examined(problem, *self.seed(problem))
        return residual, problem.to_multipliers(spectrum), margins

    @property
    def half_multipliers(self) -> np.ndarray:
        """Multipliers of the half map (half a period, then the mirror) of a symmetric orbit.

        Raises
        ------
        ValueError
            If the orbit is not symmetric.
        """
        if not self.symmetric:
            raise ValueError(f"the orbit {self.word.text!r} is not symmetric, so it has no half map")
        problem = self.system(symmetric=True)
        return examined(problem, *self.seed(problem))[1]

    @property
    def margins(self) -> list[Margin]:
        """The finite margins, none negative for a real orbit."""
        width = per_node(len(self.machine.contacts))
        return [
            Margin(margin_name(self.word, index), index // width, float(value))
            for index, value in enumerate(self._examined[2])
            if np.isfinite(value)
        ]

    def measures(self, *wanted: str) -> dict[str, float]:
        """Measures by name, all of them if none is named."""
        asked = wanted or names(self.machine)
        values = measure(
            self.machine, self.word, self.periods, self.nodes[None], self.params[None], list(asked)
        )
        return {name: float(value[0]) for name, value in values.items()}

    # ------------------------------------------------------------------ other descriptions of it
    def _with(self, word: PageWord, periods: int, nodes: np.ndarray) -> DeclaredOrbit:
        return DeclaredOrbit(self.machine, word, periods, nodes, self.params)

    def root(self) -> DeclaredOrbit:
        """The shortest orbit of which this one is a repetition."""
        same, forced = size_of_one(self.nodes), self.machine.forced
        if not len(self.word) and self.periods > 1:
            alike = np.abs(strobed(self)[1:] - self.nodes[0, 1:]).max(axis=1) < same
            again = [k for k in range(1, self.periods) if self.periods % k == 0 and alike[k - 1]]
            return self._with(self.word, min(again, default=self.periods), self.nodes)
        return self._with(*root_orbit(self.word, self.periods, self.nodes, forced=forced, same=same))

    def repeat(self, times: int) -> DeclaredOrbit:
        """The same orbit, written `times` times."""
        turn = 2.0 * np.pi * self.periods if self.machine.forced else 0.0
        parts = []
        for copy in range(times):
            part = self.nodes.copy()
            part[:, 0] += copy * turn
            parts.append(part)
        periods = self.periods * times if self.machine.forced else self.periods
        return self._with(self.word.repeat(times), periods, np.concatenate(parts))

    def mirror(self) -> DeclaredOrbit:
        """The mirror image, half a forcing period later.

        Raises
        ------
        ValueError
            If it is no motion of this machine.
        """
        if self.word.alphabet.mirror is None:
            raise ValueError(f"the machine {self.machine.name!r} declares no mirror symmetry")
        if not self.machine.has_mirror(self.params):
            raise ValueError(
                f"the machine {self.machine.name!r} has no mirror symmetry with these parameters: the image of "
                f"{self.word.text!r} is not one of its orbits"
            )
        nodes = -self.nodes
        nodes[:, 0] = self.nodes[:, 0] + (np.pi if self.machine.forced else 0.0)
        return self._with(self.word.mirror(), self.periods, nodes)

    def rotate(self, places: int) -> DeclaredOrbit:
        """The same orbit, read from the event `places` further on."""
        if not len(self.word):
            return self
        n = len(self.word)
        nodes = np.roll(self.nodes, -places, axis=0)
        if self.machine.forced:
            nodes[:, 0] += ((np.arange(n) + places) // n) * 2.0 * np.pi * self.periods
        return self._with(self.word.rotate(places), self.periods, nodes)

    # ------------------------------------------------------------------ towards continuation
    def problem(self, parameter: str | None = None, symmetric: bool | None = None) -> Any:
        """The orbit's word as a continuation problem against `parameter` (default: the forcing's frequency)."""
        name = parameter or self.machine.default_parameter
        lasting = self.symmetric and self.machine.has_mirror(self.params, name)
        half = lasting if symmetric is None else symmetric
        return above("DeclaredProblem")(self.machine, self.word, self.periods, name, self.params, half)

    def system(self, symmetric: bool) -> DeclaredSystem:
        """Its equations, against the machine's default parameter, or one along which symmetric orbits stay so."""
        names = (self.machine.default_parameter, *self.machine.parameter_names)
        lasting = (n for n in names if not symmetric or self.machine.has_mirror(self.params, n))
        name = next(lasting, names[0])
        return DeclaredSystem(self.machine, self.word, self.periods, name, self.params, symmetric)

    def seed(self, problem: DeclaredSystem) -> tuple[np.ndarray, float]:
        """Unknowns and parameter value of this orbit in `problem`."""
        return problem.reduce(self.nodes), float(self.params[problem.index])

    # ------------------------------------------------------------------ seeing and proving
    def prove(self, bits: int | None = None, **parameters: Any) -> Any:
        """Refused: flights on a page have no closed form, and proofs need one.

        Raises
        ------
        ProofError
            Always.
        """
        raise ProofError(
            f"the machine {self.machine.name!r} offers no proofs, for flights on a page have no closed form; "
            "the built-in machines do"
        )

    def sample(self, points: int = 400) -> dict[str, np.ndarray]:
        """States over one period; see `orbits.flows.page.sampling.sample`."""
        return sample(self, points)

    def replay(self) -> float:
        """Largest deviation of the event-driven simulation over one period; see `orbits.declared.deviation`."""
        return deviation(self)

    def _repr_html_(self) -> str:
        return above("orbit_page")(self)

    def plot(self, **options: Any) -> Any:
        """Phase portrait and time history; see `orbits.plots.declared.portrait`."""
        return above("portrait_of_page")(self, **options)

    def scene(self, points: int = 120) -> dict[str, Any]:
        """The orbit as plain numbers for a page that draws it; see `orbits.plots.declared.scene`."""
        return above("scene_of_page")(self, points)

    def to_dict(self) -> dict[str, Any]:
        """The orbit as JSON: events, multipliers, margins."""
        clock = "phase" if self.machine.forced else "duration"
        events = self.word.events or ("",)
        nodes = [
            {"event": event, clock: float(row[0]), **dict(zip(self.machine.states, map(float, row[1:])))}
            for event, row in zip(events, self.nodes)
        ]
        return {
            "word": self.word.text,
            **({} if len(self.word) else {"rest": "no events"}),
            "periods": self.periods,
            "impacts": self.impacts,
            "symmetric": self.symmetric,
            "parameters": self.parameters,
            "nodes": nodes,
            "multipliers": [[float(value.real), float(value.imag)] for value in self.multipliers],
            "margins": [{"kind": m.kind, "segment": m.segment, "value": m.value} for m in self.margins],
            "real": self.real,
            "residual": self.residual,
        }
