"""The loci that leave a point of codimension two."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..continuation.engine import Engine
from ..continuation.settings import Settings
from ..problems.protocol import Problem
from .layout import BRANCH
from .linear import Linearisation
from .locus import Locus
from .plane_point import PlanePoint
from .starts import begin

#: kind of a point -> kinds of the loci of the same problem that pass it
PASSING = {
    "bogdanov-takens": ("fold", "hopf"),
    "zero-hopf": ("fold", "hopf"),
    "double-hopf": ("hopf",),
    "generalized-hopf": ("hopf",),
    "resonance-1-1": ("fold", "neimark-sacker"),
    "resonance-1-2": ("period-doubling", "neimark-sacker"),
    "fold-flip": ("fold", "period-doubling"),
    "fold-symmetry-breaking": ("fold", "symmetry-breaking"),
    "fold-neimark-sacker": ("fold", "neimark-sacker"),
    "flip-neimark-sacker": ("period-doubling", "neimark-sacker"),
    "symmetry-breaking-neimark-sacker": ("symmetry-breaking", "neimark-sacker"),
    "double-neimark-sacker": ("neimark-sacker",),
    "border-fold": ("fold",),
    "border-flip": ("period-doubling",),
    "border-symmetry-breaking": ("symmetry-breaking",),
    "border-neimark-sacker": ("neimark-sacker",),
}
ASIDE = 0.01  # of the interval of the first parameter: how far from a crossing a locus is started
AMPLITUDES = (0.05, 0.02, 0.1, 0.005)  # of the doubled cycle at which its fold is looked for


class Candidate(NamedTuple):
    """A special point at (p, q) from which a locus may be traced; ``index`` is that of the margin at a border."""

    problem: Problem
    kind: str
    u: np.ndarray
    p: float
    q: float
    index: int
    seed: str


def leaving(point: PlanePoint, locus: Locus, bounds: tuple[float, float], over: str) -> list[Candidate]:
    """Starts of the loci that pass a point, or begin there."""
    problem, (p, q) = point.problem, point.value
    found = []
    crossing = locus.problem.condition == BRANCH  # two branches cross there, and none of them folds
    for kind in PASSING.get(point.kind, ()):
        if kind == "neimark-sacker" and problem.spectrum != "map":
            continue
        if not crossing:
            found.append(Candidate(problem, kind, point.u, p, q, 0, point.label))
        elif kind != "fold":  # started beside the crossing, where the equations are regular
            found += [
                Candidate(
                    problem, kind, point.u, p + side * ASIDE * (bounds[1] - bounds[0]), q, 0, point.label
                )
                for side in (-1.0, 1.0)
            ]
    if point.kind == "double-border" or point.kind.startswith("border-"):
        found += [
            Candidate(problem, problem.margin_kind(j), point.u, p, q, j, point.label) for j in point.margins
        ]
    if point.kind == "generalized-period-doubling":
        found += _fold_of_doubled(point, bounds, over, locus.within)
    return found


def _fold_of_doubled(
    point: PlanePoint, bounds: tuple[float, float], over: str, within: tuple[float, float]
) -> list[Candidate]:
    """The fold of the doubled cycle, which begins where the doubling turns from super- to subcritical."""
    problem, (p, q) = point.problem, point.value
    line = Linearisation(problem)
    line.at(point.u, p)
    null = line.null_vectors(flipped=True)
    embeddings = problem.offspring(problem.flip_kind, point.u, p, np.append(null.right, 0.0), -1.0 + 0.0j)
    if not embeddings:
        return []
    child = embeddings[0]
    n = len(point.u)
    direction = np.asarray(child.tangent, dtype=float)[:-1].copy()
    direction[n:] *= -1.0
    units = np.tile(line.units, 2)
    direction /= np.linalg.norm(direction / units)
    base = np.asarray(child.u, dtype=float)
    for amplitude in AMPLITUDES:
        size = amplitude * (1.0 + float(np.abs(base / units).max()))
        guess = base + size * direction
        locus = begin(child.problem, "fold", guess, p, over, 0, bounds)
        engine = Engine(locus, within, Settings())
        border = np.zeros(locus.dimension + 1)
        border[: 2 * n] = direction / units**2
        solved = engine.solve(locus.joined(guess, p), q, border, float(border[: 2 * n] @ guess))
        if solved is None or np.abs((solved.u[: 2 * n] - guess) / units).max() > 10.0 * size:
            continue
        return [
            Candidate(
                locus.at(solved.p),
                "fold",
                solved.u[: 2 * n],
                float(locus.split(solved.u)[1]),
                solved.p,
                0,
                point.label,
            )
        ]
    return []
