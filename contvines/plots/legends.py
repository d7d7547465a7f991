"""The legend of a diagram: what its lines and marks mean, once per axes, in a place that hides nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from contvines.shared.near_names import did_you_mean

from .figures import narrower, pixels, root, settle
from .labels import Box, text_widths
from .style import PROVED, STATES, Mark, line_of

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.transforms import Bbox

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

    def handles(self) -> list[Artist]:
        """Artists for the entries, in order."""
        from matplotlib import rcParams
        from matplotlib.lines import Line2D

        width, size = float(rcParams["lines.linewidth"]), float(rcParams["lines.markersize"])
        found: list[Artist] = []
        for state, name in STATES.items():
            if state in self.states:
                found.append(Line2D([], [], label=name, **line_of(state, self.colors.get(name, "0.2"))))
        for name, color in self.colors.items():
            if name not in STATES.values():
                found.append(Line2D([], [], color=color, linewidth=width, label=name))
        for mark in self.marks.values():
            found.append(Line2D([], [], label=mark.name, **mark.look("0.2", 0.9 * size)))
        if self.proved:
            found.append(Line2D([], [], label="proved", linewidth=4 * width, solid_capstyle="butt", **PROVED))
        return [*found, *(Line2D([], [], linestyle="none", label=text) for text in self.remarks)]


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
    pairs = [] if before is None else zip(before.get_texts(), before.legend_handles, strict=False)
    known = {text.get_text(): handle for text, handle in pairs if handle is not None}
    for handle in (*key.handles(), *axes.get_legend_handles_labels()[0]):
        known.setdefault(str(handle.get_label()), handle)
    place_legend(axes, list(known.values()), where, own, obstacles, remarks=key.remarks)


def place_legend(
    axes: Axes,
    handles: Sequence[Artist] | None,
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
        Artists with labels; None: those of the axes.
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

    handles = axes.get_legend_handles_labels()[0] if handles is None else list(handles)
    if where is False or not handles:
        return
    figure, known = root(axes), [*PLACES, *Legend.codes]
    if isinstance(where, str) and where not in known:
        raise ValueError(
            f"legend = {where!r} is unknown{did_you_mean(where, known)}; choose of {', '.join(known)}"
        )
    place = "inside" if not own else "below" if narrower(axes, NARROW) else usual
    place = where if isinstance(where, str) else place
    if place == "below":
        _below(axes, handles, own, remarks)
        return
    legend = axes.legend(handles=handles, handlelength=2.4, loc=Legend.codes.get(place, Legend.codes["best"]))
    if place not in PLACES:
        return
    settle(figure)
    if place == "beside" or (where is True and own and _covers(legend.get_window_extent(), axes, obstacles)):
        legend.set_loc("upper left")
        legend.set_bbox_to_anchor((1.01, 1.0), transform=axes.transAxes)
        engine = figure.get_layout_engine()
        if own and isinstance(engine, ConstrainedLayoutEngine):
            engine.set(w_pad=0.09)  # inches: texts are a little wider at the resolution of a file
        settle(figure, 2)  # the axes become narrower, and then their ticks fewer


def hold_legend(axes: Axes) -> list[Box]:
    """Keep the legend where it is now, whatever is written later; its box on the page."""
    legend = axes.get_legend()
    if legend is None:
        return []
    box = legend.get_window_extent()
    left, low = axes.transAxes.inverted().transform(box.min).tolist()
    legend.set_bbox_to_anchor(None)
    legend.set_loc((left, low))
    return [box.extents]


def _below(axes: Axes, handles: list[Artist], own: bool, remarks: Sequence[str]) -> None:
    """Under the axes, small, in as many columns as fit the figure; remarks go to the axis's label."""
    from matplotlib import rcParams
    from matplotlib.font_manager import FontProperties

    figure, before = root(axes), axes.get_legend()
    axes.set_xlabel("\n".join([axes.get_xlabel(), *remarks]))
    handles = [entry for entry in handles if entry.get_label() not in remarks]
    if before is not None:
        before.remove()
    if not handles:
        return
    size = 0.92 * FontProperties(size=rcParams["legend.fontsize"]).get_size_in_points()
    texts = [str(entry.get_label()) for entry in handles]
    drawn = text_widths(set(texts), size)
    wide = [drawn[text] + 3.4 * size for text in texts]  # with the sample and the gaps beside it
    room = (figure.bbox if own else axes.bbox).width / pixels(axes)
    look = {"borderpad": 0.0, "frameon": False, "handlelength": 1.8, "handletextpad": 0.5}
    look |= {"ncols": _columns(wide, room), "fontsize": size, "columnspacing": 0.9, "labelspacing": 0.25}
    if own:
        figure.legend(handles=handles, loc="outside lower center", **look)
    else:
        legend = axes.legend(handles=handles, loc="upper center", borderaxespad=0.0, **look)
        for _ in range(3):  # a layout that makes room for the legend makes the axes lower
            settle(figure)
            box = axes.xaxis.get_tightbbox()
            low = axes.bbox.y0 if box is None else min(box.y0, axes.bbox.y0)
            gap = (low - axes.bbox.y0 - 4.0 * pixels(axes)) / axes.bbox.height
            legend.set_bbox_to_anchor((0.5, gap), transform=axes.transAxes)
    settle(figure)


def _columns(wide: list[float], room: float) -> int:
    """As many columns, filled one after the other, as fit; not more than leave each row but the last one full."""
    counts = range(1, len(wide) + 1)
    fits = [n for n in counts if sum(map(max, np.array_split(np.array(wide), n))) <= room]
    rows = -(-len(wide) // max(fits, default=1))
    return -(-len(wide) // rows)


def _covers(box: Bbox, axes: Axes, obstacles: np.ndarray | None) -> bool:
    """Whether a box on the page covers lines of the axes, or obstacles in data coordinates."""
    drawn = [np.column_stack([*line.get_data()]).astype(float) for line in axes.lines]
    further = np.empty((0, 2)) if obstacles is None else obstacles
    page = axes.transData.transform(np.vstack([further, *drawn]))
    low, high = box.get_points()
    return bool(np.any(np.all((low <= page) & (page <= high), axis=1)))
