"""Export of a graph as files of AUTO-07p, b.NAME (branches), s.NAME (labelled solutions) and d.NAME (meaning of the labels), and of XPPAUT.

The formats are those of AUTO-07p's manual (E. J. Doedel and others, section "Output files"), with fixed columns of 19 characters, and
that of the points which XPPAUT's window "AUTO" writes by `Write pts`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..flows.cycle_mesh import CycleMesh
from ..journal import comments
from .frames import measures_of

if TYPE_CHECKING:
    from ..branches import Branch
    from ..branches.special_point import SpecialPoint
    from ..graph import Graph


TYPES = {"fold": 2, "branch-point": 1, "symmetry-breaking": 1, "hopf": 3}
"""AUTO's type numbers of special points of equilibria and of cycles of maps, by kind."""
TYPES_OF_CYCLES = {
    "fold": 5,
    "branch-point": 6,
    "symmetry-breaking": 6,
    "period-doubling": 7,
    "neimark-sacker": 8,
}
"""AUTO's type numbers of special points of cycles, by kind."""
END, USER = 9, -4  # AUTO's type numbers of an end of a branch and of a user-defined point
WIDTH = 19  # characters of a column
PERIOD = 11  # AUTO's index of the period among the parameters
RESERVED = range(10, 15)  # indices of parameters that AUTO reserves for itself


def places(path: Path) -> tuple[Path, Path, Path]:
    """Return the paths of the three files for a path whose name may begin with ``b.`` or end in ``.auto``."""
    name = path.name.removeprefix("b.").removesuffix(".auto")
    branches, solutions, meanings = (path.with_name(f"{letter}.{name}") for letter in "bsd")
    return branches, solutions, meanings


def write_auto(graph: Graph, path: Path) -> Path:
    """Write the three files; return the path of b.NAME."""
    labels = _labels(graph)
    written = _diagram, _solutions, _meanings
    for place, lines in zip(places(path), written, strict=True):
        place.write_text("\n".join(lines(graph, labels)) + "\n", encoding="utf-8")
    return places(path)[0]


def _labels(graph: Graph) -> dict[str, int]:
    """Return AUTO's label number of each special point, in the order of the branches and along them."""
    found: dict[str, int] = {}
    for branch in graph.branches.values():
        for _, label in sorted(branch.marks):
            if label in graph.special and label not in found:
                found[label] = len(found) + 1
    return found


def _of_cycles(branch: Branch) -> bool:
    """Whether the solutions of a branch are motions in time, not equilibria."""
    return "cycle" in branch.description or branch.description.get("word", "equilibrium") != "equilibrium"


def _type(point: SpecialPoint, branch: Branch) -> int:
    kinds = TYPES_OF_CYCLES if _of_cycles(branch) or point.kind not in TYPES else TYPES
    return END if point.kind == "end" else kinds.get(point.kind, USER)


def _parameter_places(branch: Branch) -> dict[str, int]:
    """Return AUTO's indices of the parameters of a branch, that of the continuation parameter first."""
    numbers = {
        name: value
        for name, value in _parameters(branch).items()
        if name != branch.parameter and not math.isnan(value)
    }
    free = (place for place in range(1, 1000) if place not in RESERVED)
    return dict(zip([branch.parameter, *numbers], free, strict=False))


def _parameters(branch: Branch) -> dict[str, float]:
    """Return the numerical parameters in a branch's description, by name."""
    given = branch.description.get("p0") or branch.description.get("model") or {}
    return {
        str(name): float(value)
        for name, value in given.items()
        if isinstance(value, int | float) and not isinstance(value, bool)
    }


# ---------------------------------------------------------------------- b.NAME
def _diagram(graph: Graph, labels: dict[str, int]) -> Iterator[str]:
    low, high = graph.within
    for number, branch in enumerate(graph.branches.values(), 1):
        measures = measures_of(branch)
        cycles = "cycle" in branch.description
        norm = measures.get("norm")
        if norm is None:
            norm = np.linalg.norm(branch.points, axis=1)
        columns = {branch.parameter: branch.values, "L2-NORM": norm, **measures}
        columns.pop("norm", None)
        names = {place: name for name, place in _parameter_places(branch).items()}
        yield f"   0 {low:11.4E} {high:11.4E} {0.0:11.4E} {0.0:11.4E}"
        yield f"   0   NDIM={branch.points.shape[1] if not cycles else _dimension(branch):4d} IPS ={2 if cycles else 1:4d}"
        yield f"   0   parnames={{{', '.join(f'{place}: {name!r}' for place, name in names.items())}}}"
        yield f"   0   User-specified parameter:       {branch.parameter!r}"
        yield f"   0   Active continuation parameter:  {branch.parameter!r}"
        yield "   0"
        yield "   0    PT  TY  LAB " + "".join(
            f"{name.replace('_', ' ')[: WIDTH - 1]:^{WIDTH}}" for name in columns
        )
        marks = {index: label for index, label in branch.marks if label in labels}
        for k in range(len(branch)):
            place = k % 9999 + 1
            stable = branch.stable is not None and bool(branch.stable[k])
            label = marks.get(k)
            kind = 0 if label is None else _type(graph.special[label], branch)
            row = "".join(_number(column[k]) for column in columns.values())
            yield f"{number:4d}{-place if stable else place:6d}{kind:4d}{labels.get(label or '', 0):5d}{row}"


