"""Pieces of the coupled machine's segments: the motion, the work done and the energy (compiled).

Signatures: :mod:`orbits.machines.stepping`, items 4 and 5.
"""

from __future__ import annotations

import math

from orbits.compiling.decorators import stored_with
from orbits.machines.coupled import flow as _flow
from orbits.machines.coupled.flow import ahead as _ahead
from orbits.machines.coupled.flow import leg as _leg


@stored_with(_flow, nogil=True)
def sample(states, params, ahead, out):
    """w, w', v, v' at given phases after given states; contract, item 4."""
    omega, eps = params[1], params[3]
    for i in range(states.shape[0]):
        h0, h1, z0, z1, alpha, beta, q2_rate, sp = _leg(states[i], params)
        tau = ahead[i] / omega
        way, speed, _h2, _z2, _h3, _z3 = _ahead(tau, h0, h1, z0, z1, omega, alpha, beta)
        if states[i, 3] == 0.0:
            out[i, 0] = states[i, 1]
            out[i, 1] = 0.0
            out[i, 2] = states[i, 6] + (1.0 + eps) * way
            out[i, 3] = states[i, 7] + (1.0 + eps) * speed
        else:
            travel = (q2_rate + 0.5 * sp * tau) * tau
            out[i, 0] = states[i, 1] + (states[i, 5] + (way - travel))
            out[i, 1] = states[i, 2] + speed - sp * tau
            out[i, 2] = states[i, 6] + way + eps * travel
            out[i, 3] = states[i, 7] + speed + eps * sp * tau


# Gauss-Legendre rule with 16 nodes, positive half
_GAUSS = (
    (0.09501250983763744, 0.1894506104550685),
    (0.2816035507792589, 0.18260341504492358),
    (0.45801677765722737, 0.16915651939500254),
    (0.6178762444026438, 0.14959598881657674),
    (0.755404408355003, 0.12462897125553388),
    (0.8656312023878318, 0.09515851168249279),
    (0.9445750230732326, 0.062253523938647894),
    (0.9894009349916499, 0.027152459411754096),
)


@stored_with(_flow, nogil=True)
def works(states, params, ahead, out):
    """Work of the excitation, of the damper and of friction inside pieces of segments; contract, item 5.

    Per M b^2 omega_0^2: the integrals of (e + eps lambda e') q1' and of eps lambda q1'^2, and eps mu g times the way
    slid. The integrands are sums of exponentials; the 16-point Gauss rule on pieces of at most a quarter turn is exact to
    roundoff for frequencies of order one.
    """
    G, omega, lam, eps, mu, g, chi = (
        params[0],
        params[1],
        params[2],
        params[3],
        params[5],
        params[6],
        params[7],
    )
    drag = eps * lam
    for i in range(states.shape[0]):
        h0, h1, z0, z1, alpha, beta, q2_rate, sp = _leg(states[i], params)
        span = ahead[i] / omega
        start = h1 + z1
        pieces = int(max(ahead[i], span) / 1.6) + 1
        half = 0.5 * span / pieces
        given = 0.0
        lost = 0.0
        for piece in range(pieces):
            middle = (2 * piece + 1) * half
            for node, weight in _GAUSS:
                for side in (-1.0, 1.0):
                    tau = middle + side * node * half
                    _way, speed, _h2, _z2, _h3, _z3 = _ahead(tau, h0, h1, z0, z1, omega, alpha, beta)
                    q1_rate = start + speed
                    Psi = states[i, 0] + omega * tau
                    given += weight * q1_rate * (math.sin(Psi) + chi * drag * omega * math.cos(Psi))
                    lost += weight * q1_rate * q1_rate
        out[i, 0] = eps * G * half * given
        out[i, 1] = drag * half * lost
        out[i, 2] = 0.0
        if states[i, 3] != 0.0:
            way, _speed, _h2, _z2, _h3, _z3 = _ahead(span, h0, h1, z0, z1, omega, alpha, beta)
            out[i, 2] = eps * mu * g * abs(way - (q2_rate + 0.5 * sp * span) * span)


@stored_with(_flow, nogil=True)
def energies(states, params, out):
    """Kinetic and potential energy per M b^2 omega_0^2, (q1'^2 + q1^2 + eps q2'^2)/2; contract, item 5."""
    eps = params[3]
    whole = 1.0 + eps
    for i in range(states.shape[0]):
        q1 = (states[i, 6] + eps * states[i, 1]) / whole
        q1_rate = (states[i, 7] + eps * states[i, 2]) / whole
        q2_rate = (states[i, 7] - states[i, 2]) / whole
        out[i] = 0.5 * (q1_rate * q1_rate + q1 * q1 + eps * q2_rate * q2_rate)
