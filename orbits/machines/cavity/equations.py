"""Elementary maps of a shaken cavity between consecutive events, with exact derivatives.

A node is (Psi, B+) at an impact and (Psi, w) at a turn, stick or slip. In mode s = -1 or +1, with d = (Psi - Psi_0)/Omega
and beta = v' - w' at the start (B+ after an impact, C Omega cos Psi_0 from rest),

    w' = C Omega cos Psi - beta - (b + s a_s) d,
    w  = w_0 + C (sin Psi - sin Psi_0) - beta d - (b + s a_s) d^2 / 2,

with the numbers of `orbits.machines.cavity.law`. With b = 0, equal walls and frictions these are the literature's G+_LR and G+_RL
for alternating impacts, and all other pairs of events beside them.
"""

from __future__ import annotations

import numpy as np

from orbits.machines.pinning import last_flight


def cycle(data, u, work, law, rate):
    """Residuals F, blocks A = dg_i/dx_i and D = dg_i/dx_{i+1}, and the column Q = dg_i/dp at the cycle `u`.

    In one piece: the derivatives of a flight are products of some thirty local numbers, which a function would have to return.

    Parameters
    ----------
    data : CycleData
    u : float array (2 L,)
        Nodes, node-major.
    work : Workspace
        F, A, D, Q are filled.
    law, rate : Law
        The numbers of the equations, and their derivatives with respect to the parameter that varies.

    Returns
    -------
    float
        Largest residual, infinity where the maps cannot be evaluated.
    """
    events, modes, twist, shift, pinned = data.events, data.modes, data.twist, data.shift, data.pinned
    F, A, D, Q = work.F, work.A, work.D, work.Q
    sines, cosines = work.sines, work.cosines
    length = F.shape[0]
    C, omega, d_C, d_Omega = law.amplitude, law.omega, rate.amplitude, rate.omega
    by_omega = 1.0 / omega
    speed = C * omega
    d_speed = d_C * omega + C * d_Omega
    largest = y1_p = 0.0
    sines[:length], cosines[:length] = np.sin(u[::2]), np.cos(u[::2])
    sines[length] = twist * sines[0]
    cosines[length] = twist * cosines[0]
    for i in range(length):
        event = events[i]
        if i + 1 < length:
            arrival = events[i + 1]
            psi1 = u[2 * i + 2]
            y1 = u[2 * i + 3]
        else:
            arrival = events[0] if twist > 0.0 or events[0] > 1 else 1 - events[0]
            psi1 = u[0] + shift
            y1 = twist * u[1]
            if twist < 0.0 and events[0] > 1:  # the image about the middle between the walls
                y1 += law.left + law.right
                y1_p = rate.left + rate.right
        psi0 = u[2 * i]
        y0 = u[2 * i + 1]
        s0, c0 = sines[i], cosines[i]
        s1, c1 = sines[i + 1], cosines[i + 1]
        mode = modes[i]
        if mode == 0:  # stuck: the absorber waits for the slip
            after = modes[i + 1] if i + 1 < length else twist * modes[0]
            F[i, 0] = speed * omega * s1 + (law.pull_left if after > 0 else law.pull_right)
            F[i, 1] = y0 - y1
            A[i, 0, 0] = 0.0
            A[i, 0, 1] = 0.0
            A[i, 1, 0] = 0.0
            A[i, 1, 1] = 1.0
            D[i, 0, 0] = speed * omega * c1
            D[i, 0, 1] = 0.0
            D[i, 1, 0] = 0.0
            D[i, 1, 1] = -1.0
            d_pull = rate.pull_left if after > 0 else rate.pull_right
            Q[i, 0] = d_pull + (d_speed * omega + speed * d_Omega) * s1
            Q[i, 1] = -y1_p
        else:
            sa = law.pull_left if mode > 0 else law.pull_right
            d_sa = rate.pull_left if mode > 0 else rate.pull_right
            d = (psi1 - psi0) * by_omega
            if event < 2:
                w0 = law.left if event == 0 else law.right
                w0_p = rate.left if event == 0 else rate.right
                beta = y0
                beta_psi = 0.0
                beta_y = 1.0
                w0_y = 0.0
                beta_p = 0.0
            else:
                w0 = y0
                w0_p = 0.0
                beta = speed * c0
                beta_psi = -speed * s0
                beta_y = 0.0
                w0_y = 1.0
                beta_p = d_speed * c0
            pull = beta + sa * d
            V = speed * c1 - pull
            W = w0 + C * (s1 - s0) - (beta + 0.5 * sa * d) * d
            V_psi0 = sa * by_omega - beta_psi
            V_y0 = -beta_y
            V_psi1 = -speed * s1 - sa * by_omega
            W_psi0 = pull * by_omega - C * c0 - beta_psi * d
            W_y0 = w0_y - beta_y * d
            W_psi1 = V * by_omega
            d_p = -d * by_omega * d_Omega
            V_p = d_speed * c1 - beta_p - d_sa * d - sa * d_p
            W_p = w0_p + d_C * (s1 - s0) - (beta_p + 0.5 * d_sa * d) * d - pull * d_p
            if arrival < 2:
                r = law.restitution_left if arrival == 0 else law.restitution_right
                d_r = rate.restitution_left if arrival == 0 else rate.restitution_right
                F[i, 0] = y1 - speed * c1 - r * V
                F[i, 1] = W - (law.left if arrival == 0 else law.right)
                A[i, 0, 0] = -r * V_psi0
                A[i, 0, 1] = -r * V_y0
                A[i, 1, 0] = W_psi0
                A[i, 1, 1] = W_y0
                D[i, 0, 0] = speed * s1 - r * V_psi1
                D[i, 0, 1] = 1.0
                D[i, 1, 0] = W_psi1
                D[i, 1, 1] = 0.0
                Q[i, 0] = -r * V_p - d_speed * c1 - d_r * V
                Q[i, 1] = W_p - (rate.left if arrival == 0 else rate.right)
            else:
                if event >= 2:
                    # from rest to rest: V/d, whose solutions leave out the flight of no duration
                    half = 0.5 * (psi1 - psi0)
                    middle = 0.5 * (psi1 + psi0)
                    sine, cosine = np.sin(middle), np.cos(middle)
                    if abs(half) > 1e-3:
                        ratio = np.sin(half) / half
                        turn = (np.cos(half) - ratio) / half
                    else:
                        ratio = 1.0 - half * half / 6.0
                        turn = half * (half * half / 30.0 - 1.0 / 3.0)
                    peak = speed * omega
                    V = -peak * sine * ratio - sa
                    V_psi0 = -0.5 * peak * (cosine * ratio - sine * turn)
                    V_psi1 = -0.5 * peak * (cosine * ratio + sine * turn)
                    V_y0 = 0.0
                    V_p = -(d_speed * omega + speed * d_Omega) * sine * ratio - d_sa
                F[i, 0] = V
                F[i, 1] = W - y1
                A[i, 0, 0] = V_psi0
                A[i, 0, 1] = V_y0
                A[i, 1, 0] = W_psi0
                A[i, 1, 1] = W_y0
                D[i, 0, 0] = V_psi1
                D[i, 0, 1] = 0.0
                D[i, 1, 0] = W_psi1
                D[i, 1, 1] = -1.0
                Q[i, 0] = V_p
                Q[i, 1] = W_p - y1_p
        size = max(abs(F[i, 0]), abs(F[i, 1]))
        if not size <= largest:
            largest = size
    if pinned == 1:
        middle, d_middle = law.left + law.right, rate.left + rate.right
        largest = max(largest, pin(F, A, D, Q, u, twist, modes, middle, d_middle, work.pin))
    if not np.isfinite(largest):
        return np.inf
    return largest


def pin(F, A, D, Q, u, twist, modes, middle, d_middle, kept):
    """Replace the displacement equation of the last flight by w_i + w_{i+1} = middle, the sum of the walls' places; it goes to `kept`.

    Returns what the mean position is off by.
    """
    last = last_flight(modes)
    for c in range(2):
        kept[c] = A[last, 1, c]
        kept[2 + c] = D[last, 1, c]
    kept[4] = F[last, 1]
    A[last, 1, 0] = 0.0
    A[last, 1, 1] = 1.0
    D[last, 1, 0] = 0.0
    D[last, 1, 1] = 1.0
    F[last, 1] = u[2 * last + 1] + (u[2 * last + 3] if last + 1 < F.shape[0] else twist * u[1]) - middle
    Q[last, 1] = -d_middle
    return abs(F[last, 1])


def unpin(data, work):
    """Put the displacement equation back, for the multipliers."""
    if data.pinned == 1:
        A, D, kept = work.A, work.D, work.pin
        last = last_flight(data.modes)
        for c in range(2):
            A[last, 1, c] = kept[c]
            D[last, 1, c] = kept[2 + c]
