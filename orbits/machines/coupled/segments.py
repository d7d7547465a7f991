"""Pieces of the coupled machine's segments in plain Python: the motion, the work done and the energy.

Signatures: :mod:`orbits.machines.stepping`, items 4 and 5.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from orbits.machines.coupled.oscillation import Numbers, Oscillation, certain, oscillation
from orbits.machines.stepping import LOW, MODE, PSI, RATE, V_RATE, V, W

NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)


@np.errstate(all="ignore")
def sample(states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
    """w, w', v, v' at given phases after given states; contract, item 4."""
    numbers = Numbers.of(params)
    eps = numbers.mass_ratio
    for state, phase, row in zip(states, ahead, out):
        q, tau = oscillation(state, numbers), phase / numbers.frequency
        at = q.at(tau)
        if state[MODE] == 0.0:
            row[:2] = state[W], 0.0
            row[2:] = state[V] + numbers.whole * at.way, state[V_RATE] + numbers.whole * at.speed
        else:
            travel = q.travel(tau)
            row[:2] = state[W] + (state[LOW] + (at.way - travel)), state[RATE] + at.speed - q.q2_pull * tau
            row[2] = state[V] + at.way + eps * travel
            row[3] = state[V_RATE] + at.speed + eps * q.q2_pull * tau


def quadrature(phase: float, span: float) -> tuple[np.ndarray, np.ndarray]:
    """Instants and weights of an integral over a span of time, in which the forcing turns by `phase`.

    The integrands are sums of exponentials; the 16-point Gauss rule in pieces of at most a turn misses less than 1e-19 of a product of
    two waves, cos 2 x there.
    """
    pieces = int(max(phase, span) / (2.0 * math.pi)) + 1
    half = 0.5 * span / pieces
    middles = (2.0 * np.arange(pieces) + 1.0) * half
    return (middles[:, None] + half * NODES).ravel(), np.tile(half * WEIGHTS, pieces)


@np.errstate(all="ignore")
def works(states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
    """Work of the excitation, of the damper and of friction inside pieces of segments; contract, item 5.

    Per M b^2 omega_0^2: the integrals of (e + eps lambda e') q1' and of eps lambda q1'^2, and eps mu g times the way
    slid.
    """
    numbers = Numbers.of(params)
    eps, omega = numbers.mass_ratio, numbers.frequency
    base = numbers.excitation * numbers.drag * omega
    for state, phase, row in zip(states, ahead, out):
        q, span = oscillation(state, numbers), phase / omega
        times, weights = quadrature(phase, span)
        rate = q.h1 + q.z1 + np.array([q.at(tau).speed for tau in times])
        Psi = state[PSI] + omega * times
        row[0] = eps * numbers.forcing * (weights * rate) @ (np.sin(Psi) + base * np.cos(Psi))
        row[1] = numbers.drag * weights @ rate**2
        slid = q.at(span).way - q.travel(span) if state[MODE] != 0.0 else 0.0
        row[2] = eps * numbers.pull * abs(slid)


def energies(states: np.ndarray, params: np.ndarray, out: np.ndarray) -> None:
    """Kinetic and potential energy per M b^2 omega_0^2, (q1'^2 + q1^2 + eps q2'^2)/2 + eps g sin(slope) w; contract, item 5."""
    eps, lean = params[3], Numbers.of(params).lean
    whole = 1.0 + eps
    q1 = (states[:, V] + eps * states[:, W]) / whole
    q1_rate = (states[:, V_RATE] + eps * states[:, RATE]) / whole
    q2_rate = (states[:, V_RATE] - states[:, RATE]) / whole
    out[:] = 0.5 * (q1_rate**2 + q1**2 + eps * q2_rate**2) + eps * lean * states[:, W]


@np.errstate(all="ignore")
def shapes(states: np.ndarray, params: np.ndarray, lengths: np.ndarray, out: np.ndarray) -> None:
    """Per segment: largest |q1|, and the integrals of v sin Psi, v cos Psi and q1 sin Psi over the phase, into `out` (m, 4)."""
    numbers = Numbers.of(params)
    eps, omega = numbers.mass_ratio, numbers.frequency
    for state, length, row in zip(states, lengths, out):
        q, span = oscillation(state, numbers), length / omega
        q1 = (state[V] + eps * state[W]) / numbers.whole
        times, weights = quadrature(length, span)
        way = np.array([q.at(tau).way for tau in times])
        travel = (q.q2_rate + 0.5 * q.q2_pull * times) * times
        v = state[V] + (way + eps * travel if state[MODE] != 0.0 else numbers.whole * way)
        Psi = state[PSI] + omega * times
        row[0] = max(abs(q1 + q.at(tau).way) for tau in (0.0, *_extrema(q, span), span))
        row[1] = omega * (weights * v) @ np.sin(Psi)
        row[2] = omega * (weights * v) @ np.cos(Psi)
        row[3] = omega * (weights * (q1 + way)) @ np.sin(Psi)


def _extrema(q: Oscillation, end: float) -> Iterator[float]:
    """Times up to `end` at which q1 has an extremum.

    With M >= abs(q1''') the rate y = abs(q1') stays positive for `certain(y, y', M)`: steps of that length approach a
    simple zero like Newton's method, from one side, and never jump over one. A zero where the search starts is left behind:
    the slope there tells for how long there is no other.
    """
    forced = q.omega * math.hypot(q.h0, q.h1 / q.omega)  # amplitudes of the rates
    own = math.sqrt(q.kappa) * math.hypot(q.z0, (q.z1 + q.alpha * q.z0) / q.beta)
    tiny = 4e-16 * (forced + 2.0 * own)

    def look(tau: float) -> tuple[float, float]:
        at = q.at(tau)
        return q.h1 + q.z1 + at.speed, at.h2 + at.z2

    tau = 0.0
    while tau < end:
        bound = q.omega**2 * forced + q.kappa * math.exp(-q.alpha * tau) * own
        if bound <= 1e-300:
            return
        value, slope = look(tau)
        if abs(value) <= tiny + 1e-15 * (1.0 + tau) * abs(slope):
            tau += max(abs(slope) / bound, 1e-8)
            value, slope = look(tau)
        sign = 1.0 if value > 0.0 else -1.0
        step = math.inf
        while tau < end and sign * value > tiny and step > 2e-16 * (1.0 + tau):
            step = certain(sign * value, sign * slope, bound)
            tau += step
            value, slope = look(tau)
        if tau < end:
            yield tau
