"""Check special points by orbits next to them: motions and multipliers tend to those of the point, and a multiplier or the parameter passes its critical value."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from contvines.bifurcation.kinds import BORDERS
from tools.fuzz.approached import comes_to, grow_without_bound
from tools.fuzz.between import Between
from tools.fuzz.many_digits import exact
from tools.fuzz.motion import alike, apart, shortest
from tools.fuzz.tally import Tally

PARTS = (1.0, 1e-1, 1e-2, 1e-3)  # relative distances at which motions are compared with that of the point
CLOSER = (1e-4, 1e-5)  # further distances, if virtual orbits at larger ones have negative durations
NEAR = 1e-7  # largest difference of values of one point
SAME = 1e-6  # difference of motions below which they need not decrease further
SHRINKS = 0.5  # largest ratio of differences for a tenth of the distance; for a square root it is 0.32
NEARER = (1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5)  # relative distances at which multipliers are compared
NEAREST = (1e-6, 1e-7, 1e-8, 1e-9)  # further distances, if multipliers still change
UNBOUNDED = 1e14  # listed multipliers above this size stand for unbounded ones
LIMIT = 1e-3  # largest relative difference of characteristic polynomials
ROUNDED = 0.05  # largest difference of characteristic polynomials due to rounding, for long words
UNRESOLVED = 1e-12  # relative difference of the parameter below which values are equal to rounding
ASIDE = 0.1  # relative distance at which both sides of a bifurcation are compared

TURNING = 1e-3  # largest parameter component of a unit tangent at a fold


def judge(graph: Any, tally: Tally) -> None:
    """Check each special point of each branch."""
    for branch in graph:
        between = Between(branch, graph.within)
        for i, label in branch.marks:
            if label in graph.special and graph[label].kind not in ("end", "user"):
                _tends(between, i, graph[label], tally)
                if graph[label].kind in BORDERS:
                    _limits(between, i, graph[label], tally)
                elif graph[label].branch == branch.label and branch.real and 0 < i < len(branch) - 1:
                    _crosses(between, i, graph[label], tally)
                    if graph[label].kind == "fold":
                        _turns(between, i, graph, graph[label], tally)
    for switch in graph.switches:
        _joined(graph, switch, tally)


def _joined(graph: Any, switch: Any, tally: Tally) -> None:
    """Check that both branches of a switch list the point (then `_tends` checks both), or have its orbit at another of their points."""
    tally.count("crossings")
    point = graph[switch.point]
    for end in (switch.source, switch.target):
        branch = graph[end]
        if any(label == switch.point for _, label in branch.marks):
            continue
        places = [
            i
            for i in {0, len(branch) - 1, *(i for i, _ in branch.marks)}
            if abs(branch.values[i] - point.value) < NEAR
        ]
        if any(apart(point.orbit, branch.orbit(i)) < max(SAME, _unresolved(point)) for i in places):
            continue
        if not branch.real:
            tally.count("virtual branches that are met where they have no point")
        else:
            tally.find(
                "link", f"{switch.point} joins {switch.source} and {switch.target}, but is not on {end}"
            )


def _tends(between: Between, i: int, point: Any, tally: Tally) -> None:
    """Check that the branch's orbits tend to that of the point as their distance tends to zero."""
    branch = between.branch
    for way in between.ways(i):
        beside = list(between.beside(i, way, PARTS))
        seen = [(d, apart(point.orbit, orbit)) for d, orbit in beside]
        if any(math.isnan(gap) for _, gap in seen[-2:]):
            seen += [(d, apart(point.orbit, orbit)) for d, orbit in between.beside(i, way, CLOSER)]
        gaps = [gap for _, gap in seen]
        if len(gaps) < 2 or math.isnan(gaps[-1]):
            tally.count("ways to special points that cannot be followed")
            continue
        tally.count("ways to special points followed")
        # near a branch point the equations are nearly singular, so the smallest difference counts instead of the last
        nearest = gaps[-1] if point.kind in BORDERS or point.kind == "fold" else float(np.nanmin(gaps))
        falls = nearest < SAME or (gaps[-1] < SHRINKS * gaps[-2] and gaps[-1] < 0.05)
        if not falls and gaps[-1] < _unresolved(point):
            tally.count("ways to special points shorter than what is known of the parameter")
        elif not falls and _comes_home(branch.orbit(i), [orbit for _, orbit in beside], point):
            tally.count("ways to special points followed in many digits")
        elif not falls:
            what = ", ".join(f"{gap:.1e} at {d:.0e}" for d, gap in seen)
            tally.find(
                "jump",
                f"{branch.label} does not tend to {point.label} ({point.kind}, {point.value:.10g}): {what}",
            )


