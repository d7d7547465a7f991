"""Export of a graph or a chart as a file for other programs: csv, json, graphml, mat, latex, auto, xpp."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np

from ..graph.table import with_unit
from ..journal import carried
from ..shared.files import is_database, refuse_ending, refuse_place, write_csv
from ..shared.on_demand import needed
from .auto import places, write_auto, write_xpp
from .frames import chart_rows, graph_columns, measures_of
from .latex import write_latex

if TYPE_CHECKING:
    from ..graph import Graph
    from ..loci.chart import Chart


FORMATS = ("csv", "json", "graphml", "mat", "latex", "auto", "xpp")
ENDINGS = {"latex": "tex", "xpp": "dat"}
"""File name endings of formats whose ending differs from their name."""


def export(graph: Graph, to: str | None, path: str | Path) -> Path:
    """Write a graph in one of `FORMATS`.

    - csv: one row per point of every branch: branch, index, parameter, stable, real, margin, special point, unknowns, multipliers, word,
      periods, and all measures of the graph's branches; undefined cells are empty;
    - json: the output of `contvines show --json`;
    - graphml: branches as nodes, switches as edges;
    - mat: one struct of arrays per branch (with a struct of its measures) and per special point;
    - latex: tables of branches and special points (file.tex);
    - auto: the files b.NAME, s.NAME and d.NAME of AUTO-07p, for NAME.auto or b.NAME;
    - xpp: the points of a diagram of XPPAUT (file.dat).

    Measures need the branches' problems: load the graph with them.

    Parameters
    ----------
    graph : Graph
    to : str or None
        The format; None: the one given by the ending of the file name.
    path : path

    Returns
    -------
    Path
        Of the written file.

    Raises
    ------
    ValueError
        If the format is unknown, or the path cannot be written or is a file of another kind.
    """
    writers = {
        "csv": _csv,
        "json": _json,
        "graphml": _graphml,
        "mat": _mat,
        "latex": write_latex,
        "auto": write_auto,
        "xpp": write_xpp,
    }
    if to is None:
        to = Path(path).suffix.lstrip(".").lower()
        to = next((form for form, ending in ENDINGS.items() if ending == to), to)
        if to not in writers:
            raise ValueError(
                f"{path}: a file for other programs ends in .{', .'.join(ENDINGS.get(form, form) for form in FORMATS)}; or name the format, to='csv'."
            )
    if to not in writers:
        raise ValueError(f"--to {to}: there is no such format; choose one of {', '.join(FORMATS)}.")
    path = Path(path)
    for place in places(path) if to == "auto" else (path,):
        suffix = place.suffix.lstrip(".").lower()
        check_target(place, suffix if to in ("auto", suffix) else ENDINGS.get(to, to))
    try:
        return writers[to](graph, path) or path
    except OSError as error:
        raise ValueError(f"{path}: cannot be written ({error.strerror}).") from None


def check_target(path: Path, ending: str) -> None:
    """Check that a path can be written and that no graph, study or file of another kind would be overwritten.

    Parameters
    ----------
    path : Path
    ending : str
        Of the kind of file to be written, without a dot.

    Raises
    ------
    ValueError
        If not; the message names the file and a valid name, or the package that must be installed.
    """
    refuse_place(path)
    suffix = path.suffix.lower()
    other = path.with_suffix(f".{ending}")
    if suffix in (".vines", ".toml"):
        kind = "graphs" if suffix == ".vines" else "studies"
        raise ValueError(f"{path}: names in {suffix} are kept for {kind}; use -o {other}.")
    if path.is_file() and (suffix != f".{ending}" or is_database(path)):
        raise ValueError(
            f"{path}: this file exists and is no .{ending} file, it is left untouched; use -o {other}."
            if suffix != f".{ending}"
            else f"{path}: this file is a database, it is left untouched; choose another name (option -o)."
        )
    refuse_ending(path, ending)
    if ending == "nc":
        needed("xarray", "tables")


def _csv(graph: Graph, path: Path) -> None:
    columns = graph_columns(graph)
    rows = zip(*columns.values(), strict=True)
    write_csv(path, columns, (map(_written, row) for row in rows))


def _written(value: object) -> object:
    """Return a cell of the CSV: numbers at full precision, an empty text for None and nan, 0 or 1 for booleans."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    if isinstance(value, bool | np.bool_):
        return int(value)
    return repr(float(value)) if isinstance(value, float) else value


def _json(graph: Graph, path: Path) -> None:
    path.write_text(json_text({**graph.to_dict(), **carried(graph)}) + "\n", encoding="utf-8")


