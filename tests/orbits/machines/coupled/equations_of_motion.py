"""The coupled machine's equations of motion, written down apart from `orbits`, and their integration from event to event (scipy's DOP853)."""

import math

from scipy.integrate import solve_ivp

TIGHT = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14}


def right_side(params, s):
    """(q1, q1', q2, q2') and time since phase 0 -> rates, in mode s."""
    G, Omega, lam, eps, _r, mu, g, chi, slope = params
    absorber = mu * g * math.cos(slope) * s + g * math.sin(slope)

    def rates(t, y):
        q1, p1, _q2, p2 = y
        base = eps * G * (math.sin(Omega * t) + chi * eps * lam * Omega * math.cos(Omega * t))
        if s == 0:
            acceleration = (base - eps * lam * p1 - q1) / (1.0 + eps)
            return [p1, acceleration, p2, acceleration]
        return [p1, base - eps * lam * p1 - q1 - eps * absorber, p2, absorber]

    return rates


def push(params, t, y):
    """v'', which friction does not enter, less the acceleration down the slope."""
    G, Omega, lam, eps, _r, _mu, g, chi, slope = params
    base = eps * G * (math.sin(Omega * t) + chi * eps * lam * Omega * math.cos(Omega * t))
    return base - eps * lam * y[1] - y[0] - (1.0 + eps) * g * math.sin(slope)


def event(function, direction):
    """`function` as a terminal event of solve_ivp."""
    function.terminal, function.direction = True, direction
    return function


def integrate(params, t, y, s, count):
    """The first `count` events after a start: list of (letter, phase, w, w' before, v, v')."""
    _G, Omega, _lam, eps, r, mu, g, _chi, slope = params
    a = (1.0 + eps) * mu * g * math.cos(slope)
    events = []
    while len(events) < count:
        if s != 0:
            watch = [
                event(lambda t, y, s=s: s - (y[0] - y[2]), -s),
                event(lambda t, y: y[1] - y[3], -s),
            ]
        else:
            watch = [
                event(lambda t, y: push(params, t, y) - a, 1.0),
                event(lambda t, y: push(params, t, y) + a, -1.0),
            ]
        run = solve_ivp(right_side(params, s), (t, t + 60.0), y, events=watch, **TIGHT)
        assert run.status == 1, "no event in ten periods"
        t, y = float(run.t[-1]), run.y[:, -1]
        before = y[1] - y[3]
        if s == 0:
            s = 1 if run.t_events[0].size else -1
            letter = "u"
        elif run.t_events[0].size:
            letter = "L" if s > 0 else "R"
            v_rate = y[1] + eps * y[3]
            after = -r * before
            y[1], y[3] = (v_rate + eps * after) / (1.0 + eps), (v_rate - after) / (1.0 + eps)
            s = -s
        else:
            y[1] = y[3] = (y[1] + eps * y[3]) / (1.0 + eps)
            before = 0.0
            if -s * push(params, t, y) > a:
                letter, s = "t", -s
            else:
                letter, s = "s", 0
        events.append((letter, Omega * t, y[0] - y[2], before, y[0] + eps * y[2], y[1] + eps * y[3]))
    return events
