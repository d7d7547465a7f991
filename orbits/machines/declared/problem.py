"""DeclaredProblem: the orbits of a declared machine with one word, as a continuation code takes them.

The contract is that of `orbits.problem.OrbitProblem`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from orbits.machines.declared import measures as measuring
from orbits.machines.declared.attractor import witness
from orbits.machines.declared.crossing import SAME, cross, distance
from orbits.machines.declared.identity import is_symmetric
from orbits.machines.declared.identity import root as shortest
from orbits.machines.declared.margins import border_kind
from orbits.machines.declared.orbit import DeclaredOrbit
from orbits.machines.declared.section import Section
from orbits.machines.declared.system import DeclaredSystem
from orbits.protocol import Answers, Embedding, Symmetry


class DeclaredProblem(DeclaredSystem, Answers):
    """Periodic orbits with a given word, against one parameter of a declared machine; the parameters are `DeclaredSystem`'s."""

    # ------------------------------------------------------------------ facts
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

    def margin_kind(self, j: int) -> str:
        """Kind of the border at which margin `j` vanishes."""
        return border_kind(self.word, j)

    # ------------------------------------------------------------------ symmetries and larger problems
    @cached_property
    def symmetries(self) -> tuple[Symmetry, ...]:
        """Images of a solution of the full word: the mirror some places on, and a doubled word's shift by its half."""
        if self.symmetric or not len(self.word):
            return ()
        found = []
        places = self._mirror_places()
        if places:
            periods = 2 * self.periods * places // self.length if self.forced else 1
            half = self.sibling(self.word.head(2 * places), periods, symmetric=True)
            found.append(
                Symmetry(
                    "symmetry-breaking",
                    lambda u: self._rotated(u, places, -1.0),
                    lambda u: (half, half.reduce(self.expand(u))),
                )
            )
        if self.word.repetitions % 2 == 0 and (not self.forced or self.periods % 2 == 0):
            root = self.sibling(
                self.word.head(len(self.word) // 2), max(1, self.periods // 2), symmetric=False
            )
            found.append(
                Symmetry(
                    "period-doubling",
                    lambda u: self._rotated(u, self.length // 2, 1.0),
                    lambda u: (root, root.reduce(self.expand(u))),
                )
            )
        return tuple(found)

    def root(self, u: np.ndarray, p: float) -> tuple[DeclaredProblem, np.ndarray] | None:
        """The problem of the shortest orbit of which `u` is a repetition, and that orbit in it; None for a primitive one."""
        word, periods, nodes = shortest(self.word, self.periods, self.expand(u), self.forced)
        if len(word) == len(self.word):
            return None
        found = self.sibling(word, periods, is_symmetric(word, periods, nodes, self.forced))
        return found, found.reduce(nodes)

    def _mirror_places(self) -> int:
        """After how many events the word may be its own mirror image, an odd number of half periods on; 0: never."""
        word = self.word
        if word.alphabet.mirror is None:
            return 0
        n = len(word)
        for places in range(1, n // 2 + 1):
            if n % (2 * places):
                continue
            times = n // (2 * places)
            if self.forced and (self.periods % times or (self.periods // times) % 2 == 0):
                continue
            if word.rotate(places) == word.mirror():
                return places
        return 0

    def _rotated(self, u: np.ndarray, places: int, sign: float) -> np.ndarray:
        """The solution read `places` events further on, with its states times `sign`."""
        nodes = np.asarray(u).reshape(self.length, self.size + 1)
        image = np.roll(nodes, -places, axis=0) * np.r_[1.0, np.full(self.size, sign)]
        if self.forced:
            turn = self.shift * places / self.length
            image[: self.length - places, 0] -= turn
            image[self.length - places :, 0] += self.shift - turn
        return image.ravel()

    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> list[Embedding]:
        """The larger problem whose branch point a symmetry breaking or period doubling is, with the point in it."""
        along = np.asarray(tangent[:-1])
        if kind == "symmetry-breaking" and self.symmetric and len(self.word):
            full = self.sibling(self.word, self.periods, symmetric=False)
            image = -along.reshape(self.length, -1)
            image[:, 0] *= -1.0
            direction = np.concatenate([along, image.ravel()])
            return [Embedding(full, full.reduce(self.expand(u)), np.append(direction, tangent[-1]), kind)]
        if kind == "period-doubling" and not self.symmetric and len(self.word):
            double = self.sibling(self.word.double(), 2 * self.periods if self.forced else 1, symmetric=False)
            nodes = self.expand(u)
            second = nodes.copy()
            second[:, 0] += self.shift
            direction = np.append(np.concatenate([along, along]), tangent[-1])
            return [Embedding(double, np.concatenate([nodes, second]).ravel(), direction, kind)]
        if kind == "branch-point":
            return [Embedding(self, np.array(u), np.array(tangent), kind)]
        return []

    def beyond(self, point: Any) -> Sequence[Any]:
        """The orbits on the other side of a border, with the words that physics writes."""
        return cross(self, point)

    # ------------------------------------------------------------------ identity
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

    def section(self, p: float) -> Section:
        """Its motions by simulation, once per period of the cycle."""
        return Section(self.machine, self.values(p), self.word, self.periods)

    def witness(self, p: float, starts: int = 4) -> list[dict[str, Any]]:
        """What the machine settles on at a parameter value, simulated from random starts: "word", "periods" and "kind" of each motion."""
        return witness(self.machine, self.values(p), starts)

    def replay(self, u: np.ndarray, p: float) -> float | None:
        """Largest deviation of the event-driven simulation from the orbit over its period."""
        return self.orbit(u, p).replay()

    def describe(self) -> dict[str, Any]:
        """A description that `rebuild` understands, ready for JSON."""
        return {
            "factory": "orbits.machines.declared.stored:rebuild",
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
