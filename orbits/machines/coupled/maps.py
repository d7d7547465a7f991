"""Elementary maps of the absorber on its oscillator between consecutive events, with exact derivatives.

A node is (Psi, B+, v, v') at an impact and (Psi, w, v, v') at a turn, stick or slip; v = q1 + eps q2, w = q1 - q2 and
B = v' - w' = (1 + eps) q2'. The map of a segment starts at node i, follows the closed-form motion of
`orbits.machines.coupled.flow` for d = (Psi_{i+1} - Psi_i)/Omega and compares with node i + 1:

===============  =================  =====================  ==========  ============
arrival          row 0              row 1                  row 2       row 3
===============  =================  =====================  ==========  ============
impact           w - wall           v' + r w' - B+         v - v_i+1   v' - v'_i+1
turn, stick      w'                 w - w_i+1              v - v_i+1   v' - v'_i+1
slip             v'' - m a - b      w - w_i+1              v - v_i+1   v' - v'_i+1
===============  =================  =====================  ==========  ============

(m the mode after the slip). Parameters in order: forcing G, frequency Omega, damping lambda, mass_ratio eps,
restitution r, friction mu, gravity g, excitation (1 exact, 0 without the term eps lambda e'), slope. Friction's share of q2'' is
s mu g cos(slope), gravity's g sin(slope), and b is 1 + eps times that.

**The pin.** Without impacts the absorber may be shifted as a whole, q2 -> q2 - delta with q1 untouched. In node variables
that is w -> w + delta and v -> v - eps delta at every node, the direction (0, 1, -eps, 0). A closed orbit of such a word is not
isolated, and one equation is redundant (the absorber's total displacement). `linearise` therefore replaces row 1 of the
block of the last flight by w_i + w_{i+1} = 0, the mean position; `unpin` puts it back for the multipliers, one of
which is then exactly +1. A mirrored half word (twist = -1) needs no pin: its closure w_L = -w_0 already centres the
motion, and its trivial multiplier is -1.
"""

from __future__ import annotations

import math

import numpy as np

from orbits.machines.coupled.flow import harmonic, rates, transition
from orbits.machines.coupled.margins import margins as margins
from orbits.machines.path import place
from orbits.machines.pinning import last_flight

# duration below which a difference quotient loses more to rounding than its first two terms leave out: the root of the rounding
SHORT = 2.0**-26


def _response(par, slope, mass, d_mass):
    """X, Y, alpha, beta of the oscillator with the given mass, and their derivatives along `slope`."""
    omega, lam, eps, chi = par[1], par[2], par[3], par[7]
    rate = eps * lam
    d_rate = slope[3] * lam + eps * slope[2]
    drag = rate * omega
    d_drag = d_rate * omega + rate * slope[1]
    stiffness = 1.0 - mass * omega * omega
    d_stiffness = -(d_mass * omega + 2.0 * mass * slope[1]) * omega
    force = eps * par[0]
    d_force = slope[3] * par[0] + eps * slope[0]
    d_chi = slope[7]
    X, Y = harmonic(force, chi, drag, stiffness)
    alpha, beta = rates(mass, rate)
    # (K + i c)(X + i Y) = f (1 + i chi c)
    real = d_force - X * d_stiffness + Y * d_drag
    imag = d_force * chi * drag + force * (d_chi * drag + chi * d_drag) - Y * d_stiffness - X * d_drag
    size = stiffness * stiffness + drag * drag
    dX = (real * stiffness + imag * drag) / size
    dY = (imag * stiffness - real * drag) / size
    d_alpha = 0.5 * d_rate / mass - alpha * d_mass / mass
    d_beta = (-0.5 * d_mass / (mass * mass) - alpha * d_alpha) / beta
    return X, Y, alpha, beta, dX, dY, d_alpha, d_beta


