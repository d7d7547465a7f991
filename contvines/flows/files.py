"""Flows from what files describe."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..problems.registry import find_callables
from .cycles import CycleProblem
from .problem import FlowProblem

_known: dict[str, FlowProblem] = {}  # branches of one graph share their flow


def from_description(description: Mapping[str, Any], trust: bool = False) -> Any:
    """Equilibria or cycles of a flow from what ``describe()`` returned; None where its functions are not at hand."""
    about = description["flow"]
    functions = find_callables(description["callables"], trust)
    if functions is None:
        return None
    period = about["period"]
    if isinstance(period, str):
        found = find_callables({"period": period}, trust)
        if found is None:
            return None
        period = found["period"]
    functions.pop("preconditioner", None)
    functions.pop("period", None)
    key = json.dumps([description["callables"], about, description["name"], sorted(_names(description))])
    flow = _known.get(key)
    if flow is None:
        flow = _known[key] = FlowProblem(
            functions.pop("F"),
            about["x0"],
            description["p0"],
            parameter=description["parameter"],
            name=description["name"],
            degree=about["degree"],
            error=about["error"],
            period=period,
            scale=about["scale"],
            **functions,
        )
    values = description["p0"]
    named = dict(values) if isinstance(values, Mapping) else {description["parameter"]: values}
    cycle = description.get("cycle")
    if cycle is None:
        found = flow.equilibria(description["parameter"], named)
        found.u0 = np.array(description["u0"], dtype=float)
        return found
    flow.sizes = np.array(cycle["scale"], dtype=float), float(cycle["clock"])
    values = flow.values.against(description["parameter"], named)
    return CycleProblem(
        flow,
        flow.field.against(values),
        np.array(cycle["u0"], dtype=float),
        cycle["intervals"],
        cycle["rounds"],
        cycle["copies"],
        *flow.sizes,
        cycle["unit"],
    )


def _names(description: Mapping[str, Any]) -> list[str]:
    values = description["p0"]
    return list(values) if isinstance(values, Mapping) else [str(description["parameter"])]
