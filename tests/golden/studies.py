"""The golden studies: what is computed, from starts that are stored so that nothing has to be looked for."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import contvines as cv
import orbits
from contvines.store.differences import of_chart, of_graph
from orbits.machines.page.loading import load_page
from tools.demos import listed, maps
from tools.demos.make_table import graph_of

HERE = Path(__file__).parent
GRAPHS = HERE / "graphs"
PAGES = HERE.parents[1] / "examples" / "machines"


def starts() -> dict[str, Any]:
    """Machines with the nodes of a first orbit and the options of a diagram, by name; see `tools/golden_starts.py`."""
    return json.loads((HERE / "starts.json").read_text())


def first_orbit(start: dict[str, Any]) -> Any:
    """The first orbit of a stored start."""
    if start["machine"].endswith(".py"):
        machine = load_page(PAGES / start["machine"], "machine")
    else:
        machine = getattr(orbits, start["machine"])(**start["given"])
    return machine.orbit(start["word"], start["periods"], start["nodes"], **start["values"])


def diagram(start: dict[str, Any]) -> dict[str, Any]:
    return of_graph(cv.diagram(first_orbit(start), **start["options"]))


def demo(name: str) -> dict[str, Any]:
    entry = next(entry for entry in [*listed.DEMOS, *maps.DEMOS] if entry.name == name)
    return of_graph(graph_of(entry))


def chart(start: dict[str, Any], over: str, within: tuple[float, float], **options: Any) -> dict[str, Any]:
    graph = cv.diagram(first_orbit(start), **start["options"])
    return of_chart(cv.chart(graph, over=over, within=within, regions=False, **options))


def atlas(start: dict[str, Any], **options: Any) -> dict[str, Any]:
    settings = {**start["options"], **options}
    return of_graph(cv.atlas(first_orbit(start).model, **settings))


def henon_chart() -> dict[str, Any]:
    """Fixed points of the map x, y -> y, a - b x - y^2 against both parameters."""
    problem = cv.MapProblem(
        lambda x, p: [x[1], p.a - p.b * x[0] - x[1] ** 2], [0.5, 0.5], {"a": 1.0, "b": 0.5}, parameter="a"
    )
    graph = cv.diagram(problem, over="a", within=(-1.0, 3.0), depth=0)
    return of_chart(cv.chart(graph, over="b", within=(-0.9, 1.3), regions=False, depth=0))


def studies() -> dict[str, Callable[[], dict[str, Any]]]:
    """All golden studies by name: each a function that computes its compact form."""
    stored = starts()
    friction, frequency, stronger = (stored[name] for name in ("friction", "frequency", "coupled, stronger"))
    demos = ("ab", "pp3", "lorenz 84", "enz", "henon", "delayed logistic", "generalized henon", "logistic")
    looks = {"values": [0.3, 0.6, 0.95, 1.1], "starts": 24, "scan": 0, "depth": 2}
    return {
        **{name: partial(diagram, start) for name, start in stored.items()},
        **{f"demo {name}": partial(demo, name) for name in demos},
        "chart friction": partial(chart, friction, "friction", (0.3, 0.7), depth=0),
        "chart frequency": partial(chart, stronger, "forcing", (2.8, 3.4), depth=0),
        "chart henon": henon_chart,
        "atlas friction": partial(atlas, friction, **looks),
        "atlas frequency": partial(atlas, frequency, values=[0.98, 1.0], starts=16, scan=0, depth=1),
    }


def file_of(name: str) -> Path:
    return GRAPHS / f"{name.replace(',', '').replace(' ', '_')}.json"
