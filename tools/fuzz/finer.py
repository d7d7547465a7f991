"""Compare a diagram with those computed with finer steps and in a wider interval; special points must be the same."""

from __future__ import annotations

from typing import Any

import contvines as cv
from tools.fuzz.drawing import Draw
from tools.fuzz.tally import Tally

SETTINGS = {"max_step": 0.007, "angle": 0.04}
NEAR = 1e-7  # largest difference of values of one special point
RIM = 1e-3  # margin at the ends of the interval in which points may be missing, relative to the interval


def judge(draw: Draw, graph: Any, tally: Tally, limits: dict[str, Any]) -> None:
    """Do both comparisons; incomplete diagrams are not compared."""
    if not graph.finished or not graph.complete:
        return
    low, high = draw.options["within"]
    finer = cv.diagram(draw.orbit, **draw.options, settings={**SETTINGS, **limits})
    if finer.finished and finer.complete:
        tally.count("diagrams with finer steps")
        compare(graph, finer, (low, high), "finer steps", tally)
        compare(finer, graph, (low, high), "usual steps", tally)
    width = high - low
    wide = (max(1e-3, low - 0.13 * width), high + 0.21 * width)
    wider = cv.diagram(draw.orbit, **{**draw.options, "within": wide}, settings=limits)
    if wider.finished and wider.complete:
        tally.count("diagrams in a wider interval")
        compare(graph, wider, (low, high), "a wider interval", tally)


def compare(one: Any, other: Any, within: tuple[float, float], where: str, tally: Tally) -> None:
    """Report special points of one graph that are missing in the other."""
    rim = RIM * (within[1] - within[0])
    theirs = [(p.kind, p.real, p.value) for p in other.special.values()]
    for point in one.special.values():
        if point.kind in ("end", "user") or not within[0] + rim < point.value < within[1] - rim:
            continue
        tally.count("special points compared")
        near = NEAR + 10.0 * point.location_error
        if not any(real == point.real and abs(value - point.value) < near for _, real, value in theirs):
            said = f"{point.label} ({point.kind}, {point.branch} {one[point.branch].description['word']})"
            tally.find("lacks", f"{said} at {point.value:.10g} is not found with {where}")
        elif not any(kind == point.kind and abs(value - point.value) < near for kind, _, value in theirs):
            tally.count("special points with another name")
