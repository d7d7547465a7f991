"""Branches as pandas data frames and xarray data sets."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..graph.table import parameter_head
from ..shared.extras import needed
from .columns import branch_columns, chart_rows, graph_columns, measures_of

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

    from ..branches.branch import Branch
    from ..graph.graph import Graph
    from ..loci.chart import Chart


def graph_frame(graph: Graph) -> DataFrame:
    """All points of all branches, indexed by branch and point; the columns of the csv file.

    Raises
    ------
    ValueError
        If pandas is not installed.
    """
    return needed("pandas", "tables").DataFrame(graph_columns(graph)).set_index(["branch", "index"])


def points_frame(graph: Graph) -> DataFrame:
    """The special points, indexed by label: kind, branch, value of the parameter, whether real, criticality, and the branches they lead to.

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
    """All points of all branches as a data set over the dimension ``row``, whose coordinates are branch and index.

    Raises
    ------
    ValueError
        If pandas or xarray is not installed.
    """
    found = _dataset(graph_frame(graph), graph.units)
    found.attrs["parameter"] = graph.parameter
    return found


def chart_frame(chart: Chart) -> DataFrame:
    """All points of all loci, indexed by locus and point: kind, word, both parameters, and whether the motion is real.

    Raises
    ------
    ValueError
        If pandas is not installed.
    """
    names = ["locus", "index", "kind", "word", *chart.parameters, "real"]
    rows = chart_rows(chart)
    return needed("pandas", "tables").DataFrame(rows, columns=names).set_index(["locus", "index"])


def chart_dataset(chart: Chart) -> Dataset:
    """All points of all loci as a data set over the dimension ``row``, whose coordinates are locus and index.

    Raises
    ------
    ValueError
        If pandas or xarray is not installed.
    """
    found = _dataset(chart_frame(chart), chart.units)
    found.attrs["parameters"] = list(chart.parameters)
    return found


def branch_frame(branch: Branch) -> DataFrame:
    """The points of one branch, indexed by their number."""
    units = dict(branch.description.get("units") or {})
    return (
        needed("pandas", "tables")
        .DataFrame(branch_columns(branch, units))
        .set_index("index")
        .drop(columns="branch")
    )


def branch_dataset(branch: Branch) -> Dataset:
    """One branch as a data set: points, multipliers, stability (where it is computed) and measures over the dimension ``point``.

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
    about = {"label": branch.label, "word": str(branch.description.get("word", "")), "real": int(branch.real)}
    special = np.full(len(branch), "", dtype="U16")
    for i, label in branch.marks:
        special[i] = label
    attributes = {"units": units[branch.parameter]} if branch.parameter in units else {}
    coordinates = {
        "point": np.arange(len(branch)),
        branch.parameter: ("point", branch.values, attributes),
        "special": ("point", special),
    }
    return xarray.Dataset(variables, coordinates, about)


def _dataset(frame: DataFrame, units: Mapping[str, str]) -> Dataset:
    """A frame as a data set over the dimension ``row``; what indexed the frame are coordinates."""
    needed("xarray", "tables")
    keys = list(frame.index.names)
    rows = frame.reset_index()
    rows.index.name = "row"
    found = rows.to_xarray().set_coords(keys)
    for name, unit in units.items():
        if name in found:
            found[name].attrs["units"] = unit
    return found
