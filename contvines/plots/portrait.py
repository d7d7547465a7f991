"""Picture of one solution: its own `plot` method, else the points of a cycle or the entries of the vector."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contvines.shared.near_names import did_you_mean

from ..problems.abilities import Drawable
from ..shared.figures import Size, Style, drawing
from .style import BLUE


def plot_portrait(
    orbit: object, *, axes: Axes | None = None, figsize: Size = None, style: Style = None, **options: object
) -> Figure:
    """Draw an orbit with its own `plot` method; without one, the points of a cycle of a planar map or the entries of a vector.

    Parameters
    ----------
    orbit : object
        Result of `SpecialPoint.orbit` or `Branch.orbit(i)`.
    axes, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`; given axes get the phase portrait.
    **options
        Further options of the orbit's `plot` method.
    """
    if isinstance(orbit, Drawable):
        given = {"axes": axes, "figsize": figsize, "style": style, **options}
        return orbit.plot(**{name: value for name, value in given.items() if value is not None})
    for name in options:
        known = ("axes", "figsize", "style")
        raise TypeError(
            f"this picture has no argument {name!r}{did_you_mean(name, known)}; it has {', '.join(known)}"
        )
    points = np.atleast_2d(np.asarray(getattr(orbit, "points", getattr(orbit, "u", orbit)), float))
    with drawing(axes, style, figsize or (4.6, 4.0)) as (figure, axes, _):
        if points.shape[0] > 1 and points.shape[1] == 2:
            axes.plot(*points.T, "o", color=BLUE)
            axes.set(xlabel="$x_1$", ylabel="$x_2$")
        else:
            axes.plot(points.ravel(), "o-", color=BLUE)
            axes.set(xlabel="entry", ylabel="value")
    return figure
