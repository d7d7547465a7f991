"""Figures in the package's style that pyplot does not keep; the user's own settings come before the package's.

The options that every picture takes are those of :func:`contvines.plots.diagram.plot_diagram`; methods hand them on to it.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np

from .near_names import did_you_mean

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure


Style = str | Mapping[str, Any] | None
"""A style of ours or of matplotlib's, or rcParams: see :func:`styled`."""
Size = tuple[float, float] | None
"""Inches across and upright."""

HOUSE = Path(__file__).with_name("house.mplstyle")
STYLES = {path.stem: path for path in Path(__file__).with_name("styles").glob("*.mplstyle")}
"""Styles of ours, by name: journals, print without colours, slides."""
FULL_WIDTH = 6.5  # inches; in narrower figures texts, marks and lines shrink
NARROW, LOW = 5.5, 3.4  # inches: of a picture with several panels
SMALLEST = 0.72  # but not below this share
WINDOWLESS = ("agg", "cairo", "pdf", "pgf", "ps", "svg", "template")  # backends


@contextmanager
def styled(style: Style = None) -> Iterator[None]:
    """Draw in the package's style; what the user has set, and `style`, come before it; settings stay as they were.

    Parameters
    ----------
    style : str, mapping or None
        A name of :data:`STYLES` ("aps", "elsevier", "springer", "grey", "slides") or of matplotlib's styles, the path of a
        style sheet, or several of these joined by commas, "aps,grey"; or rcParams.

    Raises
    ------
    ValueError
        If there is no style of this name.
    """
    import matplotlib as mpl
    from matplotlib.style import context, library

    own = _changed(mpl.rcParams, mpl.rcParamsDefault)
    chosen: list[Any] = (
        list(map(str.strip, style.split(","))) if isinstance(style, str) else [dict(style or {})]
    )
    with ExitStack() as stack:
        stack.enter_context(context(["default", HOUSE, own]))
        for name in chosen:
            try:
                stack.enter_context(context(STYLES.get(name, name) if isinstance(name, str) else name))
            except OSError:
                raise ValueError(
                    f"style {name!r}: there is no such style or file{did_you_mean(name, [*STYLES, *library])}; "
                    f"choose from {', '.join(sorted(STYLES))}, a style of matplotlib's, or the path of a style sheet."
                ) from None
        yield


def _changed(settings: Mapping[Any, object], default: Mapping[Any, object]) -> dict[str, object]:
    """The settings that are not the defaults; reading the backend would choose one, which imports pyplot."""
    names = [name for name in settings if not name.startswith("backend") and name in default]
    return {name: settings[name] for name in names if settings[name] != default[name]}


def shrinking(width: float) -> float:
    """By how much texts, marks and lines shrink in a figure of a width in inches, below `FULL_WIDTH`."""
    return float(min(1.0, max(SMALLEST, width / FULL_WIDTH)))


def new_figure(figsize: Size = None, **options: Any) -> Figure:
    """A figure that pyplot does not keep: notebooks show it once, as the value of a cell, and nothing piles up.

    Where pyplot shows windows it is one of pyplot's. In a figure narrower than `FULL_WIDTH` all text is smaller.
    """
    import matplotlib as mpl

    smaller = shrinking((figsize or mpl.rcParams["figure.figsize"])[0])
    changed: dict[Any, Any] = {
        name: mpl.rcParams[name] * smaller
        for name in ("font.size", "lines.linewidth", "lines.markersize", "axes.linewidth")
    } | {
        name: mpl.rcParams[name] * smaller
        for name in ("axes.labelsize", "axes.titlesize", "legend.fontsize")
        if isinstance(mpl.rcParams[name], int | float)
    }
    mpl.rcParams.update(changed)  # inside `styled`, which puts everything back
    if windows():
        return sys.modules["matplotlib.pyplot"].figure(figsize=figsize, **options)
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    made = _picture_class()(figsize=figsize, **options)
    FigureCanvasAgg(made)
    return made


