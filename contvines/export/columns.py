"""Branches as columns of numbers: the one source of csv files, data frames and data sets."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..graph.table import parameter_head, with_unit

if TYPE_CHECKING:
    from ..branches.branch import Branch
    from ..graph.graph import Graph
    from ..loci.chart import Chart


def graph_columns(graph: Graph) -> dict[str, list[Any]]:
    """A row per point of every branch.

    Returns
    -------
    dict of lists
        branch, index, the parameter, stable, real, margin, special (a label or nothing), unknowns u0 ..., multipliers, word,
        periods, and every measure that a branch has; nan where something is not defined.
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


FACTS = ("branch", "index", "stable", "real", "margin", "special")


def branch_columns(branch: Branch, units: Mapping[str, str]) -> dict[str, list[Any]]:
    """The columns of one branch, a row per point; see :func:`graph_columns`."""
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
    # values on the mesh of a cycle of a flow say nothing in a table
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
    """A row per point of every locus: label, index, kind, word, both parameters, and whether the motion is real."""
    for locus in chart.loci.values():
        word = str(locus.branch.description.get("word") or "")
        for i, ((p, q), real) in enumerate(zip(locus.values.tolist(), locus.real, strict=True)):
            yield locus.label, i, locus.kind, word, p, q, bool(real)


def measures_of(branch: Branch) -> dict[str, np.ndarray]:
    """All measures of a branch that can be evaluated, each of shape (n,)."""
    found = {}
    for name in branch.measure_names:
        try:
            found[name] = np.asarray(branch.measure(name), dtype=float)
        except (KeyError, ValueError):
            continue
    return found


def _unknown(name: str) -> int | None:
    """The number of an unknown, u0, u1 ...; None for any other column."""
    return int(name[1:]) if name.startswith("u") and name[1:].isdigit() else None
