"""Check the structure of a graph: no duplicate branches, repeated orbits, branches of length zero, borders without a reason, or loose ends."""

from __future__ import annotations

from typing import Any

import numpy as np

from contvines.bifurcation.kinds import BORDERS
from orbits.orbit import PER_PERIOD, REAL
from orbits.starts.find import polish
from tools.fuzz.many_digits import exact, rounds_apart
from tools.fuzz.motion import apart, shortest
from tools.fuzz.tally import Tally

ONE = 1e-9  # largest difference of equal motions
CRITICAL = 1e-2  # distance of multipliers from 1 below which two branches may share an orbit (branch point)
# largest difference of equal parts of a motion: absolute, and relative to the extent of the branch
REPEATED, OF_EXTENT = (
    1e-7,
    1e-2,
)
APART = 1e-30  # smallest difference of different rounds of one motion in many digits
SHARED = 1e-6  # distance from the motion of a special point below which an orbit is shared by all branches that meet there
NOTHING = 1e-7  # extent of a branch (parameter and unknowns) below which its orbit is checked in many digits
PART = 1e-2  # largest error of this orbit, relative to the extent and to its margin
ROUNDOFF = 1e-9
# largest difference of a special point's motion from the simulated one, with moderate and with large multipliers
FOLLOWED, FAR_FOLLOWED = (
    2e-5,
    1e-3,
)
# the same at a graze, times the multipliers: an impact due to rounding changes an error to its square root
ROOTED = 1e-7
ULPS = 64  # values closer than this many units in the last place count as equal, so that crossings between them are not resolved
IN_PLACE = 1e-8  # largest error of a special point


def judge(graph: Any, tally: Tally) -> None:
    """Do all checks on one graph."""
    tally.count("branches", len(graph))
    tally.count("special points", len(graph.special))
    for branch in graph:
        _branch(branch, tally)
    for point in graph.special.values():
        _point(graph, point, tally)
    if not graph.settings["virtual"]:
        _doubled([branch for branch in graph if branch.real and len(branch.description["word"])], tally)


