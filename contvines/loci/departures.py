"""The loci that leave a point of codimension two."""

from __future__ import annotations

from ..bifurcation.kinds import CODIMENSION_TWO
from .born import Candidate, born
from .homoclinic import homoclinic_of
from .layout import BRANCH
from .locus import Locus
from .plane_point import PlanePoint

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


def leaving(point: PlanePoint, locus: Locus, bounds: tuple[float, float], over: str) -> list[Candidate]:
    """Starts of the loci that pass a point, or begin there."""
    problem, (p, q) = point.attached, point.value
    found = []
    crossing = (
        locus.problem is not None and locus.problem.condition == BRANCH
    )  # two branches cross there, and none of them folds
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
    if (kind := CODIMENSION_TWO.get(point.kind)) is not None and kind.border:
        found += [
            Candidate(problem, problem.margin_kind(j), point.u, p, q, j, point.label) for j in point.margins
        ]
    if point.kind == "bogdanov-takens":
        found += homoclinic_of(point, bounds, locus.within)
    return found + born(point, bounds, over, locus.within)
