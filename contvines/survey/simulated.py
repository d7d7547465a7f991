"""Responses by simulation where a graph has no stable branch: dots, and bands of those that do not recur."""

from __future__ import annotations

import numpy as np

from contvines.shared.motions import BAND, modulation_of

from ..coexistence.population import Population
from ..graph.graph import Graph
from ..graph.stretches import SIMULATED, default_measure, gaps, spread
from .completion import FEW, ON_ITS_WAY

VALUES = 5  # in the gaps, at least
Band = tuple[float, float, float, float]


def simulated(graph: Graph, population: Population, starts: int = FEW) -> list[Band]:
    """What starts settle on at some values of every gap between the stable stretches of a graph, at fewer where a motion is integrated.

    Parameters
    ----------
    graph : Graph
    population : Population
    starts : int
        At each value.

    Returns
    -------
    list of (float, float, float, float)
        The value, and the lowest, mean and highest response in a forcing period; all the same of a motion that recurs.
    """
    name, found = default_measure(graph), []
    for p in spread(gaps(graph), graph.within, VALUES, SIMULATED / np.cbrt(population.price)):
        motions, *_ = population.settle(population.starts(starts, 0, p), p)
        for motion in motions:
            if motion.kind in ON_ITS_WAY or motion.state is None:
                continue
            measures = population.observed(motion.state, p)
            high = measures.get(name, np.nan)
            modulated = bool(modulation_of(measures))
            low, mean = (measures[end] if modulated else high for end in BAND[:2])
            if np.isfinite(high):
                found.append((p, low, mean, high))
    return found
