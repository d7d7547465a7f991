"""One graph on some axes: its curves, marks and labels, which are laid out again when the limits change."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bifurcation.kinds import BY_NAME
from ..graph.measures import measure_at, measured, undrawn
from ..graph.proving import mark as proof_of
from ..graph.proving import stretches
from ..graph.shortening import motion_name, short_word
from .curves import Curve
from .figures import scale
from .insets import Region, add_inset, crowded_region, find_room, outlines
from .labels import Label, dense, grouped, place_labels
from .legends import Key, hold_legend
from .style import LINES, PROVED, STATE_COLORS, STATE_OF, STATES, UNRESOLVED, WIDTHS, mark_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..branches.branch import Branch
    from ..graph.graph import Graph

TEXT = 0.85  # size of labels in units of font.size
POINTS, NAMES = (
    (6.5, 0.3),
    (3.5, 0.15),
)  # labels of points and names of branches, and how many more per square inch
FEW = 4.5  # inches: in narrower axes fewer labels stand together


def lay_out_again(axes: Axes) -> None:
    """Place the labels of all graphs on these axes anew, after something else has changed their size."""
    for picture in getattr(axes, "contvines_pictures", []):
        if picture.axes is axes and picture.options[0] is not False:
            picture.lay_out()


class Picture:
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
        self.kinds: Collection[str] | None = None  # that have marks; None: all
        self.spots: list[tuple[str, str, float, float]] = []  # label, kind, x, y
        self.written: list[Any] = []
        self.options: tuple[Any, bool, Any] = (False, False, [])  # no labels yet
        self.inset: Picture | None = None
        self.inset_wanted: bool | Region = False
        self.frame: list[Any] = []  # says what the inset shows
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
            for name in (self.x, self.y):
                measured(branch, name)  # refused in a sentence before anything is drawn
            for first, last, stable in branch.pieces():
                state = STATE_OF[stable] if branch.real else "virtual"
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
                    zorder=2.5 if state in ("unstable", "virtual") else 3,
                )
                self.curves.append(curve)
            self._draw_proved(branch, width)
        if self.color == "word":
            self.key.colors |= words

    def _draw_proved(self, branch: Branch, width: float) -> None:
        """A pale band beneath the stretches of a branch that are proved."""
        px, py = measured(branch, self.x), measured(branch, self.y)
        for points, _ in stretches(self.graph, branch.label):
            style = {"linewidth": 5.0 * width, "solid_capstyle": "butt", "zorder": 1.5}
            self.axes.plot(px[points], py[points], **PROVED, **style)
            self.key.proved = True

    def draw_points(self, ends: bool, kinds: Collection[str] | None = None) -> None:
        """Marks of the special points, all or those of some kinds."""
        import matplotlib as mpl

        self.kinds = kinds
        size = mpl.rcParams["lines.markersize"]
        for point in self.graph.special.values():
            branch = self.graph.branches.get(point.branch)
            if branch is None or (point.kind == "end" and not ends):
                continue
            if kinds is not None and point.kind not in kinds:
                continue
            px, py = measure_at(branch, point, self.x), measure_at(branch, point, self.y)
            if not (np.isfinite(px) and np.isfinite(py)):
                continue  # such as B of a motion without impacts
            mark = mark_of(point.kind, self.graph)
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
            if proof_of(self.graph, point.label):
                look = {"linestyle": "none", "marker": "o", "markeredgewidth": 0.0, "zorder": 5.5}
                self.axes.plot([px], [py], markersize=2.2 * size, **PROVED, **look)
                self.key.proved = True
            self.spots.append((point.label, point.kind, px, py))

    def draw_unresolved(self) -> None:
        """A hollow square round each stretch on which special points cannot be told apart."""
        for entry in self.graph.unresolved:
            branch = self.graph.branches.get(entry.branch)
            if branch is None or not 0 <= entry.index < len(branch):
                continue
            px, py = (float(measured(branch, name)[entry.index]) for name in (self.x, self.y))
            if np.isfinite(px) and np.isfinite(py):
                look: dict[str, Any] = {
                    "marker": UNRESOLVED.marker,
                    "markerfacecolor": "none",
                    "markeredgecolor": "0.4",
                }
                self.axes.plot([px], [py], linestyle="none", markersize=11.0, zorder=5.8, **look)
                self.key.marks.setdefault(UNRESOLVED.name, UNRESOLVED)

    def key_of_marks(self) -> None:
        """Say in the legend what the marks mean that can be seen."""
        for _, kind, px, py in self.spots:
            if self._inside(px, py):
                mark = mark_of(kind, self.graph)
                self.key.marks.setdefault(mark.name, mark)

    def refine(self) -> None:
        for curve in self.curves:
            curve.refine(self.axes)

    def obstacles(self) -> np.ndarray:
        """Points close together along all curves on these axes, so that a label cannot slip between two of them."""
        lines = [
            np.asarray(line.get_xydata(), dtype=float)
            for line in self.axes.lines
            if line.get_transform().contains_branch(self.axes.transData)
        ]
        if self.inset is not None:
            lines += outlines(self.axes, self.frame)
        return np.vstack([np.empty((0, 2)), *(dense(self.axes, xy) for xy in lines if len(xy) > 1)])

    def write_labels(self, labels: bool | Sequence[str], words: bool, taken: list[Any]) -> None:
        """Lay labels out for the limits that the axes have now."""
        self.options = (labels, words, taken)
        for artist in self.written:
            artist.remove()
        chosen = None if isinstance(labels, bool) else list(labels)
        size = self._text()
        places = {kind: i for i, kind in enumerate(BY_NAME)}  # whose labels are named first
        wanted = [
            Label(self._named(label), px, py, "black", places.get(kind, len(places)), chosen is not None)
            for label, kind, px, py in self.spots
            if chosen is None or label in chosen
        ]
        names = self._middles(words, chosen)
        if (inset := self.inset) is not None:  # what the inset names is not named twice
            wanted, names = ([e for e in found if not inset._inside(e.x, e.y)] for found in (wanted, names))
        wanted = [entry for entry in wanted if self._inside(entry.x, entry.y)]
        if chosen is None:
            wanted = grouped(self.axes, wanted, named=3 if self._inches()[0] > FEW else 2)
        others = [p for p in getattr(self.axes, "contvines_pictures", []) if p is not self]
        boxes = [a.get_window_extent() for p in others for a in p.written]
        taken = [*taken, *((b.x0, b.y0, b.x1, b.y1) for b in boxes)]
        if self.inset is not None:
            taken.append(_outer(self.inset.axes))
        wanted = [*self._best(wanted, POINTS), *self._best(names, NAMES)]
        self.written, left_out = place_labels(self.axes, wanted, self.obstacles(), size=size, taken=taken)
        self.left_out = left_out

    def _inches(self) -> tuple[float, float]:
        """Width and height of the axes."""
        figure = self.axes.get_figure(root=True)
        assert figure is not None
        return self.axes.bbox.width / figure.dpi, self.axes.bbox.height / figure.dpi

    def _best(self, labels: list[Label], counts: tuple[float, float]) -> list[Label]:
        """As many labels as the axes have room to be read in, those that matter most."""
        wide, high = self._inches()
        most = int(counts[0] + counts[1] * wide * high)
        chosen = sorted(range(len(labels)), key=lambda i: (not labels[i].kept, labels[i].rank))[:most]
        return [label for i, label in enumerate(labels) if i in chosen or label.kept]

    def show_inset(self, wanted: bool | Region, words: bool) -> None:
        """Draw a crowded place, or the one that is wanted, once more in a free part of the axes."""
        self.inset_wanted = wanted
        self._remove_inset()
        if wanted is False:
            return
        seen = [(px, py) for _, _, px, py in self.spots if self._inside(px, py)]
        region = crowded_region(self.axes, np.array(seen).reshape(-1, 2)) if wanted is True else wanted
        if region is None:
            return
        room = find_room(self.axes, region, self.obstacles(), hold_legend(self.axes))
        if room is None:
            return
        size = 0.8 * self._text()
        axes, self.frame = add_inset(self.axes, region, room, size)
        self.inset = Picture(axes, self.graph, self.x, self.y, self.color, None)
        self.inset.before, self.inset.after, self.inset.first_color = (
            self.before,
            self.after,
            self.first_color,
        )
        self.inset.rc = self.rc
        self.inset.draw_branches()
        self.inset.draw_points(False, self.kinds)
        axes.set(xlim=region[0], ylim=region[1])
        self.inset.refine()
        self.inset.write_labels(True, words, [])

    def _remove_inset(self) -> None:
        for artist in self.frame:
            artist.remove()
        if self.inset is not None:
            self.inset.axes.remove()
        self.inset, self.frame = None, []

    def follow_zoom(self) -> None:
        """Lay out again when the limits of the axes change."""
        for change in ("xlim_changed", "ylim_changed"):
            self.axes.callbacks.connect(change, lambda _: self.lay_out())

    def lay_out(self) -> None:
        """Refine curves and write labels anew for the limits and the size that the axes have now."""
        import matplotlib as mpl

        labels, words, _ = self.options
        with mpl.rc_context(self.rc):
            self.refine()
            self.show_inset(self.inset_wanted is True, words)
            self.write_labels(labels, words, hold_legend(self.axes))

    def _text(self) -> float:
        """Size of the labels, in points."""
        figure = self.axes.get_figure(root=True)
        assert figure is not None
        return TEXT * self.rc["font.size"] * (1.0 if self.rc["font.size"] < 9.0 else scale(figure))

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
                text = motion_name(curve.branch.description)
            tint = "0.25" if self.color == "stability" else self.tint[label]
            found[label] = Label(text, float(xy[i, 0]), float(xy[i, 1]), tint, 0, chosen is not None, True)
        longest = sorted(found, key=lambda label: -lengths[label])
        return [found[label] for label in longest]


def _outer(axes: Axes) -> tuple[float, float, float, float]:
    """The box of axes on the page, with all that stands beside them."""
    box = axes.get_tightbbox()
    assert box is not None
    return box.x0, box.y0, box.x1, box.y1
