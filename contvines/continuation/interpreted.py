"""The continuation loop of problems in Python: :mod:`contvines.continuation.loop` and :mod:`contvines.continuation.corrector`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import corrector, loop
from .aims import Aim
from .layout import Found, Metric, Points, Scratch
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
        Bracket of a search; see :mod:`contvines.continuation.bracketing`.
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
        self.kernels, self.frame, self.noise = kernels, (data, work, known, metric, scratch), noise
        self.rule = rule

    def march(self, chunk: Points, first: int, h: float, control: np.ndarray) -> tuple[int, float, int]:
        """See :func:`contvines.continuation.loop.march`."""
        data, work, _, metric, scratch = self.frame
        numbers = control.tolist()  # Python's own numbers are quicker
        with np.errstate(all="ignore"):
            return loop.march(
                self.kernels, self.rule.judge, data, work, chunk, first, h, numbers, metric, scratch
            )

    def points(
        self,
        what: int,
        chord: np.ndarray,
        stretch: tuple[float, float],
        places: np.ndarray,
        border: np.ndarray,
        along: np.ndarray,
        max_sweeps: int,
        found: Found,
        aim: Aim,
    ) -> int:
        """See :func:`contvines.continuation.corrector.points`."""
        with np.errstate(all="ignore"):
            return corrector.points(
                self.kernels,
                self.frame,
                what,
                chord,
                stretch,
                places,
                border,
                along,
                max_sweeps,
                found,
                aim,
                self.noise,
            )
