"""Flow: base class of differential equations, with the members that their equilibria, cycles and populations use."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np

from contvines.shared.numbers import TINY

from ..problems.functions import NotEvaluable, difference_text
from ..problems.registry import addresses
from ..problems.scales import given_scale

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..problems.abilities import Population
    from ..problems.algebraic import AlgebraicProblem
    from ..problems.functions import ParameterSet
    from ..problems.protocol import BorderPoint, Problem, Seed
    from ..problems.symmetries import Image
    from .field import Events, Field
    from .settings import FlowSettings

Sizes = tuple[np.ndarray, float, float]  #: of states, period and parameter


class FlowOptions(TypedDict, total=False):
    """Optional arguments of a flow; see :class:`FlowProblem`."""

    mirror: Callable[[np.ndarray], ArrayLike] | ArrayLike | None
    period: Callable | float | None
    derivative: Callable | Mapping[str, Callable] | None
    degree: int
    error: float | None
    settings: FlowSettings | Mapping[str, float] | None
    scale: ArrayLike | None
    events: Mapping[str, Callable] | None
    parameter: str
    name: str


class NamedOptions(FlowOptions, total=False):
    """The same, with the names of the states."""

    states: Sequence[str] | None


class Flow(ABC):
    """Base class of :class:`contvines.FlowProblem` and of other flows, such as those of machines, which override some members.

    Attributes
    ----------
    x0 : ndarray, shape (d,)
        A start.
    given : dict
        The user's functions: "F", "jacobian", "derivative", "mirror", "events".
    of_states : dict
        Names of measures of states -> ("max", "min" or "mean", index of the state).
    mirror_shifted : bool
        Forced flows: whether the mirror image of a motion must be shifted by half a period to be a motion.
    box : sequence of (low, high), optional
        Ranges of the states from which simulations begin, if a study gives them.
    """

    name: str
    degree: int
    error: float
    settings: FlowSettings
    x0: np.ndarray
    values: ParameterSet
    given: dict[str, Any]
    given_period: Callable | float | None
    given_scale: ArrayLike | None
    given_states: Sequence[str] | None
    states: tuple[str, ...]
    of_states: Mapping[str, tuple[str, int]]
    field: Field
    events: Events
    mirror: Image | None
    mirror_shifted = False
    sizes: tuple[np.ndarray, float] | None = None  # scales of states and period, of cycles
    box: Sequence[tuple[float, float]] | None = None
    origin: tuple[str, str, str] | None = None  # file, name and digest, if a study names the flow

    def mirrored(self, x: np.ndarray) -> np.ndarray:
        """Return the mirror images of states, shape (n, d)."""
        assert self.mirror is not None
        return np.array([self.mirror(y) for y in x])

    # ------------------------------------------------------------------ checks
    def _check_rates(self) -> None:
        """Raise an error if two evaluations of f differ (an integrator's steps could shrink without end), or if period or mirror are wrong."""
        rate = self.field.rate_at(self.values.start)
        with np.errstate(all="ignore"):
            different = difference_text(rate(0.0, self.x0), rate(0.0, self.x0))
        if different:
            raise ValueError(different)
        if self.field.forced:
            self._check_period()
            self._find_mirror()

    def _random_states(self, seed: int, width: float) -> tuple[np.ndarray, np.ndarray, float]:
        """Random states next to the start, random times, and the period."""
        rng, period = np.random.default_rng(seed), self.field.length_of_period(self.values.start)
        x = self.x0 + self.field.lengths * rng.uniform(-width, width, (6, len(self.x0)))
        return x, rng.uniform(0.0, period, 6), period

    def _check_period(self) -> None:
        """Raise an error if f at random states next to the start does not repeat after its period."""
        p, (x, t, period) = self.values.start, self._random_states(6, 0.1)
        try:
            with np.errstate(all="ignore"):
                one, later = self.field(x, p, t), self.field(x, p, t + period)
        except NotEvaluable:
            return  # states next to the start may be outside the domain of f
        size = TINY + np.nanmax(np.abs(one), initial=0.0)
        if np.nanmax(np.abs(one - later), initial=0.0) > self.settings.recurs * size:
            raise ValueError(
                f"period = {period:.10g} at the start is no period of f(x, p, t) in t: f differs there after that time; correct period= or f"
            )

    def _find_mirror(self) -> None:
        """Set ``mirror_shifted`` by testing whether f has the mirror at the same time or half a period later; raise an error if neither holds."""
        if self.mirror is None:
            return
        p, (x, t, period) = self.values.start, self._random_states(4, 1.0)
        wanted = self.mirrored(self.field(x, p, t)) - self.mirror(np.zeros(len(self.x0)))
        size = TINY + np.abs(wanted).max()
        for self.mirror_shifted in (True, False):
            found = self.field(self.mirrored(x), p, t + (0.5 * period if self.mirror_shifted else 0.0))
            if np.abs(found - wanted).max() <= self.settings.agree * size:
                return
        raise ValueError(
            "mirror: f(R x, p, t) is neither R f(x, p, t) nor R f(x, p, t + period/2); leave mirror= out, or correct it"
        )

    # ------------------------------------------------------------------ solutions
    @abstractmethod
    def equilibria(
        self, parameter: str | None = None, values: Mapping[str, float] | None = None
    ) -> AlgebraicProblem:
        """Return the equilibria as a continuation problem."""

    @abstractmethod
    def cycles(self, field: Field, u: np.ndarray, counts: tuple[int, int, int], sizes: Sizes) -> Problem:
        """Return the problem of cycles; for `counts` and `sizes` see :class:`contvines.flows.cycle_mesh.CycleMesh`."""

    @abstractmethod
    def attractor_at(
        self,
        values: Mapping[str, float],
        x0: ArrayLike | None = None,
        *,
        longest: int = 64,
        doublings: int = 12,
    ) -> Any:
        """Return the cycle on which a motion settles, a :class:`contvines.flows.orbit.CycleOrbit`."""

    @abstractmethod
    def cycle_at(self, values: Mapping[str, float], times: ArrayLike, states: ArrayLike) -> Any:
        """Return the cycle near given states."""

    @abstractmethod
    def population_at(
        self,
        values: Mapping[str, float],
        over: str | None = None,
        box: Sequence[tuple[float, float]] | None = None,
        around: np.ndarray | None = None,
    ) -> Population:
        """Return a population of starts."""

    @abstractmethod
    def simulated_attractors(self, problem: Problem, p: float, starts: int) -> list[dict[str, Any]]:
        """Simulate starts and list what they settle on."""

    @abstractmethod
    def known(self, problem: Problem, u: np.ndarray, p: float) -> dict[str, Any]:
        """Return a stable solution as an entry of `simulated_attractors`."""

    # ------------------------------------------------------------------ measures
    @property
    def of_cycles(self) -> dict[str, str]:
        """Part of a cycle's description: its word in tables."""
        return {"word": "cycle"}

    @property
    def own_measures(self) -> tuple[str, ...]:
        """Names of further measures, which not every flow has."""
        return ()

    def measure_of(self, what: str, state: str) -> str:
        """Return the name of the measure for the largest, smallest or mean value of a state."""
        return f"{what} {state}"

    def measure_own(self, name: str, problem: Problem, u: np.ndarray, p: float) -> float:
        """Return the value of one of ``own_measures``."""
        raise KeyError(name)

    # ------------------------------------------------------------------ events that stop
    def border_kind(self, k: int) -> str:
        """Return the kind of border at which a motion touches event k."""
        return "event"

    def beyond(self, problem: Problem, point: BorderPoint, k: int) -> list[Seed]:
        """Return the motions beyond a border at which one touches event k: none."""
        return []

    def dead_end(self, k: int, x: np.ndarray, when: float | None = None) -> str:
        """Return the sentence that event k stops the motion: with the state, and the time in a cycle's period."""
        place = ", ".join(f"{name} = {value:.6g}" for name, value in zip(self.states, x, strict=True))
        ahead = "" if when is None else f" at t = {when:.6g} of its period"
        return f"the event {self.events.names[k]} stops the motion: it is zero{ahead}, where {place}"

    # ------------------------------------------------------------------ files
    def rebuilt_by(self, importable: bool) -> str | None:
        """Return the name of the factory that rebuilds the flow's problems; None if its functions cannot be imported."""
        return "contvines.flows.files:from_description" if importable or self.origin else None

    def described(self) -> dict[str, Any]:
        """Return the data of the flow beside its functions, as part of ``describe()``."""
        period, changed = self.given_period, self.settings.changed()
        address, _ = addresses({"period": period if callable(period) else None})
        return {
            "degree": self.degree,
            "error": self.error,
            **({"settings": changed} if changed else {}),
            "period": address["period"] if callable(period) else period,
            "x0": self.x0.tolist(),
            "scale": self._scale(),
            "states": None if self.given_states is None else list(self.states),
            "file": None if self.origin is None else list(self.origin),
        }

    def describe(self) -> dict[str, Any]:
        """Return name, start, and the data from which the flow is rebuilt if its functions can be imported."""
        address, importable = addresses(
            {**self.given, "period": self.given_period if callable(self.given_period) else None}
        )
        return {
            "name": self.name,
            "parameter": self.values.varying,
            "u0": self.x0.tolist(),
            "p0": self.values.given(),
            "scale": self._scale(),
            "callables": address,
            "flow": self.described(),
            "factory": self.rebuilt_by(importable),
        }

    def _scale(self) -> list[float] | None:
        scale = given_scale(self.given_scale, len(self.x0))
        return None if scale is None else scale.tolist()


def is_number(given: object) -> bool:
    return isinstance(given, (int, float, np.integer, np.floating)) and not isinstance(given, bool)


def period_of(given: Callable | float | None, values: ParameterSet) -> Callable | None:
    """Return the period of f in time as a function of the parameters; None for an autonomous flow.

    Raises
    ------
    ValueError
        If the period at the start is not a positive number.
    """
    if given is None:
        return None
    if not (callable(given) or is_number(given)):
        raise ValueError(f"period = {given!r} must be a positive number or a function of p")
    period = given if callable(given) else lambda p: float(given)
    try:
        length = period(values.at(values.start))
    except Exception as error:  # a user's function may fail in any way
        raise ValueError(f"period raises {type(error).__name__}: {error}, at the start") from error
    if not (is_number(length) and 0.0 < length < np.inf):
        raise ValueError(f"period is {length!r} at the start; it must be a positive number there")
    return period
