"""The bifurcation diagram: branches as curves, special points as labelled marks."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .labels import merge_labels, place_labels
from .style import LINES, MARKS, PLAIN, STATES, axis_label, freeze, new_axes, settle, styled
from .wraps import angles_of, broken

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..graph.graph import Graph


def plot_diagram(
    graph: "Graph",
    x: str | None = None,
    y: str | None = None,
    *,
    axes: "Axes | None" = None,
    labels: bool = True,
    ends: bool = False,
) -> "Figure":
    """Draw a graph: solid stable, dashed unstable, dotted virtual, special points marked and labelled.

    Parameters
    ----------
    graph : Graph
    x, y : names of measures; the continuation parameter, and the problem's `default_measure` or first measure, by default.
    axes : drawn on; a new figure without.
    labels : write the labels of branches and special points.
    ends : mark the ends of the interval, too.

    Raises
    ------
    ValueError
        If the problem has no such measure.
    """
    x = x or graph.parameter
    y = y or default_measure(graph)
    own = axes is None
    with styled():
        figure, axes = new_axes(axes)
        obstacles, used, states = [], {}, {}
        cycle = [c["color"] for c in _cycle()]
        tint: dict[str, str] = {}
        for i, branch in enumerate(graph.branches.values()):
            color = tint[branch.label] = cycle[i % len(cycle)]
            xs, ys = measured(branch, x), measured(branch, y)
            turning = (x in angles_of(branch), y in angles_of(branch))
            for first, last, stable in branch.pieces():
                state = ("stable" if stable else "unstable") if branch.real else "virtual"
                states.setdefault(state, None)
                axes.plot(
                    *broken(xs[first : last + 1], ys[first : last + 1], turning),
                    linestyle=LINES[state],
                    color=color,
                    linewidth=2.1 if state == "stable" else 1.5,
                    zorder=3 if state == "stable" else 2.5,
                )
            if len(branch):
                obstacles.append(_dense(axes, *broken(xs, ys, turning)))
        special: list[tuple[str, float, float]] = []
        for point in graph.special.values():
            if point.kind == "end" and not ends:
                continue
            branch = graph.branches.get(point.branch)
            if branch is None:
                continue
            px, py = _at(branch, point, x), _at(branch, point, y)
            if not (np.isfinite(px) and np.isfinite(py)):
                continue  # such as B of a motion without impacts
            mark = MARKS.get(point.kind, PLAIN)
            used.setdefault(mark.name, mark)
            color = tint[branch.label]
            axes.plot(
                [px],
                [py],
                linestyle="none",
                marker=mark.marker,
                color=color,
                markerfacecolor=color if mark.filled else "white",
                markeredgecolor="black" if mark.filled else color,
                markeredgewidth=0.5 if mark.filled else 1.3,
                zorder=6,
            )
            special.append((point.label, px, py))
        axes.margins(0.04)
        axes.set_xlabel(axis_label(x, graph.units.get(x)))
        axes.set_ylabel(axis_label(y, graph.units.get(y)))
        _legend(axes, states, used, undrawn(graph, x, y))
        if labels:
            settle(figure)
            if _clear_legend(axes, obstacles):
                settle(figure)
            if own:
                freeze(figure)
            taken = _hold_legend(axes)
            spots, names = merge_labels(axes, [(px, py) for _, px, py in special], [t for t, _, _ in special])
            middles = _middles(graph, x, y, tint, axes) if len(graph.branches) > 1 else []
            anchors = [*spots, *((px, py) for _, px, py, _ in middles)]
            colors = ["black"] * len(spots) + [color for *_, color in middles]
            if anchors:
                texts = [*names, *(text for text, *_ in middles)]
                place_labels(
                    axes,
                    anchors,
                    texts,
                    np.vstack(obstacles),
                    colors=colors,
                    optional=len(middles),
                    taken=taken,
                )
        if not graph.finished:
            axes.set_title("unfinished", color="0.4")
    return figure


def default_measure(graph: "Graph") -> str:
    """The measure on the y axis when none is named: one that is a number on some branch, at least.

    Motions without impacts have no velocity B there; where none of the graph has, the largest |w| is shown.
    """
    for branch in graph.branches.values():
        names = list(getattr(branch.problem, "measure_names", ()) or ())
        if not names:
            continue
        wanted = getattr(branch.problem, "default_measure", None)
        others = [n for n in names if n not in ("norm", graph.parameter)]
        choice = [n for n in (wanted, "max_abs_w", *others) if n in names]
        return next((str(n) for n in choice if _shown(graph, n)), choice[0] if choice else names[0])
    return "norm"


def undrawn(graph: "Graph", x: str, y: str) -> str:
    """Which branches have no number to draw, as a line of the legend; empty if all have one."""
    missing = [b for b in graph.branches.values() if len(b) and not _finite(b, x, y)]
    if not missing:
        return ""
    labels = [b.label for b in missing]
    listed = ", ".join(labels) if len(labels) <= 4 else f"{', '.join(labels[:3])} +{len(labels) - 3}"
    words = [b.description.get("word") for b in missing]
    still = all(isinstance(w, str) and not set("LR") & set(w) for w in words)
    return f"not drawn: {listed} ({'no impacts' if still else f'no {y} there'})"


def _shown(graph: "Graph", name: str) -> bool:
    return any(_finite(b, graph.parameter, name) for b in graph.branches.values() if len(b))


def _finite(branch: Any, x: str, y: str) -> bool:
    """Whether some point of a branch has both measures."""
    return bool(np.any(np.isfinite(measured(branch, x)) & np.isfinite(measured(branch, y))))


def measured(branch: Any, name: str) -> np.ndarray:
    """A measure along a branch, shape (n,); what cannot be had is refused with the names that can."""
    try:
        return np.asarray(branch.measure(name), float)
    except (KeyError, ValueError) as error:
        names = sorted({branch.parameter, *branch.measure_names})
        raise ValueError(
            f"{branch.label} has no measure {name!r}; choose one of {', '.join(names)}."
        ) from error


def _at(branch: Any, point: Any, name: str) -> float:
    if name == branch.parameter:
        return float(point.value)
    if 0 <= point.index < len(branch):
        return float(measured(branch, name)[point.index])
    if branch.problem is None:
        nearest = int(np.argmin(np.abs(branch.points - point.u).max(axis=1)))
        return float(measured(branch, name)[nearest])
    return float(branch.problem.measures((name,), point.u[None, :], np.array([point.value]))[name][0])


def _cycle() -> list[dict[str, str]]:
    import matplotlib as mpl

    return list(mpl.rcParams["axes.prop_cycle"])


def _middles(
    graph: "Graph", x: str, y: str, tint: dict[str, str], axes: "Axes"
) -> list[tuple[str, float, float, str]]:
    """A point halfway along each branch as drawn, for its label."""
    found = []
    for branch in graph.branches.values():
        if len(branch) < 2:
            continue
        turning = (x in angles_of(branch), y in angles_of(branch))
        points = np.column_stack(broken(measured(branch, x), measured(branch, y), turning))
        screen = axes.transData.transform(points)
        steps = np.hypot(*np.diff(screen, axis=0).T)
        length = np.concatenate([[0], np.cumsum(np.where(np.isfinite(steps), steps, 0.0))])
        if length[-1] < 12:
            continue
        i = int(np.searchsorted(length, 0.5 * length[-1]))  # never at a gap: nothing is added there
        found.append((branch.label, float(points[i, 0]), float(points[i, 1]), tint[branch.label]))
    return found


def _dense(axes: "Axes", xs: np.ndarray, ys: np.ndarray) -> np.ndarray:
    """Points close together along a curve, so that a label cannot slip between two of them."""
    if len(xs) < 2:
        return np.column_stack([xs, ys])
    at = np.linspace(0, len(xs) - 1, max(400, len(xs)))
    return np.column_stack([np.interp(at, np.arange(len(xs)), v) for v in (xs, ys)])


def _clear_legend(axes: "Axes", obstacles: list[np.ndarray]) -> bool:
    """Put a legend beside the axes if it would cover curves or marks inside, and the figure can make room: whether so."""
    legend, figure = axes.get_legend(), axes.get_figure(root=True)
    if legend is None or figure is None or figure.get_layout_engine() is None:
        return False
    box = legend.get_window_extent()
    drawn = [np.column_stack([*line.get_data()]).astype(float) for line in axes.lines]
    points = axes.transData.transform(np.vstack([*obstacles, *drawn, np.empty((0, 2))]))
    if not any(box.contains(*point) for point in points[np.isfinite(points).all(axis=1)]):
        return False
    legend.set_loc("upper left")
    legend.set_bbox_to_anchor((1.01, 1.0), transform=axes.transAxes)
    return True


def _hold_legend(axes: "Axes") -> list[tuple[float, float, float, float]]:
    """Keep the legend where it is now, whatever is written later; its box on the page."""
    legend = axes.get_legend()
    if legend is None:
        return []
    box = legend.get_window_extent()
    (left, low) = axes.transAxes.inverted().transform((box.x0, box.y0))
    legend.set_bbox_to_anchor(None)
    legend.set_loc((float(left), float(low)))
    return [(box.x0, box.y0, box.x1, box.y1)]


def _legend(axes: "Axes", states: dict[str, None], used: dict[str, Any], remark: str) -> None:
    from matplotlib.lines import Line2D

    handles = [
        Line2D(
            [], [], color="0.2", linestyle=LINES[s], linewidth=2.1 if s == "stable" else 1.5, label=STATES[s]
        )
        for s in STATES
        if s in states
    ]
    handles += [
        Line2D(
            [],
            [],
            linestyle="none",
            marker=m.marker,
            color="0.2",
            markerfacecolor="0.2" if m.filled else "white",
            markersize=5.5,
            label=m.name,
        )
        for m in used.values()
    ]
    handles += axes.get_legend_handles_labels()[0]  # what was drawn before on these axes
    if remark:
        handles.append(Line2D([], [], linestyle="none", label=remark))
    if handles:
        axes.legend(handles=handles, loc="best", handlelength=2.6)
