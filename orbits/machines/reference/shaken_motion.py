"""Motion in a shaken cavity between events: samples, works and energies in closed form.

Notation and source of the formulas: :mod:`orbits.machines.reference.shaken_stepper`; signatures:
:mod:`orbits.machines.stepping`, items 4 and 5.
"""

from __future__ import annotations

import math

from orbits.machines.digits import remainders


def sample(law, states, ahead, out):
    """w, w', v, v' at given phases after given states; contract, item 4."""
    C = law.amplitude
    omega = law.omega
    square = omega * omega
    for i in range(states.shape[0]):
        psi = states[i, 0]
        x = ahead[i]
        s = states[i, 3]
        if s == 0.0:
            out[i, 0] = states[i, 1]
            out[i, 1] = 0.0
        else:
            p = s * states[i, 2] / omega
            m0 = -s * math.sin(psi)
            k0 = -s * math.cos(psi)
            _sine, versine, third, fourth = remainders(x)
            A = (law.pull_left if s > 0.0 else -law.pull_right) / square
            q0 = C * m0 - A
            out[i, 0] = states[i, 1] + s * (p * x + 0.5 * q0 * x * x + C * (k0 * third - m0 * fourth))
            out[i, 1] = s * omega * (p + q0 * x + C * (k0 * versine - m0 * third))
        out[i, 2] = C * math.sin(psi + x)
        out[i, 3] = C * omega * math.cos(psi + x)


def works(law, states, ahead, out):
    """Work of the shaking, of the damper (none) and of friction inside pieces of segments; contract, item 5.

    In the frame of the cavity, per mass of the absorber: the integral of -v'' w', and the friction's acceleration times the way slid.
    """
    C = law.amplitude
    omega = law.omega
    square = omega * omega
    for i in range(states.shape[0]):
        out[i, 0] = 0.0
        out[i, 1] = 0.0
        out[i, 2] = 0.0
        s = states[i, 3]
        if s == 0.0:
            continue
        psi = states[i, 0]
        x = ahead[i]
        p = s * states[i, 2] / omega
        m0 = -s * math.sin(psi)
        k0 = -s * math.cos(psi)
        m1 = -s * math.sin(psi + x)
        k1 = -s * math.cos(psi + x)
        _sine, _versine, third, fourth = remainders(x)
        A = (law.pull_left if s > 0.0 else -law.pull_right) / square
        way = p * x + 0.5 * (C * m0 - A) * x * x + C * (k0 * third - m0 * fourth)
        out[i, 0] = (
            C
            * omega
            * omega
            * ((p + C * k0) * (k0 - k1) - 0.5 * C * (m1 * m1 - m0 * m0) - A * (m1 - m0 - x * k1))
        )
        friction = law.friction_left if s > 0.0 else law.friction_right
        out[i, 2] = friction / square * omega * omega * abs(way)


def energies(law, states, out):
    """Energy of the relative motion per mass of the absorber, w'^2/2 + b w; contract, item 5."""
    for i in range(states.shape[0]):
        out[i] = 0.5 * states[i, 2] * states[i, 2] + law.lean * states[i, 1]
