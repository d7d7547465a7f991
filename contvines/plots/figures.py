"""How a figure is made, given its place and saved; the user's own settings come before the house's."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HOUSE = Path(__file__).with_name("contvines.mplstyle")
FORMATS = ("png", "pdf", "svg", "jpg", "eps")
FULL_WIDTH = 6.5  # inches; in narrower figures texts, marks and lines shrink
SMALLEST = 0.72  # but not below this share


@contextmanager
def styled(style: str | Mapping[str, Any] | None = None) -> Iterator[None]:
    """Draw in the package's style; what the user has set, and `style`, come before it; settings stay as they were.

    Parameters
    ----------
    style : str, mapping or None
        The name of a matplotlib style, the path of a style sheet, or rcParams.
    """
    import matplotlib as mpl
    from matplotlib.style import context

    default: Any = mpl.rcParamsDefault
    # reading the backend would choose one, which imports pyplot
    settings: Any = mpl.rcParams
    names = [name for name in settings if not name.startswith("backend") and name in default]
    own = {name: settings[name] for name in names if settings[name] != default[name]}
    chosen: list[Any] = ["default", HOUSE, own]
    if style is not None:
        chosen.append(dict(style) if isinstance(style, Mapping) else style)
    with context(chosen):
        yield


def scale(figure: Figure) -> float:
    """By how much texts, marks and lines shrink in a figure narrower than `FULL_WIDTH`."""
    return float(min(1.0, max(SMALLEST, figure.get_size_inches()[0] / FULL_WIDTH)))


def new_axes(axes: Axes | None, **options: Any) -> tuple[Figure, Axes]:
    """The figure and axes to draw on: the given ones, or new ones."""
    if axes is not None:
        return axes.get_figure(root=True), axes  # type: ignore[return-value]
    from matplotlib import rcParams
    from matplotlib.font_manager import FontProperties

    made = new_figure(**options)
    axes = made.add_subplot()
    settings: Any = rcParams
    for axis, key in (("x", "xtick.labelsize"), ("y", "ytick.labelsize")):
        # in points: how many ticks there are must not change when a figure is drawn again elsewhere
        size = FontProperties(size=settings[key]).get_size_in_points()
        axes.tick_params(axis=axis, labelsize=size)  # type: ignore[arg-type]
    return made, axes


def new_figure(figsize: tuple[float, float] | None = None, **options: Any) -> Figure:
    """A figure that pyplot does not keep: notebooks show it once, as the value of a cell, and nothing piles up.

    Where pyplot shows windows it is one of pyplot's. In a figure narrower than `FULL_WIDTH` all text is smaller.
    """
    import matplotlib as mpl

    width = (figsize or mpl.rcParams["figure.figsize"])[0]
    smaller = max(SMALLEST, min(1.0, width / FULL_WIDTH))
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


def _picture_class() -> type[Figure]:
    from matplotlib.figure import Figure

    class Picture(Figure):
        """A figure that shows itself in a notebook, whether or not pyplot has been imported there."""

        def _repr_png_(self) -> bytes:
            buffer = BytesIO()
            self.savefig(buffer, format="png", dpi=110)
            return buffer.getvalue()

    return Picture


def settle(figure: Figure) -> None:
    """Give everything its place."""
    figure.draw_without_rendering()


def thin_ticks(*drawn: Axes) -> None:
    """Fewer ticks where their labels would touch; the figure must have been settled."""
    from matplotlib.ticker import MaxNLocator

    for axes in drawn:
        figure = axes.get_figure(root=True)
        assert figure is not None
        for axis, side in ((axes.xaxis, 0), (axes.yaxis, 1)):
            for count in (6, 5, 4, 3, 2):
                if not isinstance(axis.get_major_locator(), MaxNLocator) or not _crowded(axis, side):
                    break
                axis.set_major_locator(MaxNLocator(count, steps=[1, 2, 2.5, 5, 10]))
                settle(figure)


def _crowded(axis: Any, side: int) -> bool:
    """Whether labels of neighbouring ticks are less than a good half of a letter apart."""
    low, high = sorted(axis.get_view_interval())
    slack = 1e-9 * (high - low)
    shown = [
        tick.label1.get_window_extent()
        for tick in axis.get_major_ticks()
        if low - slack <= tick.get_loc() <= high + slack
        and tick.label1.get_text()
        and tick.label1.get_visible()
    ]
    if len(shown) < 2:
        return False
    ends = sorted((box.intervalx if side == 0 else box.intervaly).tolist() for box in shown)
    room = 0.6 * min(box.height for box in shown) if side == 0 else 0.0
    return any(after[0] - before[1] < room for before, after in itertools.pairwise(ends))


def freeze(figure: Figure) -> None:
    """Leave everything where it is: a figure without a window is not laid out again."""
    if not windows():
        figure.set_layout_engine("none")


def windows() -> bool:
    """Whether the user's session shows pyplot's figures in windows (notebooks show what is returned)."""
    if "matplotlib.pyplot" not in sys.modules:
        return False
    backend = sys.modules["matplotlib.pyplot"].get_backend().lower()
    return backend not in ("agg", "cairo", "pdf", "pgf", "ps", "svg", "template") and "inline" not in backend


def save_figure(figure: Figure, path: str | Path) -> None:
    """Save a figure; the name's ending chooses the format.

    Raises
    ------
    ValueError
        If the ending is not one that can be written, or the place cannot be.
    """
    path = Path(path)
    check_picture(path)
    with styled():
        try:
            figure.savefig(path)
        except OSError as error:
            raise ValueError(f"{path}: the picture cannot be written ({error.strerror}).") from None


def check_style(style: str | None) -> None:
    """Refuse, before any work, a style that matplotlib does not know.

    Raises
    ------
    ValueError
        With the names that would do.
    """
    if style is None:
        return
    import matplotlib.style

    known = ["default", *matplotlib.style.available]
    if style not in known and not Path(style).is_file():
        shown = ", ".join(name for name in known if not name.startswith("_"))
        raise ValueError(
            f"--style {style}: matplotlib has no such style and there is no such file; it has {shown}."
        )


def check_size(size: tuple[float, float] | None) -> None:
    """Refuse, before any work, inches that are no picture's.

    Raises
    ------
    ValueError
        If a side is not between 1 and 60.
    """
    if size is not None and not all(1.0 <= side <= 60.0 for side in size):
        raise ValueError(f"--size {size[0]:g} {size[1]:g}: give inches between 1 and 60, such as 3.4 2.4.")


def check_picture(path: str | Path) -> None:
    """Refuse, before any work, a picture that could not be written at the end.

    Raises
    ------
    ValueError
        If the ending names no format, or the folder does not exist.
    """
    path = Path(path)
    if path.suffix.lower().lstrip(".") not in FORMATS:
        raise ValueError(
            f"{path}: a picture's name must end in .{', .'.join(FORMATS)}; {path.stem}.png would do."
        )
    if not path.parent.is_dir():
        raise ValueError(
            f"{path}: there is no folder {str(path.parent)!r}; make it first, or choose another place."
        )
