"""The mode in which a start of the absorber on its oscillator begins (compiled)."""

from __future__ import annotations

import math

from contvines_ground.parts import part
from orbits.compiling import digits as _digits
from orbits.compiling.decorators import stored_with
from orbits.compiling.digits import wrap


@part(error_model="numpy")
def _push(state, params):
    """v'' = -q1 - eps lambda q1' + e + eps lambda e' of a state."""
    G, omega, lam, eps, chi = params[0], params[1], params[2], params[3], params[7]
    q1 = (state[6] + eps * state[1]) / (1.0 + eps)
    q1_rate = (state[7] + eps * state[2]) / (1.0 + eps)
    drag = eps * lam
    return -q1 - drag * q1_rate + eps * G * (math.sin(state[0]) + chi * drag * omega * math.cos(state[0]))


@part(error_model="numpy")
def _push_rate(state, params):
    """Third derivative of v of a state without friction and with w' = 0."""
    G, omega, lam, eps, chi = params[0], params[1], params[2], params[3], params[7]
    q1_rate = state[7] / (1.0 + eps)
    drag = eps * lam
    force = eps * G * omega * (math.cos(state[0]) - chi * drag * omega * math.sin(state[0]))
    return force - q1_rate - drag * _push(state, params)


@stored_with(_digits)
def launch(state, params):
    """Reduce the phase and set the mode of a start (Psi, w, w', mode, turns, low, v, v')."""
    psi, turns = wrap(state[0])
    state[0] = psi
    state[4] += turns
    a = (1.0 + params[3]) * params[5] * params[6]
    w = state[1]
    push = _push(state, params)
    if push == 0.0 and a == 0.0:  # what comes next is up to the third derivative
        push = _push_rate(state, params)
    if state[2] != 0.0:
        state[3] = 1.0 if state[2] > 0.0 else -1.0
    elif (abs(push) <= a and a > 0.0) or (abs(w) == 1.0 and push * w >= 0.0):
        state[3] = 0.0
    else:
        state[3] = 1.0 if push >= 0.0 else -1.0
