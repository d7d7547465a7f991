"""The options that every picture takes, for methods that hand them on to it; see :func:`contvines.plots.diagram.plot_diagram`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypedDict

if TYPE_CHECKING:
    from matplotlib.axes import Axes


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
