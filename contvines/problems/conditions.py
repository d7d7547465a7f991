"""Conditions that select one solution from a continuous family of equivalent ones.

A continuous symmetry moves a solution along a family of solutions, so that dF/du is singular. With one condition g(u, p) = 0 for
each such symmetry, and one more unknown a for each condition, the system

    F(u, p) + a c = 0,   g(u, p) = 0,   c = dg/du at the start

is regular, and a = 0 on its solutions if c is not orthogonal to the left null vector (if F is a gradient, it never is).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import null_space

from .derivatives import Differentiated
from .functions import ParameterSet
from .spectra import without_roundoff


class Conditions:
    """Conditions, and the extended equations with one unknown (a multiplier) for each.

    Parameters
    ----------
    given : list of callable
        (u, p) -> number.
    functions : Differentiated
        The equations, for the lengths over which unknowns vary.
    u : ndarray, shape (n,)
        The start.

    Raises
    ------
    ValueError
        If a condition cannot be evaluated at the start or does not depend on u there.
    """

    def __init__(self, given: list[Callable], functions: Differentiated, u: np.ndarray) -> None:
        self.given, self.count, self.node = given, len(given), len(u)

        def all_values(u: np.ndarray, p: float) -> np.ndarray:
            return np.array([np.asarray(g(u, p)).reshape(-1)[0] for g in given])

        self.functions = functions.of(all_values, name="conditions", rows=len(given))
        gradient = self.functions.dense_jacobian(u, functions.parameters.start)
        sizes = np.linalg.norm(gradient, axis=1)
        if not (np.isfinite(sizes).all() and (sizes > 0.0).all()):
            raise ValueError(
                "conditions: one of them does not depend on u at the start, so it picks no solution"
            )
        self.directions = (gradient / sizes[:, None]).T

    def extended(self, u: np.ndarray) -> np.ndarray:
        """Append a zero multiplier for each condition to u."""
        return np.append(u, np.zeros(self.count))

    def equations(
        self, u: np.ndarray, p: float, functions: Differentiated, values: ParameterSet
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the extended system, its Jacobian and its parameter derivative."""
        n, state, amounts = self.node, u[: self.node], u[self.node :]
        self.functions.parameters = values
        jacobian = np.zeros((n + self.count, n + self.count))
        jacobian[:n, :n] = functions.dense_jacobian(state, p)
        jacobian[:n, n:] = self.directions
        jacobian[n:, :n] = self.functions.dense_jacobian(state, p)
        return (
            np.append(functions.value(state, p) + self.directions @ amounts, self.functions.value(state, p)),
            jacobian,
            np.append(functions.derivative(state, p), self.functions.derivative(state, p)),
        )

    def eigenvalues(self, jacobian: np.ndarray) -> np.ndarray:
        """Return the eigenvalues of dF/du without the zeros of the continuous symmetries.

        dF/du maps the tangents T of the family to zero, so it acts on the unknowns modulo T; each class has one member with dg/du y = 0.
        """
        n = self.node
        linear, gradient = jacobian[:n, :n], jacobian[n:, :n]
        wanted = np.eye(n + self.count)[:, n:]  # dF/du T = 0, dg/du T = 1
        tangents = np.linalg.lstsq(jacobian, wanted, rcond=None)[0][:n]
        basis = null_space(gradient)
        image = linear @ basis
        return without_roundoff(np.linalg.eigvals(basis.T @ (image - tangents @ (gradient @ image))))
