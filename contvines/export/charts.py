"""A chart for other programs: the points of its loci as a table, or all of it as JSON."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..graph.table import with_unit
from ..provenance import carried
from ..shared.csv_files import write_csv
from .columns import chart_rows
from .files import check_target
from .standard_json import json_text

if TYPE_CHECKING:
    from ..loci.chart import Chart

FORMATS = ("csv", "json")


def export_chart(chart: Chart, form: str, path: Path) -> Path:
    """Write a chart.

    Parameters
    ----------
    chart : Chart
    form : {"csv", "json"}
        csv has a row per point of every locus: its label, kind and word, both parameters, and whether the motion is real.
    path : Path

    Raises
    ------
    ValueError
        If there is no such format for charts, or the place will not do.
    """
    if form not in FORMATS:
        raise ValueError(f"--to {form}: a chart is written as {' or '.join(FORMATS)}.")
    check_target(path, form)
    if form == "json":
        path.write_text(json_text({**chart.to_dict(), **carried(chart)}) + "\n", encoding="utf-8")
        return path
    names = [with_unit(name, chart.units.get(name)) for name in chart.parameters]
    rows = (
        (label, kind, word, repr(p), repr(q), int(real))
        for label, _, kind, word, p, q, real in chart_rows(chart)
    )
    write_csv(path, ["locus", "kind", "word", *names, "real"], rows)
    return path
