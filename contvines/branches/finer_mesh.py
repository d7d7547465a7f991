"""Finer meshes for a branch that is being followed: what has been found of it is read on the next one, and it goes on there.

A polynomial on an interval is the same one on both halves of it. So points stay as they were solved, with the error of their mesh,
which was small enough where they are; special points are located again.
"""

from __future__ import annotations

from collections.abc import Callable, Container
from dataclasses import replace
from itertools import pairwise
from typing import TypeVar

import numpy as np

from ..bifurcation.detect import Detector
from ..bifurcation.locate import Role
from ..continuation.engine import Engine, Solved
from ..continuation.layout import Status, packed
from ..continuation.mesh_motion import MeshMotion
from ..problems.abilities import Adaptive
from ..problems.protocol import Problem
from .half_branch import HalfBranch

Start = TypeVar("Start")

FAR = 1e-3  # of a typical size: from the same point on the mesh before


class Meshes:
    """The meshes of one branch, each with twice as many intervals as the one before.

    Parameters
    ----------
    detector : Detector
        Of the first mesh.
    detector_of : callable
        The detector of a problem.
    vanishes : callable, optional
        Whether the solutions of a half shrink to nothing at its end, where equations are singular on every mesh: it ends there.
    """

    def __init__(
        self,
        detector: Detector,
        detector_of: Callable[[Problem], Detector],
        vanishes: Callable[[HalfBranch], bool] = lambda half: False,
    ) -> None:
        self.detector_of, self.vanishes = detector_of, vanishes
        self.detectors = [detector]  # in order of the meshes

    def finer(self, detector: Detector) -> Detector:
        """The detector of the next mesh."""
        place = self.detectors.index(detector) + 1
        if place == len(self.detectors):
            self.detectors.append(self.detector_of(_adaptive(detector.engine).refined()))
        return self.detectors[place]

    def followed(
        self,
        start: Start,
        halves: Callable[[Detector, Start, Container[str]], dict[str, HalfBranch]],
        again: Callable[[Detector, Detector, Start], Start | None],
        real: bool,
    ) -> tuple[dict[str, HalfBranch], Detector, Start]:
        """The halves of a branch, by the names of its sides, on one mesh, with the detector and the start of those that were followed last.

        Parameters
        ----------
        start
            To begin with, on the first mesh.
        halves : callable
            Follows the branch with a detector from a start, but for some of its sides.
        again : callable
            A side that cannot be read on the finer mesh of the other one, or comes to a mesh that is too coarse, is followed again: from a
            detector, that of the finer mesh and a start to the start there; None where there is none.
        real : bool
            Whether the branch has positive margins.
        """
        known, detector = dict[str, HalfBranch](), self.detectors[0]
        while True:
            found = {**known, **halves(detector, start, known)}
            coarse = [half.detector for half in found.values() if half.status == Status.COARSE]
            meshes = [half.detector for half in found.values()] + [self.finer(each) for each in coarse]
            wanted = max(meshes, key=self.detectors.index)
            level = {side: self._level(half, wanted, real) for side, half in found.items()}
            known = {side: half for side, half in level.items() if half is not None}
            begin = None if len(known) == len(found) else again(detector, wanted, start)
            if begin is None:
                whole = {side: known.get(side) or self.read(half, wanted) for side, half in found.items()}
                return whole, detector, start
            detector, start = wanted, begin

    def _level(self, half: HalfBranch, wanted: Detector, real: bool) -> HalfBranch | None:
        """A half on a finer mesh; None where it is to be followed on that, or has other special points there."""
        if half.status == Status.COARSE:
            return None
        while half.detector is not wanted:
            onward = self.onward(half, real)
            if onward is None:
                return None
            half = onward[0]
        return half

    def moved(
        self, detector: Detector, wanted: Detector, point: Solved | None, solve: bool = True
    ) -> Solved | None:
        """How a point of a mesh reads on one of the finer ones; None where it cannot be solved there."""
        while point is not None and detector is not wanted:
            before, detector = detector, self.finer(detector)
            point = _read(point, before.engine, detector.engine)
            point = MeshMotion(detector.engine).solved(point) if solve else point
        return point

    def read(self, half: HalfBranch, wanted: Detector) -> HalfBranch:
        """A half on a finer mesh, as it is."""
        while half.detector is not wanted:
            detector, engine, problem = self.finer(half.detector), half.engine, _adaptive(half.engine)
            finer, whole = detector.engine, half.joined()
            directions, slopes = problem.halved(whole.tangents[:, :-1], True), whole.tangents[:, -1]
            tangents = np.array([finer.unit(finer.join(v, float(s))) for v, s in zip(directions, slopes)])
            events = [(i, replace(e, point=_read(e.point, engine, finer))) for i, e in half.events]
            first = None if half.first is None else problem.halved(half.first)
            pieces = [whole._replace(points=problem.halved(whole.points), tangents=tangents)]
            half = HalfBranch(detector, pieces, events, half.status, first)
        return half

    def onward(self, half: HalfBranch, real: bool) -> tuple[HalfBranch, Callable[[Solved], Solved]] | None:
        """A half on the next mesh, and how points of its mesh read there; None where it has other special points there."""
        if _adaptive(half.engine).parts_of_refined != 1:
            return None  # a mesh with other intervals altogether
        coarse, detector = half.detector, self.finer(half.detector)
        found = self.read(half, detector)
        ended = half.status != Status.LEFT_INTERVAL or _at_the_end(found)
        same = ended and _goes_on(found, real) and _located_again(found, real)
        detector.parts = coarse.parts

        def image(point: Solved) -> Solved:
            read = self.moved(coarse, detector, point)
            return read or _read(point, coarse.engine, detector.engine)

        return (found, image) if same else None


