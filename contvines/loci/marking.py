"""The points of codimension two on a locus, with labels and coefficients."""

from __future__ import annotations

from ..interrupts import listening
from .codimension_two import find, same_point
from .coefficients_at import coefficients
from .kinds import PREFIXES
from .locus import Locus
from .plane_point import PlanePoint


@listening()
def mark_locus(locus: Locus) -> tuple[tuple[int, PlanePoint], ...]:
    """Find the points of codimension two on a locus that belongs to no chart.

    Parameters
    ----------
    locus : Locus

    Returns
    -------
    tuple of (int, PlanePoint)
        Each point with the index of the locus's point before it. The labels are numbered along the locus, kind by kind.
    """
    marked: list[tuple[int, PlanePoint]] = []
    prefixes = {**PREFIXES, **{kind.name: kind.label for kind in locus.kinds}}
    numbers = dict.fromkeys(prefixes.values(), 0)
    for index, point in find(locus):
        if any(same_point(point, other) for _, other in marked):
            continue
        prefix = prefixes[point.kind]
        numbers[prefix] += 1
        point.label, point.on = f"{prefix}{numbers[prefix]}", [locus.label]
        point.coefficients = point.coefficients or coefficients(point)
        marked.append((index, point))
    return tuple(marked)
