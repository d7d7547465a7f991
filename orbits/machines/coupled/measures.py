"""Measures of the coupled machine's orbits: oscillator's amplitude, first harmonic of v, work of excitation and damper."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numba import njit

from orbits.cycles.measures import event_table
from orbits.machines.base import Model
from orbits.machines.coupled.flow import ahead, derivative, first_zero, leg, oscillation
from orbits.words import Word

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


@njit(cache=True, error_model="numpy")
def _along(states, params, length, out):
    """Per segment: largest |q1|, and the integrals of v sin Psi and v cos Psi over the phase, into `out` (m, 3).

    The extrema of q1 are the zeros of the wave q1', none of which `first_zero` misses; the integrals are Gauss sums
    of 16 points on at most a quarter turn, exact to roundoff.
    """
    omega, eps = params[1], params[3]
    for i in range(states.shape[0]):
        h0, h1, z0, z1, alpha, beta, q2_rate, sp = leg(states[i], params)
        moving = states[i, 3] != 0.0
        q1 = (states[i, 6] + eps * states[i, 1]) / (1.0 + eps)
        span = length[i] / omega
        way, _speed, _h2, _z2, _h3, _z3 = ahead(span, h0, h1, z0, z1, omega, alpha, beta)
        largest = max(abs(q1), abs(q1 + way))
        # as a wave in the phase Omega tau, from zero
        A, B = oscillation(alpha, beta, z0, z1)
        P1, Q1, A1, B1 = derivative(omega, alpha, beta, h1 / omega, h0, A, B)
        tau = 0.0
        while span > 0.0:
            tau, _slope = first_zero(0.0, P1, Q1, A1, B1, omega, alpha, beta, 0.0, tau, span)
            if tau >= span:
                break
            way, _speed, _h2, _z2, _h3, _z3 = ahead(tau, h0, h1, z0, z1, omega, alpha, beta)
            largest = max(largest, abs(q1 + way))
        out[i, 0] = largest
        pieces = int(max(length[i], span) / 1.6) + 1
        half = 0.5 * span / pieces
        sine = 0.0
        cosine = 0.0
        for piece in range(pieces):
            for j in range(_NODES.size):
                tau = (2 * piece + 1 + _NODES[j]) * half
                way, _speed, _h2, _z2, _h3, _z3 = ahead(tau, h0, h1, z0, z1, omega, alpha, beta)
                v = states[i, 6] + (
                    way + eps * (q2_rate + 0.5 * sp * tau) * tau if moving else (1.0 + eps) * way
                )
                Psi = states[i, 0] + omega * tau
                sine += _WEIGHTS[j] * v * math.sin(Psi)
                cosine += _WEIGHTS[j] * v * math.cos(Psi)
        out[i, 1] = sine * half * omega
        out[i, 2] = cosine * half * omega


def own_measures(
    wanted: Sequence[str], model: Model, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray
) -> dict[str, np.ndarray]:
    """The measures `wanted` of many orbits with one word; nodes (m, L, 4), params (m, 8), results (m,).

    ``max_abs_q1`` is the largest displacement of the oscillator in units of b (exact, at an extremum), ``amplitude`` and
    ``v_phase`` those of the first harmonic C sin(Psi + phase) of v, ``C2`` the squared amplitude. ``input_work`` is the
    work of e + eps lambda e' on q1 over the orbit's period and ``damping_loss`` that of eps lambda q1' (so the damper's
    share of the moving base counts as excitation), in units of m b^2 omega_0^2 like ``impact_loss`` and
    ``friction_loss``; the four balance.
    """
    from orbits.machines.coupled.segments import works

    table = event_table(model, word, nodes, params)
    modes = np.array(word.modes, dtype=float)
    turn = 2.0 * np.pi * periods
    count, length = nodes.shape[:2]
    spans = np.diff(np.concatenate([table.phase, table.phase[:, :1] + turn], axis=1), axis=1)
    states = np.zeros((count, length, 8))
    states[:, :, 0] = table.phase
    states[:, :, 1] = table.w
    states[:, :, 2] = np.where(modes == 0.0, 0.0, table.rate_post)
    states[:, :, 3] = modes
    states[:, :, 6] = table.v
    states[:, :, 7] = table.v_rate
    result = {name: np.empty(count) for name in wanted}
    shape = np.empty((length, 3))
    work = np.empty((length, 3))
    power = "input_work" in wanted or "damping_loss" in wanted
    form = any(name not in ("input_work", "damping_loss") for name in wanted)
    for i in range(count):
        values: dict[str, float] = {}
        if form:
            _along(states[i], params[i], spans[i], shape)
            sine, cosine = 2.0 / turn * shape[:, 1].sum(), 2.0 / turn * shape[:, 2].sum()
            values |= {
                "max_abs_q1": shape[:, 0].max(),
                "amplitude": math.hypot(sine, cosine),
                "v_phase": math.atan2(cosine, sine),
                "C2": sine**2 + cosine**2,
            }
        if power:
            works(states[i], params[i], spans[i], work)
            eps = params[i, 3]
            values |= {"input_work": work[:, 0].sum() / eps, "damping_loss": work[:, 1].sum() / eps}
        for name in wanted:
            result[name][i] = values[name]
    return result
