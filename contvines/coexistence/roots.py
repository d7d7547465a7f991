"""A root of its own on a graph that has others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..graph.builder import begin, trace_pending, work
from ..graph.run import Run

if TYPE_CHECKING:
    from ..problems.protocol import Problem


def add_root(run: Run, problem: Problem, u: np.ndarray, p: float, depth: int = 0) -> None:
    """Trace a solution with all that leaves it; alone where `max_branches` or `max_unknowns`, which limit no roots, is reached.

    Not at all where the budget of an atlas has left branches waiting: these come first when a larger one goes on. Its branch counts as one that `depth` others lie before.

    Raises
    ------
    ValueError
        If it is no start; see :func:`contvines.graph.builder.begin`.
    """
    if run.queue and run.graph.complete:
        return
    begin(run, problem, u, p, depth)
    if run.graph.complete:
        work(run)
    else:
        trace_pending(run, run.queue.pop())
