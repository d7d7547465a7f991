"""Responses by simulation where a graph has no stable branch: dots, and bands of those that do not recur."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contvines.shared.modulation import BAND, modulation_of

from ..coexistence.population import Population
from ..graph.graph import Graph
from ..graph.measures import default_measure
from ..graph.stretches import SIMULATED, gaps, spread
from .completion import FEW, ON_ITS_WAY

VALUES = 5  # in the gaps, at least


@dataclass(frozen=True)
class Simulated:
    """A response.

    Attributes
    ----------
    value : float
        Of the parameter.
    low, mean, high : float
        Of its largest value in a forcing period; all the same for one that recurs.
    kind : str
        ``periodic``, ``weak modulation``, ``strong modulation`` (impacts stop and begin again); a chaotic one says so.
    share : float
        Of the starts at this value.
    """

    value: float
    low: float
    mean: float
    high: float
    kind: str
    share: float


def simulated(graph: Graph, population: Population, starts: int = FEW) -> list[Simulated]:
    """What starts settle on at some values of every gap between the stable stretches of a graph, at fewer where a motion is integrated.

    Parameters
    ----------
    graph : Graph
    population : Population
    starts : int
        At each value.
    """
    name, found = default_measure(graph), []
    for p in spread(gaps(graph), graph.within, VALUES, SIMULATED / np.cbrt(population.price)):
        motions, index, _ = population.settle(population.starts(starts, 0, p), p)
        for k, motion in enumerate(motions):
            if motion.kind in ON_ITS_WAY or motion.state is None:
                continue
            measures = population.observed(motion.state, p)
            high = measures.get(name, np.nan)
            kind = modulation_of(measures, motion.kind == "chaotic")
            low, mean = (measures[end] if kind else high for end in BAND[:2])
            if np.isfinite(high):
                found.append(Simulated(p, low, mean, high, kind or "periodic", float(np.mean(index == k))))
    return found
