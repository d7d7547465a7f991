"""Events that stop a motion: functions of the state that keep their sign as long as it goes on."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..problems.functions import NotEvaluable, ParameterSet

if TYPE_CHECKING:
    from ..problems.functions import Parameters

FINER = 4  # places between two nodes at which the smallest value is looked for first
ROUNDS = 3  # each of which looks ...
CLOSER = 16  # ... so many times as closely


class Events:
    """Functions (x, p), of forced flows (x, p, t), of which none changes its sign along a motion; the sign is that at the flow's start.

    Parameters
    ----------
    given : mapping of str to callable, or None
    forced : bool
    start : ndarray, shape (d,)
    values : ParameterSet

    Raises
    ------
    ValueError
        If a name or a function cannot be used, or one is zero or no finite number at the start.
    """

    def __init__(
        self, given: Mapping[str, Callable] | None, forced: bool, start: np.ndarray, values: ParameterSet
    ) -> None:
        if given is not None and not isinstance(given, Mapping):
            raise ValueError(
                f"events = {given!r} must be functions by name, for example events={{'wall': lambda x, p: 1 - x[0]}}"
            )
        self.given: dict[str, Callable] = dict(given or {})
        self.forced, self.names = forced, tuple(self.given)
        arguments = "(x, p, t)" if forced else "(x, p)"
        for name, function in self.given.items():
            if not (isinstance(name, str) and callable(function)):
                raise ValueError(f"events: {name!r} must be a name with a function {arguments} -> number")
        self.signs = np.ones(len(self.given))
        try:
            first = self(start[None], values.at(values.start), np.zeros(1))[0]
        except NotEvaluable as error:
            raise ValueError(f"events: {error}") from error
        for name, value in zip(self.names, first, strict=True):
            if not np.isfinite(value) or value == 0.0:
                raise ValueError(
                    f"events: {name} is {value:g} at x0; its sign there says on which side motions are: move x0 off it"
                )
        self.signs = np.sign(first)

    def __len__(self) -> int:
        return len(self.given)

    def __call__(
        self, x: np.ndarray, parameters: Parameters | complex, t: np.ndarray | None = None
    ) -> np.ndarray:
        """Values at points (n, d), positive where motions are, shape (n, events).

        Raises
        ------
        NotEvaluable
            If a function fails or returns no number.
        """
        found = np.empty((len(x), len(self.given)))
        for k, (name, function) in enumerate(self.given.items()):
            try:
                found[:, k] = self._many(function, x, parameters, t)
            except Exception as error:  # a user's function may fail in any way
                raise NotEvaluable(f"the event {name} fails: {error}") from error
        return found * self.signs

    def _many(
        self, function: Callable, x: np.ndarray, parameters: Parameters | complex, t: np.ndarray | None
    ) -> np.ndarray | list[float]:
        def one(y: np.ndarray, s: float | None) -> float:
            return float(function(y, parameters, s) if self.forced else function(y, parameters))

        if len(x) > 2:
            try:
                more = (t,) if self.forced else ()
                together = np.asarray(function(x.T.copy(), parameters, *more), dtype=float)
                if together.shape == (len(x),) and together[-1] == one(x[-1], None if t is None else t[-1]):
                    return together
            except Exception:  # a function of one point may fail in any way when it is called with many
                pass
        times = [None] * len(x) if t is None else t
        return [one(y, s) for y, s in zip(x, times, strict=True)]

    def closest(
        self,
        motion: Callable[[np.ndarray], np.ndarray],
        edges: np.ndarray,
        period: float,
        parameters: Parameters | complex,
    ) -> tuple[np.ndarray, np.ndarray]:
        """The smallest value of each along a periodic motion, and the place where it has it, in units of the period.

        Parameters
        ----------
        motion : callable
            Places in units of the period -> states (n, d).
        edges : ndarray
            Places, in order, between which a function has one smallest value at most.
        """

        def values(places: np.ndarray) -> np.ndarray:
            return self(motion(places), parameters, places * period if self.forced else None)

        count, smallest, where = len(edges), np.empty(len(self)), np.empty(len(self))
        rough = values(edges)
        for k in range(len(self)):
            j = int(np.argmin(rough[:, k]))
            low, high = edges[j - 1] - (j == 0), edges[(j + 1) % count] + (j == count - 1)
            places, i = np.array([low, edges[j], high]), 1
            here = rough[[j - 1, j, (j + 1) % count], k]
            for _ in range(ROUNDS):
                places = np.linspace(low, high, CLOSER + 1)
                here = values(places)[:, k]
                i = min(max(int(np.argmin(here)), 1), CLOSER - 1)
                low, high = places[i - 1], places[i + 1]
            left, middle, right = here[i - 1 : i + 2]
            bend = left - 2.0 * middle + right
            step = 0.5 * (left - right) / bend if bend > 0.0 else 0.0
            step = min(max(step, -1.0), 1.0)
            smallest[k] = (
                middle - 0.125 * (right - left) ** 2 / bend if bend > 0.0 and abs(step) < 1.0 else here.min()
            )
            where[k] = places[i] + step * (places[1] - places[0])
        return smallest, where % 1.0

    def crossings(self, values: ParameterSet, p: float) -> Sequence[Callable]:
        """The functions as scipy's integrators want them, each of which ends the integration."""
        parameters = values.at(p)

        def stopping(k: int, function: Callable) -> Callable:
            def value(t: float, x: np.ndarray) -> float:
                return self.signs[k] * float(
                    function(x, parameters, t) if self.forced else function(x, parameters)
                )

            value.terminal, value.direction = True, -1.0  # pyright: ignore[reportFunctionMemberAccess]
            return value

        return [stopping(k, function) for k, function in enumerate(self.given.values())]
