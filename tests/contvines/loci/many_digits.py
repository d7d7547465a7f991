"""The reduced absorber's motions with impacts and turns in many digits, written anew: borders at which a multiplier is 1 or -1.

Flights and impacts are those of MODEL section 2 at frequency 1. Unlike the product of the maps of the events, the determinant of their cyclic
system stays finite where an impact has no speed.
"""

from typing import Any

import mpmath
import numpy as np

DIGITS = 35
STEPS = {
    False: mpmath.mpf(10) ** -15,
    True: 1e-5,
}  # of central differences, in many digits and in floating point


class Motion:
    """A word over some periods; unknowns are (phase, place or speed after) of each event, then amplitude and second parameter."""

    def __init__(self, word, periods, machine, over, rough=False):
        self.events, self.modes, self.periods, self.over = word.events, word.modes, periods, over
        self.mp: Any = mpmath.fp if rough else mpmath.mp
        self.machine = {name: self.mp.mpf(str(value)) for name, value in machine.items()}
        self.n, self.step = len(word.events), STEPS[rough]

    def flight(self, i, x, psi, C, q):
        """(w, w') at phase psi after event i."""
        m = {**self.machine, self.over: q}
        a = (1 + m["mass_ratio"]) * m["friction"] * m["gravity"]
        first, second = x
        if self.events[i] in "LR":
            w, rate = (1 if self.events[i] == "L" else -1), C * self.mp.cos(first) - second
        else:
            w, rate = second, self.mp.mpf(0)
        d, pull = psi - first, self.modes[i] * a
        later = rate + C * (self.mp.cos(psi) - self.mp.cos(first)) - pull * d
        w += (
            C * (self.mp.sin(psi) - self.mp.sin(first))
            + (rate - C * self.mp.cos(first)) * d
            - pull * d * d / 2
        )
        return w, later

    def map(self, i, x, y, C, q):
        """What is zero if event i + 1 follows event i."""
        arrival = self.events[(i + 1) % self.n]
        w, rate = self.flight(i, x, y[0], C, q)
        if arrival in "LR":
            r = q if self.over == "restitution" else self.machine["restitution"]
            return [w - (1 if arrival == "L" else -1), y[1] - C * self.mp.cos(y[0]) - r * rate]
        return [rate, w - y[1]]

    def nodes(self, v):
        x = [(v[2 * i], v[2 * i + 1]) for i in range(self.n)]
        return [*x, (x[0][0] + 2 * self.mp.pi * self.periods, x[0][1])]

    def equations(self, v):
        """The maps of all events."""
        x, (C, q) = self.nodes(v), v[2 * self.n :]
        return [value for i in range(self.n) for value in self.map(i, x[i], x[i + 1], C, q)]

    def determinant(self, v, closure):
        """Zero where the motion has the multiplier `closure`, 1 or -1."""
        x, (C, q), n = self.nodes(v), v[2 * self.n :], self.n
        matrix = self.mp.zeros(2 * n)
        for i in range(n):
            here = [*x[i], *x[i + 1]]
            for k in range(4):
                up, down = list(here), list(here)
                up[k] += self.step
                down[k] -= self.step
                ends = [self.map(i, e[:2], e[2:], C, q) for e in (up, down)]
                column = (2 * i + k) % (2 * n)
                sign = closure if 2 * i + k >= 2 * n else 1
                for row in range(2):
                    matrix[2 * i + row, column] += sign * (ends[0][row] - ends[1][row]) / (2 * self.step)
        return self.mp.det(matrix)

    def touch(self, v, j):
        """Zero where event j touches a wall: a turn there, or an impact without speed."""
        if self.events[j] in "LR":
            return self.flight(
                j - 1, self.nodes(v)[j - 1] if j else self._last(v), v[2 * j], *v[2 * self.n :]
            )[1]
        return v[2 * j + 1] ** 2 - 1

    def _last(self, v):
        return v[2 * self.n - 2] - 2 * self.mp.pi * self.periods, v[2 * self.n - 1]


def solved(problem, point, machine, closure, touching):
    """(first parameter, second parameter) of the border at which a multiplier is `closure`, solved anew from a point of codimension two.

    Newton's method with residuals of 35 digits and a matrix of few.
    """
    exact, rough = (
        Motion(problem.word, problem.periods, machine, point.parameters[1], few) for few in (False, True)
    )

    def system(motion, v):
        return [*motion.equations(v), motion.determinant(v, closure), motion.touch(v, touching)]

    start = np.array([*problem.expand(point.u).ravel(), *point.value], dtype=float)
    columns = []
    for k in range(len(start)):
        ends = [
            np.array(system(rough, list(start + sign * 1e-5 * np.eye(len(start))[k]))) for sign in (1.0, -1.0)
        ]
        columns.append((ends[0] - ends[1]) / 2e-5)
    inverse = np.linalg.inv(np.array(columns, dtype=float).T)
    with mpmath.workdps(DIGITS):
        v, size = [mpmath.mpf(float(x)) for x in start], 1.0
        for _ in range(12):
            left = [mpmath.mpf(x) for x in system(exact, v)]
            largest = max(map(abs, left)) or mpmath.mpf(1)
            step = inverse @ np.array([float(x / largest) for x in left])
            v = [x - largest * mpmath.mpf(float(d)) for x, d in zip(v, step)]
            size = float(largest) * float(np.abs(step).max())
            if size < 1e-20:
                return float(v[-2]), float(v[-1])
    raise ArithmeticError(f"no convergence: last correction {size:.2g}")
