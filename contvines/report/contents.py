"""What a report shows of a graph, as data for its page: curves, special points, orbits and how to get them again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..bifurcation.kinds import CRITICAL
from ..continuation.settings import Settings
from ..graph.measures import default_measure
from ..graph.proving import mark, proof_text
from ..graph.shortening import motion_name, short_word
from ..plots.style import mark_of
from ..shared.stability import attracts, onto_axis, onto_circle
from .numbers import heading, scene, shortened

if TYPE_CHECKING:
    from ..branches.branch import Branch
    from ..branches.special_point import SpecialPoint
    from ..graph.attractor import Attractor
    from ..graph.graph import Graph

NUMBERS = 420_000  # numbers of all orbits together: what keeps a page below 5 MB
SAMPLES = (48, 160)  # points of an orbit's curves, fewest and most
MEASURES = 14  # at most, to choose the axes from


def contents(graph: Graph, source: str) -> dict[str, Any]:
    """The data of a page.

    Parameters
    ----------
    graph : Graph
        With its problems attached, or branches come without orbits.
    source : str
        Name of the file, as the commands on the page shall write it.

    Returns
    -------
    dict
        Plain numbers, text and lists.
    """
    y = default_measure(graph)
    return {
        **heading(graph, source, _measures(graph, y)),
        "parameter": graph.parameter,
        "within": [float(v) for v in graph.within],
        "axes": {"x": graph.parameter, "y": y},
        "branches": [_branch(graph, branch, y) for branch in graph.branches.values()],
        "special": [_point(graph, point, mark(graph, point.label)) for point in graph.special.values()],
        "switches": [switch.to_dict() for switch in graph.switches],
        "attractors": [_attractor(about) for about in graph.attractors],
        "orbits": _orbits(graph),
    }


def _measures(graph: Graph, y: str) -> list[str]:
    names = [graph.parameter, y]
    for branch in graph.branches.values():
        names += [n for n in branch.measure_names if not n.endswith("_mean")]
    return list(dict.fromkeys(names))[:MEASURES]


def _branch(graph: Graph, branch: Branch, y: str) -> dict[str, Any]:
    measures = {}
    for name in _measures(graph, y):
        try:
            measures[name] = shortened(branch.measure(name))
        except (KeyError, ValueError):
            continue  # a measure that this branch does not have
    about = branch.to_dict()
    word = about["word"]
    return about | {
        "word": None if word is None else str(word),
        "what": "" if word is None else motion_name(branch.description),
        "stable_points": None if branch.stable is None else branch.stable.astype(int).tolist(),
        "measures": measures,
        "marks": [[int(i), label] for i, label in branch.marks],
        "proof": proof_text(graph, branch.label),
        "multipliers": [_pairs(row[:8]) for row in branch.multipliers],
        "margin": shortened(branch.margin),
    }


def _point(graph: Graph, point: SpecialPoint, proof: str) -> dict[str, Any]:
    look = mark_of(point.kind, graph)
    return point.to_dict() | {
        "name": look.name,
        "marker": look.marker,
        "proof": proof,
        "index": int(point.index),
        "marginal": _marginal(point),
    }


def _marginal(point: SpecialPoint) -> bool:
    """Whether the motion is neither stable nor unstable there: a multiplier on the boundary, none beyond it."""
    sizes = point.multipliers
    if point.kind not in CRITICAL or not len(sizes) or not np.isfinite(sizes).all():
        return False
    flow = point.problem is not None and point.problem.spectrum == "flow"
    if flow:
        return attracts(np.real(onto_axis(sizes)), 0.0) is None
    moduli = np.abs(onto_circle(sizes, Settings.critical))
    return attracts(moduli, 1.0) is None


def _attractor(about: Attractor) -> dict[str, Any]:
    name = short_word(about.name)
    return {
        "value": float(about.value),
        "name": name if about.periods <= 1 else f"{name} k={about.periods}",
        "kind": about.kind,
        "branch": about.branch,
        "share": float(about.share),
        "starts": int(about.starts),
    }


def _orbits(graph: Graph) -> dict[str, Any]:
    """Per branch the scenes of its orbits, every `step`-th point; fewer samples where there are many points."""
    kept = [b for b in graph.branches.values() if b.problem is not None and len(b)]
    total = sum(len(b) for b in kept)
    if not total:
        return {}
    fewest, most = SAMPLES
    samples = int(np.clip(NUMBERS / (total * 8), fewest, most))
    step = max(1, int(np.ceil(total * samples * 8 / NUMBERS)))
    found = {}
    for branch in kept:
        marked = {i for i, _ in branch.marks}
        scenes = {}
        for i in range(len(branch)):
            if i % step and i not in marked:
                continue
            shown = scene(branch.orbit(i), samples)
            if shown is None:
                break  # a problem whose solutions have no motion
            scenes[str(i)] = shown
        if scenes:
            found[branch.label] = scenes
    return found


def _pairs(values: np.ndarray) -> list[list[float]]:
    return [[float(f"{v.real:.8g}"), float(f"{v.imag:.8g}")] for v in values if np.isfinite(v)]
