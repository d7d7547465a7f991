"""Event-driven stepper of the built-in machines in plain Python: reference of the native core (`native/shaken.hpp`, `native/coupled_simulation.hpp`).

Between events the motion is the closed form of :mod:`orbits.machines.reference.oscillation`. In the direction s of the sliding let
y = s w' > 0 and y' = s w''. With a bound M >= |w'''| of the further motion, y stays positive for at least

    h = 2 y / (sqrt(y'^2 + 2 M y) - y'),

and w is monotone as long as y is positive: in such a step the wall ahead is hit exactly if it has been passed at
the end of the step, and steps towards a turn approach it from one side like Newton's method. So no impact and no turn can be missed. The slip
is found in the same way from a - |v'' - b| > 0, with the accelerations b of the slope and a of friction in the direction of the slip.

M is the sum of the largest third derivatives of the forced harmonic and of the remaining free oscillation, which decays; it is updated now
and then.

Near the start of a flight differences are taken from the Taylor series, and positions are stored with digits below
their roundoff, so that flights, turns and impacts keep their relative accuracy however small they are.
The signatures are those of :mod:`orbits.machines.stepping`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import root_scalar

from orbits.arguments import ROUNDOFF, SMALLEST
from orbits.machines.reference.law import Law, Side
from orbits.machines.reference.oscillation import (
    Oscillation,
    Point,
    certain,
    first_zero,
    oscillation,
    push,
    standing,
)
from orbits.machines.stepping import (
    EVENTS_FULL,
    FAILED,
    HOLD,
    LOW,
    MODE,
    PSI,
    RATE,
    REST,
    TIME_REACHED,
    TURNS,
    TWO_PI,
    V_RATE,
    V,
    W,
)
from orbits.settings import EVENTS, STEPPING

_L, _R, _T, _S, _U = range(5)
EPSILON = float(np.finfo(float).eps)
_HORIZON = 2.5  # time after which M is updated
_HIT, _HALT, _SLIPS, _TIME_IS_OVER, _NEVER = range(5)  # reasons for the end of a flight


def wrap(angle):
    """Return the angle reduced to [0, 2 pi), and the number of turns removed."""
    turns = math.floor(angle / TWO_PI)
    if turns != 0.0:
        angle -= turns * TWO_PI
    if angle < 0.0:
        angle = 0.0
    elif angle >= TWO_PI:
        angle = 0.0
        turns += 1.0
    return angle, turns


def shift(w, low, step):
    """Return w + low + step as a sum of two floats (Knuth's two-sum)."""
    total = w + step
    virtual = total - w
    rest = (w - (total - virtual)) + (step - virtual) + low
    rounded = total + rest
    return rounded, rest - (rounded - total)


def launch(law: Law, state: np.ndarray) -> None:
    """Reduce the phase and set the mode of a start; item 2 of `orbits.machines.stepping`."""
    state[PSI], more = wrap(state[PSI])
    state[TURNS] += more
    x, sine, cosine = standing(state, law), math.sin(state[PSI]), math.cos(state[PSI])
    against = push(law, x, sine, cosine) - law.whole * law.lean  # friction
    undecided = law.frictionless and not law.prescribed
    if against == 0.0 and undecided:  # then the third derivative decides
        force = law.force * law.omega * (cosine - law.base * sine)
        against = force - x.v_rate / law.whole - law.drag * law.lean
    left, right = law.side(1.0), law.side(-1.0)
    if x.rate != 0.0:
        state[MODE] = 1.0 if x.rate > 0.0 else -1.0
    elif (
        (-right.friction <= against <= left.friction and not undecided)
        or (x.w == law.left and against >= 0.0)
        or (x.w == law.right and against <= 0.0)
    ):
        state[MODE] = 0.0
    else:
        state[MODE] = 1.0 if against >= 0.0 else -1.0


class _Sliding(NamedTuple):
    """The end of a sliding flight: reason and time, and there the motion of q1, y = s w', y', and the displacement s (w - w_0)."""

    outcome: int
    tau: float
    at: Point
    y: float
    y_rate: float
    gain: float


class Run:
    """A motion in progress."""

    def __init__(self, state: np.ndarray, law: Law) -> None:
        self.state, self.law = state, law
        self.sides = {s: law.side(s) for s in (1.0, -1.0)}
        self.b = law.whole * law.lean
        # speeds are compared with that of a shaken cavity
        self.speed = law.amplitude * law.omega + abs(law.lean) / law.omega if law.prescribed else 1.0

    def advance(
        self, until: float, codes: np.ndarray, modes: np.ndarray, rows: np.ndarray
    ) -> tuple[int, int]:
        state, law = self.state, self.law
        if not np.isfinite(
            [*law.slide, *law.stuck, *state, self.b, *self.sides[1.0], *self.sides[-1.0]]
        ).all():
            return 0, FAILED
        limit = min(until, state[TURNS] + STEPPING.forever)
        fresh = False  # whether the flight starts with a slip: w' = w'' = 0
        idle = 0  # consecutive flights without progress
        count = 0

        def add(code: int, before: float, after: float) -> None:
            nonlocal count
            codes[count], modes[count] = code, int(state[MODE])
            rows[count] = state[PSI], state[TURNS], state[W], before, after, *state[V:]
            count += 1

        status = EVENTS_FULL
        while count < len(codes):
            left = ((limit - state[TURNS]) * TWO_PI - state[PSI]) / law.omega
            if not left > 0.0:
                status = TIME_REACHED
                break
            if state[MODE] == 0.0:
                outcome, direction = self._wait(left)
                if outcome != _SLIPS:
                    status = REST if outcome == _NEVER else TIME_REACHED
                    break
                state[MODE], fresh = direction, True
                if not law.frictionless or state[W] in (law.left, law.right):
                    add(_U, 0.0, 0.0)
                continue
            q = oscillation(state, law)
            begin = q.start()
            s = float(state[MODE])
            ahead, behind = self.sides[s], self.sides[-s]
            Y0 = s * state[RATE]
            Y1 = 0.0 if fresh else s * (begin.h2 + begin.z2) - s * q.q2_pull
            rest = self._piles_up(behind, s, Y0, Y1 + ahead.friction, begin)
            if rest < math.inf:
                moved = 0.0 if law.prescribed else rest * state[V_RATE]
                self._ride(moved, rest * (self.b + s * (Y1 + ahead.friction)))
                self._turn(rest)
                state[RATE] = state[MODE] = 0.0
                add(HOLD, 0.0, 0.0)
                continue
            target = (ahead.reach - s * state[W]) - s * state[LOW]
            end = self._slide(q, s, Y0, Y1, target, left)
            fresh = False
            tau = left if end.outcome == _NEVER else end.tau
            idle = idle + 1 if tau < EVENTS.simultaneous else 0
            if idle > 10000:
                status = FAILED
                break
            self._ride(end.at.way + law.eps * q.travel(tau), end.at.speed + law.eps * q.q2_pull * tau)
            self._turn(tau)
            if end.outcome == _HIT:
                y = max(STEPPING.least_speed, end.y)
                state[W], state[LOW] = s * ahead.reach, 0.0
                state[RATE], state[MODE] = -s * ahead.restitution * y, -s
                add(_L if s > 0.0 else _R, s * y, state[RATE])
                continue
            w, low = shift(state[W], state[LOW], s * end.gain)
            for wall, side in ((law.left, 1.0), (law.right, -1.0)):
                if side * (w - wall) > 0.0 or (w == wall and side * low > 0.0):
                    w, low = wall, 0.0
            state[W], state[LOW] = w, low
            if end.outcome != _HALT:
                state[RATE] = s * end.y if end.y > 0.0 else 0.0
                status = REST if end.outcome == _NEVER else TIME_REACHED
                break
            state[RATE] = 0.0
            if law.frictionless:  # a zero of w' is no event
                state[MODE] = -s
                continue
            turns_back = end.y_rate < -(ahead.friction + behind.friction)
            state[MODE] = -s if turns_back else 0.0
            add(_T if turns_back else _S, 0.0, 0.0)
        return count, status if np.isfinite(state).all() else FAILED

    def _piles_up(self, behind: Side, s: float, Y0: float, push: float, begin: Point) -> float:
        """Return the remaining time of a chatter if this flight belongs to its end; otherwise infinity.

        The flight leaves a wall that is pushed after the absorber; `push` is s (v'' - b).
        """
        state, law = self.state, self.law
        back, brake = -push - behind.friction, -push + self.sides[s].friction
        if not (EVENTS.slow * self.speed > Y0 and -s * state[W] == behind.reach and state[LOW] == 0.0 < back):
            return math.inf
        factor = behind.restitution * np.sqrt(back / brake)
        rest = Y0 * (1.0 / brake + 1.0 / np.sqrt(back * brake))
        if factor < 1.0:
            rest /= 1.0 - factor
        if law.prescribed:
            bent = rest * rest * law.amplitude * law.omega**4 < 0.01 * STEPPING.chatter**2 * back
            longest = STEPPING.still / law.omega
        else:
            bent = rest < STEPPING.chatter and rest * abs(begin.h3 + begin.z3) < 0.01 * back
            longest = STEPPING.chatter
        slow = STEPPING.still * self.speed > Y0
        if not (slow or (bent and factor < 1.0)):
            return math.inf
        return rest if law.prescribed and not slow else min(rest, longest)

    def _ride(self, travel: float, speed: float) -> None:
        """Move the centre of mass on, if the cavity is an oscillator."""
        if not self.law.prescribed:
            self.state[V] += travel
            self.state[V_RATE] += speed

    def _turn(self, tau: float) -> None:
        """Move the forcing phase on."""
        self.state[PSI], more = wrap(self.state[PSI] + self.law.omega * tau)
        self.state[TURNS] += more

    def _wait(self, left: float) -> tuple[int, float]:
        """Move on, sticking, until friction yields, or for the time `left`; return the reason for the end, and the direction of the slip."""
        q, whole = oscillation(self.state, self.law), self.law.whole
        outcome, tau, direction = self._until_slip(q, left)
        if tau > 0.0:
            at = q.at(tau)
            self._ride(whole * at.way, whole * at.speed)
            self._turn(tau)
        self.state[RATE] = 0.0
        return outcome, direction

    def _until_slip(self, q: Oscillation, left: float) -> tuple[int, float, float]:
        b, whole = self.b, self.law.whole
        # directions without a wall, and the friction in each
        free_ways = [
            (direction, side.friction)
            for direction, side in self.sides.items()
            if direction * self.state[W] < side.reach
        ]
        hold = min(a + direction * b for direction, a in free_ways)
        tiny, tau = 2.0 * ROUNDOFF * (whole * (q.driven(2) + q.own(2, 0.0)) + abs(b)), 0.0
        while tau < left:
            if whole * (q.driven(2) + q.own(2, tau)) * (1.0 - EVENTS.zero) <= hold:
                return _NEVER, left, 0.0
            end, bound = min(tau + _HORIZON, left), whole * (q.driven(4) + q.own(4, tau))
            slips = []
            for direction, a in free_ways:

                def reserve(time: float, direction: float = direction, a: float = a) -> tuple[float, float]:
                    at = q.at(time)
                    return a - direction * (whole * (at.h2 + at.z2) - b), -direction * whole * (at.h3 + at.z3)

                value, slope = reserve(tau)
                # at a zero at the start the slope decides
                at_once = value <= tiny and (tau > 0.0 or slope < 0.0 or value < -tiny)
                slips.append((tau if at_once else first_zero(reserve, tau, end, bound, tiny), direction))
            slip, direction = min(slips)
            if slip < end:
                return _SLIPS, slip, direction
            tau = end
        return _TIME_IS_OVER, left, 0.0

    def _slide(self, q: Oscillation, s: float, Y0: float, Y1: float, target: float, left: float) -> _Sliding:
        """Slide until the wall ahead is hit or the absorber halts, or for the time `left`."""
        brake = s * q.q2_pull

        def look(tau: float) -> tuple[Point, float, float, float]:
            at = q.at(tau)
            y, y_rate = Y0 + s * at.speed - brake * tau, s * (at.h2 + at.z2) - brake
            return at, y, y_rate, Y0 * tau + (s * at.bend - 0.5 * brake * tau * tau)

        at, tau, y, y_rate, gain = q.start(), 0.0, Y0, Y1, 0.0
        if target <= 0.0:
            return _Sliding(_HIT, tau, at, y, y_rate, gain)
        renew, bound = -1.0, 0.0
        while True:
            if tau >= renew:
                bound = q.driven(3) + q.own(3, tau)
                renew = tau + _HORIZON
            if y <= SMALLEST:
                # the native core of coupled machines treats a tiny speed as rest
                if tau > 0.0 or (self.law.prescribed and y > 0.0 > y_rate):
                    return _Sliding(_HALT, tau, at, y, y_rate, gain)
                # from rest: the flight begins with y' or, after a slip, with y''
                jerk = s * (at.h3 + at.z3)
                further = q.driven(4) + q.own(4, tau)
                if bound == 0.0 and further == 0.0 and not y_rate > 0.0:  # no friction, slope or forcing
                    return _Sliding(_NEVER, left, at, y, y_rate, gain)
                steps = (
                    y_rate / bound if bound > 0.0 else 0.0,
                    1.5 * jerk / further if further > 0.0 else 0.0,
                )
                step = max(*steps, EVENTS.zero)  # a minimum, if the acceleration in this direction is tiny
            else:
                step = certain(y, y_rate, bound) if bound > 0.0 or y_rate < 0.0 else math.inf
                if step < ROUNDOFF * tau:
                    return _Sliding(_HALT, tau, at, y, y_rate, gain)
                step = min(step, 2.0 * target / y + 0.5)  # not far beyond the wall
            before = tau
            tau = min(tau + step if step < renew - tau else renew, left)
            at, y, y_rate, gain = look(tau)
            if gain >= target:
                break
            if tau >= left:
                return _Sliding(_TIME_IS_OVER, tau, at, y, y_rate, gain)

        def miss(time: float) -> float:
            return look(time)[-1] - target

        tau = root_scalar(miss, bracket=(before, tau), xtol=SMALLEST, rtol=4.0 * EPSILON).root
        at, y, y_rate, gain = look(tau)
        step = (gain - target) / y if y > 0.0 else 0.0  # one more Newton step, from known values
        if abs(step) < 8.0 * EPSILON * tau:
            tau -= step
            y -= step * y_rate
            way = at.way - step * (at.speed + q.h1 + q.z1)
            at = at._replace(way=way, speed=at.speed - step * (at.h2 + at.z2))
        return _Sliding(_HIT, tau, at, y, y_rate, gain)
