"""A brief look after a diagram: does simulation find what its graph does not have?"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..continuation.settings import Settings
from ..graph.builder import adopt
from ..graph.contents import Attractor
from ..graph.graph import Graph
from ..graph.run import Run
from ..graph.table import short_word
from ..journal import NullJournal
from .census import census, locate
from .places import UNBRANCHED
from .population import Population


def look(graph: Graph, population: Population) -> list[Attractor]:
    """Attractors that a few simulated starts reach and that lie on no branch of the graph; kept as ``graph.missing``.

    Parameters
    ----------
    graph : Graph
        With its problems.
    population : Population
    """
    low, high = graph.within
    run = Run(graph, Settings.kept(graph.settings), NullJournal(), 0, True, None, None)
    adopt(run)
    found: list[Attractor] = []
    values, starts = population.brief
    for t in (np.arange(values) + 0.5) / values:
        for counted in census(population, float(low + (high - low) * t), starts, 0, run.journal):
            about = counted.attractor
            if about.kind in ("slow", "escaped", "stopped") or locate(run, counted) is not None:
                continue
            found.append(about)
    graph.missing, graph.looked = found, True
    return found


def missing_text(graph: Graph, study: str) -> str:
    """What the look has found, in one line with the command that adds it; empty if nothing.

    No branch holds motions that do not repeat.
    """
    if not graph.missing:
        return ""
    best: dict[tuple[str, int, str], Any] = {}
    for about in graph.missing:
        key = (about.word, about.periods, about.kind)
        if key not in best or about.share > best[key].share:
            best[key] = about
    names = []
    for about in sorted(best.values(), key=lambda a: -a.share)[:3]:
        word = short_word(about.name)
        names.append(f"{word} ({about.share:.0%} of starts at {graph.parameter} = {about.value:.6g})")
    more = f" and {len(best) - 3} more" if len(best) > 3 else ""
    found = f"simulation also finds {', '.join(names)}{more}, "
    if all(about.kind in UNBRANCHED for about in best.values()):
        return f"{found}which no branch can hold"
    return (
        f"{found}not on any branch; run contvines atlas {study} to add {'it' if len(best) == 1 else 'them'}"
    )
