"""What is measured on cycles of flows, and how one of them is handed to users."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import mesh
from .orbit import CycleOrbit

if TYPE_CHECKING:
    from .collocation import Rule

FINER = 4  # places between two nodes at which the largest value is looked for


class CycleMeasures:
    """Largest and smallest values of the coordinates, norm, period."""

    node: int
    rule: Rule
    parts: Any
    flow: Any

    @property
    def default_measure(self) -> str:
        """The largest value of the first state."""
        return next(iter(self.flow.of_states))

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Largest, smallest and mean value of each coordinate, the root mean square of the state, the period."""
        return ("norm", "period", *self.flow.of_states, *self.flow.own_measures)

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Measures for an array of solutions."""
        u = np.atleast_2d(u)
        p = np.broadcast_to(np.asarray(p, dtype=float).reshape(-1), (len(u),))
        for name in names:
            if name not in self.measure_names:
                raise KeyError(f"there is no measure {name!r}; choose from {', '.join(self.measure_names)}")
        found = [self._measured(names, *pair) for pair in zip(u, p.tolist(), strict=True)]
        return {name: np.array([values[i] for values in found]) for i, name in enumerate(names)}

    def _measured(self, names: Sequence[str], u: np.ndarray, p: float) -> list[float]:
        x, period, widths = self.parts(u, p)
        ends, r = mesh.closed(x), self.rule
        points = np.einsum("cj,ijk->ick", r.values, ends)
        share = widths[:, None] * r.weights
        result = []
        for name in names:
            if name in self.flow.own_measures:
                result.append(self.flow.measure_own(name, self, u, p))
                continue
            word, j = self.flow.of_states.get(name, (name, 0))
            if word == "norm":
                result.append(float(np.sqrt((share * (points**2).sum(axis=2)).sum())))
            elif word == "period":
                result.append(float(period))
            elif word == "mean":
                result.append(float((share * points[:, :, j]).sum()))
            else:
                sign = 1.0 if word == "max" else -1.0
                result.append(sign * self._largest(sign * ends[:, :, j]))
        return result

    def _largest(self, ends: np.ndarray) -> float:
        """The largest value of a piecewise polynomial, from a parabola through the largest of many of its values."""
        places = np.linspace(0.0, 1.0, FINER * self.rule.degree + 1)
        values = ends @ self.rule.interpolation(places).T
        i, j = np.unravel_index(int(np.argmax(values)), values.shape)
        j = int(np.clip(j, 1, len(places) - 2))
        left, middle, right = values[i, j - 1 : j + 2]
        bend = left - 2.0 * middle + right
        if not bend < 0.0:
            return float(values.max())
        top = middle - (right - left) ** 2 / (8.0 * bend)
        inside = abs(right - left) <= -2.0 * bend
        return float(max(top, values.max())) if inside else float(values.max())

    def orbit(self, u: np.ndarray, p: float) -> CycleOrbit:
        """The cycle."""
        return CycleOrbit(self, np.array(u, dtype=float), float(p))

    def replay(self, u: np.ndarray, p: float) -> float | None:
        """Largest distance of a simulation from the cycle; see :meth:`CycleOrbit.replay`."""
        return self.orbit(u, p).replay()
