"""Event-driven simulation of a shaken cavity, w'' = -C Omega^2 sin Psi - b - s a_s.

Everything is written in the phase x = Omega d that has passed since the start of a leg and in the direction of
the motion s, with theta = Psi (s = -1) or Psi - pi (s = +1), p = s w'/Omega, A = (a_s + s b)/Omega^2:

    y''(x) = q(x) = C sin(theta_0 + x) - A,  y'(x) = p(x),  y(x) = s (w - w_0).

q is positive for theta in (alpha, pi - alpha), alpha = arcsin(A/C), and negative on the rest of the circle (A < -C, on a steep slope:
positive everywhere), so a
leg that ends at the next theta = alpha is one rising and one falling piece of p. On the rising piece y is
convex and Newton's iteration for the hit y = D, started from its right end, comes down to the root without
crossing it; on the falling piece y is concave and Newton's iteration from the left climbs to the root without
crossing it, or runs past the point where p = 0: then there is no hit before the turn. No hit and no turn can be missed.

Differences such as x - sin x are evaluated without cancellation, and positions are kept with the digits
below their roundoff, so that flights, turns and impacts keep their relative accuracy however small they are.
The signatures are those of :mod:`orbits.machines.stepping`.
"""

from __future__ import annotations

import math

import numpy as np

from orbits.machines.digits import remainders, shift, wrap
from orbits.machines.reference.legs import angle_of, directions, fall
from orbits.numbers import ROUNDOFF
from orbits.settings import EVENTS, STEPPING

_L, _R, _T, _S, _U, _HOLD = 0, 1, 2, 3, 4, 5
_EVENTS_FULL, _TIME_REACHED, _REST, _FAILED = 0, 1, 2, 3
_TWO_PI = 2.0 * math.pi


