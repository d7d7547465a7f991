"""Flows from files: descriptions in saved graphs, .ode files of XPP, Python files of studies, solutions of AUTO-07p."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from ..problems.registry import find_callables
from ..shared.files import module_of, names_of
from .expressions import read_text
from .flow import NamedOptions
from .problem import FlowProblem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .cycles import CycleProblem
    from .equilibria import Equilibria
    from .orbit import CycleOrbit


# flows from descriptions, so that the branches of a graph share one flow
_rebuilt: dict[str, FlowProblem] = {}


def from_description(description: Mapping[str, Any], trust: bool = False) -> Equilibria | CycleProblem | None:
    """Rebuild equilibria or cycles of a flow from the result of ``describe()``; None if its functions cannot be found."""
    flow = _flow(description, trust)
    return None if flow is None else flow.problem_of(description)


def read_ode(
    path: str | Path, x0: Sequence[float] | np.ndarray | float | None = None, **options: Unpack[NamedOptions]
) -> FlowProblem:
    """Read a flow from an .ode file of XPP: equations, parameters, functions and fixed quantities. Only its arithmetic is evaluated.

    Parameters
    ----------
    path : str or Path
    x0 : array_like, optional
        Start; by default the file's initial values.
    **options
        Options of :class:`contvines.FlowProblem`. All names of the file are in lower case.

    Raises
    ------
    ValueError
        If a line cannot be read, or depends on time without ``period=``; the message quotes it.
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
    """The flow of a description; all branches of a graph share one."""
    data = description["flow"]
    key = json.dumps([description["callables"], data, description["name"], sorted(_names(description))])
    if key in _rebuilt:
        return _rebuilt[key]
    if data.get("file"):
        file, name, digest = data["file"]
        loaded = [
            flow for flow in _loaded.values() if flow.origin is not None and flow.origin[1:] == (name, digest)
        ]
        if loaded or not trust:
            return loaded[0] if loaded else None
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
    period = data["period"]
    if isinstance(period, str):
        found = find_callables({"period": period}, trust)
        if found is None:
            return None
        period = found["period"]
    functions.pop("preconditioner", None)
    functions.pop("period", None)
    flow = _rebuilt[key] = FlowProblem(
        functions.pop("F"),
        data["x0"],
        description["p0"],
        parameter=description["parameter"],
        name=description["name"],
        degree=data["degree"],
        error=data["error"],
        settings=data.get("settings"),
        period=period,
        scale=data["scale"],
        states=data.get("states"),
        **functions,
    )
    return flow


_loaded: dict[tuple[str, str], FlowProblem] = {}


def load_flow(path: str | Path, name: str) -> FlowProblem | None:
    """Run a Python file and return its flow of a given name; None if the name is missing or is no flow.

    The file's code is run: call it only for a file that the user has named.

    Raises
    ------
    ValueError
        If the file does not run, or if it has flows but no object of that name.
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


@dataclass(frozen=True)
class FlowFamily:
    """A family of flows for a survey, from a Python file that is run in each worker process.

    Attributes
    ----------
    file, name : str
        The Python file and the name of its flow.
    parameter : str
        Parameter that varies along each diagram.
    values : mapping of str to float
        Parameters that are the same for all systems.
    state : sequence of float, optional
        If given (and always for forced flows), a diagram begins with the cycle on which a motion from this state settles; else with an equilibrium.
    box : sequence of (low, high), optional
        Ranges of the states from which simulations begin.
    """

    file: str
    name: str
    parameter: str
    values: Mapping[str, float]
    state: Sequence[float] | None = None
    box: Sequence[tuple[float, float]] | None = None

    def __call__(self, values: Mapping[str, float], near: object = None) -> CycleOrbit | Equilibria:
        """Return the start of the diagram of the system with these parameter values.

        Raises
        ------
        ValueError
            If no start is found, or the file no longer contains the flow.
        """
        flow = load_flow(self.file, self.name)
        numbers: dict[str, Any] = {**self.values, **values}
        if flow is None:
            raise ValueError(f"{self.file} has no flow {self.name!r} any more")
        flow.box = self.box
        if self.state is not None or flow.field.forced:
            return flow.attractor_at(numbers, self.state)
        return flow.equilibria(self.parameter, numbers)


@dataclass(frozen=True)
class AutoSolution:
    """A labelled solution of AUTO-07p.

    Attributes
    ----------
    branch, point, label : int
    kind : int
        AUTO's type number: 2 and 5 folds, 3 Hopf points, 7 period doublings, 9 ends.
    times : ndarray, shape (n,)
        Times in units of the period; a single 0 for an equilibrium.
    states : ndarray, shape (n, d)
    parameters : ndarray, shape (m,)
        PAR(1), PAR(2), ...
    """

    branch: int
    point: int
    label: int
    kind: int
    times: np.ndarray
    states: np.ndarray
    parameters: np.ndarray

    def __repr__(self) -> str:
        n, d = self.states.shape
        return f"AutoSolution(label {self.label}, branch {self.branch}, type {self.kind}: {d} states at {n} times, {len(self.parameters)} parameters)"

    @property
    def period(self) -> float:
        """PAR(11), the period of a cycle in AUTO.

        Raises
        ------
        ValueError
            If the file has fewer parameters.
        """
        if len(self.parameters) < 11:
            raise ValueError(
                f"the solution with label {self.label} has {len(self.parameters)} parameters, so no period (PAR(11)); take another label"
            )
        return float(self.parameters[10])


def read_auto(path: str | Path) -> list[AutoSolution]:
    """Read the solutions of a file s.NAME of AUTO-07p.

    To continue a cycle, call ``flow.cycle(solution.times * solution.period, solution.states, mu=solution.parameters[0])``.

    Parameters
    ----------
    path : path

    Returns
    -------
    list of AutoSolution

    Raises
    ------
    ValueError
        If the file cannot be read, or is no file s.NAME of AUTO-07p.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
        return list(_solutions(text.splitlines()))
    except OSError as error:
        raise ValueError(f"{path}: cannot be read ({error.strerror})") from None
    except (ValueError, IndexError, UnicodeDecodeError):
        raise ValueError(
            f"{path}: this is no file s.NAME of AUTO-07p (fort.8); give the name of one"
        ) from None


def _solutions(lines: list[str]) -> Iterator[AutoSolution]:
    """Generate the solutions; each begins with a line of whole numbers that gives the number of lines and numbers that follow."""
    k = 0
    while k < len(lines):
        head = [int(word) for word in lines[k].split()]
        branch, point, kind, label, _, _, points, size, rows = head[:9]
        count = head[11]
        numbers = " ".join(lines[k + 1 : k + 1 + rows]).split()
        if k + rows >= len(lines):
            raise ValueError
        k += 1 + rows
        if points == 0:  # the last line of some files only contains the last label
            continue
        values = np.array([_number(word) for word in numbers])
        along = values[: points * size].reshape(points, size)
        parameters = values[len(values) - count :]
        yield AutoSolution(branch, point, label, kind, along[:, 0].copy(), along[:, 1:].copy(), parameters)


def _number(word: str) -> float:
    """Convert a number in Fortran's format: the exponent has the letter D, or no letter if it has three digits."""
    try:
        return float(word.replace("D", "E").replace("d", "e"))
    except ValueError:
        sign = max(word.rfind("+"), word.rfind("-"))
        return float(f"{word[:sign]}E{word[sign:]}")
