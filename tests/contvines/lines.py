"""Problems of one unknown whose equation, multipliers and margins are given functions of it and of the parameter."""

import numpy as np

from contvines.problems.dense import KERNELS, DenseWork
from contvines.problems.protocol import Kernels, ProblemDefaults, Seed


def inspect(data, u, p, work, row):
    found, m = np.array(data.multipliers(u[0], p)), 2 * data.n_multipliers
    row[:m:2], row[1:m:2], row[m:] = found.real, found.imag, data.margins(u[0], p)


class Line(ProblemDefaults):
    """u = p, or the curve whose function returns F, dF/du and dF/dp, with a multiplier 1/2 or those given, and with margins."""

    dimension, parameter = 1, "p"
    kernels = Kernels(KERNELS.linearise, KERNELS.bordered, inspect)

    def __init__(
        self,
        margins=lambda u, p: [],
        multipliers=lambda u, p: [0.5],
        curve=lambda u, p: (u - p, 1.0, -1.0),
        start=(-0.95, -0.95),
    ):
        self.margins, self.multipliers, self.curve, self.data = margins, multipliers, curve, self
        self.n_margins, self.n_multipliers = len(margins(*start)), len(multipliers(*start))
        self.spectrum = "map" if self.n_multipliers else "none"
        self.u0, self.p0 = np.array(start[:1]), start[1]

    def workspace(self):
        return DenseWork(1)

    def equations(self, u, p):
        F, by_u, by_p = self.curve(u[0], p)
        return np.array([F]), np.array([[by_u]]), np.array([by_p])

    def margin_kind(self, j):
        return ("velocity-graze", "wall-graze")[j]


class Word(Line):
    """u = offset + slope p with margins sides * (p - at), or with functions of its own; what is beyond its borders functions say."""

    def __init__(self, word, offset, slope, sides=(), at=(), beyond=(), **functions):
        self.word, self.others = word, beyond
        given = {
            "margins": lambda u, p: np.array(sides) * (p - np.array(at)),
            "curve": lambda u, p: (u - offset - slope * p, 1.0, -slope),
            "start": (offset + 0.3 * slope, 0.3),
        }
        super().__init__(**given | functions)

    def beyond(self, point):
        self.seen = point
        return [other(self, point) for other in self.others]

    def canonical(self, u, p):
        return self.word, u

    def describe(self):
        return {"name": "line", "word": self.word, "factory": None}


def ending(*beyond):
    """Word "a": u = p, real for p < 1/2."""
    return Word("a", 0.0, 1.0, [-1.0], [0.5], beyond)


def seed(problem, u, p, persistence=True):
    note = "persistence" if persistence else "nonsmooth fold"
    return Seed(problem, np.array([u]), p, None, "border", note, persistence)


def persistent(line, point):
    """Word "b": u = 2 p - 1/2, real for p > 1/2, unstable."""
    return seed(Word("b", -0.5, 2.0, [1.0], [0.5], multipliers=lambda u, p: [1.5]), 0.52, 0.51)


def folding(line, point):
    """Word "b": u = 1 - p, real for p < 1/2, unstable."""
    return seed(Word("b", 1.0, -1.0, [-1.0], [0.5], multipliers=lambda u, p: [1.5]), 0.51, 0.49, False)
