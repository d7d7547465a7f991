"""Margins of admissibility of the reduced absorber's orbits (compiled); notation: `orbits.machines.absorber.maps`."""

from __future__ import annotations

import numpy as np

from orbits.compiling.decorators import kernel


@kernel
def margins(data, u, p, work, out):
    """Margins of admissibility, all positive for an orbit that a machine can follow .

    Reads sines and cosines of the last `linearise` from `work`. `out` has shape (4 L,), four numbers per node:
    0 the flight after it (smallest s w' at an interior minimum; without friction 1 - |w| at the extrema; stuck: time
    to the slip, negative unless it is the first time friction gives way), 1 the event (approach speed, excess of
    shaking over friction, reserve of friction, rate at which friction gives way), 2 the wall (1 - |w| away from impacts),
    3 the duration of the segment. Infinity where there is nothing to watch.
    """
    events, modes, twist, shift = data[0], data[1], data[4], data[5]
    par, sines, cosines = work[4], work[22], work[23]
    length = events.shape[0]
    C, mu, g, eps, omega = par[0], par[2], par[3], par[4], par[5]
    a = (1.0 + eps) * mu * g
    peak = C * omega * omega
    speed = C * omega
    two_pi = 2.0 * np.pi
    ratio = a / peak if peak > 0.0 else np.inf
    # s w' has its interior minima where sin Psi = -s a/peak and s cos Psi < 0
    reversal = np.arcsin(ratio) if ratio < 1.0 else 0.0
    for i in range(length):
        event = events[i]
        mode = modes[i]
        psi0 = u[2 * i]
        if i + 1 < length:
            psi1 = u[2 * i + 2]
            arrival = events[i + 1]
        else:
            psi1 = u[0] + shift
            arrival = events[0] if twist > 0.0 or events[0] > 1 else 1 - events[0]
        s0, c0 = sines[i], cosines[i]
        c1 = cosines[i + 1]
        d = (psi1 - psi0) / omega
        beta = u[2 * i + 1] if event < 2 else speed * c0
        flight = np.inf
        if mode == 0:
            # the first time that -m C Omega^2 sin Psi = a with growing left side, for either direction m of the slip
            if ratio < 1.0:
                up = np.pi + reversal - psi0
                down = reversal - psi0
                up -= two_pi * np.floor(up / two_pi)
                down -= two_pi * np.floor(down / two_pi)
                first = min(up, down)
                late = (psi1 - psi0) - first
                flight = d if abs(late) < 1e-6 else -abs(late)
            else:
                flight = -1.0
        elif a > 0.0:
            if ratio < 1.0 and (event != 2 or -mode * peak * s0 > a):  # else the turn's own margin says it
                # mode +: Psi = pi + reversal (cos < 0);  mode -: Psi = reversal (cos > 0)
                base = np.pi + reversal if mode > 0 else reversal
                last = base + two_pi * np.floor((psi1 - base) / two_pi)
                if last >= psi1 - 1e-9 * (1.0 if arrival >= 2 else 0.0):
                    last -= two_pi
                # a slip starts at such a minimum, which is not inside the flight; the next one is 2 pi away
                early = 1.0 if event == 4 else (1e-9 if event >= 2 else 0.0)
                if last > psi0 + early:
                    cosine = -mode * np.sqrt(1.0 - ratio * ratio)
                    # s w' = s (speed cos - beta) - a (t - t0): the last minimum is the lowest one
                    flight = mode * (speed * cosine - beta) - a * (last - psi0) / omega
        else:
            # without friction the flight may reverse; the walls must hold inside it: extrema where cos Psi = beta/speed
            w0 = 1.0 - 2.0 * event if event < 2 else u[2 * i + 1]
            if abs(beta) < speed:
                angle = np.arccos(beta / speed)
                for sign in (-1.0, 1.0):
                    psi = sign * angle
                    psi += two_pi * np.ceil((psi0 - psi) / two_pi)
                    while psi < psi1:
                        if psi > psi0:
                            w = w0 + C * (np.sin(psi) - s0) - beta * (psi - psi0) / omega
                            flight = min(flight, 1.0 - abs(w))
                        psi += two_pi
        out[4 * i] = flight
        wall = np.inf
        incoming = modes[i - 1] if i > 0 else (modes[length - 1] if twist > 0.0 else -modes[length - 1])
        push = -peak * s0  # v''
        if event >= 2:
            wall = 1.0 - abs(u[2 * i + 1])
        if event == 2:
            out[4 * i + 1] = -incoming * push - a
        elif event == 3:
            out[4 * i + 1] = a - abs(push)
        elif event == 4:
            out[4 * i + 1] = -mode * c0 * peak
        out[4 * i + 2] = wall
        out[4 * i + 3] = d
        if arrival < 2:
            approach = (1.0 - 2.0 * arrival) * (speed * c1 - beta - mode * a * d)
            following = i + 1 if i + 1 < length else 0
            out[4 * following + 1] = approach
