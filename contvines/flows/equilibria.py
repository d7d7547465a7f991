"""Equilibria of an autonomous flow: an AlgebraicProblem from whose Hopf points cycles leave."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..problems.algebraic import AlgebraicProblem
from ..problems.functions import NotEvaluable, Operator
from ..problems.protocol import Embedding, Seed, margin_of
from . import mesh
from .equilibrium import Equilibrium

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from scipy.sparse import csc_array

    from ..problems.populations import Population
    from ..problems.protocol import BorderPoint
    from .flow import Flow

FIRST = 20  # intervals of a cycle that has just been born


class Equilibria(AlgebraicProblem):
    """Equilibria of x' = f(x, p).

    Parameters
    ----------
    flow : FlowProblem
    f, x0, params, parameter, jacobian, derivative, mirror, name, scale
        As :class:`contvines.AlgebraicProblem` has them.
    """

    mixed_rows = False  # f(R x) = R f(x), as cycles have it

    def __init__(
        self,
        flow: Flow,
        f: Callable,
        x0: np.ndarray,
        params: float | Mapping[str, float],
        parameter: str,
        jacobian: Callable | None,
        derivative: Callable | Mapping[str, Callable] | None,
        mirror: Callable[[np.ndarray], ArrayLike] | ArrayLike | None,
        name: str,
        scale: ArrayLike | None,
    ) -> None:
        self.flow = flow
        super().__init__(f, x0, params, parameter, jacobian, derivative, "flow", mirror, name, scale)
        self.n_margins = len(flow.events)

    @property
    def default_measure(self) -> str:
        """The first state, as it is called on cycles."""
        return next(iter(self.flow.of_states))

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Norm and coordinates; what is measured on cycles has the values of a cycle that stands still."""
        return (
            *super().measure_names,
            *self.flow.states,
            *self.flow.of_states,
            "period",
            *self.flow.own_measures,
        )

    def unknown_name(self, i: int) -> str:
        """The state."""
        return self.flow.states[i]

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Measures for an array of solutions."""
        own = [name for name in names if name in super(Equilibria, self).measure_names]
        found = super().measures(own, u, p)
        states = np.atleast_2d(u)
        for name in names:
            if name in found:
                continue
            if name not in self.measure_names:
                raise KeyError(f"there is no measure {name!r}; choose from {', '.join(self.measure_names)}")
            if name in self.flow.own_measures:
                pairs = zip(states, np.broadcast_to(p, len(states)).tolist(), strict=True)
                found[name] = np.array([self.flow.measure_own(name, self, *pair) for pair in pairs])
            elif name == "period":
                found[name] = np.full(len(states), np.nan)
            else:
                own = name in self.flow.states
                place = self.flow.states.index(name) if own else self.flow.of_states[name][1]
                found[name] = states[:, place].copy()
        return found

    # ------------------------------------------------------------------ events that stop
    def margins(self, u: np.ndarray, p: float) -> np.ndarray:
        """The events, positive where motions are."""
        try:
            return self.flow.events(u[None, : self.node], self.values.at(p))[0]
        except NotEvaluable:
            return np.full(self.n_margins, np.nan)

    def margin_kind(self, j: int) -> str:
        """See :meth:`FlowProblem.border_kind`."""
        return self.flow.border_kind(j)

    def touching(self, u: np.ndarray, p: float, k: int) -> tuple[np.ndarray, None]:
        """The equilibrium itself."""
        return u[: self.node], None

    def beyond(self, point: BorderPoint) -> list[Seed]:
        """See :meth:`FlowProblem.beyond`."""
        return self.flow.beyond(self, point, margin_of(point))

    def dead_end(self, point: BorderPoint) -> str:
        """See :meth:`FlowProblem.dead_end`."""
        return self.flow.dead_end(self, point, margin_of(point))

    def _matrix(self, u: np.ndarray, p: float) -> np.ndarray | csc_array | Operator:
        return self.functions.jacobian(np.asarray(u, dtype=float)[: self.node], p)

    def orbit(self, u: np.ndarray, p: float) -> Equilibrium:
        """The equilibrium, with its eigenvalues."""
        x, matrix = np.array(u, dtype=float)[: self.node], self._matrix(u, p)
        values = np.zeros(0, dtype=complex)
        if not isinstance(matrix, Operator):
            full = matrix if isinstance(matrix, np.ndarray) else np.asarray(matrix.toarray())
            values = np.sort_complex(np.linalg.eigvals(full))[::-1]
        states = dict(zip(self.flow.states, x.tolist(), strict=True))
        return Equilibrium(
            self.parameter, float(p), x, states, {**self.parameters, self.parameter: float(p)}, values
        )

    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> list[Embedding]:
        """At a Hopf point: the cycles that are born there, with the direction in which their amplitude grows; of each pair where two are critical."""
        if kind != "hopf" or isinstance(matrix := self._matrix(u, p), Operator):
            return []
        found, own = np.linalg.eig(matrix if isinstance(matrix, np.ndarray) else np.asarray(matrix.toarray()))
        values, vectors = np.asarray(found, dtype=np.complex128), own.astype(complex)
        upper = np.flatnonzero(values.imag > 0.0)
        if not len(upper):
            return []
        distances, size = np.abs(values[upper].real), float(np.abs(values).max())
        order = np.argsort(distances, kind="stable")
        critical = [
            upper[k] for k in order if k == order[0] or distances[k] < self.flow.settings.critical * size
        ]
        return [cycles_at(self, u, p, float(values[k].imag), vectors[:, k]) for k in critical]

    def simulated_attractors(self, p: float, starts: int = 16) -> list[dict[str, Any]]:
        """See :meth:`FlowProblem.simulated_attractors`."""
        return self.flow.simulated_attractors(self, p, starts)

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]:
        """See :meth:`FlowProblem.known`."""
        return self.flow.known(self, u, p)

    def population(
        self, over: str | None = None, *, box: Sequence[tuple[float, float]] | None = None, **values: float
    ) -> Population:
        """Starts round the flow's start, and what they settle on."""
        return self.flow.population_at({**self.values.values, **values}, over or self.parameter, box)

    def describe(self) -> dict[str, Any]:
        """Name, start, and how to build the problem again."""
        about = super().describe()
        about["factory"] = self.flow.rebuilt_by(bool(about.get("factory")))
        return {**about, "word": "equilibrium", "flow": self.flow.described()}


def cycles_at(problem: Equilibria, u: np.ndarray, p: float, omega: float, q: np.ndarray) -> Embedding:
    """The problem of the cycles that are born at a Hopf point, the equilibrium as a cycle, and the direction of the cycles."""
    flow, d = problem.flow, problem.node
    scales = problem.scales
    scale = np.ones(d) if scales is None else scales.unknowns[:d]
    unit = 1.0 if scales is None else scales.parameter
    values = problem.values.against(problem.parameter, {problem.parameter: p})
    widths = np.full(FIRST, 1.0 / FIRST)
    period = 2.0 * np.pi / omega
    field = flow.field.against(values)
    m = flow.degree
    still = np.concatenate([np.tile(u[:d], FIRST * m), [period], widths])
    cycles = flow.cycles(field, still, (FIRST, 1, 1), (scale, period, unit))
    scale = cycles.node_scale
    angles = 2.0 * np.pi * mesh.node_places(cycles.rule, widths)
    q = q / np.linalg.norm(q / scale)
    wave = np.real(np.exp(1j * angles)[:, None] * q)
    direction = np.concatenate([wave.reshape(-1), np.zeros(1 + FIRST + 1)])
    return Embedding(cycles, still, direction, "hopf")
