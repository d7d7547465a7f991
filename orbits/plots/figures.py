"""Figures in the house's style that no window manager holds; the user's own settings come before the house's."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.resources import files
from io import BytesIO
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

QUIET = ("agg", "cairo", "pdf", "pgf", "ps", "svg", "template")  # backends without windows


@contextmanager
def styled(style: str | Mapping[str, Any] | None = None) -> Iterator[None]:
    """Draw in the house's style; what the user has set, and `style`, come before it; settings stay as they were."""
    import matplotlib as mpl
    from matplotlib.style import context

    now, default = mpl.rcParams, mpl.rcParamsDefault
    own = {n: v for n, v in now.items() if not n.startswith("backend") and n in default and v != default[n]}
    chosen: list[Any] = ["default", str(files("orbits.plots") / "house.mplstyle"), own]
    if style is not None:
        chosen.append(dict(style) if isinstance(style, Mapping) else style)
    with context(chosen):
        yield


def new_figure(size: tuple[float, float]) -> Figure:
    """A figure that a notebook shows once and pyplot does not keep, or pyplot's where it shows windows."""
    import matplotlib as mpl

    shrink = max(0.72, min(1.0, size[0] / 6.5))
    changed: dict[Any, Any] = {
        name: shrink * mpl.rcParams[name]
        for name in ("font.size", "lines.markersize", "axes.labelsize", "axes.titlesize", "legend.fontsize")
        if isinstance(mpl.rcParams[name], int | float)
    }
    mpl.rcParams.update(changed)  # inside `styled`, which puts everything back
    shown = sys.modules.get("matplotlib.pyplot")
    if shown is not None and not any(word in shown.get_backend().lower() for word in (*QUIET, "inline")):
        return shown.figure(figsize=size)
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    made = _picture_class()(figsize=size)
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
