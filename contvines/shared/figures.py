"""Figures in the package's style that pyplot does not keep; the user's own settings come before the package's.

The options that every picture takes are those of :func:`contvines.plots.diagram.plot_diagram`; methods hand them on to it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

from .near_names import did_you_mean

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


HOUSE = Path(__file__).with_name("house.mplstyle")
STYLES = {path.stem: path for path in Path(__file__).with_name("styles").glob("*.mplstyle")}
"""Styles of ours, by name: journals, print without colours, slides."""
FULL_WIDTH = 6.5  # inches; in narrower figures texts, marks and lines shrink
SMALLEST = 0.72  # but not below this share
WINDOWLESS = ("agg", "cairo", "pdf", "pgf", "ps", "svg", "template")  # backends


@contextmanager
def styled(style: str | Mapping[str, Any] | None = None) -> Iterator[None]:
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


def new_figure(figsize: tuple[float, float] | None = None, **options: Any) -> Figure:
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
    figsize: tuple[float, float] | None
    style: str | Mapping[str, Any] | None


class PlotOptions(FigureOptions, total=False):
    """Of a picture on one pair of axes."""

    axes: Axes | None


class PanelOptions(FigureOptions, total=False):
    """Of a picture on one or several pairs of axes."""

    axes: Axes | Sequence[Axes] | None
