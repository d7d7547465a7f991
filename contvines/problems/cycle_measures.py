"""What is told of the cycles of a map: measures, points, eigenvectors, iteration."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .outputs import Outputs
from .spectra import vectors_of

if TYPE_CHECKING:
    from .derivatives import Differentiated
    from .pieces import Pieces


class CycleMeasures:
    """What is measured on cycles of ``cycle`` points with ``node`` coordinates each, the user's ``outputs`` included."""

    outputs: Outputs
    node: int
    cycle: int
    pieces: Pieces
    functions: Differentiated

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Mean, smallest and largest of each coordinate over the cycle, and the coordinates of its first point."""
        names = [f"{what}{j}" for what in ("x", "mean", "min", "max") for j in range(self.node)]
        return (*self.outputs.names, "norm", *names)

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Measures for an array of solutions."""
        nodes = np.asarray(u, dtype=float).reshape(-1, self.cycle, self.node)
        own = [name for name in names if name in self.outputs.names]
        result = self.outputs.measures(own, nodes[:, 0], p)
        for name in names:
            if name not in self.measure_names:
                raise KeyError(f"there is no measure {name!r}; choose from {', '.join(self.measure_names)}")
            if name in own:
                continue
            what = name.rstrip("0123456789")
            j = int(name[len(what) :] or 0)
            if what == "norm":
                result[name] = np.sqrt((nodes**2).sum(axis=(1, 2)) / self.cycle)
            elif what == "x":
                result[name] = nodes[:, 0, j]
            else:
                result[name] = getattr(nodes[:, :, j], what)(axis=1)
        return result

    def at_each_point(self, name: str, u: np.ndarray, p: np.ndarray) -> np.ndarray | None:
        """A coordinate ``x0``, ``x1`` ... at every point of the cycle, shape (m, n); None for other measures."""
        if name not in {f"x{j}" for j in range(self.node)}:
            return None
        return np.asarray(u, dtype=float).reshape(-1, self.cycle, self.node)[:, :, int(name[1:])]

    def eigenvectors(self, u: np.ndarray, p: float, values: np.ndarray) -> np.ndarray:
        """Eigenvectors of the product of the Jacobians along the cycle, as columns, in the order of its eigenvalues."""
        product = np.eye(self.node)
        for i, x in enumerate(np.asarray(u, dtype=float).reshape(self.cycle, self.node)):
            self.pieces.current = i
            product = self.functions.jacobian(x, p) @ product
        return vectors_of(product, values)

    def orbit(self, u: np.ndarray, p: float) -> np.ndarray:
        """The points of the cycle, shape (n, d)."""
        return np.array(u).reshape(self.cycle, self.node)

    def replay(self, u: np.ndarray, p: float) -> float:
        """Largest distance after iterating each point of the cycle once."""
        nodes = np.asarray(u, dtype=float).reshape(self.cycle, self.node)
        worst = 0.0
        for i, x in enumerate(nodes):
            self.pieces.current = i
            gap = self.functions.value(x, p) - nodes[(i + 1) % self.cycle]
            worst = max(worst, float(np.abs(gap).max()))
        return worst
