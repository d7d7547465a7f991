"""Solutions of a branch at a value of its parameter."""

from __future__ import annotations

from itertools import pairwise

from ..continuation.engine import Engine, Solved
from ..continuation.layout import MARGIN
from ..continuation.settings import Settings
from ..continuation.trace import MeshMotion
from . import Branch


def on_segment(engine: Engine, branch: Branch, i: int, at: float) -> Solved | None:
    """Solve for the solution at parameter value `at`, on or near the segment from point i to the next one; None if there is none."""
    first, last = branch.values[i : i + 2]
    part = 0.5 if first == last else (at - first) / (last - first)
    one, other = branch.points[i : i + 2]
    read = MeshMotion(engine).carried(one, other, branch.tangents[i])
    return engine.at_value((1.0 - part) * (one if read is None else read) + part * other, at)


def solutions_at(branch: Branch, at: float) -> tuple[Engine, list[Solved]]:
    """Solve for all real solutions of a branch at a value of the parameter.

    Parameters
    ----------
    branch : Branch
    at : float

    Returns
    -------
    engine : Engine
        Gives the multipliers and margins of the solutions' rows.
    solutions : list of Solved
        Each once, in order along the branch.

    Raises
    ------
    ValueError
        If the branch has no problem.
    """
    if branch.problem is None:
        raise ValueError(f"{branch.label} has no problem; see Graph.attach")
    values, found = branch.values, []
    engine = Engine(branch.problem, branch.range, Settings())
    for i, (first, last) in enumerate(pairwise(values)):
        ends_here = last == at and i < len(values) - 2  # this point belongs to the next segment
        if first == last or ends_here or (first - at) * (last - at) > 0.0:
            continue
        solved = on_segment(engine, branch, i, at)
        if solved is not None and engine.smallest_margin(solved.row) >= MARGIN:
            found.append(solved)
    return engine, found
