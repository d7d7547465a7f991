"""Random branches in closed form with two multipliers, with clusters of folds, period doublings and Neimark-Sacker points.

    python -m tools.fuzz.spectra 1000 [FIRST_SEED]

The branch is p = integral of g(u) with the polynomial g = k (u - r_1) ... (u - r_i). The characteristic polynomial of its multipliers is given by its
values at +1 and at -1: a tanh((u - r_1)/w_1) ..., which vanishes at folds, and b tanh((u - q_1)/v_1) ..., which vanishes at period doublings.
Their sum is 2 + 2 P with the product P of both multipliers: a pair lies on the unit circle if the sum is 4 and both values are positive. The exact
special points are the roots r and q, and those of the sum (by bisection). An even number of missing folds or doublings is no finding, and neither
is a missing pair next to them, because the ends of a continuation step do not show them.
"""

from __future__ import annotations

import sys
import time
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from scipy.optimize import brentq

import contvines as cv
from contvines.problems.dense import KERNELS, DenseWork
from contvines.problems.protocol import Kernels, ProblemDefaults

LOW, HIGH = -0.7, 0.9  # interval of u; the cluster is at zero
WIDEST, NARROWEST = -1.0, -9.0  # decadic logarithms of the largest and smallest size of a cluster
SAME = 1e-6  # largest distance of equal points, relative to the size of the cluster
PLACE = 1e-12  # lower bound of this distance
BESIDE = 1e-11  # tolerance of the ends of unresolved stretches, relative to the range of the parameter
KINDS = ("fold", "period-doubling", "neimark-sacker")


class Place(NamedTuple):
    """A special point."""

    kind: str
    u: float


