"""contvines: branches of solutions, their bifurcations, and how the branches connect.

>>> import contvines as cv
>>> circle = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1, [1.0], 0.0)
>>> graph = cv.diagram(circle, within=(-2.0, 2.0))
>>> graph["B1"].closed
True
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from contvines.shared.on_demand import on_demand

__version__ = "0.2.0"

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

__getattr__ = on_demand(
    __name__,
    {
        "AlgebraicProblem": "contvines.problems.algebraic",
        "Branch": "contvines.branches",
        "Embedding": "contvines.problems.protocol",
        "FlowProblem": "contvines.flows",
        "Graph": "contvines.graph",
        "Interrupted": "contvines.journal",
        "KINDS": "contvines.bifurcation.kinds",
        "Kernels": "contvines.problems.protocol",
        "Kind": "contvines.bifurcation.kind",
        "MapProblem": "contvines.problems.maps",
        "MemoryJournal": "contvines.journal",
        "NullJournal": "contvines.journal",
        "ProblemDefaults": "contvines.problems.protocol",
        "Seed": "contvines.problems.protocol",
        "Settings": "contvines.continuation.settings",
        "SpecialPoint": "contvines.branches.special_point",
        "StepRule": "contvines.continuation.settings",
        "Switch": "contvines.graph",
        "Symmetry": "contvines.problems.protocol",
        "Attractor": "contvines.graph.contents",
        "atlas": "contvines.coexistence.build",
        "basins": "contvines.coexistence.basins",
        "erosion": "contvines.coexistence.erosion",
        "robustness": "contvines.coexistence.robustness",
        "Chart": "contvines.loci.chart",
        "Locus": "contvines.loci.locus",
        "chart": "contvines.loci.charting",
        "diagram": "contvines.graph.automatic",
        "load": "contvines.store",
        "locus": "contvines.loci.tracing",
        "register": "contvines.problems.registry",
        "resume": "contvines.store",
        "save": "contvines.store",
        "switch": "contvines.graph.automatic",
        "trace": "contvines.continuation.trace",
        "flows": "contvines.flows",  # the sub-package with read_ode and CompiledRates
    },
)


def __dir__() -> list[str]:
    return [*__all__, "flows", "__version__"]


if TYPE_CHECKING:
    from .bifurcation.kind import Kind
    from .bifurcation.kinds import KINDS
    from .branches import Branch
    from .branches.special_point import SpecialPoint
    from .coexistence.basins import basins
    from .coexistence.build import atlas
    from .coexistence.erosion import erosion
    from .coexistence.robustness import robustness
    from .continuation.settings import Settings, StepRule
    from .continuation.trace import trace
    from .flows import FlowProblem
    from .graph import Graph, Switch
    from .graph.automatic import diagram, switch
    from .graph.contents import Attractor as Attractor
    from .journal import Interrupted, MemoryJournal, NullJournal
    from .loci.chart import Chart
    from .loci.charting import chart
    from .loci.locus import Locus
    from .loci.tracing import locus
    from .problems.algebraic import AlgebraicProblem
    from .problems.maps import MapProblem
    from .problems.protocol import Embedding, Kernels, ProblemDefaults, Seed, Symmetry
    from .problems.registry import register
    from .store import load, resume, save
