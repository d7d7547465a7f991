"""What loci ask of problems whose unknowns belong to a mesh, the cycles of flows."""

from __future__ import annotations

from ..flows.cycles import CycleProblem
from ..problems.protocol import Problem


def on_mesh(problem: Problem) -> CycleProblem:
    """The problem, which is one of cycles of a flow.

    Raises
    ------
    TypeError
        If it is none.
    """
    if not isinstance(problem, CycleProblem):
        raise TypeError(f"a {type(problem).__name__} has no mesh")
    return problem
