"""Margins of admissibility of the coupled machine's orbits."""

from __future__ import annotations

import math

import numpy as np

from orbits.machines.coupled.flow import certain, derivative, first_zero, harmonic, oscillation, rates, wave


def _slowest(s, brake, q2_rate, h0, h1, z0, z1, omega, alpha, beta, force, start, end):
    """Smallest s w' at an interior minimum on start < tau < end of a slide, infinity if there is none.

    w'' = q1'' - q2'' is followed, s q2'' being `brake`, from zero to zero by steps that cannot pass one (`coupled_flow.certain`); the fourth
    derivative of q1 is an oscillator's response to a force of amplitude Omega^4 `force`, which bounds it. A zero needs to
    be known to 1e-5 only: the minimum is then taken from the Taylor series, exact to roundoff.
    """
    square = omega * omega
    kappa = alpha * alpha + beta * beta
    smallest = np.inf
    tau = start
    bound = -1.0
    while True:
        angle = omega * tau
        sine, cosine = math.sin(angle), math.cos(angle)
        H0 = h0 * cosine + h1 / omega * sine
        H1 = h1 * cosine - omega * h0 * sine
        decay = math.exp(-alpha * tau)
        angle = beta * tau
        cosine = decay * math.cos(angle)
        sine = decay * math.sin(angle) / beta
        Z1 = z1 * cosine - (alpha * z1 + kappa * z0) * sine
        Z2 = -2.0 * alpha * Z1 - kappa * (z0 * cosine + (z1 + alpha * z0) * sine)
        Z3 = -2.0 * alpha * Z2 - kappa * Z1
        y = s * (Z2 - square * H0) - brake
        slope = s * (Z3 - square * H1)
        if bound < 0.0:
            fourth = square * square * H0 - 2.0 * alpha * Z3 - kappa * Z2
            fifth = square * square * H1 + 2.0 * alpha * (2.0 * alpha * Z3 + kappa * Z2) - kappa * Z3
            growth = square * square * force * (end - start) / math.sqrt(kappa)
            bound = math.sqrt(fourth * fourth + fifth * fifth / kappa) + growth
            if not bound > 1e-300:
                return smallest
        sign = 1.0 if y > 0.0 else -1.0
        step = certain(abs(y), sign * slope, bound)
        if step < 1e-5:
            zero = -y / slope if sign * slope < 0.0 else 0.0
            if tau + zero >= end:
                return smallest
            if slope > 0.0:
                speed = s * (H1 + Z1 - q2_rate) - brake * tau
                smallest = min(smallest, speed + (y + 0.5 * slope * zero) * zero)
            step = zero + max(abs(slope) / bound, 1e-5)
        tau += step
        if not tau < end:
            return smallest