def _dimension(branch: Branch) -> int:
    return len(branch.description["cycle"]["scale"])


def _number(value: float) -> str:
    """Format a number in 19 characters with an exponent of three digits, as Fortran does."""
    if not math.isfinite(value):
        return f"{'NaN' if math.isnan(value) else 'Infinity' if value > 0 else '-Infinity':>{WIDTH}}"
    mantissa, exponent = f"{value:.10E}".split("E")
    return f"{mantissa}E{int(exponent):+04d}".rjust(WIDTH)


# ---------------------------------------------------------------------- s.NAME
def _solutions(graph: Graph, labels: dict[str, int]) -> Iterator[str]:
    numbers = {name: k for k, name in enumerate(graph.branches, 1)}
    for label, number in labels.items():
        point = graph.special[label]
        branch = graph.branches[point.branch]
        if point.problem is None and "cycle" in branch.description:
            continue  # without its problem, the states on AUTO's mesh cannot be evaluated
        index = next((k for k, mark in branch.marks if mark == label), 0)
        named = _parameter_places(branch)
        values = [0.0] * max(named.values())
        parameters = _parameters(branch)
        for name, place in named.items():
            values[place - 1] = point.value if name == branch.parameter else parameters[name]
        cycles = point.problem
        if isinstance(cycles, CycleMesh):
            orbit = point.orbit
            degree, intervals = cycles.rule.degree, cycles.intervals
            times = _equidistant(cycles.parts(point.u, point.value)[2], degree)
            states = orbit(times[:-1] * orbit.period)
            states = np.vstack([states, states[:1]])
            values += [0.0] * (PERIOD - len(values))
            values[PERIOD - 1] = orbit.period
            problem, free = 2, [1, PERIOD]
        else:
            times, states, degree, intervals = np.zeros(1), np.atleast_2d(point.u), 0, 0
            problem, free = 1, [1]
        size = states.shape[1]
        lines = len(times) * (size // 7 + 1) + (len(values) + 6) // 7
        head = (numbers[point.branch], index % 9999 + 1, _type(point, branch), number, len(free), 1)
        yield (
            "".join(f"{value:6d}" for value in head)
            + f"{len(times):8d}{size + 1:6d}{lines:8d}{intervals:5d}{degree:5d}{len(values):5d}"
            + f"{0:5d}{size:5d}{problem:5d}{0:5d}"
        )
        for time, state in zip(times, states, strict=True):
            yield from _rows([time, *state])
        yield from _rows(values)


def _equidistant(widths: np.ndarray, degree: int) -> np.ndarray:
    """Return the edges of mesh intervals and `degree - 1` equidistant points in each, as AUTO's mesh has them, in units of the period."""
    edges = np.append(0.0, np.cumsum(widths)) / np.sum(widths)
    inner = edges[:-1, None] + np.diff(edges)[:, None] * np.arange(degree) / degree
    return np.append(inner.reshape(-1), 1.0)


def _rows(values: Iterable[float]) -> Iterator[str]:
    """Yield lines of seven numbers."""
    texts = [_number(float(value)) for value in values]
    for k in range(0, len(texts), 7):
        yield "    " + "".join(texts[k : k + 7])


# ---------------------------------------------------------------------- d.NAME
def _meanings(graph: Graph, labels: dict[str, int]) -> Iterator[str]:
    yield from (f"# {line}".rstrip() for line in comments(graph))
    yield "# number here, label of contvines, kind, branch here, label of contvines, value"
    numbers = {name: k for k, name in enumerate(graph.branches, 1)}
    for label, number in labels.items():
        point = graph.special[label]
        yield f"{number:6d}  {label:8s} {point.kind:20s} {numbers[point.branch]:6d}  {point.branch:8s} {point.value!r}"
    yield ""
    yield from (f"# {line}" for line in str(graph).splitlines())


def write_xpp(graph: Graph, path: Path) -> None:
    """Write a file of XPPAUT: a row per point with parameter, largest and smallest value, type, number of the branch.

    The value is the first state of a flow, or the first measure of any other motion. Types are those of XPPAUT: 1 and 2 for stable and
    unstable equilibria, 3 and 4 for stable and unstable motions in time.
    """
    rows = []
    for number, branch in enumerate(graph.branches.values(), 1):
        high, low = _extremes(branch)
        cycles = branch.description.get("word", "equilibrium") != "equilibrium"
        stable = np.zeros(len(branch), dtype=bool) if branch.stable is None else np.asarray(branch.stable)
        for k, value in enumerate(branch.values):
            kind = (3 if cycles else 1) + (not stable[k])
            rows.append(f"{value:.15g} {high[k]:.15g} {low[k]:.15g} {kind} {number}")
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


def _extremes(branch: Branch) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest and the smallest value of the exported state or measure at each point, each of shape (n,)."""
    measures = measures_of(branch)
    names = [name.removeprefix("max ") for name in measures if name.startswith("max ")]
    state = next((name for name in names if f"min {name}" in measures), None)
    if state is not None:
        return measures[f"max {state}"], measures[f"min {state}"]
    chosen = next((name for name in measures if name not in ("norm", "period")), None)
    values = measures[chosen] if chosen else np.linalg.norm(branch.points, axis=1)
    return values, values
