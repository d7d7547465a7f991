"""Margins of admissibility of orbits in a shaken cavity; notation: `orbits.machines.reference.shaken_stepper`."""

from __future__ import annotations

import numpy as np

from orbits.settings import EVENTS, STEPPING


def reversal(pull, peak):
    """The friction's and slope's share of the shaking, and its arc sine (0 where there is none)."""
    if not peak > 0.0:
        return (np.inf if pull >= 0.0 else -np.inf), 0.0
    ratio = pull / peak
    return ratio, (np.arcsin(ratio) if -1.0 < ratio < 1.0 else 0.0)


def _ahead(angle):
    """An angle modulo a turn: 0 or ahead, but for rounding, which must not make a turn of an instant that is now."""
    turn = 2.0 * np.pi
    rest = angle - turn * np.floor(angle / turn)
    return rest - turn if rest > turn - STEPPING.slip else rest


def _reach(law, w0, beta, psi0, psi1):
    """Smallest distance from the walls at the extrema of w inside a flight on a slope without friction.

    w' = C Omega cos Psi - beta - b (t - t0) is monotone between the zeros of w'', so each piece has at most one zero.
    """
    C, omega, b = law.amplitude, law.omega, law.lean
    speed = C * omega
    ratio, angle = reversal(b, speed * omega)
    least = np.inf
    begin, before = psi0, speed * np.cos(psi0) - beta
    while begin < psi1:
        end = psi1
        if -1.0 < ratio < 1.0:  # sin Psi = -b/(C Omega^2)
            for base in (-angle, np.pi + angle):
                zero = base + 2.0 * np.pi * (np.floor((begin - base) / (2.0 * np.pi)) + 1.0)
                if begin + EVENTS.zero < zero < end:
                    end = zero
        after = speed * np.cos(end) - beta - b * (end - psi0) / omega
        if before * after < 0.0:
            low, high = begin, end
            for _ in range(60):
                psi = 0.5 * (low + high)
                here = speed * np.cos(psi) - beta - b * (psi - psi0) / omega
                if here * before > 0.0:
                    low = psi
                else:
                    high = psi
            d = (low - psi0) / omega
            w = w0 + C * (np.sin(low) - np.sin(psi0)) - (beta + 0.5 * b * d) * d
            least = min(least, min(law.left - w, w - law.right))
        begin, before = end, after
    return least


def margins(law, data, u, work, out):
    """Margins of admissibility, none negative for an orbit that a machine can follow.

    Reads sines and cosines of the last `linearise` from `work`. `out` has shape (4 L,), four numbers per node:
    0 the flight after it (smallest s w' at an interior minimum; without friction the distance from the walls at the extrema; stuck: time
    to the slip, negative unless it is the first time friction gives way), 1 the event (approach speed, excess of
    shaking over friction, reserve of friction, rate at which friction gives way), 2 the wall (distance from the nearer one, away from impacts),
    3 the duration of the segment. Infinity where there is nothing to watch.
    """
    events, modes, twist, shift = data.events, data.modes, data.twist, data.shift
    sines, cosines = work.sines, work.cosines
    length = events.shape[0]
    C, omega = law.amplitude, law.omega
    free = law.frictionless
    by_omega = 1.0 / omega
    peak = C * omega * omega
    speed = C * omega
    two_pi = 2.0 * np.pi
    # s w' has its interior minima where sin Psi = -s k_s/peak and s cos Psi < 0, with k_s = a_s + s b
    left_ratio, left_reversal = reversal(law.pull_left, peak)
    right_ratio, right_reversal = reversal(-law.pull_right, peak)
    left_cosine = -np.sqrt(max(0.0, 1.0 - left_ratio * left_ratio))
    right_cosine = np.sqrt(max(0.0, 1.0 - right_ratio * right_ratio))
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
        d = (psi1 - psi0) * by_omega
        beta = u[2 * i + 1] if event < 2 else speed * c0
        flight = np.inf
        if mode == 0:
            # the first time that -m C Omega^2 sin Psi = a with growing left side, for either direction m of the slip
            if left_ratio <= -1.0 or right_ratio <= -1.0:
                flight = -1.0  # it always gives way
            elif left_ratio < 1.0 or right_ratio < 1.0:
                first = np.inf
                if left_ratio < 1.0:
                    first = _ahead(np.pi + left_reversal - psi0)
                if right_ratio < 1.0:
                    first = min(first, _ahead(right_reversal - psi0))
                late = (psi1 - psi0) - first
                flight = d if abs(late) < STEPPING.slip else -abs(late)
            else:
                flight = -1.0
        elif not free:
            # k_s and where s w' is smallest
            pull = law.pull_left if mode > 0 else -law.pull_right
            ratio = left_ratio if mode > 0 else right_ratio
            turning = left_reversal if mode > 0 else right_reversal
            if -1.0 < ratio < 1.0 and (
                event != 2 or -mode * peak * s0 > pull
            ):  # else the turn's own margin says it
                # mode +: Psi = pi + reversal (cos < 0);  mode -: Psi = reversal (cos > 0)
                base = np.pi + turning if mode > 0 else turning
                last = base + two_pi * np.floor((psi1 - base) / two_pi)
                if last >= psi1 - EVENTS.at_end * (1.0 if arrival >= 2 else 0.0):
                    last -= two_pi
                # a slip starts at such a minimum, which is not inside the flight; the next one is 2 pi away
                early = 1.0 if event == 4 else (EVENTS.at_end if event >= 2 else 0.0)
                if last > psi0 + early:
                    cosine = left_cosine if mode > 0 else right_cosine
                    # s w' = s (speed cos - beta) - k_s (t - t0): the last minimum is the lowest one, the first one if k_s < 0
                    if pull < 0.0:
                        last -= two_pi * np.ceil((last - psi0 - early) / two_pi - 1.0)
                    flight = mode * (speed * cosine - beta) - pull * (last - psi0) * by_omega
        else:
            # without friction the flight may reverse; the walls must hold inside it: extrema where cos Psi = beta/speed
            w0 = (law.left if event == 0 else law.right) if event < 2 else u[2 * i + 1]
            if law.lean != 0.0:
                flight = _reach(law, w0, beta, psi0, psi1)
            elif abs(beta) < speed:
                angle = np.arccos(beta / speed)
                for sign in (-1.0, 1.0):
                    psi = sign * angle
                    psi += two_pi * np.ceil((psi0 - psi) / two_pi)
                    while psi < psi1:
                        if psi > psi0:
                            w = w0 + C * (np.sin(psi) - s0) - beta * (psi - psi0) * by_omega
                            flight = min(flight, min(law.left - w, w - law.right))
                        psi += two_pi
        out[4 * i] = flight
        wall = np.inf
        incoming = modes[i - 1] if i > 0 else (modes[length - 1] if twist > 0.0 else -modes[length - 1])
        push = -peak * s0  # v''
        if event >= 2:
            wall = min(law.left - u[2 * i + 1], u[2 * i + 1] - law.right)
        if event == 2:
            out[4 * i + 1] = law.pull_right - push if incoming > 0 else push - law.pull_left
        elif event == 3:
            out[4 * i + 1] = min(law.pull_left - push, push - law.pull_right)
        elif event == 4:
            out[4 * i + 1] = -mode * c0 * peak
        out[4 * i + 2] = wall
        out[4 * i + 3] = d
        if arrival < 2:
            approach = (1.0 - 2.0 * arrival) * (
                speed * c1 - beta - (law.pull_left if mode > 0 else law.pull_right) * d
            )
            following = i + 1 if i + 1 < length else 0
            out[4 * following + 1] = approach
