"""What a report shows of a chart, as data for its page: loci, points, regions, and the motions along the loci."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..graph.shortening import short_word
from ..plots.chart import COLORS
from ..plots.style import mark_of_locus
from .numbers import heading, scene, shortened

if TYPE_CHECKING:
    from ..loci.chart import Chart
    from ..loci.locus import Locus, PlanePoint
    from ..loci.regions import Region

RASTER = 180  # cells of the picture of the regions each way, at most
MOTIONS = 24  # of each locus
SAMPLES = 90  # points of a motion's curves


def chart_contents(chart: Chart, source: str) -> dict[str, Any]:
    """The data of a chart's page.

    Parameters
    ----------
    chart : Chart
        With its problems attached, or loci come without motions.
    source : str
        Name of the file, as the Python lines on the page shall write it.

    Returns
    -------
    dict
        Plain numbers, text and lists.
    """
    return {
        **heading(chart, source, chart.parameters),
        "parameters": list(chart.parameters),
        "within": [list(map(float, interval)) for interval in chart.within],
        "loci": [_locus(locus) for locus in chart.loci.values()],
        "points": [_point(point) for point in chart.points.values()],
        "regions": [_region(region, chart.parameters) for region in chart.regions],
        **_raster(chart),
        "orbits": {locus.label: _motions(locus) for locus in chart.loci.values()},
    }


def _locus(locus: Locus) -> dict[str, Any]:
    word = locus.branch.description.get("word")
    return {
        "label": locus.label,
        "name": mark_of_locus(locus).name,
        "marker": mark_of_locus(locus).marker,
        "border": locus.kind not in COLORS,
        "word": None if word is None else short_word(str(word)),
        "p": shortened(locus.values[:, 0], 12),
        "q": shortened(locus.values[:, 1], 12),
        "real": [bool(v) for v in locus.real],
        "ended": list(locus.ended),
        "seed": locus.seed,
    }


def _point(point: PlanePoint) -> dict[str, Any]:
    told = point.to_dict()
    return told | {
        "name": point.kind.replace("-", " "),
        "coefficients": {k: v if np.isfinite(v) else None for k, v in told["coefficients"].items()},
        "multipliers": [],
        "scene": None if point.problem is None else scene(point.orbit, SAMPLES),
        **{k: told[k] if np.isfinite(told[k]) else None for k in ("error", "residual")},
    }


def _region(region: Region, parameters: tuple[str, str]) -> dict[str, Any]:
    name = ", ".join(region.words) or "nothing was simulated here"
    short = "<br>".join(short_word(word, 16) for word in region.words[:4])
    told = region.to_dict(parameters)
    if region.others:
        apart = dict.fromkeys(", ".join(words) or "nothing" for _, words in region.others)
        name, short = f"{name}; elsewhere in it {', or '.join(apart)}", f"{short}<br>(in part)"
    return {"at": told["at"], "share": told["share"], "name": name, "short": short}


def _raster(chart: Chart) -> dict[str, Any]:
    """Which region each cell of the plane belongs to (-1: none), and where the cells lie."""
    cells = [region.cells for region in chart.regions if region.cells.size]
    if not cells:
        return {"raster": [], "corner": [0, 0], "cell": [1, 1]}
    rows, columns = cells[0].shape
    index = np.full((rows, columns), -1)
    for k, region in enumerate(chart.regions):
        if region.cells.size:
            index[region.cells] = k
    step = max(1, int(np.ceil(max(rows, columns) / RASTER)))
    index = index[step // 2 :: step, step // 2 :: step]
    size = [(high - low) / n for (low, high), n in zip(chart.within, (rows, columns))]
    return {
        "raster": index.tolist(),
        "corner": [float(low + (step // 2 + 0.5) * width) for (low, _), width in zip(chart.within, size)],
        "cell": [float(step * width) for width in size],
    }


def _motions(locus: Locus) -> dict[str, Any]:
    if locus.problem is None or not len(locus):
        return {}
    places = np.unique(np.linspace(0, len(locus) - 1, min(MOTIONS, len(locus))).round().astype(int))
    found = {}
    for i in places:
        shown = scene(locus.orbit(int(i)), SAMPLES)
        if shown is None:
            return {}
        found[str(int(i))] = shown
    return found
