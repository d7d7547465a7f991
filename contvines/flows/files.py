"""Flows from what files describe."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from ..problems.registry import find_callables
from ..shared.files import module_of, names_of
from .expressions import read_text
from .problem import FlowProblem, NamedOptions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .cycles import CycleProblem
    from .equilibria import Equilibria


_known: dict[str, FlowProblem] = {}  # branches of one graph share their flow


def from_description(description: Mapping[str, Any], trust: bool = False) -> Equilibria | CycleProblem | None:
    """Equilibria or cycles of a flow from what ``describe()`` returned; None where its functions are not at hand."""
    flow = _flow(description, trust)
    return None if flow is None else flow.problem_of(description)


def read_ode(
    path: str | Path, x0: Sequence[float] | np.ndarray | float | None = None, **options: Unpack[NamedOptions]
) -> FlowProblem:
    """A flow from an .ode file of XPP: equations, parameters, functions and fixed quantities. Only arithmetic of the file is evaluated.

    Parameters
    ----------
    path : str or Path
    x0 : array_like, optional
        Instead of the file's initial values.
    **options
        Of :class:`contvines.FlowProblem`; names are in small letters.

    Raises
    ------
    ValueError
        For what cannot be read, or depends on time without ``period=``; the sentence has the line.
    """
    f, states, starts, parameters, timed = read_text(path)
    if timed and options.get("period") is None:
        raise ValueError(f"{timed} depends on the time t; give period=, that of the forcing")
    options.setdefault("name", Path(path).stem)
    options.setdefault("states", states)
    return FlowProblem(f, starts if x0 is None else x0, parameters, **options)


def _names(description: Mapping[str, Any]) -> list[str]:
    values = description["p0"]
    return list(values) if isinstance(values, Mapping) else [str(description["parameter"])]


def _flow(description: Mapping[str, Any], trust: bool) -> FlowProblem | None:
    """The flow, one for all branches of a graph."""
    about = description["flow"]
    key = json.dumps([description["callables"], about, description["name"], sorted(_names(description))])
    if key in _known:
        return _known[key]
    if about.get("file"):
        file, name, digest = about["file"]
        known = [
            flow for flow in _loaded.values() if flow.origin is not None and flow.origin[1:] == (name, digest)
        ]
        if known or not trust:
            return known[0] if known else None
        if not Path(file).is_file():
            raise OSError(
                f"{file}: the file of the flow {name!r} is gone; put it back, or beside the result, or make the result anew"
            )
        flow = load_flow(file, name)
        if flow is None or flow.origin is None or flow.origin[2] != digest:
            raise ValueError(f"the flow {name!r} of {file} is not the one from which the graph was made")
        return flow
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
    flow = _known[key] = FlowProblem(
        functions.pop("F"),
        about["x0"],
        description["p0"],
        parameter=description["parameter"],
        name=description["name"],
        degree=about["degree"],
        error=about["error"],
        settings=about.get("settings"),
        period=period,
        scale=about["scale"],
        states=about.get("states"),
        **functions,
    )
    return flow


_loaded: dict[tuple[str, str], FlowProblem] = {}


def load_flow(path: str | Path, name: str) -> FlowProblem | None:
    """Run a Python file and take the flow that it names; None if that is something else.

    Only for a file that the user has named.

    Raises
    ------
    ValueError
        If the file does not run, or has other flows but nothing of that name.
    """
    module = module_of(path)
    flow = getattr(module, name, None)
    if flow is None and (others := names_of(module, FlowProblem)):
        raise ValueError(f"{path}: it has no flow {name!r}; it has {', '.join(others)}")
    if not isinstance(flow, FlowProblem):
        return None
    file = Path(path).resolve()
    flow.origin = str(file), name, hashlib.blake2b(file.read_bytes(), digest_size=8).hexdigest()
    _loaded[str(file), name] = flow
    return flow
