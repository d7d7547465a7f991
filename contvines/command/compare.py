"""Lines to compare a response with: the bare oscillator, a tuned absorber of the same mass, a friction damper."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.number_text import figures
from orbits.design.references import NAMES, reference
from orbits.machines.base import Model

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from orbits.machines.varying import Varying

    from ..graph.graph import Graph

LOOKS = {
    "bare": ("0.35", (0, (1, 1.2))),
    "tuned": ("#a6611a", (0, (6, 1.5, 1, 1.5))),
    "friction": ("#7b3294", (0, (3, 1.2))),
}
SHOWN = ("max_abs_q1", "amplitude")
POINTS = 600


def check_compared(kinds: list[str] | None, drawn: bool) -> None:
    """Refuse, before any work, lines that there are not, or that no picture would show.

    Raises
    ------
    ValueError
    """
    if not kinds:
        return
    from orbits.design.references import KINDS

    for kind in kinds:
        if kind not in KINDS:
            raise ValueError(f"--compare {kind}: there is no such response; expected {', '.join(KINDS)}.")
        if not drawn:
            raise ValueError(
                f"--compare {kind}: there is no picture to show it in; give --plot FILE.png, too."
            )


def compared(
    graph: Graph, kinds: list[str] | None, x: str | None = None, y: str | None = None, **options: Any
) -> Figure:
    """The picture of a graph with the lines to compare it with; options as for `contvines.plots.diagram.plot_diagram`."""
    from contvines.plots.diagram import draw_diagram, plot_diagram
    from contvines.plots.figures import new_axes, styled

    if not kinds:
        return plot_diagram(graph, x, y, **options)
    with styled(options.pop("style", None)):
        figure, axes = new_axes(None, figsize=options.pop("figsize", None))
        draw_compared(axes, graph, kinds, x, y)
        limits = options.pop("xlim", None), options.pop("ylim", None)
        draw_diagram(axes, graph, x, y, own=True, limits=limits, **options)
        return figure


def draw_compared(axes: Axes, graph: Graph, kinds: list[str], x: str | None, y: str | None) -> None:
    """Draw the lines on axes on which the graph is drawn next.

    Raises
    ------
    ValueError
        If the graph shows no response of an oscillator over its parameter.
    """
    for kind, (values, response) in _lines(graph, kinds, x, y).items():
        color, dashes = LOOKS[kind]
        axes.plot(
            values, response, color=color, linestyle=dashes, linewidth=1.4, zorder=1.7, label=NAMES[kind]
        )


def _lines(
    graph: Graph, kinds: list[str], x: str | None, y: str | None
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Values of the parameter and responses there, of each kind."""

    from contvines.graph.measures import default_measure
    from orbits.problem import OrbitProblem

    shown, over = y or default_measure(graph), x or graph.parameter
    problem = next((branch.problem for branch in graph.branches.values() if branch.problem is not None), None)
    if (
        not isinstance(problem, OrbitProblem)
        or not isinstance(problem.model, Model)
        or "damping" not in problem.model.parameter_names
        or shown not in SHOWN
        or over != graph.parameter
    ):
        raise ValueError(
            f"--compare {kinds[0]}: this goes with the displacement of an oscillator ({' or '.join(SHOWN)}) over the parameter; "
            f"here {shown} is drawn over {over}."
        )
    model = problem.model
    values = np.linspace(graph.within[0], graph.within[1], POINTS)
    params = np.atleast_2d(problem.values(values))
    return {kind: (values, response_of(kind, model, params)) for kind in kinds}


def response_of(kind: str, model: Model, params: np.ndarray) -> np.ndarray:
    """The response of a kind at some parameters (m, P), in the machine's unit, shape (m,)."""
    return reference(kind, model, params) * model.gauge("length", params)


def peaks_compared(
    model: Varying, over: str, within: tuple[float, float], kinds: Sequence[str]
) -> dict[str, tuple[float, float]]:
    """The largest response of each kind over an interval of a parameter, and where, in the machine's units.

    Raises
    ------
    ValueError
        If the machine is declared: it has no closed forms.
    """

    if not isinstance(model, Model):
        raise ValueError(f"the machine {model.name!r} has no closed forms to compare with")

    def grid(low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
        values = np.linspace(low, high, POINTS)
        return values, np.array([model.vector_at(over, float(value)) for value in values])

    found, whole = {}, grid(*within)
    for kind in kinds:
        values, params = whole
        for narrower in (True, True, False):  # between the neighbours of the largest
            response = response_of(kind, model, params)
            place = int(response.argmax())
            found[kind] = float(response[place]), float(values[place])
            if narrower:
                values, params = grid(values[max(place - 1, 0)], values[min(place + 1, POINTS - 1)])
    return found


def compared_text(model: Varying, over: str, within: tuple[float, float], kinds: Sequence[str]) -> str:
    """The largest responses to compare with, as a sentence."""
    unit, place = model.units.get(SHOWN[0], ""), model.units.get(over, "")
    said = [
        f"{NAMES[kind]} {figures(peak)} {unit} at {over} = {figures(at)} {place}".replace("  ", " ").rstrip()
        for kind, (peak, at) in peaks_compared(model, over, within, kinds).items()
    ]
    return f"to compare with, at most: {'; '.join(said)}"
