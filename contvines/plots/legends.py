"""The legend of a diagram: what its lines and marks mean, once per axes, in a place that hides nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.near_names import did_you_mean

from .figures import settle
from .labels import text_widths
from .style import LINES, PROVED, STATES, WIDTHS, Mark

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NARROW = 5.0  # inches: in a narrower figure the legend stands below the axes
PLACES = ("inside", "beside", "below")


@dataclass
class Key:
    """What a picture has used: states of branches, colours with a meaning, marks, bands of proofs, and remarks in words."""

    states: dict[str, None] = field(default_factory=dict)
    colors: dict[str, str] = field(default_factory=dict)
    marks: dict[str, Mark] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)
    proved: bool = False

    def handles(self) -> list[Any]:
        """Artists for the entries, in order."""
        import matplotlib as mpl
        from matplotlib.lines import Line2D

        width, size = mpl.rcParams["lines.linewidth"], mpl.rcParams["lines.markersize"]
        found = []
        for state, name in STATES.items():
            if state in self.states:
                look = {"linestyle": LINES[state], "linewidth": WIDTHS[state] * width, "label": name}
                found.append(Line2D([], [], color=self.colors.get(name, "0.2"), **look))
        for name, color in self.colors.items():
            if name not in STATES.values():
                found.append(Line2D([], [], color=color, linewidth=width, label=name))
        for mark in self.marks.values():
            face = "0.2" if mark.filled else "white"
            look = {
                "marker": mark.marker,
                "markerfacecolor": face,
                "markersize": 0.9 * size,
                "label": mark.name,
            }
            found.append(Line2D([], [], linestyle="none", color="0.2", **look))
        if self.proved:
            band = {"linewidth": 4.0 * width, "solid_capstyle": "butt", **PROVED}
            found.append(Line2D([], [], label="proved", **band))
        found += [Line2D([], [], linestyle="none", label=text) for text in self.remarks]
        return found


def draw_legend(axes: Axes, key: Key, where: bool | str, own: bool, obstacles: np.ndarray) -> None:
    """Write or renew the legend of axes: entries that stand there already, and what `Key` adds.

    Parameters
    ----------
    axes : Axes
    key : Key
    where, own, obstacles
        As for :func:`place_legend`.
    """
    before = axes.get_legend()
    known = {}
    if before is not None:
        for handle, text in zip(before.legend_handles, before.get_texts(), strict=False):
            known[text.get_text()] = handle
    for handle in (*key.handles(), *axes.get_legend_handles_labels()[0]):
        known.setdefault(str(handle.get_label()), handle)
    place_legend(axes, list(known.values()), where, own, obstacles, remarks=key.remarks)


def place_legend(
    axes: Axes,
    handles: list[Any],
    where: bool | str,
    own: bool,
    obstacles: np.ndarray | None = None,
    *,
    usual: str = "inside",
    remarks: Sequence[str] = (),
) -> None:
    """Write a legend where the user wants it, or where it squeezes and hides nothing.

    Parameters
    ----------
    axes : Axes
    handles : list
        Artists with labels.
    where : bool or str
        False: none. True: the usual place, but below in a narrow figure. "inside", "beside", "below", or a place of matplotlib's.
    own : bool
        Whether the figure is ours to be laid out; else True means inside.
    obstacles : float array (n, 2), optional
        Data coordinates of what should not be covered, besides the lines of the axes.
    usual : {"inside", "beside", "below"}
        What True means in a wide figure of ours; inside gives way to beside where it would cover something.
    remarks : sequence of str
        Labels among `handles` that are words alone; below they go to the label of the axis.

    Raises
    ------
    ValueError
        If `where` is no place.
    """
    from matplotlib.layout_engine import ConstrainedLayoutEngine
    from matplotlib.legend import Legend

    if where is False or not handles:
        return
    figure = axes.get_figure(root=True)
    assert figure is not None
    options: dict[str, Any] = {"handles": handles, "handlelength": 2.4}
    if isinstance(where, str) and where not in PLACES:
        known = [*PLACES, *Legend.codes]
        if where not in known:
            raise ValueError(
                f"legend = {where!r} is unknown{did_you_mean(where, known)}; choose of {', '.join(known)}"
            )
        axes.legend(**{**options, "loc": where})
        return
    narrow = figure.get_size_inches()[0] < NARROW
    place = where if isinstance(where, str) else ("inside" if not own else "below" if narrow else usual)
    if place == "below":
        _below(figure, axes, handles, own, remarks)
        return
    axes.legend(loc="best", **options)
    settle(figure)
    if place == "beside" or (where is True and own and _covers(axes, obstacles)):
        legend = axes.get_legend()
        assert legend is not None
        legend.set_loc("upper left")
        legend.set_bbox_to_anchor((1.01, 1.0), transform=axes.transAxes)
        engine = figure.get_layout_engine()
        if own and isinstance(engine, ConstrainedLayoutEngine):
            engine.set(w_pad=0.09)  # inches: texts are a little wider at the resolution of a file
        settle(figure, 2)  # the axes become narrower, and then their ticks fewer


def hold_legend(axes: Axes) -> list[tuple[float, float, float, float]]:
    """Keep the legend where it is now, whatever is written later; its box on the page."""
    legend = axes.get_legend()
    if legend is None:
        return []
    box = legend.get_window_extent()
    (left, low) = axes.transAxes.inverted().transform((box.x0, box.y0))
    legend.set_bbox_to_anchor(None)
    legend.set_loc((float(left), float(low)))
    return [(box.x0, box.y0, box.x1, box.y1)]


def _below(figure: Figure, axes: Axes, handles: list[Any], own: bool, remarks: Sequence[str]) -> None:
    """Under the axes, small, in as many columns as fit the figure; remarks go to the axis's label."""
    import matplotlib as mpl
    from matplotlib.font_manager import FontProperties

    for remark in remarks:
        axes.set_xlabel(f"{axes.get_xlabel()}\n{remark}")
    handles = [entry for entry in handles if entry.get_label() not in remarks]
    if axes.get_legend() is not None:
        axes.get_legend().remove()  # type: ignore[union-attr]
    if not handles:
        return
    size = 0.92 * FontProperties(size=mpl.rcParams["legend.fontsize"]).get_size_in_points()
    texts = {str(entry.get_label()) for entry in handles}
    drawn = text_widths(texts, size)
    wide = [
        drawn[str(entry.get_label())] + 3.4 * size for entry in handles
    ]  # with the sample and the gaps beside it
    room = figure.get_size_inches()[0] * 72.0 if own else axes.get_window_extent().width / figure.dpi * 72.0
    look: dict[str, Any] = {
        "handles": handles,
        "ncols": _columns(wide, room),
        "fontsize": size,
        "handlelength": 1.8,
        "handletextpad": 0.5,
        "columnspacing": 0.9,
        "labelspacing": 0.25,
        "borderpad": 0.0,
        "frameon": False,
    }
    if own:
        figure.legend(loc="outside lower center", **look)  # type: ignore[arg-type]
    else:
        legend = axes.legend(loc="upper center", borderaxespad=0.0, **look)
        for _ in range(
            3
        ):  # a layout may make room for the legend: the axes are lower then, and the gap another share
            settle(figure)
            box = axes.xaxis.get_tightbbox()
            low = axes.bbox.y0 if box is None else min(box.y0, axes.bbox.y0)
            gap = (low - axes.bbox.y0 - 4.0 * figure.dpi / 72.0) / axes.bbox.height
            legend.set_bbox_to_anchor((0.5, gap), transform=axes.transAxes)
    settle(figure)


def _columns(wide: list[float], room: float) -> int:
    """As many columns, filled one after the other, as fit; not more than leave each row but the last one full."""
    fits = [
        count
        for count in range(1, len(wide) + 1)
        if sum(max(part) for part in np.array_split(np.array(wide), count)) <= room
    ]
    rows = -(-len(wide) // max(fits, default=1))
    return -(-len(wide) // rows)


def _covers(axes: Axes, obstacles: np.ndarray | None) -> bool:
    legend = axes.get_legend()
    if legend is None:
        return False
    box = legend.get_window_extent()
    drawn = [np.column_stack([*line.get_data()]).astype(float) for line in axes.lines]
    further = np.empty((0, 2)) if obstacles is None else obstacles
    x, y = axes.transData.transform(np.vstack([further, *drawn, np.empty((0, 2))])).T
    return bool(np.any((box.x0 <= x) & (x <= box.x1) & (box.y0 <= y) & (y <= box.y1)))
