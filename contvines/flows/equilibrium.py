"""Equilibrium: one equilibrium, as users hold it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from contvines.shared.number_text import complex_figures, figures, pairs

from ..problems.protocol import Solution
from ..shared.stability import attracts, marginal_text, onto_axis


@dataclass(frozen=True)
class Equilibrium(Solution):
    """An equilibrium of a flow.

    Attributes
    ----------
    parameter : str
    value : float
        Of the parameter.
    u : ndarray, shape (d,)
    states : dict of float
        The same by name.
    parameters : dict of float
    eigenvalues : ndarray of complex
        Of the Jacobian; none where it is not at hand as a matrix.
    marginal : bool
        Whether it is that of a special point, at which an eigenvalue is on the imaginary axis by definition.
    """

    states: dict[str, float] = field(default_factory=dict)
    parameters: dict[str, float] = field(default_factory=dict)
    eigenvalues: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=complex))
    marginal: bool = False

    @property
    def stable(self) -> bool | None:
        """Whether all eigenvalues have negative real parts; None where they are not known, and at special points, unless one is positive."""
        if not self.eigenvalues.size:
            return None
        rates = np.real(self.eigenvalues)
        return attracts(rates, 0.0) if self.marginal else bool((rates < 0.0).all())

    def critical(self, near: float = 0.0) -> Equilibrium:
        """The same equilibrium as that of a special point, where an eigenvalue is on the imaginary axis by definition: the nearest."""
        return replace(self, eigenvalues=onto_axis(self.eigenvalues), marginal=True)

    def to_dict(self) -> dict[str, Any]:
        """The equilibrium as JSON-able dict."""
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
