"""Absorbers on an oscillator: Newton's and Coulomb's laws, written down apart from `orbits`, integrated from event to event (scipy's DOP853)."""

import math
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

TIGHT = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14}


class Mass(NamedTuple):
    """An absorber: its mass, the room to either side, restitution, accelerations by friction and by the slope."""

    mass: float
    room: float
    restitution: float
    hold: float
    lean: float = 0.0


def driven(params):
    """The coupled machine's force on its oscillator, counted from where both rest, and its absorber."""
    G, Omega, lam, eps, r, mu, g, chi, slope = params

    def force(t, q, v):
        base = math.sin(Omega * t) + chi * eps * lam * Omega * math.cos(Omega * t)
        return eps * G * base - eps * lam * v - q

    return force, Mass(eps, 1.0, r, mu * g * math.cos(slope), g * math.sin(slope))


def rates(force, mass, absorbers, modes):
    """(q, x1, ..., q', x1', ...) and time -> rates, while absorbers slide (mode 1 or -1) or stick (0)."""
    pulls = [mode * a.hold + a.lean for a, mode in zip(absorbers, modes)]
    heavy = mass + sum(a.mass for a, mode in zip(absorbers, modes) if not mode)
    pulled = sum(a.mass * pull for a, pull, mode in zip(absorbers, pulls, modes) if mode)

    def of(t, y):
        speeds = y[len(y) // 2 :]
        own = (force(t, y[0], speeds[0]) - pulled) / heavy
        return [*speeds, own, *(pull if mode else own for pull, mode in zip(pulls, modes))]

    return of


def right_side(params, s):
    """Rates of the coupled machine's (q1, q1', q2, q2'), time since phase 0, in mode s."""
    force, absorber = driven(params)
    of = rates(force, 1.0, [absorber], [s])
    return lambda t, y: np.array(of(t, np.asarray(y)[[0, 2, 1, 3]]))[[0, 2, 1, 3]]


def integrate(force, mass, absorbers, y, count, atol=1e-14):
    """The first events after time 0: list of (letter and number of the absorber, time, state after it, relative speed before)."""
    n, t, found, y = len(absorbers), 0.0, [], np.array(y, dtype=float)
    modes = [int(np.sign(y[n + 1] - speed)) for speed in y[n + 2 :]]

    def beyond(i, t, y):
        """What it would take to hold an absorber that rests in its cavity, and how much of that is more than friction."""
        resting = [0 if j == i else mode for j, mode in enumerate(modes)]
        needed = rates(force, mass, absorbers, resting)(t, y)[n + 1] - absorbers[i].lean
        return needed, abs(needed) - absorbers[i].hold

    def choose(i):
        needed, more = beyond(i, t, y)
        modes[i] = int(np.sign(needed)) if more > 0.0 else 0

    def watch(i):
        s = modes[i]
        halts = (lambda t, y: s * (y[n + 1] - y[n + 2 + i])) if s else (lambda t, y: -beyond(i, t, y)[1])
        hits = (lambda t, y: absorbers[i].room - s * (y[0] - y[1 + i])) if s else (lambda t, y: 1.0)
        for event in (halts, hits):
            event.terminal, event.direction = True, -1
        return halts, hits

    for i in range(n):
        if not modes[i]:
            choose(i)
    while len(found) < count:
        events = [event for i in range(n) for event in watch(i)]
        of = rates(force, mass, absorbers, modes)
        run = solve_ivp(of, (t, t + 60.0), y, events=events, **TIGHT | {"atol": atol})
        assert run.status == 1, "no event"
        t, y = float(run.t[-1]), run.y[:, -1]
        k = next(k for k, times in enumerate(run.t_events) if times.size)
        i, s = k // 2, modes[k // 2]
        before, a = y[n + 1] - y[n + 2 + i], absorbers[k // 2]
        if k % 2:
            impulse = (1 + a.restitution) * before * a.mass * mass / (a.mass + mass)
            y[n + 1], y[n + 2 + i] = y[n + 1] - impulse / mass, y[n + 2 + i] + impulse / a.mass
            modes[i], letter = -s, "L" if s > 0 else "R"
        elif s == 0:
            modes[i], letter = int(np.sign(beyond(i, t, y)[0])), "u"
        else:
            momentum = mass * y[n + 1] + a.mass * y[n + 2 + i]
            y[n + 1] = y[n + 2 + i] = momentum / (mass + a.mass)
            choose(i)
            letter, before = "t" if modes[i] else "s", 0.0
        found.append((f"{letter}{i + 1}", t, y.copy(), before))
        for j in range(n):
            if j != i and not modes[j]:  # it may not bear it
                choose(j)
                found += [(f"u{j + 1}", t, y.copy(), 0.0)] if modes[j] else []
    return found[:count]
