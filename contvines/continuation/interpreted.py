"""The continuation loop of problems in Python: :mod:`contvines.continuation.loop` and :mod:`contvines.continuation.corrector`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import corrector, loop
from .aims import NOTHING, Aim
from .layout import NOWHERE, Control, Found, Metric, Points, Scratch, Way
from .step_rule import StepRule

if TYPE_CHECKING:
    from ..problems.protocol import KernelFunctions


class InterpretedLoop:
    """March and single points of one problem; overflows are nobody's business.

    Parameters
    ----------
    kernels, data, work
        Of the problem.
    metric : Metric
    noise : float
    known : ndarray
        Bracket of a search; see :mod:`contvines.continuation.layout`.
    scratch : Scratch
    rule : StepRule
    """

    def __init__(
        self,
        kernels: KernelFunctions,
        data: object,
        work: object,
        metric: Metric,
        noise: float,
        known: np.ndarray,
        scratch: Scratch,
        rule: StepRule,
    ) -> None:
        self.kernels, self.frame, self.noise = kernels, (data, work, metric, scratch), noise
        self.known, self.rule = known, rule

    def march(self, chunk: Points, first: int, h: float, control: Control) -> tuple[int, float, int]:
        """See :func:`contvines.continuation.loop.march`."""
        with np.errstate(all="ignore"):
            return loop.march(self.kernels, self.rule.factor, self.frame, chunk, first, h, control)

    def points(self, way: Way, places: np.ndarray, found: Found, aim: Aim) -> int:
        """The points at some places, or the one that is aimed at; see :mod:`contvines.continuation.corrector`."""
        with np.errstate(all="ignore"):
            if aim.what != NOTHING:
                return corrector.search(self.kernels, self.frame, way, found, self.known, aim, self.noise)
            for i, s in enumerate(places):
                corrector.point(self.kernels, self.frame, way, s, found, i, self.noise)
        return NOWHERE
