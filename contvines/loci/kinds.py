"""What is followed along a locus: the condition that special points of each kind satisfy."""

from __future__ import annotations

from ..problems.protocol import Problem

# in Python alone: PERIOD, one of the unknowns, the period, has a given value; GROWTH, the only multiplier is 1; OWN, the condition of a user's kind
FOLD, FLIP, MARGIN, PAIR, BRANCH, PERIOD, GROWTH, OWN = range(8)
APART = 0.03  # of its size: how far from an equilibrium a cycle may stay that stands for a homoclinic orbit

#: kind of a special point -> what is followed, unless it is a border (then its margin)
CONDITIONS = {
    "fold": FOLD,
    "branch-point": BRANCH,
    "neimark-sacker": PAIR,
    "hopf": PAIR,
    "period-doubling": FLIP,
    "symmetry-breaking": FLIP,
    "homoclinic": PERIOD,
}


def condition(problem: Problem, kind: str) -> int:
    """What is followed for a special point of this kind, seen in this problem.

    A symmetry breaking or period doubling is a multiplier -1 where the problem says so (``flip_kind``), else a branch point
    of the problem itself, on the fixed space of a symmetry.
    """
    found = CONDITIONS.get(kind, MARGIN)
    if found == FLIP and not (problem.spectrum == "map" and problem.flip_kind == kind):
        return BRANCH
    return found