def linearise(data, u, p, work):
    """Residuals F, blocks A = dg_i/dx_i and D = dg_i/dx_{i+1}, and the column Q = dg_i/dp at the cycle `u`.

    In one piece: the derivatives of a flight are products of some fifty local numbers, which a function would have to return.

    Parameters
    ----------
    data : CycleData
    u : float array (4 L,)
        Nodes, node-major.
    p : float
        Value of the parameter that varies; what it moves: `orbits.machines.path`.
    work : Workspace
        F, A, D, Q, the parameters and the sines and cosines are filled.

    Returns
    -------
    float
        Largest residual, infinity where the maps cannot be evaluated (undamped resonance, overdamped oscillator).
    """
    events, modes, twist, shift, pinned = data.events, data.modes, data.twist, data.shift, data.pinned
    F, A, D, Q, par, sines, cosines = work.F, work.A, work.D, work.Q, work.numbers, work.sines, work.cosines
    length = F.shape[0]
    place(data.params, data.path, p, par)
    slope = par[data.params.shape[0] :]
    G, omega, lam, eps, r, mu, g, chi, angle = par[: data.params.shape[0]][:9]
    whole = 1.0 + eps
    part = 1.0 / whole
    rate = eps * lam
    force = eps * G
    upright, aside = math.cos(angle), math.sin(angle)
    pull, lean = mu * g * upright, g * aside  # accelerations of the absorber by friction and by gravity
    d_pull = (mu * slope[6] + g * slope[5]) * upright - mu * g * aside * slope[8]
    d_lean = slope[6] * aside + g * upright * slope[8]
    d_omega, d_eps, d_r = slope[1], slope[3], slope[4]
    d_rate = d_eps * lam + eps * slope[2]
    d_force = d_eps * G + eps * slope[0]
    d_lever = slope[7] * rate * omega + chi * (d_rate * omega + rate * d_omega)  # of chi eps lambda Omega
    by_omega = 1.0 / omega
    slide = _response(par, slope, 1.0, 0.0)
    stuck = slide
    for i in range(length):
        if modes[i] == 0:
            stuck = _response(par, slope, whole, d_eps)
            break
    sines[:length], cosines[:length] = np.sin(u[::4]), np.cos(u[::4])
    sines[length], cosines[length] = twist * sines[0], twist * cosines[0]
    largest = 0.0
    for i in range(length):
        event = events[i]
        mode = modes[i]
        k = 4 * i
        psi0, y0, v0, v0_rate = u[k], u[k + 1], u[k + 2], u[k + 3]
        if i + 1 < length:
            arrival = events[i + 1]
            after = 1.0 * modes[i + 1]
            psi1, y1, v1, v1_rate = u[k + 4], u[k + 5], u[k + 6], u[k + 7]
        else:
            arrival = events[0] if twist > 0.0 or events[0] > 1 else 1 - events[0]
            after = twist * modes[0]
            psi1, y1, v1, v1_rate = u[0] + shift, twist * u[1], twist * u[2], twist * u[3]
        s0, c0, s1, c1 = sines[i], cosines[i], sines[i + 1], cosines[i + 1]
        X, Y, alpha, beta, dX, dY, d_alpha, d_beta = slide if mode != 0 else stuck
        kappa = alpha * alpha + beta * beta
        d = (psi1 - psi0) * by_omega
        # --- the start: node -> (q1, q1', q2, q2') and its derivatives
        if event < 2:
            w0 = 1.0 - 2.0 * event
            q1 = (v0 + eps * w0) * part
            q2 = (v0 - w0) * part
            q2_rate = y0 * part
            q1_rate = v0_rate - eps * q2_rate
            q1_y, q2_y, q1r_y, q2r_y = 0.0, 0.0, -eps * part, part
            q1r_vr, q2r_vr = 1.0, 0.0
            dq1r = -d_eps * (q2_rate - eps * q2_rate * part)
        else:
            w0 = y0
            q1 = (v0 + eps * w0) * part
            q2 = (v0 - w0) * part
            q1_rate = v0_rate * part
            q2_rate = q1_rate
            q1_y, q2_y, q1r_y, q2r_y = eps * part, -part, 0.0, 0.0
            q1r_vr, q2r_vr = part, part
            dq1r = -d_eps * q1_rate * part
        dq1 = -d_eps * q2 * part
        dq2 = dq1
        dq2r = -d_eps * q2_rate * part
        # --- the oscillator
        slides, d_slides = (mode * pull + lean, mode * d_pull + d_lean) if mode != 0 else (0.0, 0.0)  # q2''
        offset = -eps * slides
        d_offset = -d_eps * slides - eps * d_slides
        z = q1 - X * s0 - Y * c0 - offset
        zr = q1_rate - omega * (X * c0 - Y * s0)
        T11, T12, T21, T22, C, S = transition(alpha, beta, d)
        Z = T11 * z + T12 * zr
        Zr = T21 * z + T22 * zr
        Zrr = -2.0 * alpha * Zr - kappa * Z
        h1 = X * s1 + Y * c1
        h1r = omega * (X * c1 - Y * s1)
        Q1 = Z + h1 + offset
        Q1r = Zr + h1r
        Q1rr = Zrr - omega * omega * h1
        q1_acceleration = -2.0 * alpha * zr - kappa * z - omega * omega * (X * s0 + Y * c0)
        # derivatives with respect to the parameter at fixed nodes
        dd = -d * by_omega * d_omega
        dz = dq1 - dX * s0 - dY * c0 - d_offset
        dzr = dq1r - omega * (dX * c0 - dY * s0) - d_omega * (X * c0 - Y * s0)
        lag = (d * C - S) / beta
        dQ1 = (
            T11 * dz + T12 * dzr + Zr * dd + dX * s1 + dY * c1 + d_offset
            + d_alpha * (z * S - d * Z) + d_beta * ((zr + alpha * z) * lag - d * beta * z * S)
        )  # fmt: skip
        dQ1r = (
            T21 * dz + T22 * dzr + Zrr * dd + omega * (dX * c1 - dY * s1) + d_omega * (X * c1 - Y * s1)
            - d_alpha * (d * Zr + (zr + 2.0 * alpha * z) * S)
            - d_beta * (d * beta * zr * S + (alpha * zr + kappa * z) * lag + 2.0 * beta * z * S)
        )  # fmt: skip
        # derivatives with respect to the nodes: Psi_0, y_0, v_0, v_0', and Psi_1
        Q1_psi0 = -(T11 * q1_rate + T12 * q1_acceleration) * by_omega
        Q1r_psi0 = -(T21 * q1_rate + T22 * q1_acceleration) * by_omega
        Q1_y = T11 * q1_y + T12 * q1r_y
        Q1r_y = T21 * q1_y + T22 * q1r_y
        Q1_v, Q1r_v = T11 * part, T21 * part
        Q1_vr, Q1r_vr = T12 * q1r_vr, T22 * q1r_vr
        Q1_psi1, Q1r_psi1 = Q1r * by_omega, Q1rr * by_omega
        # --- the absorber
        if mode != 0:
            Q2r = q2_rate + slides * d
            Q2 = q2 + (q2_rate + 0.5 * slides * d) * d
            Q2_psi1, Q2r_psi1 = Q2r * by_omega, slides * by_omega
            Q2_psi0, Q2r_psi0 = -Q2_psi1, -Q2r_psi1
            Q2_y, Q2r_y = q2_y + d * q2r_y, q2r_y
            Q2_v, Q2r_v = part, 0.0
            Q2_vr, Q2r_vr = d * q2r_vr, q2r_vr
            dQ2r = dq2r + slides * dd + d_slides * d
            dQ2 = dq2 + dq2r * d + Q2r * dd + 0.5 * d_slides * d * d
        else:
            Q2, Q2r = Q1 - w0, Q1r
            Q2_psi1, Q2r_psi1 = Q1_psi1, Q1r_psi1
            Q2_psi0, Q2r_psi0 = Q1_psi0, Q1r_psi0
            Q2_y, Q2r_y = Q1_y - 1.0, Q1r_y
            Q2_v, Q2r_v = Q1_v, Q1r_v
            Q2_vr, Q2r_vr = Q1_vr, Q1r_vr
            dQ2, dQ2r = dQ1, dQ1r
        # --- rows 2 and 3: v and v'
        F[i, 2] = Q1 + eps * Q2 - v1
        A[i, 2, 0] = Q1_psi0 + eps * Q2_psi0
        A[i, 2, 1] = Q1_y + eps * Q2_y
        A[i, 2, 2] = Q1_v + eps * Q2_v
        A[i, 2, 3] = Q1_vr + eps * Q2_vr
        D[i, 2, 0] = Q1_psi1 + eps * Q2_psi1
        D[i, 2, 1] = 0.0
        D[i, 2, 2] = -1.0
        D[i, 2, 3] = 0.0
        Q[i, 2] = dQ1 + eps * dQ2 + d_eps * Q2
        F[i, 3] = Q1r + eps * Q2r - v1_rate
        A[i, 3, 0] = Q1r_psi0 + eps * Q2r_psi0
        A[i, 3, 1] = Q1r_y + eps * Q2r_y
        A[i, 3, 2] = Q1r_v + eps * Q2r_v
        A[i, 3, 3] = Q1r_vr + eps * Q2r_vr
        D[i, 3, 0] = Q1r_psi1 + eps * Q2r_psi1
        D[i, 3, 1] = 0.0
        D[i, 3, 2] = 0.0
        D[i, 3, 3] = -1.0
        Q[i, 3] = dQ1r + eps * dQ2r + d_eps * Q2r
        # --- rows 0 and 1: what ends the segment
        for c in range(2):
            D[i, c, 1] = 0.0
            D[i, c, 2] = 0.0
            D[i, c, 3] = 0.0
        D[i, 1, 1] = -1.0
        if arrival < 2:
            wall = 1.0 - 2.0 * arrival
            F[i, 0] = Q1 - Q2 - wall
            A[i, 0, 0] = Q1_psi0 - Q2_psi0
            A[i, 0, 1] = Q1_y - Q2_y
            A[i, 0, 2] = Q1_v - Q2_v
            A[i, 0, 3] = Q1_vr - Q2_vr
            D[i, 0, 0] = Q1_psi1 - Q2_psi1
            Q[i, 0] = dQ1 - dQ2
            # v' + r w' = (1 + r) q1' + (eps - r) q2'
            f, h = 1.0 + r, eps - r
            F[i, 1] = f * Q1r + h * Q2r - y1
            A[i, 1, 0] = f * Q1r_psi0 + h * Q2r_psi0
            A[i, 1, 1] = f * Q1r_y + h * Q2r_y
            A[i, 1, 2] = f * Q1r_v + h * Q2r_v
            A[i, 1, 3] = f * Q1r_vr + h * Q2r_vr
            D[i, 1, 0] = f * Q1r_psi1 + h * Q2r_psi1
            Q[i, 1] = f * dQ1r + h * dQ2r + d_eps * Q2r + d_r * (Q1r - Q2r)
        else:
            F[i, 1] = Q1 - Q2 - y1
            A[i, 1, 0] = Q1_psi0 - Q2_psi0
            A[i, 1, 1] = Q1_y - Q2_y
            A[i, 1, 2] = Q1_v - Q2_v
            A[i, 1, 3] = Q1_vr - Q2_vr
            D[i, 1, 0] = Q1_psi1 - Q2_psi1
            Q[i, 1] = dQ1 - dQ2
            if (
                arrival == 4
            ):  # friction gives way: v'' = -q1 - eps lambda q1' + e + eps lambda e' reaches m a + b
                base = s1 + chi * rate * omega * c1
                F[i, 0] = -Q1 - rate * Q1r + force * base - whole * (after * pull + lean)
                A[i, 0, 0] = -Q1_psi0 - rate * Q1r_psi0
                A[i, 0, 1] = -Q1_y - rate * Q1r_y
                A[i, 0, 2] = -Q1_v - rate * Q1r_v
                A[i, 0, 3] = -Q1_vr - rate * Q1r_vr
                D[i, 0, 0] = -Q1_psi1 - rate * Q1r_psi1 + force * (c1 - chi * rate * omega * s1)
                Q[i, 0] = (
                    -dQ1 - rate * dQ1r - d_rate * Q1r + d_force * base + force * d_lever * c1
                    - d_eps * (after * pull + lean) - whole * (after * d_pull + d_lean)
                )  # fmt: skip
            elif event < 2 or mode == 0:
                F[i, 0] = Q1r - Q2r
                A[i, 0, 0] = Q1r_psi0 - Q2r_psi0
                A[i, 0, 1] = Q1r_y - Q2r_y
                A[i, 0, 2] = Q1r_v - Q2r_v
                A[i, 0, 3] = Q1r_vr - Q2r_vr
                D[i, 0, 0] = Q1r_psi1 - Q2r_psi1
                Q[i, 0] = dQ1r - dQ2r
            elif abs(d) < SHORT:
                # from rest to rest, hardly apart: the second derivative of w and half of the third times d
                base, base_psi = s0 + chi * rate * omega * c0, c0 - chi * rate * omega * s0
                jerk = force * omega * base_psi - q1_rate - rate * q1_acceleration
                F[i, 0] = q1_acceleration - slides + 0.5 * jerk * d
                A[i, 0, 0] = force * base_psi - 0.5 * jerk * by_omega
                A[i, 0, 1] = -q1_y - rate * q1r_y
                A[i, 0, 2] = -part
                A[i, 0, 3] = -rate * q1r_vr
                D[i, 0, 0] = 0.5 * jerk * by_omega
                Q[i, 0] = (
                    d_force * base + force * d_lever * c0 + d_offset - dq1 - d_rate * q1_rate - rate * dq1r
                    - d_slides + 0.5 * jerk * dd
                )  # fmt: skip
            else:
                # from rest to rest: the mean of w'' over the flight, w'/d, so that no flight of no duration solves it
                half = 0.5 * (psi1 - psi0)
                middle = 0.5 * (psi1 + psi0)
                short = math.sin(0.5 * beta * d)
                loss = (
                    math.expm1(-alpha * d) * math.cos(beta * d) - 2.0 * short * short - alpha * S
                )  # T22 - 1
                swing = 2.0 * omega * math.sin(half) * (X * math.sin(middle) + Y * math.cos(middle))
                by_d = 1.0 / d
                mean = (T21 * z + loss * zr - swing) * by_d - slides
                F[i, 0] = mean
                A[i, 0, 0] = (Q1r_psi0 - Q2r_psi0 + mean * by_omega) * by_d
                A[i, 0, 1] = (Q1r_y - Q2r_y) * by_d
                A[i, 0, 2] = (Q1r_v - Q2r_v) * by_d
                A[i, 0, 3] = loss * part * by_d
                D[i, 0, 0] = (Q1r_psi1 - Q2r_psi1 - mean * by_omega) * by_d
                Q[i, 0] = (dQ1r - dQ2r - mean * dd) * by_d
        size = max(max(abs(F[i, 0]), abs(F[i, 1])), max(abs(F[i, 2]), abs(F[i, 3])))
        if not size <= largest:
            largest = size
    if pinned and twist > 0.0:
        largest = max(largest, _pin(F, A, D, Q, u, modes, work.pin))
    if not np.isfinite(largest):
        return np.inf
    return largest


def _pin(F, A, D, Q, u, modes, pin):
    """Replace the displacement equation of the last flight by w_i + w_{i+1} = 0; what was there goes to `pin`.

    Returns what the mean position is off by.
    """
    last = last_flight(modes)
    for c in range(4):
        pin[c] = A[last, 1, c]
        pin[4 + c] = D[last, 1, c]
        A[last, 1, c] = 0.0
        D[last, 1, c] = 0.0
    pin[8] = F[last, 1]
    A[last, 1, 1] = 1.0
    D[last, 1, 1] = 1.0
    F[last, 1] = u[4 * last + 1] + (u[4 * last + 5] if last + 1 < F.shape[0] else u[1])
    Q[last, 1] = 0.0
    return abs(F[last, 1])


def unpin(data, work):
    """Put the displacement equation back, for the multipliers."""
    if data.pinned and data.twist > 0.0:
        A, D, pin = work.A, work.D, work.pin
        last = last_flight(data.modes)
        for c in range(4):
            A[last, 1, c] = pin[c]
            D[last, 1, c] = pin[4 + c]
