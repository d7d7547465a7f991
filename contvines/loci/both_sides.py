"""BothSides: a locus that is followed both ways from its first point, on meshes that suit both."""

from __future__ import annotations

from collections.abc import Callable, Container
from typing import TYPE_CHECKING

import numpy as np

from ..bifurcation.detect import Detector
from ..branches.finer_mesh import Meshes
from ..branches.half_branch import HalfBranch
from ..branches.tracing import trace_half
from ..continuation.engine import Engine, Solved
from ..continuation.layout import Status
from ..continuation.settings import Settings
from ..problems.protocol import Problem
from .ends import becoming, border_of, locus_of

if TYPE_CHECKING:
    from ..journal import Journal

MOST = 20  # borders that are passed on one side


class BothSides:
    """The sides of a locus, "ahead" and "back"; of a closed one "ahead" alone.

    Parameters
    ----------
    engine : Engine
        Of the locus, on the mesh on which it begins.
    within : (float, float)
        Interval of the second parameter.
    settings : Settings
    name : str
        Under which chunks are recorded.
    journal : Journal
    notice : callable
        See :func:`contvines.branches.tracing.trace_half`.
    real : bool
        Whether the motion exists at the first point.
    virtual : bool
        Go on where the motion ceases to exist.

    Attributes
    ----------
    real : dict of ndarray of bool
        Of each side, at which of its points the motion exists.
    """

    def __init__(
        self,
        engine: Engine,
        within: tuple[float, float],
        settings: Settings,
        name: str,
        journal: Journal,
        notice: Callable[[int, float], None],
        real: bool,
        virtual: bool,
    ) -> None:
        self.engine, self.within, self.settings = engine, within, settings
        self.name, self.journal, self.notice = name, journal, notice
        self.begins_real, self.virtual = real, virtual
        self.meshes = Meshes(self._engine_of, engine, Detector(engine), self._vanishes)
        self.real: dict[str, np.ndarray] = {}

    def followed(self, start: Solved) -> dict[str, HalfBranch]:
        """Both sides on one mesh, from a point in the direction of its tangent and backwards."""
        return self.meshes.followed(self.engine, start, self._halves, self.meshes.moved, self.begins_real)[0]

    def _engine_of(self, problem: Problem) -> tuple[Engine, Detector]:
        engine = Engine(problem, self.within, self.settings)
        return engine, Detector(engine)

    def _vanishes(self, half: HalfBranch) -> bool:
        return becoming(half, self.within)[1] is not None

    def _halves(self, engine: Engine, start: Solved, known: Container[str]) -> dict[str, HalfBranch]:
        turned = start._replace(tangent=-start.tangent, sign=-start.sign)
        found: dict[str, HalfBranch] = {}
        for side, first in (("ahead", start), ("back", turned)):
            if side not in known:
                found[side] = self._side(engine, first, side)
                if found[side].status == Status.CLOSED:
                    break
        return found

    def _side(self, engine: Engine, first: Solved, side: str) -> HalfBranch:
        mesh = list(self.meshes.detectors).index(engine)
        name = f"{self.name}/finer {mesh}/{side}" if mesh else f"{self.name}/{side}"
        now, half, self.real[side] = self.begins_real, None, np.zeros(0, dtype=bool)
        for part in range(MOST):
            detector, key = self.meshes.detectors[engine], f"{name}/{part}"
            more = trace_half(
                engine, first, detector, self.journal, key, now, notice=self.notice, meshes=self.meshes
            )
            new = len(more) - (0 if half is None else 1)
            self.real[side] = np.append(self.real[side], np.full(new, now))
            half = more if half is None else self.meshes.read(half, more.engine).extended(more, skip=1)
            border = border_of(more)
            if border is None or not self.virtual:
                break
            if locus_of(more).margin_kind(border.index) in ("end", "resonance"):
                break
            engine, now, first = more.engine, not now, border.point
        assert half is not None
        return half
