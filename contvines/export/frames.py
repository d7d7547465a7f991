"""Branches and loci as columns of numbers (which CSV files contain, too), pandas data frames and xarray data sets."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..graph.table import parameter_head, with_unit
from ..shared.on_demand import needed

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

    from ..branches import Branch
    from ..graph import Graph
    from ..loci.chart import Chart


def graph_frame(graph: Graph) -> DataFrame:
    """Return all points of all branches as a data frame indexed by branch and point, with the columns of `graph_columns`.

    Raises
    ------
    ValueError
        If pandas is not installed.
    """
    return needed("pandas", "tables").DataFrame(graph_columns(graph)).set_index(["branch", "index"])


def points_frame(graph: Graph) -> DataFrame:
    """Return the special points as a data frame indexed by label: kind, branch, parameter value, real, criticality, branches that leave them.

    Raises
    ------
    ValueError
        If pandas is not installed.
    """
    head = parameter_head(graph)
    rows = [
        {
            "label": point.label,
            "kind": point.kind,
            "branch": point.branch,
            head: float(point.value),
            "real": bool(point.real),
            "criticality": point.criticality or "",
            "leads_to": ", ".join(s.target for s in graph.switches if s.point == point.label),
        }
        for point in graph.special.values()
    ]
    names = ["label", "kind", "branch", head, "real", "criticality", "leads_to"]
    return needed("pandas", "tables").DataFrame(rows, columns=names).set_index("label")


def graph_dataset(graph: Graph) -> Dataset:
    """Return all points of all branches as a data set over the dimension ``row``, with branch and index as coordinates.

    Raises
    ------
    ValueError
        If pandas or xarray is not installed.
    """
    found = _dataset(graph_frame(graph), graph.units)
    found.attrs["parameter"] = graph.parameter
    return found


def chart_frame(chart: Chart) -> DataFrame:
    """Return all points of all loci as a data frame indexed by locus and point: kind, word, both parameters, and whether the motion is real.

    Raises
    ------
    ValueError
        If pandas is not installed.
    """
    names = ["locus", "index", "kind", "word", *chart.parameters, "real"]
    rows = chart_rows(chart)
    return needed("pandas", "tables").DataFrame(rows, columns=names).set_index(["locus", "index"])


def chart_dataset(chart: Chart) -> Dataset:
    """Return all points of all loci as a data set over the dimension ``row``, with locus and index as coordinates.

    Raises
    ------
    ValueError
        If pandas or xarray is not installed.
    """
    found = _dataset(chart_frame(chart), chart.units)
    found.attrs["parameters"] = list(chart.parameters)
    return found


def branch_frame(branch: Branch) -> DataFrame:
    """Return the points of one branch as a data frame indexed by their number.

    Raises
    ------
    ValueError
        If pandas is not installed.
    """
    units = dict(branch.description.get("units") or {})
    return (
        needed("pandas", "tables")
        .DataFrame(branch_columns(branch, units))
        .set_index("index")
        .drop(columns="branch")
    )


def branch_dataset(branch: Branch) -> Dataset:
    """Return one branch as a data set over the dimension ``point``: unknowns, multipliers, stability (if computed) and measures.

    Raises
    ------
    ValueError
        If xarray is not installed.
    """
    xarray = needed("xarray", "tables")
    units = dict(branch.description.get("units") or {})
    variables: dict[str, Any] = {
        "unknowns": (("point", "unknown"), branch.points),
        "multipliers": (("point", "multiplier"), branch.multipliers),
        "margin": ("point", branch.margin),
    }
    if branch.stable is not None:
        variables["stable"] = ("point", branch.stable)
    for name, values in measures_of(branch).items():
        if name not in variables and name != branch.parameter:
            variables[name] = ("point", values, {"units": units[name]} if name in units else {})
    attrs = {"label": branch.label, "word": str(branch.description.get("word", "")), "real": int(branch.real)}
    special = np.full(len(branch), "", dtype="U16")
    for i, label in branch.marks:
        special[i] = label
    attributes = {"units": units[branch.parameter]} if branch.parameter in units else {}
    coordinates = {
        "point": np.arange(len(branch)),
        branch.parameter: ("point", branch.values, attributes),
        "special": ("point", special),
    }
    return xarray.Dataset(variables, coordinates, attrs)


def _dataset(frame: DataFrame, units: Mapping[str, str]) -> Dataset:
    """Convert a data frame to a data set over the dimension ``row``; the frame's index becomes coordinates."""
    needed("xarray", "tables")
    keys = list(frame.index.names)
    rows = frame.reset_index()
    rows.index.name = "row"
    found = rows.to_xarray().set_coords(keys)
    for name, unit in units.items():
        if name in found:
            found[name].attrs["units"] = unit
    return found


