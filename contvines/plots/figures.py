"""How a figure is given its place and saved."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.figures import new_figure, styled, windows
from contvines.shared.files import refuse_place

from .settings import DRAWING

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

FORMATS = ("png", "pdf", "svg", "jpg", "eps")
LOW = 2.6  # inches: lower axes have short labels at their side

Style = str | Mapping[str, Any] | None
"""A style of ours or of matplotlib's, or rcParams: see :func:`contvines.shared.figures.styled`."""
Size = tuple[float, float] | None
"""Inches across and upright."""


def root(axes: Axes) -> Figure:
    """The figure that axes stand on, also where they are in a part of it."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    return figure


def pixels(axes: Axes) -> float:
    """Pixels per point."""
    return root(axes).dpi / 72.0


def new_axes(axes: Axes | None, figsize: Size = None) -> tuple[Figure, Axes]:
    """The figure and axes to draw on: the given ones, or new ones."""
    if axes is not None:
        return root(axes), axes
    from matplotlib import rcParams
    from matplotlib.font_manager import FontProperties

    made = new_figure(figsize=figsize)
    axes = made.add_subplot()
    for axis, key in ((axes.xaxis, rcParams["xtick.labelsize"]), (axes.yaxis, rcParams["ytick.labelsize"])):
        # in points: how many ticks there are must not change when a figure is drawn again elsewhere
        axis.set_tick_params(labelsize=FontProperties(size=key).get_size_in_points())
    return made, axes


@contextmanager
def drawing(axes: Axes | None, style: Style, figsize: Size = None) -> Iterator[tuple[Figure, Axes, bool]]:
    """Figure and axes to draw on in a style, and whether they are new: new ones are given their place at the end."""
    with styled(style):
        figure, drawn = new_axes(axes, figsize)
        yield figure, drawn, axes is None
        settle(figure)
        if axes is None:
            thin_ticks(*figure.axes)


@contextmanager
def panels(
    axes: Axes | Sequence[Axes] | None,
    counts: Sequence[int],
    what: str,
    arranged: Callable[[Figure], Sequence[Axes]],
    figsize: Size,
    style: Style,
) -> Iterator[tuple[Figure, list[Axes]]]:
    """A figure and the panels to draw on in a style; new ones are given their place at the end.

    Parameters
    ----------
    axes, counts, what
        As for `given_axes`; None for a new figure.
    arranged : callable
        The panels of a new figure.
    figsize, style
        Of a new figure.

    Raises
    ------
    ValueError
    """
    with styled(style):
        if axes is not None:
            yield given_axes(axes, counts, what)
            return
        figure = new_figure(figsize=figsize)
        yield figure, [*arranged(figure)]
        settle(figure)
        thin_ticks(*figure.axes)


def is_low(axes: Axes) -> bool:
    """Whether axes have room for short labels alone at their side."""
    return axes.get_window_extent().height < LOW * root(axes).dpi


def narrower(axes: Axes, inches: float) -> bool:
    """Whether the figure of some axes is narrower than that."""
    return root(axes).get_figwidth() < inches


def given_axes(axes: Axes | Sequence[Axes], counts: Sequence[int], what: str) -> tuple[Figure, list[Axes]]:
    """The axes that the user gives, and their figure.

    Raises
    ------
    ValueError
        If they are not one of so many.
    """
    given: list[Axes] = list(np.atleast_1d(np.asarray(axes, dtype=object)))
    if len(given) not in counts:
        wanted = " or ".join(map(str, counts))
        raise ValueError(
            f"axes: {what} {wanted} axes, not {len(given)}; for example plt.subplots(1, {counts[-1]})[1]"
        )
    return root(given[0]), given


def settle(figure: Figure, passes: int = 1) -> None:
    """Give everything its place, unless nothing has changed since that was done."""
    if figure.stale:
        for _ in range(passes):
            figure.draw_without_rendering()


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
    slack = DRAWING.slack * (high - low)
    ticks = [tick for tick in axis.get_major_ticks() if low - slack <= tick.get_loc() <= high + slack]
    labels = [tick.label1 for tick in ticks if tick.label1.get_text() and tick.label1.get_visible()]
    if len(labels) < 2:
        return False
    boxes = [label.get_window_extent() for label in labels]
    ends = sorted(tuple(box.intervalx if side == 0 else box.intervaly) for box in boxes)
    room = 0.6 * min(box.height for box in boxes) if side == 0 else 0.0
    return any(after[0] - before[1] < room for before, after in itertools.pairwise(ends))


def freeze(figure: Figure) -> None:
    """Leave everything where it is: a figure without a window is not laid out again."""
    if not windows():
        figure.set_layout_engine("none")


def save_figure(figure: Figure, path: str | Path) -> None:
    """Save a figure; the name's ending chooses the format.

    Raises
    ------
    ValueError
        If the ending is not one that can be written, or the place cannot be.
    """
    path = Path(path)
    check_picture(path)
    from matplotlib.layout_engine import PlaceHolderLayoutEngine

    with styled({"figure.constrained_layout.use": False}):
        if isinstance(figure.get_layout_engine(), PlaceHolderLayoutEngine):
            figure.set_layout_engine(None)  # all has its place: with an engine all is drawn once more before
        try:
            figure.savefig(path)
        except OSError as error:
            raise ValueError(f"{path}: the picture cannot be written ({error.strerror}).") from None


def check_style(style: str | None) -> None:
    """Refuse, before any work, a style that neither we nor matplotlib know."""
    with styled(style):
        pass


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
        raise ValueError(f"{path}: a picture's name must end in .{', .'.join(FORMATS)}; use {path.stem}.png.")
    refuse_place(path)
