"""The problem of one word's orbits, as borders and continuation use it: symmetries, larger problems, and other motions of the machine.

It is the same for built-in and declared, forced and self-excited machines.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from contvines.shared.motions import BAND
from orbits.flows.protocol import Equations, Flow
from orbits.orbit import Orbit
from orbits.words import Word

if TYPE_CHECKING:
    from collections.abc import Callable

    from orbits.simulation.runs import Section
    from orbits.words import Word


class BorderPoint(Protocol):
    """A special point at a border, as problems receive it."""

    @property
    def u(self) -> np.ndarray: ...
    @property
    def value(self) -> float: ...
    @property
    def tangent(self) -> np.ndarray: ...
    @property
    def margin_index(self) -> int | None: ...


class CycleProblem(Protocol):
    """The part of a problem (`orbits.problem.OrbitProblem`) that borders and searches for other motions need."""

    model: Any
    flow: Flow
    word: Word
    periods: int
    parameter: str
    params: np.ndarray
    symmetric: bool
    mirrored: bool
    forced: bool
    length: int
    dimension: int
    shift: float
    n_multipliers: int
    n_margins: int
    equations: Equations

    @property
    def spelling(self) -> str: ...

    @property
    def image_offset(self) -> Callable[[float], np.ndarray] | None: ...

    def values(self, p: float | np.ndarray) -> np.ndarray: ...

    def value(self, params: np.ndarray) -> float: ...

    def reduce(self, nodes: np.ndarray) -> np.ndarray: ...

    def expand(self, u: np.ndarray, p: float | np.ndarray | None = None) -> np.ndarray: ...

    def middle(self, p: float) -> float: ...

    def orbit(self, u: np.ndarray, p: float) -> Orbit: ...

    def sibling(
        self, word: Word, periods: int, symmetric: bool, params: np.ndarray | None = None
    ) -> CycleProblem: ...


class Symmetry(NamedTuple):
    """An image of a solution that solves the same problem.

    Attributes
    ----------
    kind : str
        Kind of the branch points at which the symmetry breaks.
    apply : callable
        Unknowns -> unknowns of the image.
    root : callable or None
        Reduces a solution that is its own image to (smaller problem, its unknowns).
    kind_at : callable or None
        Kind of the points, if it depends on the solution; never for machines.
    offset : callable or None
        Parameter value -> vector added to the image, if the middle between the walls is not at w = 0.
    """

    kind: str
    apply: Callable[[np.ndarray], np.ndarray]
    root: Callable[[np.ndarray], tuple[Any, np.ndarray]] | None
    kind_at: Callable[[np.ndarray], str] | None = None
    offset: Callable[[float], np.ndarray] | None = None


class Embedding(NamedTuple):
    """A solution in the unknowns of a larger problem, in which it is a branch point."""

    problem: object
    u: np.ndarray
    tangent: np.ndarray
    kind: str


class Seed(NamedTuple):
    """Begin of the branch beyond a border; `tangent` leads away from the border."""

    problem: CycleProblem
    u: np.ndarray
    p: float
    tangent: np.ndarray | None
    kind: str
    note: str
    persistence: bool


class Motions(CycleProblem):
    """Part of the problem of a word that concerns other motions of its machine."""

    # ------------------------------------------------------------------ images, larger and smaller problems
    @property
    def symmetries(self) -> tuple[Symmetry, ...]:
        """Images of a solution of the full word: mirror images shifted along the word, and the shift of a doubled word by its half."""
        return self._images

    @cached_property
    def _images(self) -> tuple[Symmetry, ...]:
        if self.symmetric or not self.word.modes:
            return ()
        found = []
        for places in self._mirror_places() if self.mirrored else ():
            found.append(self._mirrored_on(places))
        repetitions = self.word.repetitions if len(self.word) else self.length
        if repetitions % 2 == 0 and (not self.forced or self.periods % 2 == 0):
            periods = self.periods // 2 if self.forced else 1
            root = self._root(self.word.head(len(self.word) // 2), periods, symmetric=False)
            found.append(Symmetry("period-doubling", lambda u: self._rotated(u, self.length // 2, 1.0), root))
        return tuple(found)

    def _root(
        self, word: Word, periods: int, symmetric: bool
    ) -> Callable[[np.ndarray], tuple[CycleProblem, np.ndarray]]:
        """Return a function that takes a solution which is its own image to (problem of a shorter word, its unknowns there)."""
        shorter = cache(lambda: self.sibling(word, periods, symmetric))
        return lambda u: (shorter(), shorter().reduce(self.expand(u)))

    def _mirrored_on(self, places: int) -> Symmetry:
        periods = 2 * self.periods * places // self.length if self.forced else 1
        root = self._root(self.word.head(2 * places), periods, symmetric=True)
        return Symmetry(
            "symmetry-breaking", lambda u: self._rotated(u, places, -1.0), root, offset=self.image_offset
        )

    def _mirror_places(self) -> list[int]:
        """Return the rotations that make the word its mirror image, an odd number of half forcing periods later, smallest first.

        A word that repeats a shorter one has several: its motions can be symmetric as a whole, or repeat a symmetric motion.
        """
        mirror, n = self.word.mirror(), self.length
        found = []
        for places in range(1, n // 2 + 1):
            if n % (2 * places):
                continue
            times = n // (2 * places)
            if self.forced and (self.periods % times or (self.periods // times) % 2 == 0):
                continue
            if self.word.rotate(places) == mirror:
                found.append(places)
        return found

    def _rotated(self, u: np.ndarray, places: int, sign: float) -> np.ndarray:
        """Return the unknowns with the nodes rotated, phases shifted to the first interval, and states multiplied by `sign`."""
        nodes = self.expand(u)
        image = np.concatenate([nodes[places:], nodes[:places]])
        image[:, 1:] *= sign
        if self.forced:
            turn = self.shift * places / self.length
            image[: self.length - places, 0] -= turn
            image[self.length - places :, 0] += self.shift - turn
        return self.reduce(image)

    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> list[Embedding]:
        """Return the larger problem in which a symmetry breaking or period doubling is a branch point, with this point in its unknowns."""
        along = np.asarray(tangent[:-1])
        if kind == "symmetry-breaking" and self.symmetric:
            full = self.sibling(self.word, self.periods, symmetric=False)
            image = -along.reshape(self.length, -1)
            image[:, 0] *= -1.0
            direction = np.concatenate([along, image.ravel(), tangent[-1:]])
            return [Embedding(full, full.reduce(self.expand(u, p)), direction, kind)]
        if kind == "period-doubling" and not self.symmetric and self.word.modes:
            periods = 2 * self.periods if self.forced else 1
            double = self.sibling(self.word.double(), periods, symmetric=False)
            nodes = self.expand(u, p)
            second = nodes.copy()
            second[:, 0] += self.shift
            direction = np.concatenate([along, along, tangent[-1:]])
            return [Embedding(double, double.reduce(np.concatenate([nodes, second])), direction, kind)]
        if kind == "branch-point":
            return [Embedding(self, np.array(u), np.array(tangent), kind)]
        return []

    # ------------------------------------------------------------------ by simulation
    def simulated_attractors(self, p: float, starts: int = 5) -> list[dict[str, Any]]:
        """Return the attractors of the machine at a parameter value, simulated from rest and from random starts.

        Returns
        -------
        list of dict
            "word" (or None), "periods" and "kind" of each motion, and "share" of the starts that lead to it, sorted. A motion that does
            not recur also has "modulation" and its band (see `contvines.shared.motions`), if they are defined.
        """
        from orbits.attractors.attractor import modulated
        from orbits.attractors.search import met

        found: dict[tuple[str, int, str], dict[str, Any]] = {}
        motions = list(met(self.model, self.values(p), starts, 7, max_period=12, patience=1))
        for motion, measures in motions:
            text = None if motion.word is None else motion.word.canonical().spelled()
            key = (text or "", int(motion.periods), motion.kind)
            if key not in found:
                found[key] = {"word": text, "periods": key[1], "kind": motion.kind, "share": 0.0}
                if modulation := modulated(motion, measures):
                    found[key] |= {"modulation": modulation, **{name: measures[name] for name in BAND}}
            found[key]["share"] += 1
        for one in found.values():
            one["share"] /= len(motions)
        return [found[key] for key in sorted(found)]

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]:
        """Return a stable motion in the form of `simulated_attractors`."""
        kind = self.flow.kind(self.orbit(u, p))
        return {"word": self.word.canonical().spelled(), "periods": self.periods, "kind": kind}

    def section(self, p: float) -> Section:
        """Return the Poincare section of this word: its motions by simulation, once per period of the cycle.

        Raises
        ------
        ValueError
            For the absorber at rest, which has no event to begin with.
        """
        if not len(self.equations.unit):
            raise ValueError("the absorber that never slides has no section")
        from orbits.flows import simulator_of
        from orbits.simulation.runs import Section

        simulator, unit = simulator_of(self.model, self.values(p)), self.equations.unit[0]
        return Section(simulator, self.word, self.periods, unit, self.model.place_of(self.parameter))