def root(axes: Axes) -> Figure:
    """The figure that axes stand on, also where they are in a part of it."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    return figure


def pixels(axes: Axes) -> float:
    """Pixels per point."""
    return root(axes).dpi / 72.0


def narrower(axes: Axes, inches: float) -> bool:
    """Whether the figure of some axes is narrower than that."""
    return root(axes).get_figwidth() < inches


@contextmanager
def drawing(axes: Axes | None, style: Style, figsize: Size = None) -> Iterator[tuple[Figure, Axes, bool]]:
    """Figure and axes to draw on in a style, and whether they are new: new ones are given their place at the end."""
    with panels(axes, (1,), "this is drawn on", figsize, style, {"mosaic": "a"}) as (figure, (drawn,)):
        yield figure, drawn, axes is None


@contextmanager
def panels(
    axes: Axes | Sequence[Axes] | None,
    counts: Sequence[int],
    what: str,
    figsize: Size,
    style: Style,
    wide: Mapping[str, Any],
    narrow: Mapping[str, Any] | None = None,
) -> Iterator[tuple[Figure, list[Axes]]]:
    """A figure and the panels to draw on in a style; new ones are given their place at the end.

    Parameters
    ----------
    axes : those that the user gives, or None for a new figure
    counts : how many may be given
    what : the beginning of the sentence that refuses another number
    figsize, style
        Of a new figure.
    wide, narrow : mapping
        Arguments of `subplot_mosaic` in a new figure; the panels come in the order of their names. With `narrow` a narrow figure
        has these, and one that is low, too, has room for the first one alone.

    Raises
    ------
    ValueError
        If `axes` are not one of so many.
    """
    with styled(style):
        if axes is not None:
            given: list[Axes] = list(np.atleast_1d(np.asarray(axes, dtype=object)))
            if len(given) not in counts:
                wanted = " or ".join(map(str, counts))
                raise ValueError(
                    f"axes: {what} {wanted} axes, not {len(given)}; for example plt.subplots(1, {counts[-1]})[1]"
                )
            yield root(given[0]), given
            return
        figure = new_figure(figsize=figsize)
        across, up = figure.get_size_inches()
        small = narrow is not None and across < NARROW
        chosen: Mapping[str, Any] = (narrow or {}) if small else wide
        made: dict[Any, Axes] = figure.subplot_mosaic(**({"mosaic": "a"} if small and up < LOW else chosen))
        _prepare(*made.values())
        yield figure, [made[name] for name in sorted(made)]
        if not is_frozen(figure):
            fit(figure)


def fit(figure: Figure, frozen: bool = False) -> None:
    """Give all in a figure of ours its place: long labels on several lines, fewer ticks where their labels would touch.

    What is `frozen` is not laid out again, unless it is in a window.
    """
    _prepare(*(axes for axes in figure.axes if not axes.yaxis.label.get_wrap()))
    settle(figure)
    thin_ticks(*figure.axes)
    if frozen and not windows():
        figure.set_layout_engine("none")


def _prepare(*drawn: Axes) -> None:
    """Let long labels have several lines; how many ticks there are must not change when a figure is drawn again elsewhere."""
    from matplotlib import rcParams
    from matplotlib.font_manager import FontProperties

    for axes in drawn:
        sizes = rcParams["xtick.labelsize"], rcParams["ytick.labelsize"]
        for axis, size in zip((axes.xaxis, axes.yaxis), sizes):
            axis.label.set_wrap(True)
            axis.set_tick_params(labelsize=FontProperties(size=size).get_size_in_points())


def is_frozen(figure: Figure) -> bool:
    from matplotlib.layout_engine import PlaceHolderLayoutEngine

    return isinstance(figure.get_layout_engine(), PlaceHolderLayoutEngine)


def thin_ticks(*drawn: Axes) -> None:
    """Fewer ticks where their labels would touch; the figure must have been settled."""
    from matplotlib.ticker import MaxNLocator

    for axes in drawn:
        for axis, side in ((axes.xaxis, 0), (axes.yaxis, 1)):
            for count in (6, 5, 4, 3, 2):
                if not isinstance(axis.get_major_locator(), MaxNLocator) or not _crowded(axis, side):
                    break
                axis.set_major_locator(MaxNLocator(count, steps=[1, 2, 2.5, 5, 10]))
                settle(root(axes))


def _crowded(axis: Axis, side: int) -> bool:
    """Whether labels of neighbouring ticks are less than a good half of a letter apart."""
    low, high = sorted(axis.get_view_interval())
    slack = 1e-9 * (high - low)
    ticks = [tick for tick in axis.get_major_ticks() if low - slack <= tick.get_loc() <= high + slack]
    labels = [tick.label1 for tick in ticks if tick.label1.get_text() and tick.label1.get_visible()]
    boxes = [label.get_window_extent() for label in labels]
    ends = sorted(tuple(box.intervaly if side else box.intervalx) for box in boxes)
    room = 0.0 if side else 0.6 * min((box.height for box in boxes), default=0.0)
    return any(after[0] - before[1] < room for before, after in itertools.pairwise(ends))


def settle(figure: Figure) -> None:
    """Give everything its place, unless nothing has changed since that was done."""
    if figure.stale:
        figure.draw_without_rendering()


def legend_below(axes: Axes, handles: Sequence[Artist], own: bool) -> None:
    """A small legend in as many columns as find room: under everything in a figure of ours, else under the axes.

    Parameters
    ----------
    axes : Axes
        A legend that they have goes.
    handles : sequence of Artist
        With labels.
    own : bool
        Whether the figure is ours to be laid out.
    """
    from matplotlib import rcParams
    from matplotlib.font_manager import FontProperties

    figure, before = root(axes), axes.get_legend()
    if before is not None:
        before.remove()
    if not handles:
        return
    size = 0.92 * FontProperties(size=rcParams["legend.fontsize"]).get_size_in_points()
    look: dict[str, Any] = {"handles": handles, "borderpad": 0.0, "frameon": False, "fontsize": size}
    look |= {"handlelength": 1.8, "handletextpad": 0.5, "columnspacing": 0.9, "labelspacing": 0.25}
    if own:
        place, room = {"loc": "outside lower center"}, figure.bbox.width
    else:
        settle(figure)
        place, room = {"loc": "upper center", "borderaxespad": 0.0}, axes.bbox.width
    columns, rows = len(handles), 1
    legend = (figure if own else axes).legend(ncols=columns, **place, **look)
    while legend.get_window_extent().width > room and columns > 1:
        legend.remove()
        rows += 1
        columns = -(-len(handles) // rows)
        legend = (figure if own else axes).legend(ncols=columns, **place, **look)
    settle(figure)
    for _ in range(0 if own else 3):  # a layout that makes room for the legend makes the axes lower
        box = axes.xaxis.get_tightbbox()
        low = axes.bbox.y0 if box is None else min(box.y0, axes.bbox.y0)
        gap = (low - axes.bbox.y0 - 4.0 * figure.dpi / 72.0) / axes.bbox.height
        legend.set_bbox_to_anchor((0.5, gap), transform=axes.transAxes)
        settle(figure)


def windows() -> bool:
    """Whether the user's session shows pyplot's figures in windows (notebooks show what is returned)."""
    if "matplotlib.pyplot" not in sys.modules:
        return False
    backend = sys.modules["matplotlib.pyplot"].get_backend().lower()
    return backend not in WINDOWLESS and "inline" not in backend


def _picture_class() -> type[Figure]:
    from matplotlib.figure import Figure

    class Picture(Figure):
        """A figure that shows itself in a notebook, whether or not pyplot has been imported there."""

        def _repr_png_(self) -> bytes:
            buffer = BytesIO()
            self.savefig(buffer, format="png", dpi=110)
            return buffer.getvalue()

    return Picture


class FigureOptions(TypedDict, total=False):
    """Of any picture."""

    legend: bool | str
    figsize: Size
    style: Style


class PlotOptions(FigureOptions, total=False):
    """Of a picture on one pair of axes."""

    axes: Axes | None


class PanelOptions(FigureOptions, total=False):
    """Of a picture on one or several pairs of axes."""

    axes: Axes | Sequence[Axes] | None
