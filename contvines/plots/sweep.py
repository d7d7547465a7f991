"""A brute-force sweep as dots, over the continued branches if there are any."""

from typing import TYPE_CHECKING

import numpy as np

from .diagram import plot_diagram
from .style import axis_label, new_axes, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..graph.graph import Graph


def plot_sweep(
    points: list[tuple[float, float]], parameter: str, graph: "Graph | None" = None, measure: str = "B"
) -> "Figure":
    """Draw the attractors of a sweep.

    Parameters
    ----------
    points : (parameter value, measure), for B as many as there are impacts.
    parameter : name of the parameter.
    graph : branches drawn beneath, with the same measure (B at their first impact).
    measure : name of the measure.
    """
    values = np.array(points, float).reshape(-1, 2)
    with styled():
        figure, axes = new_axes(None)
        axes.plot(
            values[:, 0],
            values[:, 1],
            linestyle="none",
            marker=".",
            markersize=2.4 if measure == "B" else 3.0,
            color="0.45" if measure == "B" else "black",
            label="simulated: B at every impact" if measure == "B" else "simulated",
            zorder=2 if measure == "B" else 3.5,
        )
        if graph is not None:
            plot_diagram(graph, x=parameter, y=measure, axes=axes)
        else:
            axes.legend(loc="best", handlelength=2.6)
        axes.set_xlabel(axis_label(parameter))
        axes.set_ylabel("$B$ at the impacts" if measure == "B" else axis_label(measure))
    return figure