def _graphml(graph: Graph, path: Path) -> None:
    """Write GraphML (graphml.graphdrawing.org): a `key` element for each attribute of nodes and edges, then the graph with its data."""
    keys: dict[tuple[str, str, str], ElementTree.Element] = {}

    def describe(element: ElementTree.Element, element_kind: str, data: dict[str, Any]) -> None:
        for name, value in _scalars(data).items():
            kind = next(kind for sort, kind in _GRAPHML_TYPES if isinstance(value, sort))
            attributes = {"id": f"d{len(keys)}", "for": element_kind, "attr.name": name, "attr.type": kind}
            key = keys.setdefault((element_kind, name, kind), ElementTree.Element("key", attributes))
            text = str(value).lower() if kind == "boolean" else str(value)
            ElementTree.SubElement(element, "data", key=key.attrib["id"]).text = text

    body = ElementTree.Element("graph", edgedefault="directed")
    describe(body, "graph", {"parameter": graph.parameter, "finished": graph.finished, **carried(graph)})
    for label, data in graph.nodes():
        describe(ElementTree.SubElement(body, "node", id=label), "node", data)
    for source, target, data in graph.edges():
        edge = ElementTree.SubElement(body, "edge", source=source, target=target, id=data["point"])
        describe(edge, "edge", data)
    root = ElementTree.Element("graphml", xmlns="http://graphml.graphdrawing.org/xmlns")
    root.extend([*keys.values(), body])
    tree = ElementTree.ElementTree(root)
    ElementTree.indent(tree)
    tree.write(path, encoding="utf-8", xml_declaration=True)


_GRAPHML_TYPES = ((bool, "boolean"), (int, "long"), (float, "double"), (str, "string"))


def _scalars(data: dict[str, Any]) -> dict[str, Any]:
    """Convert values to the scalars of GraphML: lists and dicts become JSON text, None is left out."""
    return {
        str(k): v if isinstance(v, bool | int | float | str) else json_text(v, indent=None)
        for k, v in data.items()
        if v is not None
    }


def _mat(graph: Graph, path: Path) -> None:
    """Write a MATLAB file: structs with the arrays, and as further fields the JSON content, of branches, special points and the graph."""
    from scipy.io import savemat

    branches = {
        b.label: {
            **_fields(b.to_dict()),
            "points": b.points,
            "values": b.values,
            "tangents": b.tangents,
            "multipliers": b.multipliers,
            "margin": b.margin,
            "stable": np.zeros(0, dtype=bool) if b.stable is None else b.stable,
            "real": b.real,
            "ended": list(b.ended),
            "word": str(b.description.get("word", "")),
            "periods": float(b.description.get("periods", np.nan)),
            "measures": measures_of(b),
        }
        for b in graph.branches.values()
    }
    special = {
        p.label: {
            **_fields(p.to_dict()),
            "value": float(p.value),
            "u": p.u,
            "tangent": p.tangent,
            "multipliers": p.multipliers,
        }
        for p in graph.special.values()
    }
    everything = {
        "branches": branches,
        "special": special,
        "switches": np.array([_fields(s.to_dict()) for s in graph.switches], dtype=object),
        "model": _fields(graph.model),
        "parameter": graph.parameter,
        "within": np.array(graph.within),
        "finished": graph.finished,
        **_fields(carried(graph)),
    }
    savemat(path, everything, long_field_names=True)


def _fields(data: Mapping[str, Any]) -> dict[str, Any]:
    """Convert a mapping to a MATLAB struct: valid field names, None left out, lists of mappings as cells."""
    return {
        re.sub(r"\W", "_", str(name)): _mat_value(value)
        for name, value in data.items()
        if value is not None and not str(name).startswith("_")
    }


def _mat_value(value: object) -> object:
    if isinstance(value, Mapping):
        return _fields(value)
    if isinstance(value, list | tuple):
        plain = all(isinstance(item, bool | int | float) for item in value)
        return (
            np.array(value, dtype=float)
            if plain
            else np.array([*map(_mat_value, value), None], dtype=object)[:-1]
        )
    return np.nan if value is None else value


CHART_FORMATS = ("csv", "json")


def export_chart(chart: Chart, form: str, path: Path) -> Path:
    """Write a chart as CSV or JSON.

    Parameters
    ----------
    chart : Chart
    form : {"csv", "json"}
        The CSV has a row per point of every locus: label, kind and word of the locus, both parameters, and whether the motion is real.
    path : Path

    Raises
    ------
    ValueError
        If the format is unknown, or the path cannot be written or is a file of another kind.
    """
    if form not in CHART_FORMATS:
        raise ValueError(f"--to {form}: a chart is written as {' or '.join(CHART_FORMATS)}.")
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


def json_text(data: object, *, indent: int | None = 2) -> str:
    """Return standard JSON text at full precision; nan and infinities, which JSON lacks, become null."""
    return json.dumps(_finite(data), indent=indent, allow_nan=False, ensure_ascii=False)


def _finite(data: object) -> object:
    if isinstance(data, dict):
        return {str(k): _finite(v) for k, v in data.items()}
    if isinstance(data, np.ndarray):
        return _finite(data.tolist())
    if isinstance(data, list | tuple):
        return [_finite(v) for v in data]
    if isinstance(data, complex | np.complexfloating):
        return _finite([data.real, data.imag])
    if isinstance(data, np.generic):
        data = data.item()
    return None if isinstance(data, float) and not math.isfinite(data) else data
