"""The equations F(u, p) = 0 of a declared machine's orbits with one word: unknowns, data, kernels in plain Python round compiled flights."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from contvines.core.library import native
from orbits.flows.page import flights, sampling
from orbits.flows.page.margins import fill_margins
from orbits.flows.page.pieces import TURN_OF_PHASE, Pieces
from orbits.flows.plain_kernels import PlainKernels
from orbits.flows.protocol import Approach
from orbits.settings import SOLVING


class PageKernels(PlainKernels[Pieces, flights.Work]):
    """The functions that a continuation calls; plain Python round integrated flights."""

    column = 3
    accepted = SOLVING.residual
    patience = 0.5

    def linearise(self, data: Pieces, u: np.ndarray, p: float, work: flights.Work) -> float:
        """See `orbits.flows.page.flights.linearise`."""
        return flights.linearise(data, u, p, work)

    def fill(self, data: Pieces, work: flights.Work, matrix: np.ndarray) -> None:
        """See `orbits.flows.page.flights.fill`."""
        flights.fill(data, work, matrix)

    def bordered(
        self,
        data: Pieces,
        work: flights.Work,
        border: np.ndarray,
        target: float,
        step: np.ndarray,
        tangent: np.ndarray,
    ) -> float:
        """Of a long cycle by blocks."""
        if data.dimension > flights.CYCLIC and not data.pinned and native():
            return flights.by_blocks(data, work, border, target, step, tangent)
        return super().bordered(data, work, border, target, step, tangent)

    def assign(self, data: Pieces, other: Pieces, value: float) -> None:
        """Give the parameter that varies in ``other`` a value in ``data``, in place."""
        data.params[other.index] = value
        data.base_numbers[:, other.index] = value

    def flip(self, data: Pieces, work: flights.Work, sign: float) -> None:
        """Turn F_u to perturbations that change sign over the period (sign = -1), and back (sign = 1)."""
        work.following[-1] *= -1.0

    def transpose(self, data: Pieces, work: flights.Work, column: np.ndarray, other: flights.Work) -> None:
        """The transposed F_u, with another last column, into another workspace."""
        for name in ("own", "following", "drift", "still", "numbers"):
            getattr(other, name)[:] = getattr(work, name)
        other.derivative.reshape(-1)[:] = column
        other.turned[0] = 1.0

    def matrix(self, data: Pieces, work: flights.Work) -> np.ndarray:
        """F_u as it stands in a workspace, shape (N, N)."""
        found = np.zeros((data.dimension, data.dimension))
        flights.fill(data, work, found)
        return found

    def inspect(self, data: Pieces, u: np.ndarray, p: float, work: flights.Work, row: np.ndarray) -> None:
        """Multipliers as (re, im) pairs, then the margins, into `row`."""
        m = data.n_multipliers
        row[: 2 * m].view(np.complex128)[:] = flights.multipliers(data, work)
        fill_margins(data, u, work, row[2 * m :])


KERNELS = PageKernels()


class PageEquations(Pieces):
    """Periodic orbits with a given word, against one parameter of a declared machine; made as `Pieces` are."""

    kernels = KERNELS

    @property
    def data(self) -> PageEquations:
        """Itself."""
        return self

    # ------------------------------------------------------------------ numerics
    @cached_property
    def scratch(self) -> flights.Work:
        """A workspace for single calls, whose contents nobody relies on."""
        return self.workspace()

    def workspace(self) -> flights.Work:
        """Arrays for the kernels."""
        return flights.workspace(self.length, self.size, self.base_numbers.shape[1])

    def approach(self, u: np.ndarray, p: float, place: int, near: float) -> Approach:
        """Of the impact at a place: the rate of its wall's gap; the wall's push changes it."""
        compiled, d = self.machine.compiled, self.size + 1
        node = u[place * d : (place + 1) * d]
        numbers = compiled.numbers(self.values(p), self.word.entries(place))
        clock = node[:1] if self.forced else np.zeros(1)
        row = compiled.approach(self.letters[place].contact)(node[None, 1:], clock, numbers[None])[0]
        return Approach(float(row[0]), np.append(0.0, row[1:d]), 0.0, np.append(0.0, row[d:]))

    def through_flights(self, u: np.ndarray, p: float) -> tuple[np.ndarray, None] | None:
        """Derivatives of each node by the one before, the mirror in the last."""
        if not np.isfinite(self.kernels.linearise(self, u, p, self.scratch)):
            return None
        with np.errstate(all="ignore"):
            return flights.factors(self, self.scratch), None

    # ------------------------------------------------------------------ shapes
    def expand(self, u: np.ndarray, p: float | np.ndarray | None = None) -> np.ndarray:
        """Nodes of the whole cycle, shape (..., L, n + 1)."""
        u = np.asarray(u, dtype=float)
        nodes = u.reshape(*u.shape[:-1], self.length, self.size + 1)
        if not self.symmetric:
            return nodes
        return np.concatenate([nodes, self._image(nodes)], axis=-2)

    def _image(self, nodes: np.ndarray) -> np.ndarray:
        image = -nodes
        image[..., 0] = nodes[..., 0] + self.shift
        return image

    def reduce(self, nodes: np.ndarray) -> np.ndarray:
        """Unknowns, shape (N,), from the nodes of the whole cycle; of a motion without events the first node tells the others."""
        often = self.length * (2 if self.symmetric else 1) // self.periods
        apart = (
            float(np.ptp(nodes[:2, 0])) * often / TURN_OF_PHASE
        )  # 1 where they are as far from one another as here
        if not len(self.word) and self.length > 1 and abs(apart - 1.0) > 0.1:
            nodes = sampling.strobed(self.machine, self.word, self.periods, nodes[0], self.params, often)
        return np.array(nodes[: self.length], dtype=float, order="C").ravel()
