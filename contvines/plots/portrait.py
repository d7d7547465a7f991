"""One solution: the picture that its problem knows how to draw, else its numbers."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .style import new_axes, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot_portrait(orbit: Any) -> "Figure":
    """Draw an orbit: its own `plot()` where it has one, else the points of a cycle or the entries of a vector.

    Parameters
    ----------
    orbit : what `SpecialPoint.orbit` or `Branch.orbit(i)` returned.
    """
    draw = getattr(orbit, "plot", None)
    if callable(draw):
        drawn: Any = draw()
        return drawn if hasattr(drawn, "savefig") else drawn.get_figure()
    points = np.atleast_2d(np.asarray(getattr(orbit, "points", getattr(orbit, "u", orbit)), float))
    with styled():
        figure, axes = new_axes(None, figsize=(4.6, 4.0))
        if points.shape[0] > 1 and points.shape[1] == 2:
            axes.plot(*points.T, "o", color="#0b3c6f")
            axes.set_xlabel("$x_1$")
            axes.set_ylabel("$x_2$")
        else:
            axes.plot(np.arange(points.size), points.ravel(), "o-", color="#0b3c6f")
            axes.set_xlabel("entry")
            axes.set_ylabel("value")
    return figure
