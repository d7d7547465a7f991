"""Margins of admissibility of the built-in machines' orbits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from orbits.machines.reference.law import Law
from orbits.machines.reference.oscillation import (
    State,
    after,
    leg,
    push,
)
from orbits.settings import EVENTS, STEPPING
from orbits.words.alphabet import CODES

if TYPE_CHECKING:
    from orbits.arguments import CycleData, Workspace

LEFT_IMPACT, TURN, STICK, SLIP = (CODES[letter] for letter in "Ltsu")


def margins(law: Law, data: CycleData, u: np.ndarray, work: Workspace, out: np.ndarray) -> None:
    """Write margins of admissibility, none negative for an orbit that a machine can follow.

    `out` has shape (4 L,), four numbers per node; infinity if there is nothing to test. Sines and cosines of the last `linearise` are read from
    `work`. All zeros are found by steps that cannot pass one (`orbits.machines.reference.oscillation.first_zero`).

    0. The flight after the node. Sliding: smallest s w' at an interior minimum. Without friction, when flights may reverse: distance from the
       walls at the zeros of w'. Stuck: smallest reserve of friction at an interior extremum of v''; in a shaken cavity the time to the slip,
       negative unless the slip is the first instant at which friction yields.
    1. The event. Impact: approach speed. Turn: -s (v'' - b) - a with s the mode before and a of the direction after it, since the relative
       acceleration v'' - b - a S cannot vanish for any S in [-1, 1] exactly if |v'' - b| > a. Stick: a - |v'' - b|. Slip: m v''' at its start,
       in a shaken cavity per radian of the phase. Here v'' = -q1 - eps lambda q1' + e + eps lambda e' contains neither friction nor gravity, and
       b = (1 + eps) g sin(slope).
    2. The wall: distance from it at events other than impacts.
    3. The duration of the flight.
    """
    events, modes, twist, shaken = data.events, data.modes, data.twist, law.prescribed
    length, n = work.F.shape
    nodes = u.reshape(length, n)
    b, friction = law.whole * law.lean, {s: law.side(s).friction for s in (1.0, -1.0)}

    def reserve(against: float) -> float:
        """Return the friction left while it holds against this acceleration, in the direction nearer to slipping."""
        return min(friction[1.0] - against, friction[-1.0] + against)

    for i in range(length):
        event, mode = events[i], float(modes[i])
        psi, y = nodes[i, :2]
        inner = i + 1 < length
        arrival = events[(i + 1) % length]
        if not inner and twist < 0.0 and arrival < TURN:
            arrival = 1 - arrival
        d = ((nodes[i + 1, 0] if inner else nodes[0, 0] + data.shift) - psi) / law.omega
        speed = law.amplitude * law.omega
        v, v_rate = (law.amplitude * work.sines[i], speed * work.cosines[i]) if shaken else nodes[i, 2:]
        wall = law.left if event == LEFT_IMPACT else law.right
        begin = State(wall, v_rate - y, v, v_rate) if event < TURN else State(y, 0.0, v, v_rate)
        against = push(law, begin, work.sines[i], work.cosines[i]) - b  # friction
        q = leg(law, psi, begin, mode)
        first = q.start()
        jerk = first.h3 + first.z3
        flight = np.inf
        if shaken and mode == 0.0:
            flight = _late(law, psi, d)
        elif not d > 0.0:
            pass
        elif mode == 0.0:
            for at in map(q.at, q.zeros(3, 0.0, d, psi)):
                flight = min(flight, reserve(law.whole * (at.h2 + at.z2) - b))
        elif not law.frictionless:
            tau, until = 0.0, d
            if shaken:  # a slip starts at such a minimum, and the next one is one turn later; near a turn or stick there is none
                tau = (1.0 if event == SLIP else EVENTS.at_end if event >= TURN else 0.0) / law.omega
                until -= (EVENTS.at_end if arrival >= TURN else 0.0) / law.omega
            elif event == SLIP:  # w' = w'' = 0 at the start of a slip: go as far as m w''' keeps its sign
                bound = q.driven(4) + q.own(4, 0.0)
                tau = min(abs(jerk) / bound, 0.5 * d) if bound > 0.0 else 0.0
            if (
                event != TURN or mode * against > friction[mode]
            ):  # otherwise the turn's own margin is negative
                lowest = [
                    mode * q.derivative(1, instant, sliding=True)[0]
                    for instant in q.zeros(2, tau, until, psi, sliding=True)
                    if mode * q.derivative(2, instant, sliding=True)[1] > 0.0
                ]
                flight = min(lowest, default=np.inf)
        else:
            for tau in q.zeros(1, 0.0, d, psi, sliding=True):
                w = after(law, q, q.at(tau), begin, mode, tau).w
                flight = min(flight, law.left - w, w - law.right)
        before = modes[i - 1] if i > 0 else twist * modes[-1]
        out[4 * i] = flight
        out[4 * i + 2] = min(law.left - y, y - law.right) if event >= TURN else np.inf
        out[4 * i + 3] = d
        if event == TURN:
            out[4 * i + 1] = -before * against - friction[-1.0 if before > 0 else 1.0]
        elif event == STICK:
            out[4 * i + 1] = reserve(against)
        elif event == SLIP:
            out[4 * i + 1] = mode * jerk / (law.omega if shaken else 1.0)  # w''' of the slide that begins
        if arrival < TURN:
            following, side = (i + 1) % length, 1.0 - 2.0 * float(arrival)
            if shaken:
                rate = after(law, q, q.at(d), begin, mode, d).rate
            else:  # by Newton's law w'+ = -r w'-, and B+ = v' - w'+
                arrival_rate = nodes[following, 1] - nodes[following, 3]
                rate = (1.0 if inner else twist) * arrival_rate / law.side(side).restitution
            out[4 * following + 1] = side * rate


def _late(law: Law, psi: float, d: float) -> float:
    """Return the margin of a stick in a shaken cavity.

    It is its duration if the slip is the first instant at which friction yields; otherwise minus the distance from that instant, in phase.
    """
    peak, first = law.amplitude * law.omega * law.omega, np.inf
    for pull, base in ((law.pull_left, np.pi), (-law.pull_right, 0.0)):
        ratio = pull / peak if peak > 0.0 else np.inf
        if ratio <= -1.0:  # friction always yields
            return -1.0
        if ratio < 1.0:
            rest = (base + np.arcsin(ratio) - psi) % (2.0 * np.pi)
            # an instant just before now must not become one a whole turn later by roundoff
            first = min(first, rest - 2.0 * np.pi if rest > 2.0 * np.pi - STEPPING.slip else rest)
    late = d * law.omega - first
    return -1.0 if first == np.inf else d if abs(late) < STEPPING.slip else -abs(late)
