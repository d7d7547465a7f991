"""The bifurcation diagram: branches as curves, special points as labelled marks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..events.kinds import KINDS
from ..graph.measures import default_measure, has_numbers, measured
from ..graph.shortening import short_word
from .curves import Curve
from .figures import freeze, new_axes, scale, settle, styled
from .labels import Label, grouped, place_labels
from .legends import Key, draw_legend, hold_legend
from .style import LINES, MARKS, PLAIN, STATE_COLORS, STATES, WIDTHS, axis_label
from .views import frame

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..graph.graph import Graph

LOW = 2.6  # inches: lower axes have the symbol of a measure alone at their side
COLORS = ("branch", "word", "stability")
TEXT = 0.85  # size of labels in units of font.size


def plot_diagram(
    graph: Graph,
    x: str | None = None,
    y: str | None = None,
    *,
    axes: Axes | None = None,
    labels: bool | Sequence[str] = True,
    ends: bool = False,
    words: bool = False,
    color: str = "branch",
    legend: bool | str = True,
    name: str | None = None,
    xlim: tuple[float, float] | None = None,
    ylim: tuple[float, float] | None = None,
    figsize: tuple[float, float] | None = None,
    style: str | Mapping[str, Any] | None = None,
) -> Figure:
    """Draw a graph: solid stable, dashed unstable, dotted virtual, special points marked and labelled.

    Parameters
    ----------
    graph : Graph
    x, y : str, optional
        Names of measures; by default the continuation parameter, and the problem's `default_measure` or first measure.
        Where a measure has a value at each point of a cycle (`x0` of a map), every one is drawn.
    axes : Axes, optional
        Drawn on; without, a new figure. A second graph on the same axes shares the legend; its labels have a prime, or `name`.
    labels : bool or sequence of str
        Write the labels of branches and special points: all for which there is room, none, or exactly these.
    ends : bool
        Mark the ends of the interval, too.
    words : bool
        Write the words of the motions along the branches instead of the branches' labels.
    color : {"branch", "word", "stability"}
        What a colour stands for.
    legend : bool or str
        Whether, or where: "inside", "beside", "below", or a place that matplotlib knows.
    name : str, optional
        Put before the labels, to tell graphs on the same axes apart.
    xlim, ylim : (float, float), optional
        Limits; labels are placed and curves refined for what is seen then, and again when the limits change later.
    figsize : (float, float), optional
        Inches, of a new figure.
    style : str or mapping, optional
        A style or rcParams of matplotlib's that come before the house's.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If the problem has no such measure, a label is unknown, or an option has no such value.
    """
    if color not in COLORS:
        raise ValueError(f"color = {color!r} is unknown; choose one of {', '.join(COLORS)}")
    _check_labels(graph, labels)
    x = x or graph.parameter
    y = y or default_measure(graph)
    own = axes is None
    with styled(style):
        figure, axes = new_axes(axes, figsize=figsize)
        picture = _Picture(axes, graph, x, y, color, name)
        picture.draw_branches()
        picture.draw_points(ends)
        frame(axes, graph, picture.curves, x, y, xlim, ylim)
        if own or not axes.get_xlabel():
            axes.set_xlabel(axis_label(x, unit=graph.units.get(x)))
        if own or not axes.get_ylabel():
            axes.set_ylabel(
                axis_label(y, axes.get_window_extent().height < LOW * figure.dpi, graph.units.get(y))
            )
        settle(figure)
        picture.refine()
        picture.key_of_marks()
        draw_legend(axes, picture.key, legend, own, picture.obstacles())
        settle(figure)
        if own:
            freeze(figure)
        taken = hold_legend(axes)
        if labels is not False:
            picture.write_labels(labels, words, taken)
            picture.follow_zoom()
        if not graph.finished:
            axes.set_title("unfinished", color="0.4")
    return figure


class _Picture:
    """One graph on some axes: its curves, marks and labels, which are laid out again when the limits change."""

    def __init__(self, axes: Axes, graph: Graph, x: str, y: str, color: str, name: str | None) -> None:
        import matplotlib as mpl

        self.axes, self.graph, self.x, self.y, self.color = axes, graph, x, y, color
        known = [p for p in getattr(axes, "contvines_pictures", []) if p.axes is axes]
        axes.contvines_pictures = [*known, self]  # type: ignore[attr-defined]
        self.before, self.after = (f"{name} ", "") if name else ("", "′" * len(known))
        self.first_color = sum(len(p.graph.branches) for p in known)
        self.rc = mpl.rcParams.copy()
        self.key = Key()
        self.curves: list[Curve] = []
        self.tint: dict[str, str] = {}
        self.spots: list[tuple[str, str, float, float]] = []  # label, kind, x, y
        self.written: list[Any] = []
        self.options: tuple[Any, bool, Any] = (True, False, [])
        if (remark := undrawn(graph, x, y)) != "":
            self.key.remarks.append(remark)

    def draw_branches(self) -> None:
        import matplotlib as mpl

        width = mpl.rcParams["lines.linewidth"]
        colors = [entry.get("color", "black") for entry in mpl.rcParams["axes.prop_cycle"]]
        words: dict[str, str] = {}
        for i, branch in enumerate(self.graph.branches.values()):
            tint = colors[(self.first_color + i) % len(colors)]
            if self.color == "word":
                word = str(branch.description.get("word") or branch.description.get("name", ""))
                tint = words.setdefault(short_word(word, 24), colors[len(words) % len(colors)])
            self.tint[branch.label] = tint
            (
                measured(branch, self.x),
                measured(branch, self.y),
            )  # refused in a sentence before anything is drawn
            for first, last, stable in branch.pieces():
                state = ("stable" if stable else "unstable") if branch.real else "virtual"
                self.key.states.setdefault(state, None)
                shade = STATE_COLORS[state] if self.color == "stability" else tint
                if self.color == "stability":
                    self.key.colors[STATES[state]] = shade
                curve = Curve(branch, self.x, self.y, first, last)
                curve.draw(
                    self.axes,
                    linestyle=LINES[state],
                    color=shade,
                    linewidth=WIDTHS[state] * width,
                    zorder=3 if state == "stable" else 2.5,
                )
                self.curves.append(curve)
        if self.color == "word":
            self.key.colors |= words

    def draw_points(self, ends: bool) -> None:
        import matplotlib as mpl

        size = mpl.rcParams["lines.markersize"]
        for point in self.graph.special.values():
            branch = self.graph.branches.get(point.branch)
            if branch is None or (point.kind == "end" and not ends):
                continue
            px, py = _at(branch, point, self.x), _at(branch, point, self.y)
            if not (np.isfinite(px) and np.isfinite(py)):
                continue  # such as B of a motion without impacts
            mark = MARKS.get(point.kind, PLAIN)
            tint = "0.15" if self.color == "stability" else self.tint[branch.label]
            self.axes.plot(
                [px],
                [py],
                linestyle="none",
                marker=mark.marker,
                color=tint,
                markersize=size,
                markerfacecolor=tint if mark.filled else "white",
                markeredgecolor="black" if mark.filled else tint,
                markeredgewidth=(0.5 if mark.filled else 1.3) * size / 6.0,
                zorder=6,
            )
            self.spots.append((point.label, point.kind, px, py))

    def key_of_marks(self) -> None:
        """Say in the legend what the marks mean that can be seen."""
        for _, kind, px, py in self.spots:
            if self._inside(px, py):
                mark = MARKS.get(kind, PLAIN)
                self.key.marks.setdefault(mark.name, mark)

    def refine(self) -> None:
        for curve in self.curves:
            curve.refine(self.axes)

    def obstacles(self) -> np.ndarray:
        """Points close together along all curves on these axes, so that a label cannot slip between two of them."""
        found = [np.empty((0, 2))]
        for line in self.axes.lines:
            xy = np.asarray(line.get_xydata(), dtype=float)
            if len(xy) > 1 and line.get_transform().contains_branch(self.axes.transData):
                page = self.axes.transData.transform(xy)
                steps = np.nan_to_num(np.hypot(*np.diff(page, axis=0).T))
                total = np.concatenate([[0.0], np.cumsum(steps)])
                at = np.linspace(0.0, total[-1], int(np.clip(total[-1] / 1.5, 2, 20000)))
                found.append(np.column_stack([np.interp(at, total, v) for v in xy.T]))
        return np.vstack(found)

    def write_labels(self, labels: bool | Sequence[str], words: bool, taken: list[Any]) -> None:
        """Lay labels out for the limits that the axes have now."""
        self.options = (labels, words, taken)
        for artist in self.written:
            artist.remove()
        chosen = None if isinstance(labels, bool) else list(labels)
        figure = self.axes.get_figure(root=True)
        assert figure is not None
        size = TEXT * self.rc["font.size"] * (1.0 if self.rc["font.size"] < 9.0 else scale(figure))
        places = {kind: i for i, kind in enumerate(KINDS)}  # whose labels are named first
        wanted = [
            Label(self._named(label), px, py, "black", places.get(kind, len(places)), chosen is not None)
            for label, kind, px, py in self.spots
            if chosen is None or label in chosen
        ]
        wanted = [entry for entry in wanted if self._inside(entry.x, entry.y)]
        wanted = wanted if chosen is not None else grouped(self.axes, wanted)
        others = [p for p in getattr(self.axes, "contvines_pictures", []) if p is not self]
        boxes = [a.get_window_extent() for p in others for a in p.written]
        taken = [*taken, *((b.x0, b.y0, b.x1, b.y1) for b in boxes)]
        wanted += self._middles(words, chosen)
        self.written, left_out = place_labels(self.axes, wanted, self.obstacles(), size=size, taken=taken)
        self.left_out = left_out

    def follow_zoom(self) -> None:
        """Lay out again when the limits of the axes change."""

        def again(_: Any) -> None:
            import matplotlib as mpl

            labels, words, _ = self.options
            with mpl.rc_context(self.rc):
                self.refine()
                self.write_labels(labels, words, hold_legend(self.axes))

        for change in ("xlim_changed", "ylim_changed"):
            self.axes.callbacks.connect(change, again)

    def _named(self, label: str) -> str:
        return f"{self.before}{label}{self.after}"

    def _inside(self, x: float, y: float) -> bool:
        (x0, x1), (y0, y1) = sorted(self.axes.get_xlim()), sorted(self.axes.get_ylim())
        return x0 <= x <= x1 and y0 <= y <= y1

    def _middles(self, words: bool, chosen: list[str] | None) -> list[Label]:
        """A point halfway along what is seen of each branch, for its name."""
        if len(self.graph.branches) < 2 and not words and chosen is None:
            return []
        found: dict[str, Label] = {}
        lengths: dict[str, float] = {}
        for curve in self.curves:
            label = curve.branch.label
            if not curve.lines or (chosen is not None and label not in chosen):
                continue
            xy = np.asarray(curve.lines[0].get_xydata(), dtype=float)
            page = self.axes.transData.transform(xy)
            box = self.axes.bbox
            inside = (
                (box.x0 <= page[:, 0])
                & (page[:, 0] <= box.x1)
                & (box.y0 <= page[:, 1])
                & (page[:, 1] <= box.y1)
            )
            steps = np.nan_to_num(np.hypot(*np.diff(page, axis=0).T)) * (inside[1:] & inside[:-1])
            total = np.concatenate([[0.0], np.cumsum(steps)])
            if total[-1] < 12 or total[-1] <= lengths.get(label, 0.0):
                continue
            lengths[label] = total[-1]
            i = int(np.searchsorted(total, 0.5 * total[-1]))  # never at a gap: nothing is added there
            text = self._named(label)
            if words:
                text = short_word(str(curve.branch.description.get("word") or "stuck"), 24)
            found[label] = Label(
                text, float(xy[i, 0]), float(xy[i, 1]), self.tint[label], 0, chosen is not None, True
            )
        return list(found.values())


def undrawn(graph: Graph, x: str, y: str) -> str:
    """Which branches have no number to draw, as a line of the legend; empty if all have one."""
    missing = [b for b in graph.branches.values() if len(b) and not has_numbers(b, x, y)]
    if not missing:
        return ""
    labels = [b.label for b in missing]
    listed = ", ".join(labels) if len(labels) <= 4 else f"{', '.join(labels[:3])} +{len(labels) - 3}"
    still = all(b.description.get("impacts") == 0 for b in missing)
    return f"not drawn: {listed} ({'no impacts' if still else f'no {y} there'})"


def _check_labels(graph: Graph, labels: bool | Sequence[str]) -> None:
    if isinstance(labels, bool):
        return
    if isinstance(labels, str):
        raise ValueError(f"labels = {labels!r}: give True, False or a list, for example [{labels!r}]")
    unknown = [label for label in labels if label not in graph]
    if unknown:
        known = ", ".join([*graph.branches, *graph.special])
        raise ValueError(f"labels: the graph has no {unknown[0]!r}; it has {known}")


def _at(branch: Any, point: Any, name: str) -> float:
    if name == branch.parameter:
        return float(point.value)
    if 0 <= point.index < len(branch):
        return float(measured(branch, name)[point.index])
    if branch.problem is None:
        nearest = int(np.argmin(np.abs(branch.points - point.u).max(axis=1)))
        return float(measured(branch, name)[nearest])
    return float(branch.problem.measures((name,), point.u[None, :], np.array([point.value]))[name][0])