def _branch(branch: Any, tally: Tally) -> None:
    inner = branch.margin[1:-1]
    if branch.real and len(inner) and inner.min() < REAL:
        tally.find("margin", f"{branch.label} is called real, a margin inside is {inner.min():.1e}")
    extent = max(float(np.ptp(branch.values)), float(np.ptp(branch.points, axis=0).max(initial=0.0)))
    if branch.real and len(branch) > 1 and extent < NOTHING and not _certainly_there(branch, extent):
        tally.find("no length", f"{branch.label} is called real, but is {extent:.1e} long")
    marked = {i for i, _ in branch.marks}
    flips = np.flatnonzero(branch.stable[1:] != branch.stable[:-1])
    loose = [int(i) for i in flips if not {i, i + 1} & marked]
    if loose and branch.real:
        apart = np.abs(branch.values[[i + 1 for i in loose]] - branch.values[loose])
        told = apart > ULPS * np.spacing(np.abs(branch.values[loose]))
        tally.count("changes of stability within rounding of the parameter", int(np.sum(~told)))
        loose = [i for i, seen in zip(loose, told) if seen]
    if loose and not branch.real:
        tally.count("virtual branches that change their stability without a point")
    elif loose:
        tally.find(
            "stability",
            f"{branch.label} changes its stability at {branch.values[loose[0]]:.9g} without a point",
        )
    if not len(branch.problem.word):
        return
    places = np.unique(np.linspace(0, len(branch) - 1, 7).astype(int))
    orbits = [branch.orbit(int(i)) for i in places]
    # a very short branch after a doubling differs little from its root, in proportion to its extent
    extent = max(
        float(np.abs(orbit.positions(PER_PERIOD) - orbits[0].positions(PER_PERIOD)).max()) for orbit in orbits
    )
    near = min(REPEATED, OF_EXTENT * extent) if len(branch) > 1 else REPEATED
    if all(shortest(orbit, near) < orbit.periods for orbit in orbits):
        middle = orbits[len(orbits) // 2]
        if rounds_apart(middle, shortest(middle, near)) > APART:
            tally.count("branches whose rounds differ by hardly more than rounding")
            return
        tally.find(
            "repeated",
            f"{branch.label} {branch.description['word']} k={branch.problem.periods} repeats a shorter orbit",
        )


def _certainly_there(branch: Any, extent: float) -> bool:
    """Whether the orbit with the largest margin has, against many digits, an error that is small relative to the margin and the branch."""
    orbit = branch.orbit(int(np.argmax(branch.margin)))
    found = exact(orbit)
    return found is not None and abs(found.shift) + found.moved < PART * min(orbit.margin, extent)


def _point(graph: Any, point: Any, tally: Tally) -> None:
    where = f"{point.label} at {point.value:.10g}"
    if " failed: " in point.note:
        tally.find("exception", f"{where}: {point.note}")
    size = max(1.0, float(np.abs(point.u).max(initial=0.0)))
    if not point.residual < ROUNDOFF * size:
        tally.find("residual", f"{where}: {point.residual:.1e}")
    low, high = graph.within
    if not max(low - point.value, point.value - high) <= point.location_error + ROUNDOFF:
        tally.find("outside", f"{where} ({point.kind}) lies outside the interval")
    branch = graph[point.branch]
    if not (point.real and branch.real):
        return
    if not point.location_error < IN_PLACE:
        tally.count("special points with a told error above 1e-8")
    outermost = np.abs(point.multipliers).max(initial=0.0)
    followed = FAR_FOLLOWED if outermost > 1e3 else FOLLOWED
    if point.kind == "wall-graze":
        followed = max(followed, ROOTED * outermost)
    if point.replay is None or not point.replay < followed:
        if outermost > 1e8:
            tally.count("special points too unstable to be simulated")
        else:
            tally.find(
                "replay",
                f"{where} ({point.kind}, {point.branch}): {point.replay}, multipliers to {outermost:.1e}",
            )
    if point.kind in BORDERS and not any(switch.point == point.label for switch in graph.switches):
        if not point.note:
            tally.find(
                "no reason",
                f"{where} ({point.kind}) on {point.branch}: nothing goes on, and nothing says why",
            )
        else:
            tally.count("borders with a reason: " + " ".join(point.note.split()[:4]))


def _doubled(branches: list[Any], tally: Tally) -> None:
    """Check that the motion at the middle of a branch is on no other branch; every other branch is solved at the same parameter value."""
    for i, one in enumerate(branches):
        place = _middle(one)
        if place is None:
            continue
        value, orbit = float(one.values[place]), one.orbit(place)
        for other in branches[i + 1 :]:
            for q in np.flatnonzero((other.values[:-1] - value) * (other.values[1:] - value) <= 0.0):
                step = other.values[q + 1] - other.values[q]
                if step == 0.0:
                    continue
                t = (value - other.values[q]) / step
                guess = (1.0 - t) * other.points[q] + t * other.points[q + 1]
                solved = polish(other.problem.orbit(guess, value))
                if solved is None:
                    continue
                tally.count("pairs of branches compared")
                if apart(orbit, solved) < ONE:
                    tally.find("doubled", f"{one.label} and {other.label} have one motion at {value:.10g}")


def _middle(branch: Any) -> int | None:
    """Return the point with the largest margin among those that can belong to no other branch; None if there is none.

    Its multipliers must not be critical, and it must not be next to a special point, whose motion several branches share.
    """
    margin = branch.margin.copy()
    margin[[0, -1]] = 0.0
    if branch.multipliers.shape[1]:
        margin[np.abs(branch.multipliers - 1.0).min(axis=1) < CRITICAL] = 0.0
    special = [branch.orbit(i) for i in sorted({0, len(branch) - 1, *(i for i, _ in branch.marks)})]
    for place in np.argsort(-margin, kind="stable"):
        if not margin[place] > 0.0:
            break
        if all(not apart(branch.orbit(int(place)), shared) < SHARED for shared in special):
            return int(place)
    return None
