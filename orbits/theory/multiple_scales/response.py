"""Frequency response of the slow flow in closed form, without continuation.

For a given position on a manifold the detuning is known in closed form,
``2 sigma C^2 = k2 +- sqrt(G^2 C^2 - (lambda C^2 - k1)^2)``. The two signs meet where the square root
vanishes (phase resonance, ``cos(gamma) = 0``). So every connected piece of the response is an
explicit curve, with a parameter t that passes from one sign to the other.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root_scalar

from orbits.arguments import ROUNDOFF, Reals
from orbits.settings import THEORY

from .equilibria import Equilibrium, equilibrium_at, phase_at
from .flow import Manifold, SlowFlow
from .polynomials import real_roots, root_bound


@dataclass(frozen=True)
class ResponseCurve:
    """One connected piece of the frequency response on a manifold.

    Arrays of equal length along the curve: `position` (``B`` or ``delta``), `velocity` ``B``, `amplitude`
    ``C``, `phase` ``gamma``, `detuning` ``sigma``, `frequency` ``Omega``, `eigenvalues` (n, 2), `attracting`.
    `closed` is True for an isola and False for an arc that ends at an end of the manifold.
    """

    flow: SlowFlow
    manifold: Manifold
    ends: tuple[float, float]
    span: tuple[float, float]
    closed: bool
    parameter: NDArray
    position: NDArray
    velocity: NDArray
    amplitude: NDArray
    phase: NDArray
    detuning: NDArray
    eigenvalues: NDArray
    attracting: NDArray

    @property
    def frequency(self) -> NDArray:
        """``Omega = 1 + eps sigma``."""
        return np.asarray(self.flow.frequency(self.detuning))

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether each point is stable along the manifold (by the eigenvalues of the slow flow)."""
        return np.all(np.real(self.eigenvalues) < 0, axis=-1)

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Whether each point can be observed: stable along the manifold and attracting across it."""
        return self.stable & self.attracting

    def __len__(self) -> int:
        return len(self.position)


@dataclass(frozen=True)
class ResponsePoint:
    """A special steady state: `kind` is "fold", "hopf", "resonance", "activation" or "symmetry-breaking"."""

    kind: str
    state: Equilibrium


def _existence(flow: SlowFlow, manifold: Manifold) -> NDArray:
    """Coefficients of G^2 C^2 - (lambda C^2 - k1)^2 as a polynomial in the position; it is positive where a
    steady state exists."""
    R, h, kappa = float(flow.loss), float(flow.level), flow.kappa
    if manifold == "impacting":
        squared = np.array([0.25 * np.pi**2 + R**2, 2.0 * R * h - np.pi, 1.0 + h**2])
        k1 = np.array([-(4.0 / np.pi) * R, h * (0.5 * np.pi * kappa - 4.0 / np.pi), -kappa * h])
    else:
        squared, k1 = np.array([1.0, 0.0, h**2]), np.array([0.0, -kappa * h, 0.0])
    loss = float(flow.damping) * squared - k1
    return np.polysub(float(flow.forcing) ** 2 * squared, np.polymul(loss, loss))


def _place(ends: tuple[float, float], t: Reals) -> Reals:
    """Position along a piece: t from 0 to pi on one side of the resonance, pi to 2 pi back on the other."""
    low, high = ends
    return 0.5 * (low + high) - 0.5 * (high - low) * np.cos(t)


def _detuning(flow: SlowFlow, manifold: Manifold, position: Reals, t: Reals) -> Reals:
    squared, k1, k2 = flow.harmonics(position, manifold)
    inside = float(flow.forcing) ** 2 * squared - (float(flow.damping) * squared - k1) ** 2
    return (k2 + np.sign(np.sin(t)) * np.sqrt(np.maximum(inside, 0.0))) / (2.0 * squared)


def _curve(
    flow: SlowFlow,
    manifold: Manifold,
    ends: tuple[float, float],
    span: tuple[float, float],
    points: int,
    closed: bool,
):
    t = np.linspace(*span, points)
    position = np.asarray(_place(ends, t))
    detuning = np.asarray(_detuning(flow, manifold, position, t))
    phase = np.asarray(phase_at(flow, position, detuning, manifold))
    amplitude = np.sqrt(flow.harmonics(position, manifold)[0])
    eigenvalues = flow.eigenvalues(position, phase, manifold)
    if manifold == "impacting":
        velocity, attracting = position, flow.attracts(position)
    else:
        velocity, attracting = np.zeros_like(position), np.ones(len(position), dtype=bool)
    return ResponseCurve(
        flow,
        manifold,
        ends,
        span,
        closed,
        t,
        position,
        velocity,
        amplitude,
        phase,
        detuning,
        eigenvalues,
        attracting,
    )


def frequency_response(
    flow: SlowFlow, manifold: Manifold = "impacting", points: int = 800
) -> list[ResponseCurve]:
    """Compute all pieces of the frequency response at fixed forcing.

    Parameters
    ----------
    flow : SlowFlow
        Scalar fields.
    manifold : {"impacting", "sliding"}
    points : int
        Points per piece, denser towards phase resonance.

    Returns
    -------
    list of ResponseCurve
        By ascending position; empty if there is no steady state with this forcing.
    """
    if manifold == "sliding" and float(flow.level) == 0.0:
        return []
    polynomial = _existence(flow, manifold)
    low, high = (
        (0.0, float(root_bound(polynomial)))
        if manifold == "impacting"
        else (2.0 * float(flow.level) / np.pi, 1.0)
    )
    if low >= high:
        return []
    roots = real_roots(polynomial, low, high)
    knots = np.unique(np.concatenate([[low], roots[np.isfinite(roots)], [high]]))
    pieces = []
    for a, b in pairwise(knots):
        if np.polyval(polynomial, 0.5 * (a + b)) <= 0:
            continue
        ends = (float(a), float(b))
        cut_low, cut_high = a == low, b == high
        if cut_low and cut_high:
            spans = [(0.0, np.pi), (np.pi, 2.0 * np.pi)]
        elif cut_high:
            spans = [(-np.pi, np.pi)]
        elif cut_low:
            spans = [(0.0, 2.0 * np.pi)]
        else:
            pieces.append(_curve(flow, manifold, ends, (0.0, 2.0 * np.pi), points, True))
            continue
        for first, last in spans:
            pieces.append(
                _curve(flow, manifold, ends, (first + THEORY.off_end, last - THEORY.off_end), points, False)
            )
    return pieces


def special_points(curve: ResponseCurve) -> list[ResponsePoint]:
    """Find folds and Hopf points of the slow flow, phase resonance and the limits of the manifold along a piece.

    A fold is a zero of the determinant of the Jacobian of the slow flow, a Hopf point a zero of its trace
    where the determinant is positive; both are located to rounding on the closed-form curve.
    """
    flow, manifold = curve.flow, curve.manifold

    def state(t: float) -> Equilibrium:
        position = float(_place(curve.ends, t))
        return equilibrium_at(flow, position, float(_detuning(flow, manifold, position, t)), manifold)

    def determinant(t: float) -> float:
        s = state(t)
        a, b, c, d = flow.rate_slopes(s.position, s.phase, manifold)
        return float(a * d - b * c)

    def trace(t: float) -> float:
        s = state(t)
        a, _, _, d = flow.rate_slopes(s.position, s.phase, manifold)
        return float(a + d * flow.harmonic_slopes(s.position, manifold)[0])

    def resonance(t: float) -> float:
        return float(np.sin(t))

    watched = [("fold", determinant), ("hopf", trace), ("resonance", resonance)]
    if manifold == "impacting":
        watched += [
            ("activation", lambda t: float(_place(curve.ends, t) - flow.activation.velocity)),
            ("symmetry-breaking", lambda t: float(_place(curve.ends, t) - flow.symmetry_limit.velocity)),
        ]
    found = []
    for kind, function in watched:
        values = np.array([function(float(t)) for t in curve.parameter])
        for i in np.nonzero(values[:-1] * values[1:] < 0)[0]:
            t = float(
                root_scalar(
                    function, bracket=(curve.parameter[i], curve.parameter[i + 1]), xtol=4.0 * ROUNDOFF
                ).root
            )
            point = state(t)
            if kind == "hopf":
                slope = flow.harmonic_slopes(point.position, manifold)[0]
                if determinant(t) * slope <= 0:
                    continue
            found.append((t, ResponsePoint(kind, point)))
    return [point for _, point in sorted(found, key=lambda pair: pair[0])]


def hopf_velocity(flow: SlowFlow) -> NDArray | float:
    """``B`` at which the slow flow's eigenvalues may cross the imaginary axis, whatever the forcing and
    the detuning.

    The trace of the slow flow in ``(C^2, gamma)`` contains neither phase nor forcing:
    ``-lambda + (dk1/dB)/(d(C^2)/dB)``, with the exact closure ``-lambda - (8/pi) R B/(d(C^2)/dB)``. It
    vanishes at ``B = lambda (pi - 2 R h)/(lambda (pi^2/2 + 2 R^2) + 8 R/pi)``, below ``B_min``. On the
    attracting part the trace is negative, so steady states there lose stability only at folds. (Own derivation.
    With the paper's closure a term in ``h`` remains.)
    """
    R, h = flow.loss, flow.level
    tilt = h * (0.5 * np.pi * flow.kappa - 4.0 / np.pi)
    top = flow.damping * (np.pi - 2.0 * R * h) + tilt
    return top / (flow.damping * (0.5 * np.pi**2 + 2.0 * R**2) + 8.0 * R / np.pi)
