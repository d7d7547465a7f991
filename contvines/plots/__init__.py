"""Pictures of graphs, charts, atlases, basins, circles, surveys and orbits; matplotlib is imported when the first one is drawn."""

from typing import TYPE_CHECKING

from contvines.shared.on_demand import on_demand

if TYPE_CHECKING:
    from contvines.plots.atlas import plot_atlas
    from contvines.plots.basins import plot_basins
    from contvines.plots.chart import plot_chart
    from contvines.plots.circles import plot_circles
    from contvines.plots.diagram import plot_diagram
    from contvines.plots.erosion import plot_erosion
    from contvines.plots.figures import save_figure
    from contvines.plots.multipliers import plot_multipliers
    from contvines.plots.network import plot_network
    from contvines.plots.portrait import plot_portrait
    from contvines.plots.survey import plot_survey
    from contvines.plots.sweep import plot_sweep

__all__ = [
    "plot_atlas",
    "plot_basins",
    "plot_chart",
    "plot_circles",
    "plot_diagram",
    "plot_erosion",
    "plot_multipliers",
    "plot_network",
    "plot_portrait",
    "plot_survey",
    "plot_sweep",
    "save_figure",
]

__getattr__ = on_demand(
    __name__,
    {name: f"{__name__}.{name.replace('plot_', '').replace('save_figure', 'figures')}" for name in __all__},
)
