"""DeclaredProblem: the orbits of a declared machine with one word, as a continuation code takes them.

The contract is that of `orbits.problem.OrbitProblem`.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import numpy as np

from orbits.cycles.identity import canonical, size_of_one
from orbits.declared.attractor import witness
from orbits.declared.crossing import cross
from orbits.declared.dead_ends import dead_end
from orbits.declared.distance import SAME, distance
from orbits.declared.orbit import DeclaredOrbit
from orbits.flows.page import measures as measuring
from orbits.flows.page.cycle_equations import DeclaredSystem
from orbits.flows.page.margins import border_kind
from orbits.machines.notation import SYMBOLS
from orbits.protocol import Answers
from orbits.relatives import Relatives
from orbits.simulation.section import VariedSection, section_of_page


class DeclaredProblem(DeclaredSystem, Relatives, Answers):
    """Periodic orbits with a given word, against one parameter of a declared machine; the parameters are `DeclaredSystem`'s."""

    every = True

    # ------------------------------------------------------------------ facts
    @property
    def notation(self) -> dict[str, str]:
        """Labels of axes by name of measure; states and parameters (never "phase") are shown by the names on the page."""
        return {"phase": SYMBOLS["phase"]}

    @property
    def units(self) -> dict[str, str]:
        """Units of parameters and measures: a declared machine has plain numbers."""
        return {}

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name."""
        return dict(zip(self.machine.parameter_names, map(float, self.params)))

    def against(self, parameter: str, values: Mapping[str, float] | None = None) -> DeclaredProblem:
        """The same orbits against another parameter, with other values."""
        params = self.machine.vector({**self.parameters, **(values or {})})
        return DeclaredProblem(self.machine, self.word, self.periods, parameter, params, self.symmetric)

    def check_value(self, name: str, value: float) -> None:
        """Refuse a value that a parameter of the machine cannot have; see `Machine.check_value`."""
        self.machine.check_value(name, value)

    def margin_kind(self, j: int) -> str:
        """Kind of the border at which margin `j` vanishes."""
        return border_kind(self.word, j)

    # ------------------------------------------------------------------ larger and smaller problems
    def root(self, u: np.ndarray, p: float) -> tuple[DeclaredProblem, np.ndarray] | None:
        """The problem of the shortest orbit of which `u` is a repetition, and that orbit in it; None for a primitive one."""
        root = DeclaredOrbit.of(self, u, p).root()
        if (len(root.word), root.periods) == (len(self.word), self.periods):
            return None
        found = self.sibling(root.word, root.periods, root.symmetric)
        return found, found.reduce(root.nodes)

    def beyond(self, point: Any) -> Sequence[Any]:
        """The orbits on the other side of a border, with the words that physics writes."""
        return cross(self, point, self.every)

    def dead_end(self, point: Any) -> str:
        """Why no motion was found on the other side of a border."""
        return dead_end(self, point)

    # ------------------------------------------------------------------ identity
    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]:
        """Key and vector that are equal for one orbit in all its descriptions."""
        nodes = self.expand(u)
        mirror = self.mirrored or self.machine.has_mirror(self.values(p))
        return canonical(self.word, self.periods, nodes, mirror, forced=self.forced, same=size_of_one(nodes))

    def same_motion(self, u: np.ndarray, p: float, other: Any, v: np.ndarray) -> bool:
        """Whether a solution of another problem at the same parameter value is this motion, or its mirror image."""
        if not isinstance(other, DeclaredProblem) or other.machine is not self.machine:
            return False
        return distance(self.orbit(u, p), other.orbit(v, p)) <= SAME

    # ------------------------------------------------------------------ for people
    @property
    def measure_names(self) -> tuple[str, ...]:
        """Measures that this machine's orbits have."""
        return measuring.names(self.machine)

    @property
    def angles(self) -> tuple[str, ...]:
        """Measures that are angles."""
        return ("phase",)

    @property
    def default_measure(self) -> str:
        """The measure that a diagram shows when none is asked for: impact speeds, or how far the first state goes."""
        return measuring.shown_first(self.machine)

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Measures of many solutions at once: `u` has shape (m, N), `p` shape (m,)."""
        p = np.atleast_1d(np.asarray(p, dtype=float))
        nodes = self.expand(np.atleast_2d(u))
        params = np.array([self.values(value) for value in p])
        return measuring.measure(self.machine, self.word, self.periods, nodes, params, names)

    def orbit(self, u: np.ndarray, p: float) -> Any:
        """The solution as a `DeclaredOrbit`."""
        return DeclaredOrbit.of(self, u, p)

    def section(self, p: float) -> VariedSection:
        """Its motions by simulation, once per period of the cycle."""
        return section_of_page(self.machine, self.values(p), self.word, self.periods, self.index)

    def population(self, over: str | None = None, **parameters: float) -> Any:
        """Starts of this machine and what they settle on; see `orbits.population.Population`."""
        over = over or self.parameter
        values = {**self.parameters, **parameters}
        return self.machine.population(over, **{n: v for n, v in values.items() if n != over})

    def witness(self, p: float, starts: int = 4) -> list[dict[str, Any]]:
        """What the machine settles on at a parameter value, simulated from random starts: "word", "periods" and "kind" of each motion."""
        return witness(self.machine, self.values(p), starts)

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]:
        """A stable motion as `witness` tells of it."""
        return {"word": self.word.canonical().text or None, "periods": self.periods, "kind": "periodic"}

    def replay(self, u: np.ndarray, p: float) -> float | None:
        """Largest deviation of the event-driven simulation from the orbit over its period."""
        return self.orbit(u, p).replay()

    def describe(self) -> dict[str, Any]:
        """A description that `rebuild` understands, ready for JSON."""
        return {
            "factory": "orbits.declared.stored:rebuild",
            "name": f"P_{self.word.impacts}^{self.periods}" if len(self.word) else "no events",
            "model": {**self.machine.settings(), **self.parameters},
            "word": self.word.text,
            "events": list(self.word.events),
            "modes": [list(mode) for mode in self.word.modes],
            "periods": self.periods,
            "impacts": self.word.impacts,
            "parameter": self.parameter,
            "params": [float(value) for value in self.params],
            "symmetric": self.symmetric,
        }
