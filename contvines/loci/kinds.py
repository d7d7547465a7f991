"""Points of codimension two: their kinds and labels, and what is looked for along each sort of locus."""

from __future__ import annotations

from typing import NamedTuple

from ..bifurcation.kinds import CODIMENSION_TWO
from ..problems.protocol import Problem
from .layout import BRANCH, FLIP, FOLD, MARGIN, OWN, PAIR, PERIOD

#: kind of a point of codimension two -> prefix of its label
PREFIXES = {kind.name: kind.label for kind in CODIMENSION_TWO.values()}


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
    if kind in ("period-doubling", "symmetry-breaking") and not (
        problem.spectrum == "map" and problem.flip_kind == kind
    ):
        return BRANCH
    return CONDITIONS.get(kind, MARGIN)


class Look(NamedTuple):
    """What to look for along a locus: a test and the kind of point that its zero is.

    Attributes
    ----------
    test : str
        "quadratic", "cubic", "lyapunov", "plus", "minus", "pair", "second-pair", "double" (two multipliers at ``value``), "angle"
        (the cosine of a pair is ``value``), "touch" (the margin has a double zero along the branch).
    kind : str
    value : float
    """

    test: str
    kind: str
    value: float = 0.0


TOUCH = Look("touch", "degenerate-border")


def looks(problem: Problem, condition: int) -> list[Look]:
    """What is looked for along a locus with this condition; borders are found by the margins themselves."""
    if condition == OWN:
        return []  # of a user's condition nothing is known
    spectrum, m = problem.spectrum, int(problem.n_multipliers)
    half = problem.flip_kind == "symmetry-breaking"
    turn = "symmetry-breaking" if half else "flip"
    flow, found = spectrum == "flow", []
    pairs = m >= (2 if condition in (MARGIN, PAIR) else 3)
    if condition == FOLD:
        found.append(Look("quadratic", "cusp"))
    if spectrum == "none":
        return found if condition != MARGIN else [Look("plus", "border-fold"), TOUCH]
    if condition in (FOLD, BRANCH) and m >= 2:
        found.append(Look("double", "bogdanov-takens" if flow else "resonance-1-1", 0.0 if flow else 1.0))
        if pairs:
            found.append(Look("pair", "zero-hopf" if flow else "fold-neimark-sacker"))
        if not flow:
            found.append(Look("minus", f"fold-{turn}"))
    if condition == FLIP:
        found.append(Look("cubic", "degenerate-symmetry-breaking" if half else "generalized-period-doubling"))
        if m >= 2:
            found.append(Look("double", "resonance-1-1" if half else "resonance-1-2", -1.0))
            found.append(Look("plus", f"fold-{turn}"))
        if pairs:
            found.append(Look("pair", f"{turn}-neimark-sacker"))
    if condition == PAIR:
        found.append(Look("lyapunov", "generalized-hopf" if flow else "chenciner"))
        if flow:
            found.append(Look("angle", "bogdanov-takens", 0.0))
        else:
            found += resonances(half)
        if m >= 3:
            found.append(Look("plus", "zero-hopf" if flow else "fold-neimark-sacker"))
            if not flow:
                found.append(Look("minus", f"{turn}-neimark-sacker"))
        if m >= 4:
            found.append(Look("second-pair", "double-hopf" if flow else "double-neimark-sacker"))
    if condition == MARGIN:
        found += [Look("plus", "border-fold"), TOUCH]
        if not flow:
            found.append(Look("minus", f"border-{turn}"))
        if m >= 2:
            found.append(Look("pair", "border-neimark-sacker"))
    return found


def resonances(half: bool) -> list[Look]:
    """Strong resonances by the cosine of the raw angle; on half maps the multipliers of the full period are squares."""
    root = 0.5**0.5
    cosines = (
        ((1.0, -1.0), (0.0,), (0.5, -0.5), (root, -root)) if half else ((1.0,), (-1.0,), (-0.5,), (0.0,))
    )
    return [Look("angle", f"resonance-1-{n}", c) for n, both in enumerate(cosines, 1) for c in both]