def margins(data, u, p, work, out):
    """Margins of admissibility, none negative for an orbit that a machine can follow.

    `out` has shape (4 L,), four numbers per node; infinity where there is nothing to watch. Reads parameters, sines and
    cosines of the last `linearise` from `work`. All zeros are found by `coupled_flow.first_zero`: none can be missed.

    0. The flight after the node. Sliding: smallest s w' at an interior minimum (`_slowest`). Without
       friction, where a flight may reverse: 1 - |w| at the zeros of w'. Stuck: smallest a - |v'' - b| at an interior extremum.
    1. The event. Impact: approach speed. Turn: -s (v'' - b) - a with s the mode before, since the relative acceleration
       v'' - b - a S cannot vanish for any S in [-1, 1] exactly when |v'' - b| > a. Stick: a - |v'' - b|. Slip: m v''' at its start.
       Here v'' = -q1 - eps lambda q1' + e + eps lambda e', which neither friction nor gravity enters, and
       b = (1 + eps) g sin(slope).
    2. The wall: 1 - |w| away from impacts.
    3. The duration of the segment.
    """
    events, modes, twist, shift = data.events, data.modes, data.twist, data.shift
    par, sines, cosines = work.numbers, work.sines, work.cosines
    length = events.shape[0]
    G, omega, lam, eps, r, mu, g, chi, angle = par[:9]
    whole = 1.0 + eps
    rate = eps * lam
    force = eps * G
    pull, lean = mu * g * math.cos(angle), g * math.sin(angle)
    a, b = whole * pull, whole * lean
    square = omega * omega
    slide_X, slide_Y = harmonic(force, chi, rate * omega, 1.0 - square)
    stuck_X, stuck_Y = harmonic(force, chi, rate * omega, 1.0 - whole * square)
    slide_alpha, slide_beta = rates(1.0, rate)
    stuck_alpha, stuck_beta = rates(whole, rate)
    strength = force * math.sqrt(1.0 + chi * chi * rate * rate * square)
    for i in range(length):
        event = events[i]
        mode = modes[i]
        k = 4 * i
        psi0, y0, v0, v0_rate = u[k], u[k + 1], u[k + 2], u[k + 3]
        if i + 1 < length:
            arrival = events[i + 1]
            psi1, y1, v1_rate = u[k + 4], u[k + 5], u[k + 7]
        else:
            arrival = events[0] if twist > 0.0 or events[0] > 1 else 1 - events[0]
            psi1, y1, v1_rate = u[0] + shift, twist * u[1], twist * u[3]
        s0, c0 = sines[i], cosines[i]
        d = (psi1 - psi0) / omega
        if event < 2:
            w0 = 1.0 - 2.0 * event
            q2_rate = y0 / whole
            q1_rate = v0_rate - eps * q2_rate
        else:
            w0 = y0
            q1_rate = q2_rate = v0_rate / whole
        q1 = (v0 + eps * w0) / whole
        push = -q1 - rate * q1_rate + force * (s0 + chi * rate * omega * c0) - b
        if mode != 0:
            X, Y, alpha, beta = slide_X, slide_Y, slide_alpha, slide_beta
        else:
            X, Y, alpha, beta = stuck_X, stuck_Y, stuck_alpha, stuck_beta
        acceleration = mode * pull + lean if mode != 0 else 0.0  # of q2
        offset = -eps * acceleration
        h0, h1 = X * s0 + Y * c0, omega * (X * c0 - Y * s0)
        z0, z1 = q1 - h0 - offset, q1_rate - h1
        A, B = oscillation(alpha, beta, z0, z1)
        P1, Q1, A1, B1 = derivative(omega, alpha, beta, X, Y, A, B)
        P2, Q2, A2, B2 = derivative(omega, alpha, beta, P1, Q1, A1, B1)
        P3, Q3, A3, B3 = derivative(omega, alpha, beta, P2, Q2, A2, B2)
        flight = np.inf
        if not d > 0.0:
            pass
        elif mode == 0:
            tau = 0.0
            while True:
                tau, _ = first_zero(0.0, P3, Q3, A3, B3, omega, alpha, beta, psi0, tau, d)
                if tau >= d:
                    break
                q1_second, _ = wave(0.0, P2, Q2, A2, B2, omega, alpha, beta, psi0, tau)
                flight = min(flight, a - abs(whole * q1_second - b))
        elif a > 0.0:
            tau = 0.0
            if event == 4:  # w' = w'' = 0 at the start of a slip: go as far as m w''' keeps its sign
                bound = square * math.hypot(P2, Q2) + (alpha * alpha + beta * beta) * math.hypot(A2, B2)
                if bound > 0.0:
                    tau = min(abs(P3 * s0 + Q3 * c0 + A3) / bound, 0.5 * d)
            if event != 2 or mode * push > a:  # else the turn's own margin says it
                flight = _slowest(
                    mode, mode * acceleration, q2_rate, h0, h1, z0, z1, omega, alpha, beta, strength, tau, d
                )
        else:
            tau = 0.0
            while True:
                tau, _ = first_zero(-q2_rate, P1, Q1, A1, B1, omega, alpha, beta, psi0, tau, d, -lean)
                if tau >= d:
                    break
                position, _ = wave(offset, X, Y, A, B, omega, alpha, beta, psi0, tau)
                flight = min(flight, 1.0 - abs(w0 - q1 + position - (q2_rate + 0.5 * lean * tau) * tau))
        out[k] = flight
        incoming = modes[i - 1] if i > 0 else (modes[length - 1] if twist > 0.0 else -modes[length - 1])
        out[k + 2] = np.inf
        if event >= 2:
            out[k + 2] = 1.0 - abs(y0)
        if event == 2:
            out[k + 1] = -incoming * push - a
        elif event == 3:
            out[k + 1] = a - abs(push)
        elif event == 4:
            # q1''' of the slide that begins; w''' = q1''' there
            out[k + 1] = mode * (P3 * s0 + Q3 * c0 + A3)
        out[k + 3] = d
        if arrival < 2:
            following = i + 1 if i + 1 < length else 0
            # the wall's reaction: w'+ = -r w'-, and B+ = v' - w'+
            out[4 * following + 1] = (1.0 - 2.0 * arrival) * (y1 - v1_rate) / r
