"""Figures in the package's style, not registered with pyplot; settings of the user take precedence over the style.

The options common to all pictures are explained in :func:`contvines.plots.diagram.plot_diagram`.
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
"""A style of this package or of matplotlib, or rcParams: see :func:`styled`."""
Size = tuple[float, float] | None
"""Width and height in inches."""

DEFAULT_STYLE = Path(__file__).with_name("house.mplstyle")
STYLES = {path.stem: path for path in Path(__file__).with_name("styles").glob("*.mplstyle")}
"""Styles of this package by name, for journals, print without colours, and slides."""
FULL_WIDTH = 6.5  # inches; in narrower figures texts, marks and lines shrink
NARROW, LOW = 5.5, 3.4  # inches: below this width and height, several panels are arranged differently
SMALLEST = 0.72  # smallest factor by which texts, marks and lines shrink
WINDOWLESS = ("agg", "cairo", "pdf", "pgf", "ps", "svg", "template")  # backends without windows


@contextmanager
def styled(style: Style = None) -> Iterator[None]:
    """Draw in the package's style inside a context; changed rcParams of the user and `style` override it. The rcParams are restored afterwards.

    Parameters
    ----------
    style : str, mapping or None
        A style of :data:`STYLES` ("aps", "elsevier", "springer", "grey", "slides") or of matplotlib, the path of a style sheet, or several
        of these joined by commas ("aps,grey"); or a mapping of rcParams.

    Raises
    ------
    ValueError
        If there is no style of this name.
    """
    import matplotlib as mpl
    from matplotlib.style import context, library

    changes = _changed(mpl.rcParams, mpl.rcParamsDefault)
    chosen: list[Any] = (
        list(map(str.strip, style.split(","))) if isinstance(style, str) else [dict(style or {})]
    )
    with ExitStack() as stack:
        stack.enter_context(context(["default", DEFAULT_STYLE, changes]))
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
    """Return the settings that differ from the defaults, without the backend: reading that would choose one, and import pyplot."""
    names = [name for name in settings if not name.startswith("backend") and name in default]
    return {name: settings[name] for name in names if settings[name] != default[name]}


def shrinking(width: float) -> float:
    """Return the factor by which texts, marks and lines shrink in a figure of a width in inches."""
    return float(min(1.0, max(SMALLEST, width / FULL_WIDTH)))


def new_figure(figsize: Size = None, **options: Any) -> Figure:
    """Return a new figure that is not registered with pyplot, so that notebooks show it once and memory is released.

    If pyplot shows windows, it is a figure of pyplot. In a figure narrower than `FULL_WIDTH` all text is smaller.
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
    mpl.rcParams.update(changed)  # inside `styled`, which restores the settings
    if windows():
        return sys.modules["matplotlib.pyplot"].figure(figsize=figsize, **options)
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure = _picture_class()(figsize=figsize, **options)
    FigureCanvasAgg(figure)
    return figure


def root(axes: Axes) -> Figure:
    """Return the figure of axes, also of axes in a subfigure."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    return figure


def pixels(axes: Axes) -> float:
    """Return the number of pixels per point."""
    return root(axes).dpi / 72.0


def narrower(axes: Axes, inches: float) -> bool:
    """Whether the figure of some axes is narrower than a width in inches."""
    return root(axes).get_figwidth() < inches


@contextmanager
def drawing(axes: Axes | None, style: Style, figsize: Size = None) -> Iterator[tuple[Figure, Axes, bool]]:
    """Yield figure and axes to draw on in a style, and whether they are new; a new figure is laid out at the end."""
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
    """Yield a figure and the panels to draw on in a style; a new figure is laid out at the end.

    Parameters
    ----------
    axes : Axes, sequence of Axes or None
        Axes given by the user; None: a new figure.
    counts : sequence of int
        Allowed numbers of given axes.
    what : str
        Beginning of the error message for another number.
    figsize, style
        Of a new figure.
    wide, narrow : mapping
        Arguments of `subplot_mosaic` for a new figure; the panels are returned in the order of their names. `narrow` is for figures narrower
        than `NARROW`; a figure that is lower than `LOW`, too, has the first panel only.

    Raises
    ------
    ValueError
        If the number of given axes is not allowed.
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
        width, height = figure.get_size_inches()
        small = narrow is not None and width < NARROW
        chosen: Mapping[str, Any] = (narrow or {}) if small else wide
        drawn: dict[Any, Axes] = figure.subplot_mosaic(
            **({"mosaic": "a"} if small and height < LOW else chosen)
        )
        _prepare(*drawn.values())
        yield figure, [drawn[name] for name in sorted(drawn)]
        if not is_frozen(figure):
            fit(figure)


def fit(figure: Figure) -> None:
    """Lay out a figure made here: long labels are broken into lines, ticks whose labels would touch are thinned out."""
    _prepare(*(axes for axes in figure.axes if not axes.yaxis.label.get_wrap()))
    settle(figure)
    for axes in figure.axes:  # the layout leaves too much room for labels that may be broken
        for label, room in ((axes.xaxis.label, axes.bbox.width), (axes.yaxis.label, axes.bbox.height)):
            label.set_wrap(False)
            label.set_wrap(bool(max(label.get_window_extent().size) > room))
    settle(figure)
    thin_ticks(*figure.axes)


