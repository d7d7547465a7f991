"""Branches of solutions of F(u, p) = 0, their bifurcations, and how they connect.

Everything public is imported on first use, so that ``import contvines`` costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING

__version__ = "0.1.0"

_HOMES = {
    "Branch": "contvines.branch",
    "SpecialPoint": "contvines.special",
    "Graph": "contvines.graph.graph",
    "Switch": "contvines.graph.graph",
    "load": "contvines.store",
    "AlgebraicProblem": "contvines.problem",
    "MapProblem": "contvines.problem",
    "diagram": "contvines.graph.diagram",
    "trace": "contvines.continuation.trace",
}

__all__ = ["__version__", *sorted(_HOMES)]

if TYPE_CHECKING:
    from contvines.branch import Branch
    from contvines.graph.graph import Graph, Switch
    from contvines.special import SpecialPoint


def __getattr__(name: str):
    if name not in _HOMES:
        raise AttributeError(f"module 'contvines' has no attribute {name!r}")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))
