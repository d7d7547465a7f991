"""The real solutions of a branch at a value of its parameter."""

from __future__ import annotations

from ..branches.branch import Branch
from ..continuation.engine import Engine, Solved
from ..continuation.layout import MARGIN
from ..continuation.mesh_motion import MeshMotion
from ..continuation.settings import Settings


def solutions_at(branch: Branch, at: float) -> tuple[Engine, list[Solved]]:
    """All real solutions of a branch at a value, each once, in order along it, and the engine that reads their rows.

    Raises
    ------
    ValueError
        If the branch has no problem.
    """
    if branch.problem is None:
        raise ValueError(f"{branch.label} has no problem; see Graph.attach")
    values = branch.values
    engine = Engine(branch.problem, (float(values.min()), float(values.max())), Settings())
    found: list[Solved] = []
    for i in range(len(values) - 1):
        first, last = values[i], values[i + 1]
        ends_here = last == at and i < len(values) - 2  # the next segment has it
        if first == last or ends_here or (first - at) * (last - at) > 0.0:
            continue
        part = (at - first) / (last - first)
        one, other = branch.points[i], branch.points[i + 1]
        read = MeshMotion(engine).carried(one, other, branch.tangents[i])
        solved = engine.at_value((1.0 - part) * (one if read is None else read) + part * other, at)
        if solved is not None and engine.smallest_margin(solved.row) >= MARGIN:
            found.append(solved)
    return engine, found