def advance(law, state, until, codes, modes, rows):
    """Run from event to event; see :mod:`orbits.machines.stepping`, item 3.

    In one piece: the state of a leg is some thirty local numbers, which every part of the loop reads and changes.
    """
    C = law.amplitude
    omega = law.omega
    rightwards, leftwards = directions(law)
    free = law.frictionless
    size = C + abs(law.lean) / (omega * omega)
    psi = state[0]
    w = state[1]
    p = abs(state[2]) / omega
    s = state[3]
    turns = state[4]
    low = state[5]
    if not (
        math.isfinite(psi)
        and math.isfinite(w)
        and math.isfinite(p)
        and math.isfinite(size)
        and math.isfinite(leftwards.pull)
    ):
        return 0, _FAILED
    room = codes.shape[0]
    at_root = False  # the leg starts exactly where q = 0, q rising
    ahead = leftwards if s > 0.0 else rightwards
    if ahead.driven and s != 0.0 and p == 0.0 and -s * math.cos(psi) > 0.0:
        at_root = abs(-s * C * math.sin(psi) - ahead.pull) < EVENTS.zero * C  # a slip
    count = 0
    status = _EVENTS_FULL
    while True:
        if count == room:
            break
        left = (until - turns) * _TWO_PI - psi
        if not left > 0.0:
            status = _TIME_REACHED
            break
        # ---- at rest on the floor, or against a wall -------------------------------------------------------
        if s == 0.0:
            wait = math.inf
            for way in (-1.0, 1.0):
                ahead = leftwards if way > 0.0 else rightwards
                if way * w >= ahead.reach or not ahead.driven:
                    continue
                theta = angle_of(psi, way, ahead.alpha)
                if ahead.always or ahead.alpha <= theta < math.pi - ahead.alpha - EVENTS.zero:
                    delay = 0.0
                else:
                    delay, _ = wrap(ahead.alpha - theta)
                if delay < wait:
                    wait = delay
                    s = way
                    at_root = delay > 0.0
            if wait >= left:
                psi, more = wrap(psi + left)
                turns += more
                s = 0.0
                at_root = False
                status = _REST if math.isinf(wait) else _TIME_REACHED
                break
            psi, more = wrap(psi + wait)
            turns += more
            p = 0.0
            if free and law.right < w < law.left:
                continue
            codes[count] = _U
            modes[count] = int(s)
            rows[count, 0] = psi
            rows[count, 1] = turns
            rows[count, 2] = w
            rows[count, 3] = 0.0
            rows[count, 4] = 0.0
            count += 1
            continue
        # ---- one leg of sliding ----------------------------------------------------------------------------
        ahead = leftwards if s > 0.0 else rightwards
        behind = rightwards if s > 0.0 else leftwards
        A = ahead.pull
        if at_root:
            m0, k0, theta, q0 = ahead.ratio, ahead.beta, ahead.alpha, 0.0
            at_root = False
        else:
            m0 = -s * math.sin(psi)
            k0 = -s * math.cos(psi)
            theta = angle_of(psi, s, ahead.alpha)
            q0 = C * m0 - A
        away = -m0 * C  # v'' against the motion
        if (
            p < EVENTS.slow * size
            and -s * w == behind.reach
            and away > behind.pull
            and away + A > 0.0
            and not (ahead.alpha <= theta < math.pi - ahead.alpha)
        ):
            # leaving a wall that is pushed after the absorber: is this the tail of a chatter?
            back, brake = away - behind.pull, away + A
            factor = behind.restitution * np.sqrt(back / brake)
            rest = p * (1.0 / brake + 1.0 / np.sqrt(back * brake))
            if factor < 1.0:
                rest /= 1.0 - factor
            if (
                rest * rest * C < 0.01 * STEPPING.chatter**2 * back and factor < 1.0
            ) or p < STEPPING.still * size:
                if p < STEPPING.still * size:
                    rest = min(rest, STEPPING.still)
                psi, more = wrap(psi + rest)
                turns += more
                codes[count] = _HOLD
                modes[count] = 0
                rows[count, 0] = psi
                rows[count, 1] = turns
                rows[count, 2] = w
                rows[count, 3] = 0.0
                rows[count, 4] = 0.0
                count += 1
                p = 0.0
                s = 0.0
                continue
        target = (ahead.reach - s * w) - s * low
        kind = 0  # 0 leg ends, 1 hit, 2 turn
        if ahead.driven:
            alpha = ahead.alpha
            top = math.pi - alpha - theta if alpha <= theta < math.pi - alpha else 0.0
            end = alpha - theta if theta < alpha else _TWO_PI + alpha - theta
            if ahead.always:
                top = end
        else:
            top = 0.0
            end = (p + 2.0 * C) / A if A > 0.0 else math.inf
            if A == 0.0 and C == 0.0:
                if p == 0.0:
                    psi, more = wrap(psi + left)
                    turns += more
                    status = _REST
                    break
                end = 2.0 * target / p + 1.0
        whole = end
        cut = end > left
        if cut:
            end = left
        x = 0.0
        y = 0.0
        rate = p
        if top > 0.0:
            x = min(top, end)
            _sine, versine, third, fourth = remainders(x)
            rate = p + q0 * x + C * (k0 * versine - m0 * third)
            y = p * x + 0.5 * q0 * x * x + C * (k0 * third - m0 * fourth)
            if target <= 0.0:
                kind = 1
                x = 0.0
                rate = p
            elif y >= target:
                kind = 1
                for _ in range(100):  # convex: from the right
                    step = (y - target) / rate if rate > 0.0 else x
                    if step >= x:
                        step = 0.5 * x
                    if not step > ROUNDOFF * x:
                        break
                    x -= step
                    sine, versine, third, fourth = remainders(x)
                    rate = p + q0 * x + C * (k0 * versine - m0 * third)
                    y = p * x + 0.5 * q0 * x * x + C * (k0 * third - m0 * fourth)
                    step = (y - target) / rate
                    pull = q0 + C * (k0 * sine - m0 * versine)
                    if (
                        step <= STEPPING.last_step * x
                        and abs(pull) * step <= STEPPING.last_step * rate
                        and C * step * step <= STEPPING.curved * rate
                    ):
                        step *= 1.0 + 0.5 * step * pull / rate  # the last step from values at hand
                        x -= step
                        rate -= step * (pull - 0.5 * step * C * (k0 * (1.0 - versine) - m0 * sine))
                        break
        if kind == 0 and x < end:
            before = x
            for _ in range(200):  # concave: from the left
                if rate <= 0.0:
                    kind = 2
                    break
                step = (target - y) / rate
                if not step > ROUNDOFF * x:
                    if target - y <= 0.0 or step > 0.0:
                        kind = 1
                    break
                if x == end:
                    break
                before = x
                x += step
                if x > end:
                    x = end
                sine, versine, third, fourth = remainders(x)
                rate = p + q0 * x + C * (k0 * versine - m0 * third)
                y = p * x + 0.5 * q0 * x * x + C * (k0 * third - m0 * fourth)
                step = (target - y) / rate
                pull = q0 + C * (k0 * sine - m0 * versine)
                small = (
                    abs(pull) * step <= STEPPING.last_step * rate
                    and C * step * step <= STEPPING.curved * rate
                )
                if small and 0.0 < step <= STEPPING.last_step * x and x + step < end:
                    step *= 1.0 - 0.5 * step * pull / rate  # the last step from values at hand
                    x += step
                    rate += step * (pull + 0.5 * step * C * (k0 * (1.0 - versine) - m0 * sine))
                    kind = 1
                    break
            else:
                kind = 1
            if kind == 2:
                if before < x:
                    x = fall(before, x, p, q0, C, A, k0, m0)
                    _sine, versine, third, fourth = remainders(x)
                    y = p * x + 0.5 * q0 * x * x + C * (k0 * third - m0 * fourth)
                else:
                    y = 0.0
        # ---- what ended the leg ----------------------------------------------------------------------------
        if kind == 0 and not cut:
            at_root = ahead.driven and not ahead.always  # theta = alpha: go on with fresh digits
            if ahead.driven:
                x = whole
        psi, more = wrap(psi + x)
        turns += more
        if kind == 1:
            rate = max(STEPPING.least_speed, rate)
            w = s * ahead.reach
            low = 0.0
            p = ahead.restitution * rate
            codes[count] = _L if s > 0.0 else _R
            rows[count, 3] = s * omega * rate
            s = -s
            modes[count] = int(s)
            rows[count, 4] = s * omega * p
        else:
            w, low = shift(w, low, s * y)
            if w > law.left or (w == law.left and low > 0.0):
                w = law.left
                low = 0.0
            elif w < law.right or (w == law.right and low < 0.0):
                w = law.right
                low = 0.0
            if kind == 0:
                p = rate if rate > 0.0 else 0.0
                if cut:
                    status = _TIME_REACHED
                    break
                continue
            p = 0.0
            if free:  # nothing happens where w' passes zero
                s = -s
                continue
            if behind.driven and C * (s * math.sin(psi)) > behind.pull:
                codes[count] = _T
                s = -s
            else:
                codes[count] = _S
                s = 0.0
            modes[count] = int(s)
            rows[count, 3] = 0.0
            rows[count, 4] = 0.0
        rows[count, 0] = psi
        rows[count, 1] = turns
        rows[count, 2] = w
        count += 1
    if not (math.isfinite(psi) and math.isfinite(w) and math.isfinite(p)):
        status = _FAILED
    state[0] = psi
    state[1] = w
    state[2] = s * omega * p
    state[3] = s
    state[4] = turns
    state[5] = low
    return count, status
