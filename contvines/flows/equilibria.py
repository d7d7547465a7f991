"""Equilibria of an autonomous flow: an AlgebraicProblem with branches of cycles at its Hopf points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.numbers import complex_figures, figures, pairs

from ..problems.algebraic import AlgebraicProblem
from ..problems.functions import NotEvaluable, Operator
from ..problems.protocol import Embedding, Seed, Solution, margin_of
from ..shared.motions import attracts, marginal_text, onto_axis
from . import mesh

if TYPE_CHECKING:
    from ..problems.abilities import Population
    from ..problems.protocol import BorderPoint
    from .flow import Flow


FIRST = 20  # mesh intervals of the first cycles at a Hopf point


class Equilibria(AlgebraicProblem):
    """Equilibria of the autonomous flow x' = f(x, p)."""

    mixed_rows = False  # a mirror must fulfil f(R x) = R f(x), as cycles need it

    def __init__(self, flow: Flow, params: float | Mapping[str, float], parameter: str) -> None:
        self.flow, given = flow, flow.given
        super().__init__(
            given["F"],
            flow.x0,
            params,
            parameter,
            given["jacobian"],
            given["derivative"],
            "flow",
            given["mirror"],
            flow.name,
            flow.given_scale,
        )
        self.n_margins = len(flow.events)

    @property
    def default_measure(self) -> str:
        """Largest value of the first state: equal to that state, under its name for cycles."""
        return next(iter(self.flow.of_states))

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Norm and coordinates, and the measures of cycles, evaluated for a cycle at rest."""
        flow = self.flow
        return (*super().measure_names, *flow.states, *flow.of_states, "period", *flow.own_measures)

    def unknown_name(self, i: int) -> str:
        """Return the name of state i."""
        return self.flow.states[i]

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Return the named measures, each of shape (m,), of m equilibria."""
        flow, states = self.flow, np.atleast_2d(u)
        places = {name: j for j, name in enumerate(flow.states)} | {
            name: j for name, (_, j) in flow.of_states.items()
        }
        found = {}
        for name in names:
            if name in super().measure_names:
                found |= super().measures([name], u, p)
            elif name in flow.own_measures:
                pairs = zip(states, np.broadcast_to(p, len(states)).tolist(), strict=True)
                found[name] = np.array([flow.measure_own(name, self, *pair) for pair in pairs])
            elif name == "period":
                found[name] = np.full(len(states), np.nan)
            elif name in places:
                found[name] = states[:, places[name]].copy()
            else:
                raise KeyError(f"there is no measure {name!r}; choose from {', '.join(self.measure_names)}")
        return found

    # ------------------------------------------------------------------ events that stop
    def margins(self, u: np.ndarray, p: float) -> np.ndarray:
        """Return the event functions, positive on the side of the motions; NaN if one cannot be evaluated."""
        try:
            return self.flow.events(u[None, : self.node], self.values.at(p))[0]
        except NotEvaluable:
            return np.full(self.n_margins, np.nan)

    def margin_kind(self, j: int) -> str:
        """See :meth:`FlowProblem.border_kind`."""
        return self.flow.border_kind(j)

    def beyond(self, point: BorderPoint) -> list[Seed]:
        """See :meth:`FlowProblem.beyond`."""
        return self.flow.beyond(self, point, margin_of(point))

    def dead_end(self, point: BorderPoint) -> str:
        """See :meth:`FlowProblem.dead_end`."""
        return self.flow.dead_end(margin_of(point), point.u[: self.node])

    def _matrix(self, u: np.ndarray, p: float) -> np.ndarray | None:
        """df/dx as an array; None if it is a LinearOperator."""
        matrix = self.functions.jacobian(np.asarray(u, dtype=float)[: self.node], p)
        if isinstance(matrix, np.ndarray | Operator):
            return matrix if isinstance(matrix, np.ndarray) else None
        return np.asarray(matrix.toarray())

    def orbit(self, u: np.ndarray, p: float) -> Equilibrium:
        """Return the equilibrium with its eigenvalues."""
        x, matrix = np.array(u, dtype=float)[: self.node], self._matrix(u, p)
        values = np.zeros(0) if matrix is None else np.linalg.eigvals(matrix)
        states = dict(zip(self.flow.states, x.tolist(), strict=True))
        parameters = {**self.parameters, self.parameter: float(p)}
        return Equilibrium(self.parameter, float(p), x, states, parameters, np.sort_complex(values)[::-1])

    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> list[Embedding]:
        """Return, at a Hopf point, the cycles that are born there, with the direction of growing amplitude; one for each critical pair of eigenvalues."""
        if kind != "hopf" or (matrix := self._matrix(u, p)) is None:
            return []
        values, vectors = (np.asarray(part, dtype=np.complex128) for part in np.linalg.eig(matrix))
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
        """Return a population of starts around the flow's start."""
        return self.flow.population_at({**self.values.values, **values}, over or self.parameter, box)

    def describe(self) -> dict[str, Any]:
        """Return name, start, and the data from which the problem is rebuilt."""
        data = super().describe()
        data["factory"] = self.flow.rebuilt_by(bool(data.get("factory")))
        return {**data, "word": "equilibrium", "flow": self.flow.described()}