def _comes_home(end: Any, beside: list[Any], point: Any) -> bool:
    """Whether the branch through the two most distant orbits leads to the motion of the point in many digits; they must not repeat shorter orbits."""
    return (
        len(beside) > 1
        and apart(end, point.orbit) < SAME
        and all(shortest(orbit) == orbit.periods for orbit in beside[:2])
        and comes_to(beside[0], beside[1], end, point.location_error)
    )


def _unresolved(point: Any) -> float:
    """Change of the motion while the parameter changes by the point's stated error or its last bit; smaller differences of motions are not significant."""
    if point.kind == "fold":  # the parameter is stationary, and folds are located by the motion
        return 0.0
    along = np.asarray(point.tangent)
    rate = abs(float(along[-1])) / float(np.abs(along).max())
    return max(float(np.spacing(point.value)), point.location_error) / max(rate, 1e-300)


def _limits(between: Between, i: int, point: Any, tally: Tally) -> None:
    """Check that the multipliers listed at a border are the limits of those of nearby orbits on this branch."""
    branch = between.branch
    ways = between.ways(i)
    if len(ways) != 1 or not branch.multipliers.shape[1] or not len(branch.problem.word):
        return
    listed = branch.multipliers[i]
    if branch.real and not any(
        m is not None and len(m) == len(listed) and np.array_equal(m, listed)
        for m in (point.multipliers, point.multipliers_beyond)
    ):
        tally.count("ends of branches with multipliers of a third branch")
    beside = list(between.beside(i, ways[0], NEARER))
    seen = [(d, orbit.multipliers) for d, orbit in beside]
    if len(seen) < 3:
        tally.count("borders beside which nothing can be solved for")
        return
    tally.count("multipliers at borders")
    sizes = [float(np.abs(m).max()) for _, m in seen]
    if sizes[0] > UNBOUNDED / 100.0:
        tally.count("borders of orbits too unstable to tell")
        return
    if not np.all(np.abs(listed) < UNBOUNDED):
        if sizes[-1] > 1.5 * sizes[-2] or sizes[-1] > UNBOUNDED:
            return
        if grow_without_bound(beside[-3][1], beside[-2][1], point.location_error):
            tally.count("multipliers at borders that grow in many digits, where doubles come no nearer")
        else:
            tally.find("limit", f"{branch.label} at {point.label}: without bound, but {sizes[-3:]} beside it")
        return
    if _tend_to(listed, seen):
        return
    nearest = list(between.beside(i, ways[0], NEAREST))
    seen += [(d, orbit.multipliers) for d, orbit in nearest]
    if _tend_to(listed, seen):
        return
    if _within_rounding(listed, [orbit for _, orbit in nearest[-2:]]):
        tally.count("multipliers at borders that are off by what rounding does to those beside them")
        return
    known = [
        orbit
        for _, orbit in beside + nearest
        if abs(branch.problem.value(orbit.params) - point.value) <= point.location_error
    ]
    if _among(listed, known):
        tally.count("multipliers at borders that change by more within the told error")
        return
    what = f"{_text(listed)} listed, {_text(seen[-1][1])} at {seen[-1][0]:.0e}, {_text(seen[-3][1])} at {seen[-3][0]:.0e}"
    tally.find("limit", f"{branch.label} at {point.label} ({point.kind}, {point.value:.10g}): {what}")


def _tend_to(listed: np.ndarray, seen: list[tuple[float, np.ndarray]]) -> bool:
    """Whether multipliers at decreasing distances from a border tend to the listed ones."""
    gaps = [alike(listed, m) for _, m in seen]
    nearest = gaps[-3:]
    return min(gaps) < LIMIT or (nearest[2] < SHRINKS * nearest[0] and nearest[2] < 0.1)


