"""Event-driven stepper of the absorber on its oscillator (compiled).

Between events the motion is the closed form of :mod:`orbits.machines.coupled.flow`. In the direction s of the sliding let
y = s w' > 0 and y' = s w''. With M >= |w'''| ahead, y stays positive for at least

    h = 2 y / (sqrt(y'^2 + 2 M y) - y'),

and w is monotone for as long as y is positive: inside such a step the wall ahead is met exactly when it has been passed at
the end of it, and steps towards a turn approach it from one side like Newton's method. So no hit and no turn can be missed. The slip
is found in the same way from a - |v''| > 0.

M comes from the energy of the third derivative u = q1''', which is itself an oscillator's response to a force of amplitude
f = Omega^3 eps G sqrt(1 + (eps lambda Omega)^2): sqrt(u^2 + u'^2/kappa) grows by at most f/sqrt(kappa) per unit of time.

Close to the start of a leg differences are taken from the Taylor series, and positions are kept with the digits below
their roundoff, so that flights, turns and impacts keep their relative accuracy however small they are.
The signatures are those of :mod:`orbits.machines.stepping`; parameters as in `orbits.machines.coupled.maps`.
"""

from __future__ import annotations

import math

from orbits.compiling import digits as _digits
from orbits.compiling.decorators import stored_with
from orbits.compiling.digits import shift as _shift
from orbits.compiling.digits import wrap as _wrap
from orbits.machines.coupled import flow as _flow
from orbits.machines.coupled.flow import ahead as _ahead
from orbits.machines.coupled.flow import certain, harmonic, rates
from orbits.machines.coupled.flow import decompose as _decompose
from orbits.machines.coupled.launch import launch as launch
from orbits.machines.coupled.segments import energies as energies
from orbits.machines.coupled.segments import sample as sample
from orbits.machines.coupled.segments import works as works

STATE = 8
ROW = 7

_L, _R, _T, _S, _U, _HOLD = 0, 1, 2, 3, 4, 5
_EVENTS_FULL, _TIME_REACHED, _REST, _FAILED = 0, 1, 2, 3
_TWO_PI = 2.0 * math.pi
_HORIZON = 2.5  # M is renewed after this time
_FOREVER = 1e7  # forcing periods