def finish_layout(figure: Figure, own: bool) -> None:
    """Compute the final positions of all axes, before labels are placed; a figure made here (`own`) keeps them, unless it is shown in a window."""
    if own:
        fit(figure)
        if not windows():
            figure.set_layout_engine("none")
    settle(figure)


def _prepare(*drawn: Axes) -> None:
    """Allow long axis labels to wrap, and fix the size of tick labels, so that the number of ticks does not change with later rcParams."""
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
    """Reduce the number of ticks where their labels would touch; call `settle` first."""
    from matplotlib.ticker import MaxNLocator

    for axes in drawn:
        for axis, side in ((axes.xaxis, 0), (axes.yaxis, 1)):
            for count in (6, 5, 4, 3, 2):
                if not isinstance(axis.get_major_locator(), MaxNLocator) or not _crowded(axis, side):
                    break
                axis.set_major_locator(MaxNLocator(count, steps=[1, 2, 2.5, 5, 10]))
                settle(root(axes))


def _crowded(axis: Axis, side: int) -> bool:
    """Whether labels of neighbouring ticks overlap, or (horizontally) are less than 0.6 of a letter's height apart."""
    low, high = sorted(axis.get_view_interval())
    slack = 1e-9 * (high - low)
    ticks = [tick for tick in axis.get_major_ticks() if low - slack <= tick.get_loc() <= high + slack]
    labels = [tick.label1 for tick in ticks if tick.label1.get_text() and tick.label1.get_visible()]
    boxes = [label.get_window_extent() for label in labels]
    ends = sorted(tuple(box.intervaly if side else box.intervalx) for box in boxes)
    room = 0.0 if side else 0.6 * min((box.height for box in boxes), default=0.0)
    return any(after[0] - before[1] < room for before, after in itertools.pairwise(ends))


def settle(figure: Figure) -> None:
    """Compute the positions of all artists if the figure has changed since the last time."""
    if figure.stale:
        figure.draw_without_rendering()


def legend_below(axes: Axes, handles: Sequence[Artist], own: bool) -> None:
    """Draw a small legend with as many columns as fit: at the bottom of a figure made here, otherwise below the axes.

    Parameters
    ----------
    axes : Axes
        Their present legend is removed.
    handles : sequence of Artist
        With labels.
    own : bool
        Whether the figure was made by `new_figure`.
    """
    from matplotlib import rcParams
    from matplotlib.font_manager import FontProperties

    figure, before = root(axes), axes.get_legend()
    if before is not None:
        before.remove()
    if not handles:
        return
    size = 0.92 * FontProperties(size=rcParams["legend.fontsize"]).get_size_in_points()
    options: dict[str, Any] = {"handles": handles, "borderpad": 0.0, "frameon": False, "fontsize": size}
    options |= {"handlelength": 1.8, "handletextpad": 0.5, "columnspacing": 0.9, "labelspacing": 0.25}
    if own:
        place, room = {"loc": "outside lower center"}, figure.bbox.width
    else:
        settle(figure)
        place, room = {"loc": "upper center", "borderaxespad": 0.0}, axes.bbox.width
    columns, rows = len(handles), 1
    legend = (figure if own else axes).legend(ncols=columns, **place, **options)
    while legend.get_window_extent().width > room and columns > 1:
        legend.remove()
        rows += 1
        columns = -(-len(handles) // rows)
        legend = (figure if own else axes).legend(ncols=columns, **place, **options)
    settle(figure)
    for _ in range(0 if own else 3):  # the layout lowers the axes for the legend, which moves it again
        box = axes.xaxis.get_tightbbox()
        low = axes.bbox.y0 if box is None else min(box.y0, axes.bbox.y0)
        gap = (low - axes.bbox.y0 - 4.0 * figure.dpi / 72.0) / axes.bbox.height
        legend.set_bbox_to_anchor((0.5, gap), transform=axes.transAxes)
        settle(figure)


def windows() -> bool:
    """Whether pyplot is imported and shows its figures in windows (notebooks do not)."""
    if "matplotlib.pyplot" not in sys.modules:
        return False
    backend = sys.modules["matplotlib.pyplot"].get_backend().lower()
    return backend not in WINDOWLESS and "inline" not in backend


def _picture_class() -> type[Figure]:
    from matplotlib.figure import Figure

    class Picture(Figure):
        """A figure that a notebook displays even if pyplot has not been imported."""

        def _repr_png_(self) -> bytes:
            buffer = BytesIO()
            self.savefig(buffer, format="png", dpi=110)
            return buffer.getvalue()

    return Picture


class FigureOptions(TypedDict, total=False):
    """Options of all pictures."""

    legend: bool | str
    figsize: Size
    style: Style


class PlotOptions(FigureOptions, total=False):
    """Options of pictures on one pair of axes."""

    axes: Axes | None


class PanelOptions(FigureOptions, total=False):
    """Options of pictures on one or several pairs of axes."""

    axes: Axes | Sequence[Axes] | None
