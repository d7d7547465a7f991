"""Pictures of branches, orbits, multipliers and the graph; matplotlib is imported only when one is drawn."""

from importlib import import_module

_HOMES = {
    "plot_diagram": "contvines.plots.diagram",
    "plot_multipliers": "contvines.plots.multipliers",
    "plot_network": "contvines.plots.network",
    "plot_portrait": "contvines.plots.portrait",
    "save_figure": "contvines.plots.figures",
}

__all__ = ["plot_diagram", "plot_multipliers", "plot_network", "plot_portrait", "save_figure"]


def __getattr__(name: str):
    if name not in _HOMES:
        raise AttributeError(f"module 'contvines.plots' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