def cycles_at(problem: Equilibria, u: np.ndarray, p: float, omega: float, q: np.ndarray) -> Embedding:
    """Return the problem of the cycles that are born at a Hopf point, the equilibrium as a cycle of it, and the direction of growing amplitude.

    Parameters
    ----------
    problem : Equilibria
    u, p
        The Hopf point.
    omega : float
        Imaginary part of the critical eigenvalue.
    q : ndarray of complex, shape (d,)
        Its eigenvector.
    """
    flow, d, scales = problem.flow, problem.node, problem.scales
    scale, unit = (np.ones(d), 1.0) if scales is None else (scales.unknowns[:d], scales.parameter)
    field = flow.field.against(problem.values.against(problem.parameter, {problem.parameter: p}))
    widths, period = np.full(FIRST, 1.0 / FIRST), 2.0 * np.pi / omega
    unknowns = np.concatenate([np.tile(u[:d], FIRST * flow.degree), [period], widths])
    cycles = flow.cycles(field, unknowns, (FIRST, 1, 1), (scale, period, unit))
    assert flow.sizes is not None  # set by the first call of flow.cycles
    q = q / np.linalg.norm(q / flow.sizes[0])
    angles = 2.0 * np.pi * mesh.node_places(mesh.rule(flow.degree), widths)
    wave = np.real(np.exp(1j * angles)[:, None] * q)
    direction = np.concatenate([wave.reshape(-1), np.zeros(1 + FIRST + 1)])
    return Embedding(cycles, unknowns, direction, "hopf")


@dataclass(frozen=True)
class Equilibrium(Solution):
    """An equilibrium of a flow.

    Attributes
    ----------
    parameter : str
    value : float
        Value of the parameter.
    u : ndarray, shape (d,)
    states : dict of float
        The states u by name.
    parameters : dict of float
    eigenvalues : ndarray of complex
        Eigenvalues of the Jacobian; empty if the Jacobian is matrix-free.
    marginal : bool
        Whether it belongs to a special point, at which an eigenvalue lies on the imaginary axis by definition.
    """

    states: dict[str, float] = field(default_factory=dict)
    parameters: dict[str, float] = field(default_factory=dict)
    eigenvalues: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=complex))
    marginal: bool = False

    @property
    def stable(self) -> bool | None:
        """Whether all eigenvalues have negative real parts. None if they are unknown, and at a special point unless one real part is positive."""
        if not self.eigenvalues.size:
            return None
        rates = np.real(self.eigenvalues)
        return attracts(rates, 0.0) if self.marginal else bool((rates < 0.0).all())

    def critical(self, near: float = 0.0) -> Equilibrium:
        """Return the equilibrium as that of a special point: the eigenvalue nearest to the imaginary axis is moved onto it."""
        return replace(self, eigenvalues=onto_axis(self.eigenvalues), marginal=True)

    def to_dict(self) -> dict[str, Any]:
        """Return the equilibrium as a JSON-able dict."""
        return {
            "parameter": self.parameter,
            "value": self.value,
            "u": self.u.tolist(),
            "equilibrium": dict(self.states),
            "stable": self.stable,
            "parameters": dict(self.parameters),
            "eigenvalues": pairs(self.eigenvalues),
        }

    def __str__(self) -> str:
        marginal = f"  ({marginal_text(self.eigenvalues, flow=True)})" if self.eigenvalues.size else ""
        nature = {True: "  (stable)", False: "  (unstable)", None: marginal}[self.stable]
        lines = [
            f"equilibrium{nature}",
            "  " + "  ".join(f"{name} = {figures(x)}" for name, x in self.states.items()),
            "  " + "  ".join(f"{name} = {value:.7g}" for name, value in self.parameters.items()),
        ]
        if self.eigenvalues.size:
            lines.append(f"  eigenvalues: {complex_figures(self.eigenvalues)}")
        return "\n".join(lines)
