"""Graphs and charts as plain numbers and names: all that the golden files hold and that the comparison reads."""

from typing import Any

import numpy as np


def of_graph(graph: Any) -> dict[str, Any]:
    """Branches, special points and links of a graph, from its documented JSON."""
    data = graph.to_dict()
    return {
        "branches": {
            entry["label"]: {
                "word": entry["word"],
                "periods": entry["periods"],
                "symmetric": entry["symmetric"],
                "real": entry["real"],
                "range": entry["range"],
                "stable": entry["stable"],
                "closed": entry["closed"],
            }
            for entry in data["branches"]
        },
        "points": {
            entry["label"]: {
                "kind": entry["kind"],
                "branch": entry["branch"],
                "value": next(iter(entry["value"].values())),
                "error": entry["location_error"],
                "real": entry["real"],
                "criticality": entry["criticality"],
                "multipliers": _moduli(entry["multipliers"]),
            }
            for entry in data["special"]
        },
        "links": sorted([link["point"], link["from"], link["to"]] for link in data["switches"]),
        "attractors": sorted(
            [entry["word"], entry["periods"]] for entry in data.get("attractors", []) if "word" in entry
        ),
    }


def of_chart(chart: Any) -> dict[str, Any]:
    """Loci by kind with their ends, and codimension-two points, of a chart's documented JSON."""
    data = chart.to_dict()
    return {
        "loci": {
            entry["label"]: {
                "kind": entry["kind"],
                "seed": entry["seed"],
                "closed": entry["closed"],
                "ends": [] if entry["closed"] else sorted([entry["values"][0], entry["values"][-1]]),
            }
            for entry in data["loci"]
        },
        "points": {
            entry["label"]: {
                "kind": entry["kind"],
                "value": [float(value) for value in entry["value"].values()],
                "error": entry["error"],
                "real": entry["real"],
                "on": sorted(entry["on"]),
            }
            for entry in data["points"]
        },
    }


def _moduli(pairs: list[list[float]]) -> list[float]:
    return sorted(float(np.hypot(*pair)) for pair in pairs)
