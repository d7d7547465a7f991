"""Data for the page of a report on a graph, a chart or a survey: rounded numbers, no infinities, no markup."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bifurcation.kinds import CRITICAL
from ..continuation.settings import Settings
from ..graph.contents import proof_mark, proof_text
from ..graph.stretches import default_measure
from ..graph.table import motion_name, short_word
from ..plots.style import LOCI, axis_label, kind_of_locus, label_of
from ..problems.abilities import Animated
from ..shared.motions import attracts, onto_axis, onto_circle

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..branches import Branch
    from ..branches.special_point import SpecialPoint
    from ..graph import Graph
    from ..graph.contents import Attractor
    from ..loci.chart import Chart
    from ..loci.locus import Locus, PlanePoint
    from ..loci.regions import Region
    from ..survey.results import Survey


NUMBERS = 420_000  # numbers for all orbits together, which keep a page below 5 MB
SAMPLES = (48, 160)  # smallest and largest number of points on an orbit's curves
MEASURES = 14  # largest number of measures offered for the axes
RASTER = 180  # largest number of cells of the picture of regions each way
MOTIONS = 24  # number of motions per locus
DENSE = 90  # points on a motion's curves in charts


def contents(graph: Graph, source: str) -> dict[str, Any]:
    """Return the data for a graph's page.

    Parameters
    ----------
    graph : Graph
        Branches without an attached problem are shown without orbits.
    source : str
        Name of the graph's file in the commands that the page shows.

    Returns
    -------
    dict
        Plain numbers, text and lists.
    """
    y = default_measure(graph)
    return {
        **heading(graph, source, _measures(graph, y)),
        "parameter": graph.parameter,
        "within": list(graph.within),
        "axes": {"x": graph.parameter, "y": y},
        "branches": [_branch(graph, branch, y) for branch in graph.branches.values()],
        "special": [_point(graph, point, proof_mark(graph, point.label)) for point in graph.special.values()],
        "switches": [switch.to_dict() for switch in graph.switches],
        "attractors": [_attractor(attractor) for attractor in graph.attractors],
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
    data = branch.to_dict()
    word = data["word"]
    return data | {
        "word": None if word is None else str(word),
        "what": "" if word is None else motion_name(branch.description),
        "stable_points": None if branch.stable is None else branch.stable.astype(int).tolist(),
        "measures": measures,
        "marks": [[i, label] for i, label in branch.marks],
        "proof": proof_text(graph, branch.label),
        "multipliers": [_pairs(row[:8]) for row in branch.multipliers],
        "margin": shortened(branch.margin),
    }


def _point(graph: Graph, point: SpecialPoint, proof: str) -> dict[str, Any]:
    kind = graph.kind(point.kind)
    return point.to_dict() | {
        "name": kind.text,
        "marker": kind.marker,
        "proof": proof,
        "index": point.index,
        "marginal": _marginal(point),
    }


def _marginal(point: SpecialPoint) -> bool:
    """Whether the motion at a special point is marginal: a multiplier on the stability boundary, none beyond it."""
    sizes = point.multipliers
    if point.kind not in CRITICAL or not len(sizes) or not np.isfinite(sizes).all():
        return False
    flow = point.problem is not None and point.problem.spectrum == "flow"
    if flow:
        return attracts(np.real(onto_axis(sizes)), 0.0) is None
    moduli = np.abs(onto_circle(sizes, Settings.critical))
    return attracts(moduli, 1.0) is None


def _attractor(attractor: Attractor) -> dict[str, Any]:
    name = short_word(attractor.name)
    return {
        **{key: getattr(attractor, key) for key in ("value", "kind", "branch", "share", "starts")},
        "name": name if attractor.periods <= 1 else f"{name} k={attractor.periods}",
    }


def _orbits(graph: Graph) -> dict[str, Any]:
    """Return for each branch the scenes of its orbits; points are skipped and samples reduced to stay below `NUMBERS`."""
    solved = [b for b in graph.branches.values() if b.problem is not None and len(b)]
    total = sum(len(b) for b in solved)
    if not total:
        return {}
    fewest, most = SAMPLES
    samples = int(np.clip(NUMBERS / (total * 8), fewest, most))
    step = max(1, int(np.ceil(total * samples * 8 / NUMBERS)))
    found = {}
    for branch in solved:
        marked = {i for i, _ in branch.marks}
        scenes = _scenes(branch, (i for i in range(len(branch)) if i % step == 0 or i in marked), samples)
        if scenes:
            found[branch.label] = scenes
    return found


def _scenes(curve: Branch | Locus, places: Iterable[int], samples: int) -> dict[str, Any]:
    """Return the scenes at some points of a branch or locus, by index; empty if the solutions are not `Animated`."""
    found = {}
    for i in places:
        drawn = scene(curve.orbit(i), samples)
        if drawn is None:
            break
        found[str(i)] = drawn
    return found


def _pairs(values: np.ndarray) -> list[list[float]]:
    return [[float(f"{v.real:.8g}"), float(f"{v.imag:.8g}")] for v in values if np.isfinite(v)]


def chart_contents(chart: Chart, source: str) -> dict[str, Any]:
    """Return the data for a chart's page.

    Parameters
    ----------
    chart : Chart
        Loci without an attached problem are shown without motions.
    source : str
        Name of the chart's file in the Python lines that the page shows.

    Returns
    -------
    dict
        Plain numbers, text and lists.
    """
    return {
        **heading(chart, source, chart.parameters),
        "parameters": list(chart.parameters),
        "within": [list(interval) for interval in chart.within],
        "loci": [_locus(locus) for locus in chart.loci.values()],
        "points": [_plane_point(point) for point in chart.points.values()],
        "regions": [_region(region, chart.parameters) for region in chart.regions],
        **_raster(chart),
        "orbits": {locus.label: _motions(locus) for locus in chart.loci.values()},
    }


def _locus(locus: Locus) -> dict[str, Any]:
    word = locus.branch.description.get("word")
    return {
        "label": locus.label,
        "name": kind_of_locus(locus).text,
        "marker": kind_of_locus(locus).marker,
        "border": locus.kind not in LOCI,
        "word": None if word is None else short_word(str(word)),
        "p": shortened(locus.values[:, 0], 12),
        "q": shortened(locus.values[:, 1], 12),
        "real": locus.real,
        "ended": list(locus.ended),
        "seed": locus.seed,
    }


def _plane_point(point: PlanePoint) -> dict[str, Any]:
    return point.to_dict() | {
        "name": point.kind.replace("-", " "),
        "multipliers": [],
        "scene": None if point.problem is None else scene(point.orbit, DENSE),
    }


def _region(region: Region, parameters: tuple[str, str]) -> dict[str, Any]:
    name = ", ".join(region.words) or "nothing was simulated here"
    short = "<br>".join(short_word(word, 16) for word in region.words[:4])
    data = region.to_dict(parameters)
    if region.others:
        others = dict.fromkeys(", ".join(words) or "nothing" for _, words in region.others)
        name, short = f"{name}; elsewhere in it {', or '.join(others)}", f"{short}<br>(in part)"
    return {"at": data["at"], "share": data["share"], "name": name, "short": short}


def _raster(chart: Chart) -> dict[str, Any]:
    """Return the region index of each cell of the plane (-1: none), the centre of the first cell, and the size of a cell."""
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
    places = np.linspace(0, len(locus) - 1, min(MOTIONS, len(locus))).round().astype(int)
    return _scenes(locus, np.unique(places).tolist(), DENSE)


def survey_contents(survey: Survey, source: str) -> dict[str, Any]:
    """Return the data for a survey's page.

    Parameters
    ----------
    survey : Survey
    source : str
        Name of the file.

    Returns
    -------
    dict
        Plain numbers, text and lists; machines in the order of the plan.
    """
    from .. import __version__

    systems = list(survey.plan.systems())
    return {
        "version": __version__,
        "source": source,
        "axes": {name: shortened(values, 12) for name, values in survey.plan.axes.items()},
        "samples": list(survey.plan.samples),
        "parameters": {
            name: shortened([system[name] for system in systems], 12) for name in survey.plan.names
        },
        "columns": {name: shortened(np.ravel(values), 12) for name, values in survey.columns.items()},
        "failed": survey.failed,
        "notes": [str(note) for note in survey.notes.ravel()],
        "units": dict(survey.units),
        "names": {
            name: plain_label(label_of(survey, name)) for name in (*survey.plan.names, *survey.columns)
        },
        "about": {str(k): _as_text(v) for k, v in survey.about.items()},
    }


def _as_text(value: object) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{k}: {_as_text(v)}" for k, v in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(_as_text(v) for v in value)
    return str(value)


def shortened(values: ArrayLike, digits: int = 9) -> list[float | None]:
    """Round numbers to `digits` significant digits; None for nan and infinities."""
    return [float(f"{v:.{digits}g}") if np.isfinite(v) else None for v in np.asarray(values, dtype=float)]


def rounded(value: object) -> object:
    """Round the arrays and numbers in nested dicts and lists to five significant digits."""
    if isinstance(value, np.ndarray):
        return shortened(value, 5)
    if isinstance(value, dict):
        return {k: rounded(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(v) for v in value]
    return float(f"{value:.5g}") if isinstance(value, float) else value


def heading(result: Graph | Chart, source: str, names: Iterable[str]) -> dict[str, Any]:
    """Return the data common to pages of graphs and charts: version, model, settings, state, and axis labels for `names`."""
    from .. import __version__

    model = {str(k): v for k, v in result.model.items() if not isinstance(v, dict | list)}
    if "page" in model:  # without its folder
        model["page"] = PurePath(model["page"]).name
    return {
        "version": __version__,
        "source": source,
        "model": model,
        "settings": result.settings,
        "finished": result.finished,
        "message": result.message,
        "names": {
            name: plain_label(axis_label(name, unit=result.units.get(name), notation=result.notation))
            for name in names
        },
    }


def scene(orbit: object, samples: int) -> dict[str, Any] | None:
    """Return the curves of a motion for the page; None if the solution is not `Animated`."""
    if not isinstance(orbit, Animated):
        return None
    return {name: rounded(part) for name, part in orbit.scene(samples).items()}


def plain_label(label: str) -> str:
    """Convert a matplotlib label to plain text, without dollars and commands."""
    for old, new in (
        ("$^{-1}$", "⁻¹"), ("$", ""), (r"\Omega", "Ω"), (r"\mu", "μ"), (r"\tilde g", "g"), (r"\varepsilon", "ε"), (r"\lambda", "λ"),
        ("^{2}", "²"), ("^{-2}", "⁻²"), ("^{3}", "³"), ("^+", "⁺"), ("^-", "⁻"), ("^2", "²"), ("_1", "₁"), ("_-", "₋"), (r"\,", " "),
    ):  # fmt: skip
        label = label.replace(old, new)
    return label
