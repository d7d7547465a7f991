"""Segment: the piece of a branch between two neighbouring points, parametrised so that any point of it can be solved."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from ..continuation.engine import Engine, Hit, Solved
from ..continuation.layout import Aim, Found, solved_point, solved_points
from ..continuation.mesh_motion import MeshMotion
from .multiplier_counts import counts

FAR = 3.0  # decades between a multiplier and the circle


class Segment:
    """Points between a and b: s in [0, 1] measures along the chord.

    Parameters
    ----------
    engine : Engine
    a, b : Solved
        Their tangents make an angle of less than a right angle with the chord.
    turns : bool
        A fold has been found on a segment of which this is a part: signs of the parameter's part of the tangent tell folds, however small it is, so
        that as many are found on all parts together.
    """

    def __init__(self, engine: Engine, a: Solved, b: Solved, turns: bool = False) -> None:
        self.engine, self.a, self.b, self.turns = engine, a, b, turns
        self.chord = np.empty((4, engine.n + 1))
        self.za, self.zb = self.chord[0], self.chord[2]
        self.za[:-1], self.za[-1], self.zb[:-1], self.zb[-1] = a.u, a.p, b.u, b.p
        begin, end = a.tangent, b.tangent
        read = MeshMotion(engine).carried(a.u, b.u, begin)
        if read is not None:
            self.za[:-1] = read
        chord = self.zb - self.za
        self.length = engine.norm(chord)
        self.direction = chord / self.length if self.length > 0.0 else a.tangent
        if read is not None:
            begin = end = self.direction  # tangents tell how meshes move that are not one
        turn = begin - end
        self.border = engine.weights * self.direction
        self.arc = self.length * (1.0 + engine.inner(turn, turn) / 24.0)
        np.multiply(self.arc, begin, out=self.chord[1])
        np.multiply(self.arc, end, out=self.chord[3])
        self.start = float(self.border.dot(self.za))

    @cached_property
    def counts(self) -> tuple[list[int], list[int]]:
        """Multipliers past the circle at both ends: real ones past 1, past -1, and complex pairs."""
        engine = self.engine
        before, after = counts(engine, np.array([self.a.row, self.b.row])).tolist()
        return (before, before) if engine.adaptive and self._far_from_circle() else (before, after)

    def _far_from_circle(self) -> bool:
        """Whether as many multipliers are outside the circle at both ends, and all of them so far from it that none has passed it: beside a
        homoclinic orbit they turn round zero."""
        sizes = np.abs(self.engine.spectrum(np.array([self.a.row, self.b.row])))
        with np.errstate(all="ignore"):
            logs = np.abs(np.log10(sizes))
        outside = (sizes > 1.0).sum(axis=1)
        return bool((logs > FAR).all() and outside[0] == outside[1])

    def through_infinity(self) -> bool:
        """Whether the outermost multipliers of both ends are real, of opposite signs, and so large that one has come back from infinity."""
        spectra = self.engine.spectrum(np.array([self.a.row, self.b.row]))
        one, other = spectra[(0, 1), np.abs(spectra).argmax(axis=1)]
        far = min(abs(one), abs(other)) > 10.0**FAR and one.imag == other.imag == 0.0
        return bool(far and one.real * other.real < 0.0)

    def at(self, s: float) -> Solved | None:
        """The point of the branch at s, to roundoff; None if it cannot be solved or belongs to another branch."""
        return solved_point(self.found((s,)), 0)

    def several(self, places: Sequence[float] | np.ndarray) -> list[Solved | None]:
        """The points of the branch at some places, each as by `at`."""
        return solved_points(self.found(places))

    def rows(self, places: Sequence[float] | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rows of multipliers and margins at some places, (k, columns), and which of them are of points of the branch, (k,)."""
        found = self.found(places)
        return found.rows, found.numbers[:, 1] >= 0.0

    def found(self, places: Sequence[float] | np.ndarray) -> Found:
        """All that is found at some places, as arrays."""
        return self.engine.on_chord(
            self.chord, np.array(places, dtype=float), self.start, self.length, self.border, self.direction
        )

    def search(self, aim: Aim, tolerance: float, jump: float) -> Hit | None:
        """Where a number passes zero; see :meth:`contvines.continuation.engine.Engine.search`."""
        return self.engine.search(
            self.chord, self.start, self.length, self.border, self.direction, aim, tolerance, jump
        )
