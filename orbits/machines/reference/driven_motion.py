"""Pieces of the coupled machine's segments in plain Python: the motion, the work done and the energy.

Signatures: :mod:`orbits.machines.stepping`, items 4 and 5.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from orbits.machines.reference.law import Law
from orbits.machines.reference.oscillation import Oscillation, State, after, first_zero, oscillation
from orbits.machines.stepping import LOW, MODE, PSI, RATE, V_RATE, V, W
from orbits.numbers import ROUNDOFF

NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)


def sample(law: Law[float], states: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
    """w, w', v, v' at given phases after given states; contract, item 4."""
    for state, phase, row in zip(states, ahead, out):
        q, tau = oscillation(state, law), phase / law.omega
        begin = State(state[W], state[RATE], state[V], state[V_RATE])
        row[:] = after(law, q, q.at(tau), begin, state[MODE], tau, state[LOW])


def quadrature(phase: float, span: float) -> tuple[np.ndarray, np.ndarray]:
    """Instants and weights of an integral over a span of time, in which the forcing turns by `phase`.

    The integrands are sums of exponentials; the 16-point Gauss rule in pieces of at most a turn misses less than 1e-19 of a product of
    two waves, cos 2 x there.
    """
    pieces = int(max(phase, span) / (2.0 * math.pi)) + 1
    half = 0.5 * span / pieces
    middles = (2.0 * np.arange(pieces) + 1.0) * half
    return (middles[:, None] + half * NODES).ravel(), np.tile(half * WEIGHTS, pieces)


def works(law: Law[float], states: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
    """Work of the excitation, of the damper and of friction inside pieces of segments; contract, item 5.

    Per M b^2 omega_0^2: the integrals of (e + eps lambda e') q1' and of eps lambda q1'^2, and eps mu g times the way
    slid.
    """
    eps, omega = law.eps, law.omega
    for state, phase, row in zip(states, ahead, out):
        q, span = oscillation(state, law), phase / omega
        times, weights = quadrature(phase, span)
        rate = q.h1 + q.z1 + np.array([q.at(tau).speed for tau in times])
        Psi = state[PSI] + omega * times
        row[0] = law.force * (weights * rate) @ (np.sin(Psi) + law.base * np.cos(Psi))
        row[1] = law.drag * weights @ rate**2
        slid = q.at(span).way - q.travel(span) if state[MODE] != 0.0 else 0.0
        row[2] = eps * law.friction_left * abs(slid)


def energies(law: Law[float], states: np.ndarray, out: np.ndarray) -> None:
    """Kinetic and potential energy per M b^2 omega_0^2, (q1'^2 + q1^2 + eps q2'^2)/2 + eps g sin(slope) w; contract, item 5."""
    eps, lean, whole = law.eps, law.lean, law.whole
    q1 = (states[:, V] + eps * states[:, W]) / whole
    q1_rate = (states[:, V_RATE] + eps * states[:, RATE]) / whole
    q2_rate = (states[:, V_RATE] - states[:, RATE]) / whole
    out[:] = 0.5 * (q1_rate**2 + q1**2 + eps * q2_rate**2) + eps * lean * states[:, W]


def shapes(law: Law[float], states: np.ndarray, lengths: np.ndarray, out: np.ndarray) -> None:
    """Per segment: largest |q1|, and the integrals of v sin Psi, v cos Psi and q1 sin Psi over the phase, into `out` (m, 4)."""
    eps, omega = law.eps, law.omega
    for state, length, row in zip(states, lengths, out):
        q, span = oscillation(state, law), length / omega
        q1 = (state[V] + eps * state[W]) / law.whole
        times, weights = quadrature(length, span)
        way = np.array([q.at(tau).way for tau in times])
        travel = (q.q2_rate + 0.5 * q.q2_pull * times) * times
        v = state[V] + (way + eps * travel if state[MODE] != 0.0 else law.whole * way)
        Psi = state[PSI] + omega * times
        row[0] = max(abs(q1 + q.at(tau).way) for tau in (0.0, *_extrema(q, span), span))
        row[1] = omega * (weights * v) @ np.sin(Psi)
        row[2] = omega * (weights * v) @ np.cos(Psi)
        row[3] = omega * (weights * (q1 + way)) @ np.sin(Psi)


def _extrema(q: Oscillation[float], end: float) -> Iterator[float]:
    """Times up to `end` at which q1 has an extremum."""

    def look(tau: float) -> tuple[float, float]:
        at = q.at(tau)
        return q.h1 + q.z1 + at.speed, at.h2 + at.z2

    tiny = 2.0 * ROUNDOFF * (2.0 * q.driven(1) + 2.0 * q.own(1, 0.0))
    tau = 0.0
    while (tau := first_zero(look, tau, end, q.driven(3) + q.own(3, tau), tiny)) < end:
        yield tau
