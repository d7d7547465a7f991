"""A chart in a few lines: how many loci and points of each kind, where, and what is stable in the largest regions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ..graph.table import with_unit
from ..shared.number_text import figures_in
from ..text_table import Table, terminal_width
from .table import regions_table, title

if TYPE_CHECKING:
    from .chart import Chart

MOST = 8  # regions


def chart_summary(chart: Chart, width: int | None = None) -> str:
    """Loci and points by kind, then the largest regions.

    Parameters
    ----------
    chart : Chart
    width : int, optional
        Characters to a line; those of the terminal by default.
    """
    width = terminal_width() if width is None else width
    number = [figures_in(within) for within in chart.within]

    def spread(values: list[float], text: Callable[[float], str]) -> str:
        return "..".join(dict.fromkeys((text(min(values)), text(max(values)))))

    loci = [(locus.sort, locus.values) for locus in chart.loci.values()]
    points = [(point.kind, np.array([point.value])) for point in chart.points.values()]
    rows = []
    for each in (loci, points):
        for kind, count in Counter(kind for kind, _ in each).most_common():
            values = np.concatenate([values for own, values in each if own == kind])
            across = (spread([values[:, k].min(), values[:, k].max()], number[k]) for k in (1, 0))
            rows.append((kind, str(count), *across))
    p, q = (with_unit(name, chart.units.get(name)) for name in chart.parameters)
    lines = [title(chart), "", *Table(("loci and points", "number", q, p), rows).lines(width)]
    if chart.regions:
        lines += ["", *regions_table(chart, MOST).lines(width)]
    return "\n".join(lines)
