"""Exact orbits of the absorber on its oscillator: symmetric impacting `LR`, symmetric sliding `tt`, stuck.

A symmetric orbit with one flight per half period T = pi/Omega repeats itself with the opposite sign after T. In that flight
q1 = h + o + z (harmonic X sin Psi + Y cos Psi, offset o = -eps mu g s, damped oscillation z) and q2 is a parabola, so

    z(T) + z(0) = -2 o,      z'(T) + z'(0) = -eps (2 beta + s mu g T),      q2(0) = -(beta T + s mu g T^2/2)/2,

beta = q2' just after the event: the jump of q1' at an impact balances that of eps q2'. For given beta these equations are linear, as
are the two conditions at the event (contact and restitution, or w' = 0), whose unknowns are h and h' at the event. Since
h^2 + (h'/Omega)^2 = X^2 + Y^2, a quadratic equation in beta remains for `LR`: at most two orbits at each frequency, and
a fold at the zero of its discriminant. For `tt` beta = -s mu g T/2 is known.

While the absorber sticks the oscillator has the mass 1 + eps; it slips if (1 + eps) Omega^2 |q1| reaches (1 + eps) mu g.

Source: own derivation from the equations of motion; parameters as in `orbits.machines.reference.law`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial.polynomial import polymul, polyroots

from orbits.machines.reference.law import Law, coupled
from orbits.settings import FORMULAS

if TYPE_CHECKING:
    from orbits.theory.multiple_scales import Equilibrium


class _Half:
    """The oscillator over half a forcing period T of sliding in direction s.

    The free oscillation at its start is z(0) = start + beta ahead, as a pair (z, z'); `transition` maps it to z(T). `pull` is mu g, `square` is
    X^2 + Y^2, `offset` is o.
    """

    def __init__(self, params: np.ndarray, s: int) -> None:
        law = _law(params)
        self.eps, self.pull, self.omega, self.T = law.eps, law.friction_left, law.omega, math.pi / law.omega
        self.X, self.Y, alpha, beta = law.slide
        decay = math.exp(-alpha * self.T)
        c, d = decay * math.cos(beta * self.T), decay * math.sin(beta * self.T) / beta
        self.transition = np.array([[c + alpha * d, d], [-d, c - alpha * d]])
        self.offset = -self.eps * self.pull * s
        solve = np.linalg.inv(self.transition + np.eye(2))
        self.start = solve @ np.array([-2.0 * self.offset, -self.eps * s * self.pull * self.T])
        self.ahead = solve @ np.array([0.0, -2.0 * self.eps])
        self.square = self.X**2 + self.Y**2

    def phase(self, h0: float, h1: float) -> float:
        """Return Psi from X sin Psi + Y cos Psi = h0 and X cos Psi - Y sin Psi = h1."""
        return math.atan2(self.X * h0 - self.Y * h1, self.X * h1 + self.Y * h0) % (2.0 * math.pi)


def _law(params: np.ndarray) -> Law:
    """Return the numbers of the equations; the response is infinite, or NaN, at a resonance without damping."""
    with np.errstate(all="ignore"):
        return coupled([*params])


def symmetric_nodes(params: np.ndarray) -> list[np.ndarray]:
    """Return nodes (Psi, B+, v, v') at L and R of the symmetric orbits `LR`, each of shape (2, 4): the faster absorber first.

    Empty if there are none, as on a slope. Admissibility is not tested.
    """
    if params[8] != 0.0:
        return []
    half, r = _Half(params, -1), float(params[4])
    eps, pull, T = half.eps, half.pull, half.T
    # h and h' just after the impact on the left wall, and z there and at the end: coefficients of 1 and beta
    z = np.array([half.start, half.ahead])
    z_end = z @ half.transition.T
    h = -z[:, 0] + np.array([1.0 - half.offset + 0.25 * pull * T**2, -0.5 * T])
    # h' (1 + r) = r (z'(T) - beta + mu g T) - z'(0) + beta
    h_rate = (r * (z_end[:, 1] + np.array([pull * T, -1.0])) - z[:, 1] + np.array([0.0, 1.0])) / (1.0 + r)
    c, b, a = polymul(h, h) + polymul(h_rate, h_rate) / half.omega**2 - np.array([half.square, 0.0, 0.0])
    discriminant = b * b - 4.0 * a * c
    if not discriminant >= 0.0 or not np.isfinite(half.X):
        return []
    found = []
    for beta in sorted({(-b + sign * math.sqrt(discriminant)) / (2.0 * a) for sign in (1.0, -1.0)}):
        (h0, h1), (z0, z1) = np.array([h, h_rate]) @ [1.0, beta], half.start + beta * half.ahead
        q1, q1_rate = h0 + half.offset + z0, h1 + z1
        q2 = -0.5 * (beta * T - 0.5 * pull * T**2)
        psi = half.phase(h0, h1 / half.omega)
        found.append(_mirrored([psi, (1.0 + eps) * beta, q1 + eps * q2, q1_rate + eps * beta]))
    return found[::-1] if abs(found[0][0, 1]) < abs(found[-1][0, 1]) else found


def nodes_from_equilibrium(params: np.ndarray, equilibrium: Equilibrium) -> np.ndarray:
    """Return a first approximation of the nodes of `LR` or `tt`, shape (2, 4), from a steady state of the slow flow.

    With v = C sin(Psi + gamma) and B, h of the slow flow: at the left wall v = 1 - pi B/2, v' = Omega (R B + h) and
    B+ = B + h; at a turn towards the left wall v = w = -delta, v' = -Omega h. Exact to order eps.

    Parameters
    ----------
    params : float array (8,)
    equilibrium : orbits.theory.multiple_scales.Equilibrium
        With the same parameters and detuning (Omega - 1)/eps.
    """
    omega, eps, r = float(params[1]), float(params[3]), float(params[4])
    h = 0.5 * math.pi * (1.0 + eps) * float(params[5]) * float(params[6])
    if equilibrium.manifold == "impacting":
        B = equilibrium.velocity
        v, speed, second = 1.0 - 0.5 * math.pi * B, (1.0 - r) / (1.0 + r) * B + h, B + h
    else:
        v, speed, second = -(equilibrium.turning_point or 0.0), -h, -(equilibrium.turning_point or 0.0)
    psi = (math.atan2(v, speed) - equilibrium.phase) % (2.0 * math.pi)
    return _mirrored([psi, second, v, omega * speed])


def _mirrored(first: Sequence[float]) -> np.ndarray:
    """Return a node and its mirror image half a period later."""
    return np.array([first, [first[0] + math.pi, *(-value for value in first[1:])]])


def sliding_nodes(params: np.ndarray, mode: int = 1) -> np.ndarray | None:
    """Return nodes (Psi, w, v, v') at the turns of symmetric sliding `tt` about the middle, shape (2, 4); None if there is none.

    Parameters
    ----------
    params : float array (8,)
    mode : int
        Direction of the slide after the first turn.
    """
    if params[8] != 0.0:
        return None
    half = _Half(params, mode)
    beta = -0.5 * mode * half.pull * half.T
    z = half.start + beta * half.ahead
    h1 = (beta - z[1]) / half.omega
    square = half.square - h1**2
    if not 0.0 <= square < math.inf:
        return None
    for h0 in (-mode * math.sqrt(square), mode * math.sqrt(square)):
        w = h0 + half.offset + z[0]  # q2 = 0 at the turns
        if mode * w < 0.0:
            return _mirrored([half.phase(h0, h1), w, w, (1.0 + half.eps) * beta])
    return None


@dataclass(frozen=True)
class StuckResponse:
    """The linear response with the absorber stuck to the cavity's floor.

    Attributes
    ----------
    amplitude : float
        |q1| in units of b.
    phase : float
        q1 = amplitude sin(Psi + phase).
    shaking : float
        Largest |v''|.
    reserve : float
        a - |b| - |v''|, b = (1 + eps) g sin(slope): positive if friction holds the absorber.
    """

    amplitude: float
    phase: float
    shaking: float
    reserve: float

    @property
    def real(self) -> bool:
        """Whether friction holds the absorber all the time."""
        return self.reserve >= 0.0


def stuck_response(params: np.ndarray) -> StuckResponse:
    """Return the response with the absorber stuck."""
    law = _law(params)
    X, Y, reserve = law.stuck.X, law.stuck.Y, law.friction_left - abs(law.lean)
    amplitude = math.hypot(X, Y)
    shaking = law.whole * law.omega**2 * amplitude
    return StuckResponse(amplitude, math.atan2(Y, X), shaking, law.whole * reserve - shaking)


def stuck_frequencies(params: np.ndarray) -> np.ndarray:
    """Return the frequencies at which the stuck response begins or ceases to slip, ascending.

    With x = Omega^2, c = eps lambda and f = g (mu cos(slope) - |sin(slope)|): Omega^2 |q1| = f is the cubic
    (eps G)^2 x^2 (1 + chi^2 c^2 x) = f^2 ((1 - (1 + eps) x)^2 + c^2 x).
    """
    G, lam, eps, chi = (float(params[i]) for i in (0, 2, 3, 7))
    law = _law(params)
    reserve = float(law.friction_left - abs(law.lean))
    if reserve < 0.0:
        return np.zeros(0)
    square, hold, force = (eps * lam) ** 2, reserve**2, (eps * G) ** 2
    roots = polyroots(
        np.trim_zeros(
            [
                -hold,
                hold * (2.0 * (1.0 + eps) - square),
                force - hold * (1.0 + eps) ** 2,
                force * chi**2 * square,
            ],
            "b",
        )
    )
    real = roots[np.abs(roots.imag) < FORMULAS.real * np.abs(roots)].real
    return np.sqrt(np.sort(real[real > 0.0]))