def _adaptive(engine: Engine) -> Adaptive:
    assert engine.adaptive is not None
    return engine.adaptive


def _read(point: Solved, engine: Engine, finer: Engine) -> Solved:
    """How a point of a mesh reads on the next one."""
    problem = _adaptive(engine)
    direction = problem.halved(point.tangent[:-1], True)
    tangent = finer.unit(finer.join(direction, float(point.tangent[-1])))
    return point._replace(u=problem.halved(point.u), tangent=tangent)


def _guess(half: HalfBranch, i: int) -> Solved:
    return Solved(*half.at(i), np.zeros(0), 0.0, 0.0, 0.0)


def _goes_on(half: HalfBranch, real: bool) -> bool:
    """Whether the last point lies where it did, on this mesh: not far away, as a cycle that passes a saddle within rounding, and before a border."""
    guess = _guess(half, len(half) - 1)
    last = MeshMotion(half.engine).solved(guess)
    if last is None:
        return True
    near = half.engine.distance(guess, last) <= FAR
    return near and not (real and bool(half.engine.smallest_margin(last.row) < 0.0))


def _at_the_end(half: HalfBranch) -> bool:
    """Solve for the last point, at its end of the interval."""
    finer, last = half.engine, len(half) - 1
    u, p, tangent = half.at(last)
    _adaptive(finer).anchor(u, p)
    found = finer.at_value(u, p, tangent)
    _adaptive(finer).anchor(None)
    if found is not None:
        half.put(last, found)
    return found is not None


def _located_again(half: HalfBranch, real: bool) -> bool:
    """Locate the special points of a half between their neighbours on its mesh; whether they are the same ones."""
    detector, events, half.events = half.detector, half.events, []
    places = sorted({i for i, _ in events})
    breaks = [k + 1 for k, (one, other) in enumerate(pairwise(places)) if other > one + 1]
    for group in np.split(np.array(places, dtype=int), breaks) if places else []:
        low, high = int(group[0]) - 1, int(group[-1]) + 1
        if low < 1 or high >= len(half):
            return False  # an end may be singular itself
        solved = [MeshMotion(half.engine).solved(_guess(half, i)) for i in (low, high)]
        ends = [end for end in solved if end is not None]
        if len(ends) < 2:
            return False
        _adaptive(half.engine).anchor(ends[0].u, ends[0].p)  # as while a chunk is looked at
        chunk = packed(ends, Status.RUNNING)
        found = [e for e in detector.look(chunk, detector.scan(chunk), real) if e.role is not Role.PLAIN]
        _adaptive(half.engine).anchor(None)
        known = [(i, e) for i, e in events if low < i < high]
        if not found:  # what was rounding on the mesh before
            known = [(i, e) for i, e in known if e.role is not Role.UNRESOLVED]
        if [(e.kind, e.role, e.name) for e in found] != [(e.kind, e.role, e.name) for _, e in known]:
            return False
        for (i, event), again in zip(known, found):
            half.put(i, again.point)
            half.events.append((i, replace(again, position=event.position)))
    return True