def graph_columns(graph: Graph) -> dict[str, list[Any]]:
    """Return the columns of a table with a row per point of every branch.

    Returns
    -------
    dict of lists
        branch, index, the parameter, stable, real, margin, special (a label or an empty text), unknowns u0 ..., multipliers, word,
        periods, and all measures of the branches; undefined cells are nan.
    """
    branches = list(graph.branches.values())
    parts = [branch_columns(branch, graph.units) for branch in branches]
    heads: list[dict[str, None]] = [{}, {}, {}, {}]  # facts, unknowns, multipliers, word and measures
    for columns in parts:
        for name in columns:
            group = 1 if _unknown(name) is not None else 2 if name.startswith("multiplier") else 3
            heads[group if name not in FACTS and name != parameter_head(graph) else 0].setdefault(name, None)
    order = [*heads[0], *sorted(heads[1], key=lambda name: int(name[1:])), *heads[2], *heads[3]]
    result: dict[str, list[Any]] = {name: [] for name in order}
    for branch, columns in zip(branches, parts, strict=True):
        nothing = [float("nan")] * len(branch)
        for name in order:
            result[name] += columns.get(name, nothing)
    return result


FACTS = ("branch", "index", "stable", "real", "margin", "special")  # the first columns, besides the parameter


def branch_columns(branch: Branch, units: Mapping[str, str]) -> dict[str, list[Any]]:
    """Return the columns of one branch; see :func:`graph_columns`."""
    marks = dict(branch.marks)
    n, undefined = len(branch), float("nan")
    columns: dict[str, list[Any]] = {
        "branch": [branch.label] * n,
        "index": list(range(n)),
        with_unit(branch.parameter, units.get(branch.parameter)): branch.values.tolist(),
        "stable": [undefined] * n if branch.stable is None else branch.stable.tolist(),
        "real": [bool(branch.real)] * n,
        "margin": branch.margin.tolist(),
        "special": [marks.get(i, "") for i in range(n)],
    }
    # the unknowns of a cycle of a flow are values on its mesh: too many for a table
    meshed = isinstance(branch.description.get("cycle"), Mapping)
    for j in range(0 if meshed else branch.points.shape[1]):
        columns[f"u{j}"] = branch.points[:, j].tolist()
    for j in range(branch.multipliers.shape[1]):
        columns[f"multiplier{j}_re"] = np.real(branch.multipliers[:, j]).tolist()
        columns[f"multiplier{j}_im"] = np.imag(branch.multipliers[:, j]).tolist()
    columns["word"] = [branch.description.get("word", "")] * n
    columns["periods"] = [branch.description.get("periods", "")] * n
    for name, values in measures_of(branch).items():
        columns.setdefault(with_unit(name, units.get(name)), values.tolist())
    return columns


def chart_rows(chart: Chart) -> Iterator[tuple[str, int, str, str, float, float, bool]]:
    """Yield a row per point of every locus: label, index, kind, word, both parameters, and whether the motion is real."""
    for locus in chart.loci.values():
        word = str(locus.branch.description.get("word") or "")
        for i, ((p, q), real) in enumerate(zip(locus.values.tolist(), locus.real, strict=True)):
            yield locus.label, i, locus.kind, word, p, q, bool(real)


def measures_of(branch: Branch) -> dict[str, np.ndarray]:
    """Return all measures of a branch that can be evaluated, each of shape (n,), by name."""
    found = {}
    for name in branch.measure_names:
        try:
            found[name] = np.asarray(branch.measure(name), dtype=float)
        except (KeyError, ValueError):
            continue
    return found


def _unknown(name: str) -> int | None:
    """Return the number of an unknown from its column's name, u0, u1 ...; None for any other column."""
    return int(name[1:]) if name.startswith("u") and name[1:].isdigit() else None
