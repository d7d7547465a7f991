"""Steady states of the slow flow as a problem F(u, p) = 0, for any continuation package.

Unknowns are the position on the manifold (``B`` or ``delta``) and the phase ``gamma``; F is the slow
vector field in these coordinates. So the eigenvalues of dF/du are those of the slow flow, and show folds and
Hopf points. With contvines:

    response = SlowResponse(SlowFlow(forcing=2.47), "detuning")
    u, p = response.start(detuning=-2.58)
    problem = AlgebraicProblem(response, u, p, "detuning", response.jacobian, response.derivative,
    spectrum="flow")

At the lowest point of the impacting manifold ``C^2`` does not determine ``B`` and the vector field is
singular: the slow flow leaves the manifold there, one eigenvalue passes through infinity, and
continuation reports a branch point. ``regular=True`` multiplies the first equation by ``d(C^2)/dB``: the
steady states and folds stay the same and the curve is smooth across that point, but the eigenvalues have
no meaning.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .equilibria import equilibria
from .flow import Manifold, SlowFlow

PARAMETERS = ("detuning", "frequency", "forcing", "damping")


@dataclass(frozen=True)
class SlowResponse:
    """The function F(u, p) whose zeros are the steady states of the slow flow; call an instance to evaluate it.

    Parameters
    ----------
    flow : SlowFlow
    parameter : {"detuning", "frequency", "forcing", "damping"}
    manifold : {"impacting", "sliding"}
    detuning : float
        Detuning if another parameter varies.
    regular : bool
        Multiply the first equation by ``d(C^2)/dB``; see the docstring of the module.
    """

    flow: SlowFlow
    parameter: str = "detuning"
    manifold: Manifold = "impacting"
    detuning: float = 0.0
    regular: bool = False

    def __post_init__(self) -> None:
        if self.parameter not in PARAMETERS:
            raise ValueError(f"parameter = {self.parameter!r} is none of {', '.join(PARAMETERS)}.")

    def _at(self, p: float) -> tuple[SlowFlow, float]:
        if self.parameter == "detuning":
            return self.flow, p
        if self.parameter == "frequency":
            return self.flow, float(self.flow.detuning(p))
        return self.flow.with_(**{self.parameter: p}), self.detuning

    def _scale(self, flow: SlowFlow, position: float) -> float:
        return 1.0 if self.regular else 1.0 / float(flow.harmonic_slopes(position, self.manifold)[0])

    def __call__(self, u: ArrayLike, p: float) -> NDArray[np.float64]:
        """Rates of position and phase, shape (2,)."""
        position, phase = np.asarray(u, dtype=float)
        flow, sigma = self._at(p)
        growth, turn = flow.rates(position, phase, sigma, self.manifold)
        return np.array([growth * self._scale(flow, position), turn], dtype=float)

    def jacobian(self, u: ArrayLike, p: float) -> NDArray[np.float64]:
        """dF/du, shape (2, 2)."""
        position, phase = np.asarray(u, dtype=float)
        flow, sigma = self._at(p)
        a, b, c, d = flow.rate_slopes(position, phase, self.manifold)
        scale = self._scale(flow, position)
        if not self.regular:
            growth = flow.rates(position, phase, sigma, self.manifold)[0]
            bend = 2.0 if self.manifold == "sliding" else 0.5 * np.pi**2 + 2.0 * flow.loss**2
            a = a - growth * bend * scale
        return np.array([[a * scale, b * scale], [c, d]], dtype=float)

    def derivative(self, u: ArrayLike, p: float) -> NDArray[np.float64]:
        """dF/dp, shape (2,)."""
        position, phase = np.asarray(u, dtype=float)
        flow, _ = self._at(p)
        if self.parameter == "detuning":
            return np.array([0.0, -1.0])
        if self.parameter == "frequency":
            return np.array([0.0, -1.0 / float(flow.mass_ratio)])
        squared = float(flow.harmonics(position, self.manifold)[0])
        scale = self._scale(flow, position)
        if self.parameter == "damping":
            return np.array([-squared * scale, 0.0])
        amplitude = np.sqrt(squared)
        return np.array([-amplitude * np.sin(phase) * scale, -np.cos(phase) / (2.0 * amplitude)], dtype=float)

    def start(self, p: float | None = None, **named: float) -> tuple[NDArray[np.float64], float]:
        """Return (u, p) of the steady state with the largest amplitude at a parameter value, given as `p` or by name.

        Raises
        ------
        ValueError
            If this manifold has no steady state there.
        """
        value = float(named[self.parameter]) if p is None else float(p)
        flow, sigma = self._at(value)
        states = [s for s in equilibria(flow, sigma) if s.manifold == self.manifold]
        if not states:
            raise ValueError(
                f"no {self.manifold} steady state at {self.parameter} = {value}; try another value."
            )
        best = max(states, key=lambda s: s.amplitude)
        return np.array([best.position, best.phase]), value