class Spectrum(ProblemDefaults):
    """The branch of a seed."""

    dimension, n_multipliers, n_margins, spectrum, parameter = 1, 2, 0, "map", "p"

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng([41, seed])
        self.data = self
        self.size = 10.0 ** rng.uniform(NARROWEST, WIDEST)
        self.folds, self.doublings = (self._roots(rng) for _ in range(2))
        widths = rng.uniform(1.0, 3.0, 2) * self.size * 10.0 ** rng.choice([0.0, 1.0, 2.0], 2)
        self.widths = np.minimum(widths, 0.5)
        self.heights = rng.uniform(1.0, 6.0, 2) * rng.choice([-1.0, 1.0], 2)
        slope = Polynomial.fromroots(self.folds) if len(self.folds) else Polynomial([1.0])
        self.slope = slope * float(np.sign(self.heights[0]) / np.abs(slope(np.array([LOW, HIGH]))).max())
        self.value = self.slope.integ()
        self.u0 = np.array([LOW])
        self.p0 = float(self.value(LOW))
        self.kernels = Kernels(KERNELS.linearise, KERNELS.bordered, self._inspect)

    def _roots(self, rng: np.random.Generator) -> np.ndarray:
        count = int(rng.integers(0, 4))
        return np.sort(self.size * rng.uniform(-3.0, 3.0, count))

    def ends(self, u: Any) -> np.ndarray:
        """Return the values of the characteristic polynomial at +1 and at -1."""
        found = [
            height * np.prod([np.ones_like(u), *(np.tanh((u - root) / width) for root in roots)], axis=0)
            for height, width, roots in zip(self.heights, self.widths, (self.folds, self.doublings))
        ]
        return np.array(found)

    def multipliers(self, u: float) -> np.ndarray:
        """Return both multipliers."""
        one, other = self.ends(u)
        half, product = 0.25 * (other - one), 0.5 * (one + other) - 1.0
        root = np.sqrt(complex(half * half - product))
        larger = half + root if half >= 0.0 else half - root
        return np.array([larger, product / larger if root.imag == 0.0 and larger else 2.0 * half - larger])

    @staticmethod
    def _inspect(data: Spectrum, u: np.ndarray, p: float, work: Any, row: np.ndarray) -> None:
        both = data.multipliers(float(u[0]))
        row[:4:2], row[1:4:2] = both.real, both.imag

    def workspace(self) -> Any:
        """Return the workspace that contvines uses."""
        return DenseWork(1)

    def equations(self, u: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the residual p - p(u) and its derivatives."""
        return p - self.value(u), -np.diag(self.slope(u)), np.array([1.0])

    def places(self) -> list[Place]:
        """Return the exact special points."""
        found = [Place("fold", u) for u in self.folds] + [Place("period-doubling", u) for u in self.doublings]
        far = np.geomspace(1e-3 * self.size, 2.0, 3000)
        near = np.linspace(-4.0, 4.0, 8001) * self.size
        grid = np.unique(np.concatenate([-far, near, far]))
        grid = grid[(grid > LOW) & (grid < HIGH)]
        gap = self.ends(grid).sum(axis=0) - 4.0
        for i in np.flatnonzero(gap[:-1] * gap[1:] < 0.0):
            u = brentq(
                lambda u: float(self.ends(u).sum()) - 4.0, grid[i], grid[i + 1], xtol=1e-300, rtol=1e-15
            )
            if (self.ends(u) > 0.0).all():
                found.append(Place("neimark-sacker", float(u)))
        return sorted(found, key=lambda place: place.u)

    def graph(self) -> Any:
        """Compute the diagram."""
        values = self.value(np.linspace(LOW, HIGH, 1001))
        within = float(values.min()) - 1.0, float(values.max()) + 1.0
        return cv.diagram(self, within=within, depth=0)

    def wrong(self) -> tuple[list[str], int]:
        """Return errors of the diagram (missing and additional points), and the number of points that it reports as unresolved."""
        graph, wanted = self.graph(), self.places()
        branch = graph["B1"]
        marks = [(graph[label].kind, float(branch.points[i, 0])) for i, label in branch.marks]
        found = [Place(kind, u) for kind, u in marks if kind in KINDS and LOW < u < HIGH]
        said, left, lacking, unresolved = [], list(found), [], []
        beside = BESIDE * float(np.ptp(branch.values))
        for place in wanted:
            same = [f for f in left if f.kind == place.kind and self._same(f.u, place.u)]
            p = float(self.value(place.u))
            if same:
                left.remove(min(same, key=lambda f: abs(f.u - place.u)))
            elif any(x.low - beside <= p <= x.high + beside for x in graph.unresolved):
                unresolved.append(place)
            else:
                lacking.append(place)
        for kind in KINDS:
            lacks = [place.u for place in lacking if place.kind == kind]
            known = [f.u for f in found if f.kind == kind]
            one = any(abs(u - v) < graph.settings["same"] for u in lacks for v in known)  # have one label
            if kind == "neimark-sacker":
                one = len(lacking) + len(unresolved) > len(lacks)
            if len(lacks) % 2 and not one:
                said.append(f"lacks {kind} at " + " or ".join(f"{self.local(u):.9g}" for u in lacks))
        said += [f"has {place.kind} at {self.local(place.u):.9g}" for place in left]
        if len(graph.branches) != 1:
            said.append(f"has {len(graph.branches)} branches")
        if said:
            said.append(
                "there are " + ", ".join(f"{place.kind} {self.local(place.u):.9g}" for place in wanted)
            )
            said += [x.sentence("p") for x in graph.unresolved]
        return said, len(unresolved)

    def local(self, u: float) -> float:
        """Return a position relative to the size of the cluster."""
        return u / self.size

    def _same(self, one: float, other: float) -> bool:
        return abs(one - other) <= max(SAME * self.size, PLACE)


def main(count: int, first: int) -> None:
    """Check `count` branches and print the findings."""
    began, bad, unresolved, points = time.process_time(), 0, 0, 0
    for seed in range(first, first + count):
        problem = Spectrum(seed)
        said, open_ = problem.wrong()
        unresolved += open_
        points += len(problem.places())
        if said:
            bad += 1
            print(f"{seed}, a cluster of {problem.size:.2g}", *said, sep="\n    ", flush=True)
    spent = time.process_time() - began
    print(
        f"{count} branches, {points} points, {unresolved} of them unresolved, {bad} wrong, {spent:.0f} s",
        flush=True,
    )


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)
