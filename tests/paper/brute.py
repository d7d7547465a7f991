"""A second opinion on the reduced absorber, sharing no code with the package: 40 digits, events by scan
and secant.

The flow between events is the closed form of w'' = -C Omega^2 sin(Psi) - a S at Omega = 1. Whoever asks
may dictate what happens where w' = 0 (``x`` goes on as if friction did not turn, ``s`` sticks, ``t``
turns); by default mechanics decides.
"""

from __future__ import annotations

import numpy as np
from mpmath import asin, cos, eye, lu_solve, matrix, mp, mpf, pi, sin

mp.dps = 40
STEP = mpf(10) ** -13  # of the central differences: errors of 1e-26 relative
SCAN = np.linspace(0.0, 13.0, 4001)[1:]


class Machine:
    """The reduced absorber at Omega = 1: `squared` is C^2, `a` the friction acceleration."""

    def __init__(self, squared, restitution="0.76", friction="0.5", gravity="0.211", mass_ratio="0.006"):
        self.C = mp.sqrt(mpf(squared))
        self.r = mpf(restitution)
        self.a = (1 + mpf(mass_ratio)) * mpf(friction) * mpf(gravity)

    # ------------------------------------------------------------------ one flight
    def rate(self, start, s, psi):
        """w' in a flight with friction sign `s` that left `start` = (psi0, w0, w0')."""
        psi0, _, rate0 = start
        return rate0 + self.C * (cos(psi) - cos(psi0)) - s * self.a * (psi - psi0)

    def place(self, start, s, psi):
        """w in the same flight."""
        psi0, w0, rate0 = start
        d = psi - psi0
        return (
            w0 + self.C * (sin(psi) - sin(psi0)) + (rate0 - self.C * cos(psi0)) * d - s * self.a * d * d / 2
        )

    def shaking(self, psi):
        """-v'': what pulls on the absorber, in the cavity's frame."""
        return -self.C * sin(psi)

    def dips(self, start, s, end):
        """Phases inside a flight at which s w' has a minimum, from w'' = 0, in order."""
        base = asin(-s * self.a / self.C)
        found = []
        for first in (base, pi - base):
            psi = first + 2 * pi * mp.ceil((start[0] - first) / (2 * pi))
            while psi < end:
                if psi > start[0] and -self.C * cos(psi) * s > 0:
                    found.append(psi)
                psi += 2 * pi
        return sorted(found)

    def lowest_rate(self, start, s, end):
        """The smallest s w' at a dip of a flight; +inf if there is none."""
        return min((s * self.rate(start, s, psi) for psi in self.dips(start, s, end)), default=mpf("inf"))

    def _root(self, function, low, high):
        """A sign change of `function` between two phases, to all digits: false position with halved weights."""
        f_low, f_high = function(low), function(high)
        assert f_low * f_high <= 0
        side = 0
        for _ in range(200):
            psi = high - f_high * (high - low) / (f_high - f_low) if f_high != f_low else high
            value = function(psi)
            if value == 0 or abs(high - low) < mpf(10) ** -36:
                return psi
            if abs(value) < mpf(10) ** -37:
                return psi
            if value * f_high < 0:
                low, f_low, side = high, f_high, 0
            else:
                side += 1
                f_low /= 2
            high, f_high = psi, value
        raise AssertionError("an event cannot be located")

    def next_event(self, start, s, frozen):
        """(psi, "hit" | "zero") of the first event of a flight."""
        near = mpf(0)
        if start[2] == 0:  # from rest: w' = d (w''0 + w''' d/2 + ...) may come back to zero almost at once
            force = self.shaking(start[0]) - s * self.a
            jerk = -self.C * cos(start[0])
            if force * s > mpf(10) ** -30 and -2 * force / jerk > 0 and -2 * force / jerk < mpf("0.02"):
                guess = -2 * force / jerk
                psi = self._root(
                    lambda x: self.rate(start, s, x) / (x - start[0]),
                    start[0] + guess * mpf("0.9"),
                    start[0] + guess * mpf("1.1"),
                )
                return psi, "zero"
            near = mpf("0.01")
        psi0, w0, rate0 = (float(value) for value in start)
        C, a = float(self.C), float(self.a)
        d = SCAN
        rates = rate0 + C * (np.cos(psi0 + d) - np.cos(psi0)) - s * a * d
        places = (
            w0 + C * (np.sin(psi0 + d) - np.sin(psi0)) + (rate0 - C * np.cos(psi0)) * d - s * a * d * d / 2
        )
        hits = np.flatnonzero(np.abs(places) > 1.0)
        zeros = np.flatnonzero((rates * s < 0.0) & (d > float(near))) if not frozen else np.zeros(0, int)
        hit = hits[0] if hits.size else d.size
        zero = zeros[0] if zeros.size else d.size
        assert min(hit, zero) < d.size, "no event came"
        which = min(hit, zero)
        low = start[0] + (mpf(float(d[which - 1])) if which else near)
        high = start[0] + mpf(float(d[which]))
        for dip in [] if frozen else self.dips(start, s, low):  # too short for the scan
            if dip > start[0] + near and s * self.rate(start, s, dip) < 0:
                return self._root(lambda x: self.rate(start, s, x), dip - mpf("0.01"), dip), "zero"
        if zero <= hit:
            return self._root(lambda x: self.rate(start, s, x), low, high), "zero"
        wall = 1 if places[hit] > 0.0 else -1
        return self._root(lambda x: self.place(start, s, x) - wall, low, high), "hit"

    # ------------------------------------------------------------------ once round
    def go(self, node, events, script=None):
        """From (psi, B+) just after an impact on the left wall, through `events` events.

        Returns the letters met, the last node and a dict of what was seen on the way: `lowest` the
        smallest s w' inside each flight, `stick` (a - |v''|) and `turn` (|v''| - a) at the zeros of w',
        `held` the durations of sticks.
        """
        psi, B = node
        state, s = (psi, mpf(1), self.C * cos(psi) - B), -1
        letters, seen = "", {"lowest": [], "stick": [], "turn": [], "held": []}
        script = list(script) if script is not None else None
        while len(letters) < events:
            frozen = script is not None and "x" in script
            psi, what = self.next_event(state, s, frozen)
            seen["lowest"].append(self.lowest_rate(state, s, psi))
            if what == "hit":
                speed = self.rate(state, s, psi)
                letters += "L" if s > 0 else "R"
                state, s = (psi, mpf(s), -self.r * speed), -s
                continue
            w, pull = self.place(state, s, psi), self.shaking(psi)
            held = abs(pull) <= self.a
            if script:
                held = script.pop(0) == "s"
            seen["stick"].append(self.a - abs(pull))
            seen["turn"].append(abs(pull) - self.a)
            if not held:
                letters += "t"
                state, s = (psi, w, mpf(0)), -s
                continue
            slips = []
            for sign in (1, -1):  # the shaking reaches +a or -a, on the way out
                base = asin(-sign * self.a / self.C)
                for first in (base, pi - base):
                    slip = first + 2 * pi * mp.ceil((psi - first) / (2 * pi))
                    if -self.C * cos(slip) * sign > 0:
                        slips.append((slip, sign))
            slip, sign = min(slips)
            letters += "s"
            seen["held"].append(slip - psi)
            state, s = (slip, w, mpf(0)), sign
        psi, w, rate = state
        return letters, matrix([psi, self.C * cos(psi) - rate]), seen

    def image(self, node, word, periods=1, half=False):
        """The node after the word, shifted back; for `half` words mirrored onto the same wall."""
        psi, B = node
        if half:
            letters, end, _ = self.go((psi, B), 1)
            assert letters == "R"
            return matrix([end[0] - pi, -end[1]])
        script = word.get("script")
        _, end, _ = self.go((psi, B), len(word["letters"]), script)
        return matrix([end[0] - 2 * pi * periods, end[1]])

    def derivative(self, node, word, periods=1, half=False):
        """The return map's matrix of central differences."""
        columns = []
        for j in range(2):
            ends = []
            for sign in (1, -1):
                moved = matrix(node)
                moved[j] += sign * STEP
                ends.append(self.image(moved, word, periods, half))
            columns.append((ends[0] - ends[1]) / (2 * STEP))
        return matrix([[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]])

    def orbit(self, guess, word, periods=1, half=False):
        """The fixed point of the return map, by Newton's method."""
        node = matrix([mpf(value) for value in guess])
        for _ in range(12):
            gap = self.image(node, word, periods, half) - node
            if max(abs(gap[0]), abs(gap[1])) < mpf(10) ** -32:
                return node
            node = node + lu_solve(eye(2) - self.derivative(node, word, periods, half), gap)
        raise AssertionError("Newton's method on the brute-force return map does not converge")


def secant(function, first, second, digits=16):
    """A root of a scalar function by the secant rule."""
    x0, x1 = mpf(first), mpf(second)
    y0, y1 = function(x0), function(x1)
    for _ in range(30):
        x2 = x1 - y1 * (x1 - x0) / (y1 - y0)
        if abs(x2 - x1) < mpf(10) ** -digits:
            return x2
        x0, y0, x1, y1 = x1, y1, x2, function(x2)
    raise AssertionError("the secant rule does not converge")


def eigenvalues(A):
    """Of a 2 x 2 matrix, complex, sorted by modulus, largest first."""
    trace, det = A[0, 0] + A[1, 1], A[0, 0] * A[1, 1] - A[0, 1] * A[1, 0]
    root = mp.sqrt(trace * trace / 4 - det)
    return sorted((complex(trace / 2 + root), complex(trace / 2 - root)), key=abs, reverse=True)
