"""Starts of a problem, and the motions that they settle on.

The contract, in words:

1. ``population.starts(count, seed, p)`` draws starts, shape (count, n), over a box that the machine knows; the same for the
   same seed.
2. ``population.settle(starts, p)`` returns ``(motions, index, mirrored)``: the motions reached, each once; which of them each
   start reaches; and whether it is the mirror image that it reaches. The result depends on the starts alone.
3. A motion has ``kind``, ``word``, ``periods``, ``exponent`` and ``error`` (the largest Lyapunov exponent per period and its
   standard error; nan where it recurs), and ``problem`` and ``u`` where it is a solution that can be continued, else None;
   ``state``, a state on it from which it goes on, where there is one.
4. ``population.about`` is what the graph says of the machine (JSON-able); ``population.names`` are the coordinates of a start, ``population.box(p)`` their ranges, shape (n, 2).
   Optional: ``population.notation``, labels of axes by name of coordinate; ``population.leftward``, the coordinate that a picture shows growing from right to left.
5. ``population.brief`` is how many values and how many starts at each a brief look after a diagram takes: few, so that it costs a
   fraction of the diagram; ``population.price``, how many times as long as in closed form a solution takes; ``population.across`` how many starts each way a picture of basins has where no number is given.
6. ``population.embedded(motion.state, p)`` returns ``(problem, u)`` of unstable cycles that a chaotic motion passes near, each once.
   Windows of periodic motion are born in pairs of which the unstable one lives on in the chaos beside them: traced back, it
   leads into windows that are too narrow for starts to meet.
7. ``population.returning(starts, p)`` returns ``(problem, u)`` of cycles, stable or not, to which Newton's method on the return map leads
   from starts, each once: it reaches a cycle from far more starts than settle on it. What is known in closed form is among them.
8. ``population.closed(p)`` returns ``(problem, u)`` of the motions known in closed form, stable or not, each once.
9. ``population.restored(problem.describe(), u, p)`` returns the problem of a motion that `settle`, `embedded` or `returning` had at p, measured as theirs; None
   where it cannot be rebuilt.
10. ``population.observed(motion.state, p, periods)`` returns the measures by name of the motion through this state, from simulation, of what does not recur
    over at least so many periods; none without a state.
11. ``population.work`` counts the forcing periods (steps of a map) simulated so far, for the budget of an atlas.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np

from ..shared.motions import Motion

if TYPE_CHECKING:
    from .protocol import Problem


@runtime_checkable
class Population(Protocol):
    """Starts of a problem and what becomes of them; see the contract at the top of this module."""

    work: float

    @property
    def parameter(self) -> str: ...
    @property
    def about(self) -> dict[str, Any]: ...
    @property
    def names(self) -> tuple[str, ...]: ...

    @property
    def brief(self) -> tuple[int, int]: ...

    @property
    def across(self) -> int: ...

    @property
    def price(self) -> float: ...

    def box(self, p: float) -> np.ndarray: ...

    def starts(self, count: int, seed: int, p: float) -> np.ndarray: ...

    def settle(
        self, starts: np.ndarray, p: float
    ) -> tuple[Sequence[Motion[Problem]], np.ndarray, np.ndarray]: ...

    def embedded(self, state: np.ndarray, p: float) -> Sequence[tuple[Problem, np.ndarray]]: ...

    def returning(self, starts: np.ndarray, p: float) -> Sequence[tuple[Problem, np.ndarray]]: ...

    def closed(self, p: float) -> Sequence[tuple[Problem, np.ndarray]]: ...

    def restored(self, description: Mapping[str, Any], u: np.ndarray, p: float) -> Problem | None: ...

    def observed(self, state: np.ndarray | None, p: float, periods: float = 0.0) -> dict[str, float]: ...


class StartsInBox:
    """Starts in a box; see the contract in `contvines.problems.populations`.

    Parameters
    ----------
    name : str
        Of the map or flow.
    parameter : str
    box : sequence of (low, high), optional
        One pair per state; by default round the points, widened by their extent on every side.
    points : ndarray, shape (n, d)
        States that are known.
    lengths : float or ndarray, shape (d,)
        By so much the box is widened at least.

    Raises
    ------
    ValueError
        If the box has not one pair low < high per state.
    """

    price = 1.0

    def __init__(
        self,
        name: str,
        parameter: str,
        box: Sequence[tuple[float, float]] | None,
        points: np.ndarray,
        lengths: float | np.ndarray,
    ) -> None:
        self.name, self.parameter, self.node = name, parameter, points.shape[1]
        self.work = 0.0
        """Steps of a map, or periods of a flow, so far, those that solve for cycles included."""
        if box is None:
            reach = np.maximum(np.ptp(points, axis=0), np.maximum(lengths, np.abs(points).max(axis=0)))
            self._box = np.column_stack([points.min(axis=0) - reach, points.max(axis=0) + reach])
            return
        try:
            self._box = np.array(box, dtype=float).reshape(-1, 2)
        except (TypeError, ValueError):
            self._box = np.empty(0)
        if (
            self._box.shape != (self.node, 2)
            or not np.isfinite(self._box).all()
            or not (self._box[:, 0] < self._box[:, 1]).all()
        ):
            raise ValueError(
                f"box = {box!r}: give {self.node} pairs (low, high) with low < high, one per state"
            )

    @property
    def about(self) -> dict[str, Any]:
        """The name of the map or flow."""
        return {"name": self.name}

    def box(self, p: float) -> np.ndarray:
        """Ranges of the starts, shape (d, 2)."""
        return self._box

    def closed(self, p: float) -> list[tuple[Any, np.ndarray]]:
        """Motions known in closed form: none."""
        return []

    def observed(self, state: np.ndarray | None, p: float, periods: float = 0.0) -> dict[str, float]:
        """Measures of a motion that recurs nowhere: none."""
        return {}
