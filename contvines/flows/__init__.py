"""Smooth flows: differential equations, their equilibria, their cycles by orthogonal collocation, and bifurcations of cycles."""

from __future__ import annotations

from .at_points import CompiledRates
from .files import AutoSolution, read_auto, read_ode
from .problem import FlowProblem
from .settings import FlowSettings

__all__ = ["AutoSolution", "CompiledRates", "FlowProblem", "FlowSettings", "read_auto", "read_ode"]


def __dir__() -> list[str]:
    return __all__
