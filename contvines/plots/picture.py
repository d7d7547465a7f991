"""One graph on some axes: its curves, marks and labels, which are laid out again when the limits change."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

import numpy as np

from contvines.shared.figures import shrinking

from ..bifurcation.kinds import BY_NAME
from ..graph.contents import proof_mark as proof_of
from ..graph.contents import proved_stretches
from ..graph.stretches import measure_at, measured, undrawn
from ..graph.table import motion_name, told_apart
from .curves import Curve
from .figures import pixels, root
from .labels import (
    Box,
    Label,
    Region,
    add_inset,
    crowded_region,
    dense,
    find_room,
    grouped,
    outlines,
    place_labels,
)
from .legends import Key, hold_legend
from .style import PROVED, STATE_COLORS, STATE_OF, STATES, UNRESOLVED, line_of, mark_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.inset import InsetIndicator
    from matplotlib.text import Annotation

    from ..graph.graph import Graph

TEXT = 0.85  # size of labels in units of font.size
POINTS, NAMES = (
    (6.5, 0.3),
    (3.5, 0.15),
)  # labels of points, names of branches: so many, and more per square inch
FEW = 4.5  # inches: in narrower axes fewer labels stand together


def pictures_on(axes: Axes) -> list[Picture]:
    """The graphs drawn on some axes."""
    return [picture for picture in getattr(axes, "contvines_pictures", []) if picture.axes is axes]


def lay_out_again(axes: Axes) -> None:
    """Place the labels of all graphs on these axes anew, after something else has changed their size."""
    for picture in pictures_on(axes):
        if picture.labels is not False:
            picture.lay_out()


class Picture:
    """One graph on some axes: its curves, marks and labels, which are laid out again when the limits change."""

    def __init__(self, axes: Axes, graph: Graph, x: str, y: str, color: str, name: str | None) -> None:
        from matplotlib import rcParams

        self.axes, self.graph, self.x, self.y, self.color = axes, graph, x, y, color
        known = pictures_on(axes)
        axes.contvines_pictures = [*known, self]  # type: ignore[attr-defined]
        self.before, self.after = (f"{name} ", "") if name else ("", "′" * len(known))
        self.first_color = sum(len(picture.graph.branches) for picture in known)
        self.rc = rcParams.copy()
        self.key = Key(remarks=[remark] if (remark := undrawn(graph, x, y)) else [])
        self.curves: list[Curve] = []
        self.tint: dict[str, str] = {}
        self.kinds: Collection[str] | None = None  # that have marks; None: all
        self.spots: list[tuple[str, str, float, float]] = []  # label, kind, x, y
        self.written: list[Annotation] = []
        self.labels: bool | Sequence[str] = False  # those that were written last
        self.words = False
        self.inset: Picture | None = None
        self.inset_wanted: bool | Region = False
        self.frame: InsetIndicator | None = None  # says what the inset shows

    def draw_branches(self) -> None:
        """Each branch as curves, a run of points in one state after the other; a pale band beneath what is proved."""
        from matplotlib import rcParams

        colors = [entry.get("color", "black") for entry in rcParams["axes.prop_cycle"]]
        words: dict[str, str] = {}
        for i, branch in enumerate(self.graph.branches.values(), self.first_color):
            tint = colors[i % len(colors)]
            if self.color == "word":
                word = str(branch.description.get("word") or branch.description.get("name", ""))
                tint = words.setdefault(word, colors[len(words) % len(colors)])
            self.tint[branch.label] = tint
            xs, ys = (measured(branch, name) for name in (self.x, self.y))  # or refused in a sentence
            for first, last, stable in branch.pieces():
                state = STATE_OF[stable] if branch.real else "virtual"
                self.key.states.setdefault(state, None)
                if self.color == "stability":
                    tint = self.key.colors[STATES[state]] = STATE_COLORS[state]
                curve = Curve(branch, self.x, self.y, first, last)
                behind = state in ("unstable", "virtual")
                curve.draw(self.axes, {"zorder": 2.5 if behind else 3, **line_of(state, tint)})
                self.curves.append(curve)
            for points, _ in proved_stretches(self.graph, branch.label):
                width = 5.0 * float(rcParams["lines.linewidth"])
                band = {"linewidth": width, "solid_capstyle": "butt", "zorder": 1.5, **PROVED}
                self.axes.plot(xs[points], ys[points], **band)
                self.key.proved = True
        if self.color == "word":
            short = told_apart(words)
            self.key.colors |= {short[word]: tint for word, tint in words.items()}

    def draw_points(self, ends: bool, kinds: Collection[str] | None = None) -> None:
        """Marks of the special points, all or those of some kinds."""
        from matplotlib import rcParams

        self.kinds, size = kinds, float(rcParams["lines.markersize"])
        for point in self.graph.special.values():
            branch = self.graph.branches.get(point.branch)
            if branch is None or (point.kind == "end" and not ends):
                continue
            if kinds is not None and point.kind not in kinds:
                continue
            px, py = measure_at(branch, point, self.x), measure_at(branch, point, self.y)
            if not (np.isfinite(px) and np.isfinite(py)):
                continue  # such as B of a motion without impacts
            tint = "0.15" if self.color == "stability" else self.tint[branch.label]
            self.axes.plot([px], [py], zorder=6, **mark_of(point.kind, self.graph).look(tint, size))
            if proof_of(self.graph, point.label):
                look = {"linestyle": "none", "marker": "o", "markeredgewidth": 0.0, "zorder": 5.5, **PROVED}
                self.axes.plot([px], [py], markersize=2.2 * size, **look)
                self.key.proved = True
            self.spots.append((point.label, point.kind, px, py))

    def draw_unresolved(self) -> None:
        """A hollow square round each stretch on which special points cannot be distinguished."""
        for entry in self.graph.unresolved:
            branch = self.graph.branches.get(entry.branch)
            if branch is None or not 0 <= entry.index < len(branch):
                continue
            px, py = (float(measured(branch, name)[entry.index]) for name in (self.x, self.y))
            if np.isfinite(px) and np.isfinite(py):
                look = UNRESOLVED.look("0.4", 11.0) | {"markerfacecolor": "none", "markeredgewidth": 1.0}
                self.axes.plot([px], [py], zorder=5.8, **look)
                self.key.marks.setdefault(UNRESOLVED.name, UNRESOLVED)

    def key_of_marks(self) -> None:
        """Say in the legend what the marks mean that can be seen."""
        for _, kind, px, py in self.spots:
            if self._inside(px, py):
                mark = mark_of(kind, self.graph)
                self.key.marks.setdefault(mark.name, mark)

    def refine(self) -> None:
        """Put points between the stored ones where lines have corners."""
        for curve in self.curves:
            curve.refine(self.axes)

    def obstacles(self) -> np.ndarray:
        """Points close together along all curves on these axes, so that a label cannot slip between two of them."""
        data = self.axes.transData
        lines = [line for line in self.axes.lines if line.get_transform().contains_branch(data)]
        found = [np.asarray(line.get_xydata(), dtype=float) for line in lines]
        if self.inset is not None and self.frame is not None:
            found += outlines(self.axes, self.inset.axes, self.frame)
        return np.vstack([np.empty((0, 2)), *(dense(self.axes, xy) for xy in found if len(xy) > 1)])

    def write_labels(self, labels: bool | Sequence[str], words: bool, taken: Sequence[Box]) -> None:
        """Lay labels out for the limits that the axes have now."""
        self.labels, self.words = labels, words
        for artist in self.written:
            artist.remove()
        chosen = None if isinstance(labels, bool) else list(labels)
        places = {kind: i for i, kind in enumerate(BY_NAME)}  # whose labels are named first
        wanted = [
            Label(self._named(label), px, py, "black", places.get(kind, len(places)), chosen is not None)
            for label, kind, px, py in self.spots
            if self._inside(px, py) and (chosen is None or label in chosen)
        ]
        names = self._middles(words, chosen)
        boxes = [
            text.get_window_extent()
            for other in pictures_on(self.axes)
            if other is not self
            for text in other.written
        ]
        if (inset := self.inset) is not None:  # what the inset names is not named twice
            wanted, names = ([e for e in found if not inset._inside(e.x, e.y)] for found in (wanted, names))
            boxes += [box for box in [inset.axes.get_tightbbox()] if box is not None]
        if chosen is None:
            narrow = self.axes.bbox.width < FEW * 72.0 * pixels(self.axes)
            wanted = grouped(self.axes, wanted, named=2 if narrow else 3)
        wanted = [*self._best(wanted, POINTS), *self._best(names, NAMES)]
        taken = [*taken, *(box.extents for box in boxes)]
        self.written = place_labels(self.axes, wanted, self.obstacles(), size=self._text(), taken=taken)

    def _best(self, labels: list[Label], counts: tuple[float, float]) -> list[Label]:
        """As many labels as the axes have room to be read in, those that matter most."""
        wide, high = np.ptp(self.axes.bbox.get_points(), axis=0) / (72.0 * pixels(self.axes))
        most = int(counts[0] + counts[1] * wide * high)
        chosen = sorted(range(len(labels)), key=lambda i: (not labels[i].kept, labels[i].rank))[:most]
        return [label for i, label in enumerate(labels) if i in chosen or label.kept]

    def show_inset(self, wanted: bool | Region, words: bool) -> None:
        """Draw a crowded place, or the one that is wanted, once more in a free part of the axes."""
        self.inset_wanted = wanted
        if self.inset is not None and self.frame is not None:
            self.frame.remove()
            self.inset.axes.remove()
        self.inset = self.frame = None
        if wanted is False:
            return
        seen = [(px, py) for _, _, px, py in self.spots if self._inside(px, py)]
        region = crowded_region(self.axes, np.array(seen).reshape(-1, 2)) if wanted is True else wanted
        if region is None:
            return
        room = find_room(self.axes, region, self.obstacles(), hold_legend(self.axes))
        if room is None:
            return
        axes, self.frame = add_inset(self.axes, region, room, 0.8 * self._text())
        self.inset = Picture(axes, self.graph, self.x, self.y, self.color, None)
        self.inset.before, self.inset.after, self.inset.rc = self.before, self.after, self.rc
        self.inset.first_color = self.first_color
        self.inset.draw_branches()
        self.inset.draw_points(False, self.kinds)
        axes.set(xlim=region[0], ylim=region[1])
        self.inset.refine()
        self.inset.write_labels(True, words, [])

    def follow_zoom(self) -> None:
        """Lay out again when the limits of the axes change."""
        for change in ("xlim_changed", "ylim_changed"):
            self.axes.callbacks.connect(change, lambda _: self.lay_out())

    def lay_out(self) -> None:
        """Refine curves and write labels anew for the limits and the size that the axes have now."""
        from matplotlib import rc_context

        with rc_context(self.rc):
            self.refine()
            self.show_inset(self.inset_wanted is True, self.words)
            self.write_labels(self.labels, self.words, hold_legend(self.axes))

    def _text(self) -> float:
        """Size of the labels, in points."""
        size = float(self.rc["font.size"])
        return TEXT * size * (1.0 if size < 9.0 else shrinking(root(self.axes).get_size_inches()[0]))

    def _named(self, label: str) -> str:
        return f"{self.before}{label}{self.after}"

    def _inside(self, x: float, y: float) -> bool:
        (x0, x1), (y0, y1) = sorted(self.axes.get_xlim()), sorted(self.axes.get_ylim())
        return x0 <= x <= x1 and y0 <= y <= y1

    def _middles(self, words: bool, chosen: list[str] | None) -> list[Label]:
        """A point halfway along what is seen of each branch, for its name; the longest first."""
        if len(self.graph.branches) < 2 and not words and chosen is None:
            return []
        found: dict[str, tuple[float, Label]] = {}
        low, high = self.axes.bbox.get_points()
        for curve in self.curves:
            label = curve.branch.label
            if not curve.lines or (chosen is not None and label not in chosen):
                continue
            xy = np.asarray(curve.lines[0].get_xydata(), dtype=float)
            page = self.axes.transData.transform(xy)
            inside = np.all((low <= page) & (page <= high), axis=1)
            steps = np.nan_to_num(np.hypot(*np.diff(page, axis=0).T)) * (inside[1:] & inside[:-1])
            total = np.concatenate([[0.0], np.cumsum(steps)])
            if total[-1] < 12 or (label in found and total[-1] <= found[label][0]):
                continue
            x, y = xy[
                np.searchsorted(total, 0.5 * total[-1])
            ].tolist()  # never at a gap: nothing is added there
            text = motion_name(curve.branch.description) if words else self._named(label)
            tint = "0.25" if self.color == "stability" else self.tint[label]
            found[label] = float(total[-1]), Label(text, x, y, tint, 0, chosen is not None, True)
        return [label for _, label in sorted(found.values(), key=lambda entry: -entry[0])]
