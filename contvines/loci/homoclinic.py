"""Where homoclinic loci begin: beside Bogdanov-Takens points."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

import numpy as np

from ..branches.special_point import SpecialPoint
from ..continuation.settings import Settings
from ..flows.equilibria import Equilibria
from ..graph.automatic import diagram
from ..graph.cycle_at import cycle_at
from .born import Candidate
from .long_period import lengthened, on_mesh
from .plane_point import PlanePoint
from .starts import begin
from .tracing import trace_locus

if TYPE_CHECKING:
    from ..problems.protocol import Problem


LONGER = 3.0  # times the period with which the branch of cycles ends
PLACES = (
    0.15,
    0.3,
    0.06,
    0.6,
)  # of the interval of the second parameter: how far from a Bogdanov-Takens point a cycle is followed


def homoclinic_of(
    point: PlanePoint, bounds: tuple[float, float], over: str, within: tuple[float, float]
) -> list[Candidate]:
    """A homoclinic orbit beside a Bogdanov-Takens point of a flow.

    The cycles of a Hopf point that lies on the locus through the point are followed until their period is long.
    """
    problem, (p, q) = point.attached, point.value
    if not isinstance(problem, Equilibria):
        return []
    hopf = begin(problem, "hopf", point.u, p, over, 0, bounds)
    locus = trace_locus(hopf, point.u, p, q, within, Settings(), point.label)
    if locus is None:
        return []
    widths = bounds[1] - bounds[0], within[1] - within[0]
    far = np.abs((locus.values - (p, q)) / widths).max(axis=1)
    for place in PLACES:
        i = int(np.argmin(np.abs(far - place)))
        u, value = hopf.split(locus.branch.points[i])
        end = _end_of_cycles(hopf.at(float(locus.branch.values[i])), u, float(value), bounds)
        if end is not None:
            there = float(locus.branch.values[i])
            with contextlib.suppress(ValueError):  # the nearer to the point, the longer is a long period
                end = lengthened(end, LONGER * float(end.u[on_mesh(end.attached).period_place]))
            return [Candidate(end.attached, "homoclinic", end.u, end.value, there, 0, point.label)]
    return []


def _end_of_cycles(
    problem: Problem, u: np.ndarray, p: float, bounds: tuple[float, float]
) -> SpecialPoint | None:
    """The homoclinic orbit with which the cycles of a Hopf point end; None where they do not."""
    nothing = np.zeros(len(u) + 1)
    hopf = SpecialPoint("HB", "hopf", "", p, problem.parameter, u, nothing, np.zeros(0), problem=problem)
    try:
        ends = diagram(cycle_at(hopf), over=problem.parameter, within=bounds, depth=0).of_kind("homoclinic")
    except ValueError:
        return None
    return min(ends, key=lambda end: abs(end.value - p), default=None)
