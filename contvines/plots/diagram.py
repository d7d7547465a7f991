"""Picture of a bifurcation diagram: branches as curves, special points as labelled marks; the layout follows the limits of the axes."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from matplotlib import rc_context, rcParams
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.inset import InsetIndicator
from matplotlib.lines import Line2D
from matplotlib.text import Annotation

from contvines.shared.near_names import did_you_mean

from ..bifurcation.kind import Kind
from ..bifurcation.kinds import BY_NAME
from ..continuation.settings import hinting
from ..graph import Graph
from ..graph.contents import proof_mark, proved_stretches
from ..graph.stretches import default_measure, measure_at, measured, undrawn
from ..graph.table import motion_name, told_apart
from ..shared.figures import Size, Style, drawing, finish_layout, pixels, root, shrinking
from .curves import Curve
from .labels import Label, Region, add_inset, crowded_region, grouped, is_curve, place_labels
from .legends import hold_legend, place_legend
from .style import PROVED, STATE_COLORS, STATE_OF, STATES, UNRESOLVED, axis_label, line_of, mark_of

COLORS = ("branch", "word", "stability")
# a range of y longer than this multiple of the range of most points and of the special points is cut
RUNAWAY = 6.0
UPRIGHT = 1e-6  # relative to the width of the axes: narrower lines do not set the range of y
MOST = (4.0, 96.0)  # per cent: percentiles of y between which most points lie
TEXT = 0.85  # font size of labels, relative to font.size
# largest number of labels of points, and of branches: constant part, and part per square inch
POINTS, NAMES = (6.5, 0.3), (3.5, 0.15)
FEW = 4.5  # inches: in narrower axes fewer labels share a place


@hinting
def plot_diagram(
    graph: Graph,
    x: str | None = None,
    y: str | None = None,
    *,
    axes: Axes | None = None,
    labels: bool | Sequence[str] = True,
    ends: bool = False,
    marks: bool | Sequence[str] = True,
    words: bool = False,
    color: str = "branch",
    legend: bool | str = True,
    name: str | None = None,
    xlim: tuple[float, float] | None = None,
    ylim: tuple[float, float] | None = None,
    inset: bool | Region | None = None,
    figsize: Size = None,
    style: Style = None,
) -> Figure:
    """Draw a graph: stable parts solid, unstable ones dashed, virtual ones dotted, special points as labelled marks.

    Parameters
    ----------
    graph : Graph
    x, y : str, optional
        Names of measures; by default the continuation parameter, and the problem's `default_measure` or first measure.
        If a measure has a value at each point of a cycle (`x0` of a map), all of them are drawn.
    axes : Axes, optional
        Default: a new figure. A second graph on the same axes shares the legend; its labels have a prime, or begin with `name`.
    labels : bool or sequence of str
        Labels of branches and special points to be written: all that find room, none, or exactly these.
    ends : bool
        Also mark the ends of the interval.
    marks : bool or sequence of str
        Special points to be marked: all, none, or those of these kinds, by name or label: ``["fold", "SB"]``.
    words : bool
        Write the words of the motions beside the branches, instead of the branches' labels.
    color : {"branch", "word", "stability"}
        Meaning of the colours.
    legend : bool or str
        Whether there is a legend, or its place: "inside", "beside", "below", or a location of matplotlib.
    name : str, optional
        Prefix of the labels, which distinguishes graphs on the same axes.
    xlim, ylim : (float, float), optional
        Limits of the axes. Labels are placed and curves refined for these limits, and again when the limits change. With
        `xlim` alone, the limits of y are those of the visible curves.
    inset : bool or ((float, float), (float, float)), optional
        Enlarge the most crowded part, or the part with these limits, in a free part of the axes. By default a new figure with a
        crowded part has an inset, if there is room.
    figsize : (float, float), optional
        Size of a new figure in inches.
    style : str or mapping, optional
        "aps", "elsevier", "springer" (one column), "grey", "slides", a style of matplotlib, several of them ("aps,grey"), or
        rcParams; they override those of the package.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If a measure, a label, or the value of an option is unknown.
    """
    if color not in COLORS:
        raise ValueError(
            f"color = {color!r} is unknown{did_you_mean(color, COLORS)}; choose one of {', '.join(COLORS)}"
        )
    if isinstance(labels, str):
        raise ValueError(f"labels = {labels!r}: give True, False or a list, for example [{labels!r}]")
    unknown = [] if isinstance(labels, bool) else [label for label in labels if label not in graph]
    if unknown:
        labels_of_graph = ", ".join([*graph.branches, *graph.special])
        raise ValueError(f"labels: the graph has no {unknown[0]!r}; it has {labels_of_graph}")
    with drawing(axes, style, figsize) as (figure, axes, own):
        look = {"labels": labels, "ends": ends, "words": words, "color": color, "name": name}
        look["inset"] = own if inset is None else inset
        draw_diagram(axes, graph, x, y, own, marks=marks, legend=legend, limits=(xlim, ylim), **look)
    return figure


def draw_diagram(
    axes: Axes,
    graph: Graph,
    x: str | None,
    y: str | None,
    own: bool,
    *,
    marks: bool | Sequence[str] = True,
    legend: bool | str = True,
    limits: tuple[tuple[float, float] | None, tuple[float, float] | None] = (None, None),
    **look: Any,
) -> Picture:
    """Draw a graph as :func:`plot_diagram` does, with the present rcParams.

    `own`: whether the figure was made by `new_figure`, so that its layout may change; `limits`: `xlim` and `ylim`; `look`: options of :class:`Picture`.
    """
    x, y = x or graph.parameter, y or default_measure(graph)
    picture = Picture(axes, graph, x, y, kinds=_marked(graph, marks), **look)
    picture.draw()
    frame(axes, *limits)
    across, up = (axis_label(name, graph.units.get(name), graph.notation) for name in (x, y))
    axes.set(xlabel=axes.get_xlabel() or across, ylabel=axes.get_ylabel() or up)
    picture.refine()  # changes of the axes' size by the layout below are too small to need another refinement
    if limits[0] is not None:
        frame(axes, *limits)  # again, with the points inserted between the stored ones
    picture.visible_points()
    place_legend(axes, picture.handles(), legend, own, remarks=picture.remarks)
    finish_layout(root(axes), own)
    picture.lay_out()
    picture.follow_zoom()
    if not graph.finished:
        axes.set_title("unfinished", color="0.4")
    return picture


def _marked(graph: Graph, marks: bool | Sequence[str]) -> list[str] | None:
    """Return the names of the kinds to be marked; None for all."""
    if isinstance(marks, bool):
        return None if marks else []
    kinds = {**BY_NAME, **graph.own_kinds}
    by_label = {kind.label: name for name, kind in kinds.items()}
    names = [marks] if isinstance(marks, str) else list(marks)
    for name in names:
        if name not in kinds and name not in by_label:
            raise ValueError(
                f"marks: there is no kind {name!r}{did_you_mean(name, [*kinds, *by_label])}; give names or labels, for example ['fold', 'SB']"
            )
    return [by_label.get(name, name) for name in names]


def frame(axes: Axes, xlim: tuple[float, float] | None, ylim: tuple[float, float] | None) -> None:
    """Set the limits of the axes; by default they show all that is drawn, without the far ends of branches that run away in y."""
    axes.margins(0.04)
    axes.autoscale_view()
    if xlim is not None:
        axes.set_xlim(*xlim)
    if ylim is not None:
        axes.set_ylim(*ylim)
        return
    left, right = sorted(axes.get_xlim())
    scale, log = axes.yaxis.get_transform(), axes.get_yscale() == "log"
    drawn, leaning, marks = [np.empty(0)], [np.empty(0)], [np.empty(0)]
    for line in axes.lines:
        xy = np.asarray(line.get_xydata(), dtype=float)
        if not len(xy) or not line.get_transform().contains_branch(axes.transData):
            continue
        count = 20 if is_curve(line) else 1  # a segment may cross the edges
        steps = np.arange(count * (len(xy) - 1) + 1) / count
        x, y = (np.interp(steps, np.arange(len(xy)), values) for values in xy.T)
        seen = (x >= left) & (x <= right) & np.isfinite(y) & (not log or y > 0.0)
        drawn.append(scale.transform(y[seen]))
        if len(xy) == 1:
            marks.append(drawn[-1])
        elif seen.any() and np.ptp(x[seen]) > UPRIGHT * (right - left):
            leaning.append(drawn[-1])  # a family of cycles at one parameter value has all amplitudes
    heights, most, spots = map(np.concatenate, (drawn, leaning, marks))
    if not heights.size:
        return
    inner = np.append(np.percentile(most if most.size else heights, MOST), spots if xlim is None else [])
    low, high, room = heights.min(), heights.max(), np.ptp(inner)
    if 0.0 < RUNAWAY * room < high - low:
        low, high = max(low, inner.min() - 0.44 * room), min(high, inner.max() + 0.44 * room)
    elif xlim is None:
        return
    pad = 0.06 * (high - low)
    low, high = axes.yaxis.get_major_locator().nonsingular(low - pad, high + pad)
    axes.set_ylim(*scale.inverted().transform(np.array([low, high])))


class Picture:
    """A graph drawn on axes. Options as for :func:`plot_diagram`; `kinds`: names of the kinds to be marked (None: all)."""

    def __init__(
        self, axes: Axes, graph: Graph, x: str, y: str, *, labels: bool | Sequence[str] = True, words: bool = False,
        color: str = "branch", name: str | None = None, kinds: Collection[str] | None = None, ends: bool = False,
        inset: bool | Region = False,
    ) -> None:  # fmt: skip
        self.axes, self.graph, self.x, self.y, self.color = axes, graph, x, y, color
        self.labels, self.words, self.kinds, self.ends, self.region = labels, words, kinds, ends, inset
        earlier = getattr(axes, "contvines_pictures", [])  # some may have been cleared by the user
        others = [one for one in earlier if one.curves and one.curves[0].lines[0].axes is axes]
        axes.contvines_pictures = [*others, self]  # type: ignore[attr-defined]
        self.name = (f"{name} ", "") if name else ("", "′" * len(others))  # prefix and suffix of labels
        self.first_color = sum(len(picture.graph.branches) for picture in others)
        self.rc = rcParams.copy()
        self.remarks = [remark] if (remark := undrawn(graph, x, y)) else []
        self.entries: dict[str, tuple[int, Artist]] = {}  # legend: label -> rank and handle
        self.curves: list[Curve] = []
        self.tint: dict[str, str] = {}
        self.spots: list[tuple[str, str, float, float]] = []  # label, kind, x, y
        self.written: list[Annotation] = []
        self.inset: tuple[Picture, InsetIndicator] | None = None

    def draw(self) -> None:
        """Draw branches, special points, and marks of unresolved stretches."""
        self._draw_branches()
        self._draw_points()
        for entry in self.graph.unresolved:
            branch = self.graph.branches.get(entry.branch)
            if branch is None or not 0 <= entry.index < len(branch):
                continue
            spot = [float(measured(branch, name)[entry.index]) for name in (self.x, self.y)]
            if np.isfinite(spot).all():
                look = mark_of(UNRESOLVED, "0.4", 11.0) | {"markerfacecolor": "none", "markeredgewidth": 1.0}
                self.axes.plot(*spot, zorder=5.8, **look)
                self._explain_mark(UNRESOLVED)

    def _draw_branches(self) -> None:
        """Draw each branch as curves, one per piece with the same stability; a pale band below the proved parts."""
        colors = [entry.get("color", "black") for entry in rcParams["axes.prop_cycle"]]
        words: dict[str, str] = {}
        for i, branch in enumerate(self.graph.branches.values(), self.first_color):
            tint = colors[i % len(colors)]
            if self.color == "word":
                word = str(branch.description.get("word") or branch.description.get("name", ""))
                tint = words.setdefault(word, colors[len(words) % len(colors)])
            self.tint[branch.label] = tint
            xs, ys = (measured(branch, name) for name in (self.x, self.y))  # unknown measures: ValueError
            for first, last, stable in branch.pieces():
                state = STATE_OF[stable] if branch.real else "virtual"
                tint = STATE_COLORS[state] if self.color == "stability" else tint
                shown = line_of(state, tint if self.color == "stability" else "0.2")
                self._explain(list(STATES).index(state), STATES[state], **shown)
                curve = Curve(branch, self.x, self.y, first, last)
                behind = state in ("unstable", "virtual")
                curve.draw(self.axes, {"zorder": 2.5 if behind else 3, **line_of(state, tint)})
                self.curves.append(curve)
            for points, _ in proved_stretches(self.graph, branch.label):
                width = 5.0 * float(rcParams["lines.linewidth"])
                band = {"linewidth": width, "solid_capstyle": "butt", "zorder": 1.5, **PROVED}
                self.axes.plot(xs[points], ys[points], **band)
                self._explain(9, "proved", **band)
        if self.color == "word":
            for word, short in told_apart(words).items():
                self._explain(7, short, color=words[word])

    def _draw_points(self) -> None:
        size = float(rcParams["lines.markersize"])
        for point in self.graph.special.values():
            branch = self.graph.branches.get(point.branch)
            if branch is None or (point.kind == "end" and not self.ends):
                continue
            if self.kinds is not None and point.kind not in self.kinds:
                continue
            px, py = measure_at(branch, point, self.x), measure_at(branch, point, self.y)
            if not (np.isfinite(px) and np.isfinite(py)):
                continue  # for example B of a motion without impacts
            tint = "0.15" if self.color == "stability" else self.tint[branch.label]
            self.axes.plot([px], [py], zorder=6, **mark_of(self.graph.kind(point.kind), tint, size))
            if proof_mark(self.graph, point.label):
                look: dict[str, Any] = {"linestyle": "none", "marker": "o", "markeredgewidth": 0.0, **PROVED}
                self.axes.plot([px], [py], markersize=2.2 * size, zorder=5.5, **look)
                self._explain(9, "proved", linewidth=6.8, solid_capstyle="butt", **PROVED)
            self.spots.append((point.label, point.kind, px, py))

    def visible_points(self) -> list[tuple[str, str, float, float]]:
        """Return the special points within the limits, and add the meaning of their marks to the legend."""
        found = [spot for spot in self.spots if self._inside(*spot[2:])]
        for _, kind, _, _ in found:
            self._explain_mark(self.graph.kind(kind))
        return found

    def handles(self) -> list[Artist]:
        """Return the entries of the legend, in order."""
        ranked = sorted(self.entries.values(), key=lambda entry: entry[0])
        return [
            *(handle for _, handle in ranked),
            *(Line2D([], [], linestyle="none", label=remark) for remark in self.remarks),
        ]

    def _explain(self, rank: int, label: str, **look: Any) -> None:
        self.entries.setdefault(label, (rank, Line2D([], [], label=label, **look)))

    def _explain_mark(self, kind: Kind) -> None:
        self._explain(8, kind.text, **mark_of(kind, "0.2", 0.9 * float(self.rc["lines.markersize"])))

    def refine(self) -> None:
        """Insert points between the stored ones where lines have visible corners."""
        for curve in self.curves:
            curve.refine(self.axes)

    def lay_out(self) -> None:
        """Refine the curves, and renew inset and labels, for the present limits and size of the axes."""
        with rc_context(self.rc):
            self.refine()
            hold_legend(self.axes)
            for artist in self.written:
                artist.remove()
            self.written = []
            self._enlarge()
            if self.labels is not False:
                self._write_labels()

    def follow_zoom(self) -> None:
        """Renew the layout whenever the limits of the axes change."""

        def again(_: Axes) -> None:
            self.region = self.region is True  # a region given by the user belongs to the first limits only
            self.lay_out()

        for change in ("xlim_changed", "ylim_changed"):
            self.axes.callbacks.connect(change, again)

    def _enlarge(self) -> None:
        """Draw the inset: the crowded part, or the region given by the user."""
        if self.inset is not None:
            self.inset[1].remove()
            self.inset[0].axes.remove()
            self.inset = None
        spots = np.array([spot[2:] for spot in self.visible_points()]).reshape(-1, 2)
        region = crowded_region(self.axes, spots) if self.region is True else self.region
        made = add_inset(self.axes, region, 0.8 * self._text()) if region else None
        if not region or made is None:
            return
        look: dict[str, Any] = {"words": self.words, "color": self.color, "kinds": self.kinds}
        inset = Picture(made[0], self.graph, self.x, self.y, **look)
        inset.name, inset.first_color, inset.rc = self.name, self.first_color, self.rc
        inset.draw()
        inset.axes.set(xlim=region[0], ylim=region[1])
        inset.lay_out()
        self.inset = inset, made[1]

    def _write_labels(self) -> None:
        chosen = None if isinstance(self.labels, bool) else list(self.labels)
        places = {kind: i for i, kind in enumerate(BY_NAME)}  # rank of their labels
        wanted = [
            Label(self._named(label), x, y, "black", places.get(kind, len(places)), chosen is not None)
            for label, kind, x, y in self.visible_points()
            if chosen is None or label in chosen
        ]
        names = self._middles(chosen)
        if self.inset is not None:  # labels in the inset are not repeated
            inside = self.inset[0]._inside
            wanted, names = ([e for e in found if not inside(e.x, e.y)] for found in (wanted, names))
        if chosen is None:
            inches = np.array(self.axes.bbox.size) / (72.0 * pixels(self.axes))
            wanted = grouped(self.axes, wanted, named=2 if inches[0] < FEW else 3)
            wanted.sort(key=lambda label: label.rank)
            wanted, names = (
                found[: int(count + more * inches.prod())]  # as many as remain legible
                for found, (count, more) in ((wanted, POINTS), (names, NAMES))
            )
        self.written = place_labels(self.axes, [*wanted, *names], self._text())

    def _named(self, label: str) -> str:
        return f"{self.name[0]}{label}{self.name[1]}"

    def _text(self) -> float:
        """Return the font size of labels in points."""
        size = float(self.rc["font.size"])
        return TEXT * size * (1.0 if size < 9.0 else shrinking(root(self.axes).get_size_inches()[0]))

    def _inside(self, x: float, y: float) -> bool:
        (x0, x1), (y0, y1) = sorted(self.axes.get_xlim()), sorted(self.axes.get_ylim())
        return x0 <= x <= x1 and y0 <= y <= y1

    def _middles(self, chosen: list[str] | None) -> list[Label]:
        """Return a label halfway along the longest visible piece of each branch; longest pieces first."""
        if len(self.graph.branches) < 2 and not self.words and chosen is None:
            return []
        found: dict[str, tuple[float, Label]] = {}
        low, high = self.axes.bbox.get_points()
        for curve in self.curves:
            label = curve.branch.label
            if chosen is not None and label not in chosen:
                continue
            xy = np.asarray(curve.lines[0].get_xydata(), dtype=float)
            page = self.axes.transData.transform(xy)
            inside = np.all((low <= page) & (page <= high), axis=1)
            steps = np.nan_to_num(np.hypot(*np.diff(page, axis=0).T)) * (inside[1:] & inside[:-1])
            total = np.concatenate([[0.0], np.cumsum(steps)])
            if total[-1] < 12 or (label in found and total[-1] <= found[label][0]):
                continue
            # at a gap the sum does not grow, so that the point is never nan
            x, y = xy[np.searchsorted(total, 0.5 * total[-1])].tolist()
            text = motion_name(curve.branch.description) if self.words else self._named(label)
            tint = "0.25" if self.color == "stability" else self.tint[label]
            found[label] = float(total[-1]), Label(text, x, y, tint, 0, chosen is not None, True)
        return [label for _, label in sorted(found.values(), key=lambda entry: -entry[0])]