def _within_rounding(listed: np.ndarray, beside: list[Any]) -> bool:
    """Whether the error of listed multipliers (against many digits) is not larger than the rounding error of multipliers of nearby orbits."""
    known = [(orbit, found) for orbit in beside if (found := exact(orbit)) is not None]
    if not known:
        return False
    off = max(alike(orbit.multipliers, found.multipliers) for orbit, found in known)
    return alike(listed, known[-1][1].multipliers) <= min(off, ROUNDED)


def _among(listed: np.ndarray, known: list[Any]) -> bool:
    """Whether the characteristic polynomial lies between those of orbits that cannot be distinguished from the border."""
    if len(known) < 2:
        return False
    polynomials = np.array([np.poly(orbit.multipliers).real for orbit in known])
    slack = LIMIT * np.abs(polynomials).max()
    own = np.poly(listed).real
    return bool(
        (own >= polynomials.min(axis=0) - slack).all() and (own <= polynomials.max(axis=0) + slack).all()
    )


def _text(multipliers: np.ndarray) -> str:
    return "[" + " ".join(f"{m:.6g}" for m in multipliers) + "]"


def _crosses(between: Between, i: int, point: Any, tally: Tally) -> None:
    """Check that a multiplier crosses the unit circle at a bifurcation, and that the parameter turns at a fold.

    Only for real branches: equations of virtual orbits may be singular without this, if a stick (whose end does not depend on its
    beginning) ends at a maximum.
    """
    branch = between.branch
    sides = [next((orbit for _, orbit in between.beside(i, way, (ASIDE,))), None) for way in (-1, 1)]
    if None in sides or point.met_from is not None:
        return
    if point.kind == "branch-point" and abs(point.tangent[-1]) < TURNING:
        tally.count(
            "branch points at which the parameter turns"
        )  # the curved branch of a pitchfork: the multiplier only touches 1
        return
    tally.count("bifurcations with both sides")
    before, after = (_past(orbit.multipliers) for orbit in sides)
    if before == after:
        what = f"{_text(sides[0].multipliers)} and {_text(sides[1].multipliers)}"
        tally.find(
            "crossing",
            f"nothing crosses at {point.label} ({point.kind}, {branch.label}, {point.value:.10g}): {what} beside it",
        )


def _turns(between: Between, i: int, graph: Any, point: Any, tally: Tally) -> None:
    """Check that the parameter turns at a fold: compare the nearest orbits on both sides whose parameter differs by more than rounding, before the next fold."""
    if point.met_from is not None:
        return
    branch, gaps = between.branch, []
    near = UNRESOLVED * max(1.0, abs(point.value))
    folds = {
        k for k, label in branch.marks if k != i and label in graph.special and graph[label].kind == "fold"
    }
    for way in (-1, 1):
        aside = next((orbit for _, orbit in between.beside(i, way, (ASIDE,))), None)
        k, gap = i, 0.0 if aside is None else branch.problem.value(aside.params) - point.value
        while abs(gap) < near and 0 <= k + way < len(branch) and k + way not in folds:
            k += way
            gap = float(branch.values[k]) - point.value
        gaps.append(gap)
    if min(map(abs, gaps)) < near:
        tally.count("folds beside another point, or an end, that floating point does not resolve")
    elif gaps[0] * gaps[1] < 0.0:
        tally.find(
            "fold",
            f"{point.label} on {branch.label}: {point.parameter} does not turn at {point.value:.12g}: {gaps}",
        )
    else:
        tally.count("folds at which the parameter turns")


def _past(multipliers: np.ndarray) -> tuple[int, int, int]:
    """Return the numbers of multipliers above 1, below -1, and in pairs outside the unit circle."""
    real = multipliers[multipliers.imag == 0.0].real
    pairs = multipliers[multipliers.imag > 0.0]
    return int((real > 1.0).sum()), int((real < -1.0).sum()), int((np.abs(pairs) > 1.0).sum())
