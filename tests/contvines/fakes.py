"""Small made-up graphs for tests of store, export, plots and command line."""

import numpy as np

from contvines.branches import Branch, Ending
from contvines.branches.special_point import SpecialPoint
from contvines.graph import Graph, Switch


def pitchfork_graph(finished: bool = True) -> Graph:
    """x' = p x - x^3 as a graph: the trivial branch, and the upper half of the parabola that leaves it at 0."""
    p = np.linspace(-1, 1, 41)
    trivial = _branch("B1", np.zeros((41, 1)), p, (p[:, None]) * np.ones((1, 1)), marks=((20, "BP1"),))
    x = np.linspace(0, 1, 31)[:, None]
    parabola = _branch("B2", x, x[:, 0] ** 2, -2 * x**2, seed="BP1", marks=((0, "BP1"), (30, "EP1")))
    virtual = _branch("B3", x + 1, 1 - 0.5 * x[:, 0] ** 2, -2 * x**2 + 1, real=False, seed="VG1", marks=())
    graph = Graph(
        parameter="p",
        model={"name": "pitchfork"},
        branches={b.label: b for b in (trivial, parabola, virtual)},
        special={
            "BP1": _point("BP1", "branch-point", "B1", 0.0, [0.0], criticality="supercritical", index=20),
            "EP1": _point("EP1", "end", "B2", 1.0, [1.0], index=30),
            "VG1": _point(
                "VG1", "velocity-graze", "B2", 0.64, [0.8], multipliers_beyond=np.array([0.5 + 0.1j])
            ),
        },
        switches=[
            Switch("BP1", "B1", "B2", "branch-point", "mirror image not traced"),
            Switch("VG1", "B2", "B3", "velocity-graze", "persistence"),
        ],
        within=(-1.0, 1.0),
        settings={"depth": 2, "virtual": True},
        finished=finished,
        message="complete" if finished else "running",
    )
    return graph


def _branch(label: str, points: np.ndarray, values: np.ndarray, eigenvalues: np.ndarray, **more) -> Branch:
    tangents = np.gradient(np.column_stack([points, values]), axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    return Branch(
        label=label,
        problem=None,
        points=points,
        values=values,
        tangents=tangents,
        multipliers=eigenvalues.astype(complex),
        margin=np.full(len(values), np.inf),
        stable=eigenvalues[:, 0] <= 0,
        endings=(Ending.from_text("reached the lower end"), Ending.from_text("reached the upper end")),
        description={"name": "pitchfork", "factory": None},
        parameter="p",
        **more,
    )


def _point(label: str, kind: str, branch: str, value: float, u: list[float], **more) -> SpecialPoint:
    return SpecialPoint(
        label=label,
        kind=kind,
        branch=branch,
        value=value,
        parameter="p",
        u=np.array(u),
        tangent=np.array([0.6, 0.8]),
        multipliers=np.array([0.1 + 0.2j]),
        bracket=(value - 0.1, value + 0.1),
        residual=1e-16,
        location_error=2e-13,
        replay=None,
        **more,
    )
