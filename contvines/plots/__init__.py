"""Pictures of branches, orbits, multipliers and the graph; matplotlib is imported only when one is drawn."""

from importlib import import_module

_HOMES = {
    "plot_atlas": "contvines.plots.atlas",
    "plot_basins": "contvines.plots.basins",
    "plot_chart": "contvines.plots.chart",
    "plot_circles": "contvines.plots.circles",
    "plot_diagram": "contvines.plots.diagram",
    "plot_erosion": "contvines.plots.erosion",
    "plot_multipliers": "contvines.plots.multipliers",
    "plot_network": "contvines.plots.network",
    "plot_portrait": "contvines.plots.portrait",
    "plot_survey": "contvines.plots.survey",
    "plot_sweep": "contvines.plots.sweep",
    "save_figure": "contvines.plots.figures",
}

__all__ = [*_HOMES]


def __getattr__(name: str):
    if name not in _HOMES:
        raise AttributeError(f"module 'contvines.plots' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
