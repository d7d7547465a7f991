"""What a graph itself must not have: doubled branches, repeated orbits, branches of no length, borders without a reason, loose ends."""

from __future__ import annotations

from typing import Any

import numpy as np

from contvines.bifurcation.kinds import BORDERS
from orbits.orbit import PER_PERIOD, REAL
from orbits.starts.find import polish
from tools.fuzz.many_digits import exact, rounds_apart
from tools.fuzz.motion import apart, shortest
from tools.fuzz.tally import Tally

ONE = 1e-9  # motions this near are one
CRITICAL = 1e-2  # multipliers as near to 1: beside a branch point two branches do share an orbit
REPEATED, OF_EXTENT = (
    1e-7,
    1e-2,
)  # parts of a motion that differ by less are one; the same as a part of the branch's extent
APART = 1e-30  # rounds of one motion, in many digits, that differ by more are two
SHARED = 1e-6  # motions nearer than this to that of a special point are those of all branches that meet there
NOTHING = 1e-7  # extent of a branch, in parameter and unknowns, that needs a proof ...
PART = 1e-2  # ... in many digits: part of it, and of its margin, by which an orbit may be elsewhere
ROUNDOFF = 1e-9
FOLLOWED, FAR_FOLLOWED = (
    2e-5,
    1e-3,
)  # differences of a special point's motion from the simulated one, where multipliers are moderate, and not
ROOTED = (
    1e-7  # the same, times multipliers, at a graze: a wall that rounding hits turns it into its square root
)
ULPS = 64  # values nearer than so many last bits are one: where a multiplier passes 1 or -1 between them is not told
IN_PLACE = 1e-8  # a special point's error


def judge(graph: Any, tally: Tally) -> None:
    """All of these checks on one graph."""
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
    # a branch so short that it is born by a doubling and hardly leaves it does differ from its root: as much as its own motions do
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
    """Whether the orbit of the largest margin, in many digits, is off its place by next to nothing of the margin and of the branch."""
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
    """Motions at the middle of a branch, solved for on every other branch that has this value of the parameter."""
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
    """The point of the largest margin: furthest from borders, and not critical, so that the orbit is no other branch's.

    Nor one beside a special point of the branch, whose motion all branches share that meet there.
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
