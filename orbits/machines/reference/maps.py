"""Elementary maps between consecutive events, with exact derivatives.

A node is (Psi, B+) at an impact and (Psi, w) at a turn, stick or slip, followed by (v, v') if the cavity is an oscillator; B = v' - w'. The
map of a flight starts at node i, follows the closed form (`orbits.machines.reference.oscillation`) for d = (Psi_{i+1} - Psi_i)/Omega and
compares the result with node i + 1:

===============  =================  =====================  ==========  ============
arrival          row 0              row 1                  row 2       row 3
===============  =================  =====================  ==========  ============
impact           w - wall           v' + r w' - B+         v - v_i+1   v' - v'_i+1
turn, stick      w'                 w - w_i+1              v - v_i+1   v' - v'_i+1
slip             v'' - m a - b      w - w_i+1              v - v_i+1   v' - v'_i+1
===============  =================  =====================  ==========  ============

Here m is the mode after the slip. From rest to rest row 0 is the mean of w'' over the flight, w'/d, so that a flight of zero duration is no
solution. In a shaken cavity the two rows of an impact are exchanged, and v' + r w' - B+ and the row of a slip have the opposite sign. For
alternating impacts these are the literature's G+_LR and G+_RL.

**Derivatives** are complex steps: f(x + i h) = f(x) + i h f'(x) for an analytic function, exact to roundoff for very small h
(Squire and Trapp, SIAM Review 40, 1998). One row of numbers for each direction, all flights at once.

**The pin.** Without impacts the absorber can be shifted as a whole, q2 -> q2 - delta with q1 unchanged. A closed orbit of such a word is not
isolated, and one equation is redundant (the absorber's total displacement): row 1 of the last flight is replaced by
w_i + w_{i+1} = left + right, the mean position. `unpin` restores it for the multipliers, one of which is then exactly +1. Half a word
(twist = -1) needs no pin: its closure already centres the motion.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from orbits.arguments import COMPLEX_STEP
from orbits.machines.parameters import place
from orbits.machines.reference.law import LawOf
from orbits.machines.reference.oscillation import State, after, chosen, leg
from orbits.words.alphabet import CODES

if TYPE_CHECKING:
    from orbits.arguments import CycleData, Workspace

STICK, SLIP = CODES["s"], CODES["u"]


def linearise(law_of: LawOf, data: CycleData, u: np.ndarray, p: float, work: Workspace) -> float:
    """Compute residuals F, blocks A = dg_i/dx_i and D = dg_i/dx_{i+1}, and the column Q = dg_i/dp at the cycle `u`.

    Parameters
    ----------
    law_of : callable
        The machine's parameters -> the numbers of the equations.
    data : CycleData
    u : float array (n L,)
        Nodes, node-major.
    p : float
        Value of the varying parameter; for its effect see `orbits.machines.parameters`.
    work : Workspace
        F, A, D, Q, the parameters and the sines and cosines are written.

    Returns
    -------
    float
        Largest residual; infinity if the maps cannot be evaluated (undamped resonance, overdamped oscillator).
    """
    F, A, D, Q, par = work.F, work.A, work.D, work.Q, work.numbers
    events, modes, twist = data.events, data.modes, data.twist
    length, n = F.shape
    place(data.params, data.path, p, par)
    x = u.reshape(length, n)
    work.sines[:length], work.cosines[:length] = np.sin(x[:, 0]), np.cos(x[:, 0])
    work.sines[length], work.cosines[length] = twist * work.sines[0], twist * work.cosines[0]
    # one direction for each entry of the node before, one for the phase after, one for the parameter
    size, count = n + 2, data.params.shape[0]
    numbers = np.repeat(par[:count, None, None].astype(complex), size, axis=1)
    numbers[:, -1, 0] += 1j * COMPLEX_STEP * par[count:]
    node = np.repeat(x.T[:, None, :].astype(complex), size, axis=1)
    for k in range(n):
        node[k, k] += 1j * COMPLEX_STEP
    following = np.roll(x, -1, axis=0)
    following[-1] *= twist
    following[-1, 0] = x[0, 0] + data.shift
    phase = np.repeat(following[None, :, 0].astype(complex), size, axis=0)
    phase[n] += 1j * COMPLEX_STEP
    law = law_of([*numbers])
    arrival, next_modes = np.roll(events, -1), np.roll(modes, -1)
    next_modes[-1] *= twist
    if twist < 0.0 and events[0] < 2:
        arrival[-1] = 1 - events[0]
    hit = events < 2
    if law.prescribed:
        v, v_rate = law.amplitude * np.sin(node[0]), law.amplitude * law.omega * np.cos(node[0])
    else:
        v, v_rate = node[2], node[3]
    wall = np.where(events == 0, law.left, law.right)
    begin = State(np.where(hit, wall, node[1]), np.where(hit, v_rate - node[1], 0.0), v, v_rate)
    q, t = leg(law, node[0], begin, modes), (phase - node[0]) / law.omega
    point = q.at(t)
    end = after(law, q, point, begin, modes, t)
    hits, left = arrival < 2, arrival == 0
    y = following[:, 1] + 0j
    if twist < 0.0 and events[0] > 1:  # the image about the middle between the walls
        y = y + np.where(np.arange(length) == length - 1, law.left + law.right, 0.0)
    from_rest = (events >= 2) & (modes != 0)
    stops = np.where(from_rest, point.mean - q.q2_pull, end.rate)
    slips = law.whole * (point.h2 + point.z2 - chosen(next_modes, law.pull_left, law.pull_right, 0.0))
    back = end.v_rate + np.where(left, law.restitution_left, law.restitution_right) * end.rate - y
    place_ = end.w - np.where(left, law.left, law.right)
    sign = -1.0 if law.prescribed else 1.0
    rows: list[np.ndarray] = [
        np.where(
            hits, back * sign if law.prescribed else place_, np.where(arrival == SLIP, sign * slips, stops)
        ),
        np.where(hits, place_ if law.prescribed else back, end.w - y),
    ]
    if n > 2:
        rows += [end.v - following[:, 2], end.v_rate - following[:, 3]]
    D[:] = 0.0
    for j, row in enumerate(rows):
        F[:, j] = row[-1].real
        A[:, j, :] = np.imag(row[:n]).T / COMPLEX_STEP
        D[:, j, 0] = np.imag(row[n]) / COMPLEX_STEP
        Q[:, j] = row[-1].imag / COMPLEX_STEP
    D[:, 1, 1] = np.where(hits & law.prescribed, 0.0, -1.0)
    D[:, 0, 1] = np.where(hits & law.prescribed, 1.0, 0.0)
    D[:, range(2, n), range(2, n)] = -1.0
    largest = float(np.abs(F).max())
    if data.pinned == 1:
        middle = (law.left + law.right) * np.ones((size, 1))
        largest = max(largest, _pin(data, u, work, middle[-1, 0]))
    return largest if np.isfinite(largest) else np.inf


def last_flight(modes: np.ndarray) -> int:
    """Return the last event that is followed by a flight."""
    last = len(modes) - 1
    return last if modes[last] != 0 else last - 1


def _pin(data: CycleData, u: np.ndarray, work: Workspace, middle: complex) -> float:
    """Replace the displacement equation of the last flight by w_i + w_{i+1} = middle; return the error of the mean position."""
    F, A, D, Q = work.F, work.A, work.D, work.Q
    length, n = F.shape
    last = last_flight(data.modes)
    work.pin[:n], work.pin[n : 2 * n] = A[last, 1], D[last, 1]
    A[last, 1], D[last, 1] = 0.0, 0.0
    A[last, 1, 1] = D[last, 1, 1] = 1.0
    y = u[n * last + n + 1] if last + 1 < length else data.twist * u[1]
    F[last, 1] = u[n * last + 1] + y - middle.real
    Q[last, 1] = -middle.imag / COMPLEX_STEP
    return abs(float(F[last, 1]))


def unpin(data: CycleData, work: Workspace) -> None:
    """Restore the displacement equation, for the multipliers."""
    if data.pinned == 1:
        n, last = work.F.shape[1], last_flight(data.modes)
        work.A[last, 1], work.D[last, 1] = work.pin[:n], work.pin[n : 2 * n]
