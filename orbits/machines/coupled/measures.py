"""Measures of the coupled machine's orbits: oscillator's amplitude, first harmonic of v, work of excitation and damper."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numba import njit

from orbits.machines.base import Model
from orbits.machines.coupled.damper import share_of_the_base
from orbits.machines.coupled.flow import ahead, derivative, first_zero, leg, oscillation
from orbits.machines.events import event_table
from orbits.words import Word

POWERS = ("input_work", "damping_loss", "force_work", "grounded_damping_loss")
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


@njit(cache=True, error_model="numpy")
def _along(states, params, length, out):
    """Per segment: largest |q1|, and the integrals of v sin Psi, v cos Psi and q1 sin Psi over the phase, into `out` (m, 4).

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
        own = 0.0
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
                own += _WEIGHTS[j] * (q1 + way) * math.sin(Psi)
        out[i, 1] = sine * half * omega
        out[i, 2] = cosine * half * omega
        out[i, 3] = own * half * omega


def own_measures(
    wanted: Sequence[str], model: Model, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray
) -> dict[str, np.ndarray]:
    """The measures `wanted` of many orbits with one word; nodes (m, L, 4), params (m, 8), results (m,).

    ``max_abs_q1`` is the largest displacement of the oscillator in units of b (exact, at an extremum), ``amplitude`` and
    ``v_phase`` those of the first harmonic C sin(Psi + phase) of v, ``C2`` the squared amplitude. Over the orbit's
    period, in units of m b^2 omega_0^2 like ``impact_loss`` and ``friction_loss``: ``damping_loss`` is what the damper between
    base and oscillator takes, the integral of eps lambda (q1' - e')^2, and ``input_work`` what the moving base gives through
    spring and damper; the four balance. For the same motion driven by the force e + eps lambda e', its damper held to the
    ground, ``force_work`` is the work of that force on q1 and ``grounded_damping_loss`` the integral of eps lambda q1'^2;
    they balance with the other two as well. With the truncated excitation the machine is that one, and both pairs are one.
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
    shape = np.empty((length, 4))
    work = np.empty((length, 3))
    power = any(name in POWERS for name in wanted)
    for i in range(count):
        _along(states[i], params[i], spans[i], shape)
        sine, cosine = 2.0 / turn * shape[:, 1].sum(), 2.0 / turn * shape[:, 2].sum()
        values: dict[str, float] = {
            "max_abs_q1": shape[:, 0].max(),
            "amplitude": math.hypot(sine, cosine),
            "v_phase": math.atan2(cosine, sine),
            "C2": sine**2 + cosine**2,
        }
        if power:
            works(states[i], params[i], spans[i], work)
            force, ground = work[:, 0].sum() / params[i, 3], work[:, 1].sum() / params[i, 3]
            more = share_of_the_base(params[i], periods, shape[:, 3].sum())
            values |= {
                "force_work": force,
                "grounded_damping_loss": ground,
                "input_work": force + more,
                "damping_loss": ground + more,
            }
        for name in wanted:
            result[name][i] = values[name]
    return result
