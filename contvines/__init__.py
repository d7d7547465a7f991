"""contvines: branches of solutions, their bifurcations, and how the branches connect.

>>> import contvines as cv
>>> circle = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1, [1.0], 0.0)
>>> graph = cv.diagram(circle, within=(-2.0, 2.0))
>>> graph["B1"].closed
True
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.2.0"

_HOME = {
    "AlgebraicProblem": ".problems.algebraic",
    "Branch": ".branches.branch",
    "Embedding": ".problems.protocol",
    "FlowProblem": ".flows",
    "Graph": ".graph.graph",
    "Interrupted": ".interrupts",
    "KINDS": ".bifurcation.kinds",
    "Kernels": ".problems.kernels",
    "Kind": ".bifurcation.kind",
    "MapProblem": ".problems.maps",
    "MemoryJournal": ".journal",
    "NullJournal": ".journal",
    "ProblemDefaults": ".problems.protocol",
    "Seed": ".problems.protocol",
    "Settings": ".continuation.settings",
    "SpecialPoint": ".branches.special_point",
    "StepRule": ".continuation.step_rule",
    "Switch": ".graph.graph",
    "Symmetry": ".problems.protocol",
    "Attractor": ".graph.attractor",
    "atlas": ".coexistence.build",
    "basins": ".coexistence.basins",
    "erosion": ".coexistence.erosion",
    "robustness": ".coexistence.robustness",
    "Chart": ".loci.chart",
    "Locus": ".loci.locus",
    "chart": ".loci.charting",
    "diagram": ".graph.automatic",
    "load": ".store",
    "locus": ".loci.tracing",
    "register": ".problems.registry",
    "resume": ".store",
    "save": ".store",
    "switch": ".graph.automatic",
    "trace": ".continuation.trace",
}

__all__ = [
    "KINDS",
    "AlgebraicProblem",
    "Branch",
    "Chart",
    "Embedding",
    "FlowProblem",
    "Graph",
    "Interrupted",
    "Kernels",
    "Kind",
    "Locus",
    "MapProblem",
    "MemoryJournal",
    "NullJournal",
    "ProblemDefaults",
    "Seed",
    "Settings",
    "SpecialPoint",
    "StepRule",
    "Switch",
    "Symmetry",
    "atlas",
    "basins",
    "chart",
    "diagram",
    "erosion",
    "load",
    "locus",
    "register",
    "resume",
    "robustness",
    "save",
    "switch",
    "trace",
]


def __getattr__(name: str) -> Any:
    if name in _HOME:
        value = getattr(import_module(_HOME[name], __name__), name)
        globals()[name] = value
        return value
    if name == "flows":  # the sub-package with read_ode and CompiledRates
        return import_module(".flows", __name__)
    from contvines.shared.near_names import did_you_mean

    raise AttributeError(
        f"contvines has no {name!r}{did_you_mean(name, __all__)}; it has {', '.join(__all__)}"
    )


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


if TYPE_CHECKING:
    from .bifurcation.kind import Kind
    from .bifurcation.kinds import KINDS
    from .branches.branch import Branch
    from .branches.special_point import SpecialPoint
    from .continuation.settings import Settings
    from .continuation.step_rule import StepRule
    from .continuation.trace import trace
    from .flows import FlowProblem
    from .graph.automatic import diagram, switch
    from .graph.graph import Graph, Switch
    from .interrupts import Interrupted
    from .journal import MemoryJournal, NullJournal
    from .loci.chart import Chart
    from .loci.charting import chart
    from .loci.locus import Locus
    from .loci.tracing import locus
    from .problems.algebraic import AlgebraicProblem
    from .problems.kernels import Kernels
    from .problems.maps import MapProblem
    from .problems.protocol import Embedding, ProblemDefaults, Seed, Symmetry
    from .problems.registry import register
    from .store import load, resume, save