@stored_with(_digits, _flow, nogil=True)
def advance(state, params, until, codes, modes, rows):
    """Run from event to event; see :mod:`orbits.machines.stepping`, item 3.

    In one piece: the state of a leg is some thirty local numbers, which every part of the loop reads and changes.
    """
    G, omega, lam, eps, r, mu, g, chi = (
        params[0], params[1], params[2], params[3], params[4], params[5], params[6], params[7]
    )  # fmt: skip
    whole = 1.0 + eps
    pull = mu * g
    a = whole * pull
    drag = eps * lam
    square = omega * omega
    psi, w, rate, s, turns, low, v, v_rate = (
        state[0], state[1], state[2], state[3], state[4], state[5], state[6], state[7]
    )  # fmt: skip
    slide_X, slide_Y = harmonic(eps * G, chi, drag * omega, 1.0 - square)
    stuck_X, stuck_Y = harmonic(eps * G, chi, drag * omega, 1.0 - whole * square)
    slide_alpha, slide_beta = rates(1.0, drag)
    stuck_alpha, stuck_beta = rates(whole, drag)
    force = eps * abs(G) * math.sqrt(1.0 + chi * chi * drag * drag * square)
    check = psi + w + rate + v + v_rate + slide_X + slide_Y + stuck_X + stuck_Y + slide_beta + stuck_beta + a
    if not math.isfinite(check):
        return 0, _FAILED
    room = codes.shape[0]
    limit = min(until, turns + _FOREVER)
    fresh = False  # the leg starts with a slip: w' = w'' = 0
    idle = 0  # legs in a row without progress
    count = 0
    status = _EVENTS_FULL
    while True:
        if count == room:
            break
        left = ((limit - turns) * _TWO_PI - psi) / omega
        if not left > 0.0:
            status = _TIME_REACHED
            break
        # ---- at rest on the floor, or against a wall -------------------------------------------------------
        if s == 0.0:
            h0, h1, z0, z1, q2_rate = _decompose(psi, w, 0.0, v, v_rate, eps, omega, stuck_X, stuck_Y, 0.0)
            alpha, beta = stuck_alpha, stuck_beta
            kappa = alpha * alpha + beta * beta
            z2 = -2.0 * alpha * z1 - kappa * z0
            H2, H3 = -square * h0, -square * h1
            Z2, Z3 = z2, -2.0 * alpha * z2 - kappa * z1
            driven = whole * square * math.hypot(h0, h1 / omega)  # bounds of |v''|
            free = whole * kappa * math.hypot(z0, (z1 + alpha * z0) / beta)
            tiny = 4e-16 * (driven + free)
            tau = 0.0
            way = 0.0
            speed = 0.0
            slip = 0.0
            leap = True  # a zero right at the start is judged by its slope, and left behind
            renew = -1.0
            M = 0.0
            while tau < left:
                if tau >= renew:
                    if driven + free * math.exp(-alpha * tau) < a or driven + free == 0.0:
                        tau = left
                        status = _REST
                        break
                    u4 = -square * H2 - 2.0 * alpha * Z3 - kappa * Z2
                    u5 = -square * H3 + 2.0 * alpha * (2.0 * alpha * Z3 + kappa * Z2) - kappa * Z3
                    M = whole * (math.sqrt(u4 * u4 + u5 * u5 / kappa) + square * square * force * _HORIZON)
                    renew = tau + _HORIZON
                value = whole * (H2 + Z2)
                slope = whole * (H3 + Z3)
                step = renew - tau
                for m in (1.0, -1.0):
                    if m * w >= 1.0:
                        continue
                    y = a - m * value
                    y_rate = -m * slope
                    if y <= tiny:
                        if not leap or y_rate < 0.0 or y < -tiny:
                            slip = m
                            break
                        ahead = y_rate / M if M > 0.0 else step
                        step = min(step, max(ahead, 1e-9))
                    else:
                        ahead = certain(y, y_rate, M) if M > 0.0 or y_rate < 0.0 else step
                        step = min(step, ahead)
                        if ahead < 2.3e-16 * (1.0 + tau):
                            slip = m
                            break
                leap = False
                if slip != 0.0:
                    break
                tau = min(tau + step if step < renew - tau else renew, left)
                way, speed, H2, Z2, H3, Z3 = _ahead(tau, h0, h1, z0, z1, omega, alpha, beta)
            if tau > 0.0:
                if status == _REST:
                    way, speed, H2, Z2, H3, Z3 = _ahead(tau, h0, h1, z0, z1, omega, alpha, beta)
                v += whole * way
                v_rate += whole * speed
                psi, more = _wrap(psi + omega * tau)
                turns += more
            rate = 0.0
            if status == _REST:
                break
            if slip == 0.0:
                status = _TIME_REACHED
                break
            s = slip
            fresh = True
            if a > 0.0 or abs(w) == 1.0:
                codes[count] = _U
                modes[count] = int(s)
                rows[count, 0] = psi
                rows[count, 1] = turns
                rows[count, 2] = w
                rows[count, 3] = 0.0
                rows[count, 4] = 0.0
                rows[count, 5] = v
                rows[count, 6] = v_rate
                count += 1
            continue
        # ---- one leg of sliding ----------------------------------------------------------------------------
        sp = s * pull
        alpha, beta = slide_alpha, slide_beta
        kappa = alpha * alpha + beta * beta
        h0, h1, z0, z1, q2_rate = _decompose(psi, w, rate, v, v_rate, eps, omega, slide_X, slide_Y, -eps * sp)
        H2, H3 = -square * h0, -square * h1
        Z2 = -2.0 * alpha * z1 - kappa * z0
        Z3 = -2.0 * alpha * Z2 - kappa * z1
        Y0 = s * rate  # y and y'
        Y1 = 0.0 if fresh else s * (H2 + Z2) - pull
        if Y0 < 1e-6 and s * w == -1.0 and low == 0.0 and Y1 + 2.0 * a < 0.0:
            # leaving a wall that is pushed after the absorber: is this the tail of a chatter?
            shove = -Y1 - a  # |v''|
            factor = r * math.sqrt((shove - a) / (shove + a))
            rest = Y0 * (1.0 / (shove + a) + 1.0 / math.sqrt((shove - a) * (shove + a)))
            if factor < 1.0:
                rest /= 1.0 - factor
            if (factor < 1.0 and rest < 1e-7 and rest * abs(H3 + Z3) < 0.01 * (shove - a)) or Y0 < 1e-13:
                rest = min(rest, 1e-7)
                way, speed, H2, Z2, H3, Z3 = _ahead(rest, h0, h1, z0, z1, omega, alpha, beta)
                v += rest * v_rate
                v_rate -= rest * s * shove
                psi, more = _wrap(psi + omega * rest)
                turns += more
                codes[count] = _HOLD
                modes[count] = 0
                rows[count, 0] = psi
                rows[count, 1] = turns
                rows[count, 2] = w
                rows[count, 3] = 0.0
                rows[count, 4] = 0.0
                rows[count, 5] = v
                rows[count, 6] = v_rate
                count += 1
                rate = 0.0
                s = 0.0
                continue
        target = (1.0 - s * w) - s * low
        tau = 0.0
        way = 0.0  # q1's
        speed = 0.0
        gain = 0.0  # s (w(tau) - w(0))
        y, y_rate = Y0, Y1
        kind = 0  # 0 time is over, 1 hit, 2 turn
        renew = -1.0
        M = 0.0
        tiny = 1e-300
        if target <= 0.0:
            kind = 1
        while kind == 0:
            if tau >= renew:
                u3 = H3 + Z3
                u4 = -square * H2 - 2.0 * alpha * Z3 - kappa * Z2
                M = math.sqrt(u3 * u3 + u4 * u4 / kappa) + square * omega * force * _HORIZON / math.sqrt(
                    kappa
                )
                renew = tau + _HORIZON
            if y <= tiny:
                if tau > 0.0:
                    kind = 2
                    break
                # from rest: y' or, after a slip, y'' opens the flight
                jerk = s * (H3 + Z3)
                u4 = -square * H2 - 2.0 * alpha * Z3 - kappa * Z2
                u5 = -square * H3 + 2.0 * alpha * (2.0 * alpha * Z3 + kappa * Z2) - kappa * Z3
                M4 = math.sqrt(u4 * u4 + u5 * u5 / kappa) + square * square * force * _HORIZON / math.sqrt(
                    kappa
                )
                step = max(y_rate / M if M > 0.0 else 0.0, 1.5 * jerk / M4 if M4 > 0.0 else 0.0)
                if M == 0.0 and M4 == 0.0:  # neither friction nor forcing: nothing moves
                    tau = left
                    status = _REST
                    break
                if not step > 1e-13:
                    step = 1e-13  # no acceleration in this direction to speak of
            else:
                step = certain(y, y_rate, M) if M > 0.0 or y_rate < 0.0 else math.inf
                if step < 2.3e-16 * tau:
                    kind = 2
                    break
                if step > 2.0 * target / y + 0.5:  # far beyond the wall: no need to know that much
                    step = 2.0 * target / y + 0.5
            before = tau
            tau = min(tau + step if step < renew - tau else renew, left)
            way, speed, H2, Z2, H3, Z3 = _ahead(tau, h0, h1, z0, z1, omega, alpha, beta)
            gain = s * (way - (q2_rate + 0.5 * sp * tau) * tau)
            y = Y0 + s * speed - pull * tau
            y_rate = s * (H2 + Z2) - pull
            if gain >= target:
                kind = 1
                lo, hi = before, tau
                for _ in range(60):
                    miss = gain - target
                    if miss >= 0.0:
                        hi = tau
                    else:
                        lo = tau
                    bottom = 2.0 * y * y - miss * y_rate
                    step = 2.0 * miss * y / bottom if bottom > 0.0 else math.inf
                    new = tau - step
                    if not lo < new < hi:
                        if abs(step) <= 4.5e-16 * tau:
                            break
                        new = 0.5 * (lo + hi)
                    change = abs(new - tau)
                    tau = new
                    way, speed, H2, Z2, H3, Z3 = _ahead(tau, h0, h1, z0, z1, omega, alpha, beta)
                    gain = s * (way - (q2_rate + 0.5 * sp * tau) * tau)
                    y = Y0 + s * speed - pull * tau
                    y_rate = s * (H2 + Z2) - pull
                    if (
                        change <= 1e-6 * tau and change * change * abs(y_rate) <= 1e-16 * y * tau
                    ) or hi - lo <= 2.3e-16 * hi:
                        # one Newton step more, from values at hand
                        step = (gain - target) / y if y > 0.0 else 0.0
                        if abs(step) < change:
                            tau -= step
                            way -= step * (speed + h1 + z1)
                            speed -= step * (H2 + Z2)
                            y -= step * y_rate
                        break
            elif tau >= left:
                break
        fresh = False
        idle = idle + 1 if tau < 1e-11 else 0
        if idle > 10000:
            status = _FAILED
            break
        # ---- what ended the leg ----------------------------------------------------------------------------
        v += way + eps * (q2_rate + 0.5 * sp * tau) * tau
        v_rate += speed + eps * sp * tau
        psi, more = _wrap(psi + omega * tau)
        turns += more
        if kind == 1:
            if not y > 1e-30:
                y = 1e-30
            w = s
            low = 0.0
            codes[count] = _L if s > 0.0 else _R
            rows[count, 3] = s * y
            rate = -s * r * y
            s = -s
            modes[count] = int(s)
            rows[count, 4] = rate
        else:
            w, low = _shift(w, low, s * gain)
            if abs(w) > 1.0 or (abs(w) == 1.0 and w * low > 0.0):
                w = math.copysign(1.0, w)
                low = 0.0
            if kind == 0:
                rate = s * y if y > 0.0 else 0.0
                if status != _REST:
                    status = _TIME_REACHED
                break
            rate = 0.0
            if a == 0.0:  # nothing happens where w' passes zero
                s = -s
                continue
            if y_rate < -2.0 * a:
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
        rows[count, 5] = v
        rows[count, 6] = v_rate
        count += 1
    if not (math.isfinite(psi) and math.isfinite(w) and math.isfinite(rate) and math.isfinite(v)):
        status = _FAILED
    state[0], state[1], state[2], state[3], state[4], state[5], state[6], state[7] = (
        psi, w, rate, s, turns, low, v, v_rate
    )  # fmt: skip
    return count, status
