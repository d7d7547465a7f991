"""Picture of the multipliers of a branch: over the parameter, and in the complex plane with the unit circle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..branches import Branch
from ..continuation.settings import hinting
from ..problems.abilities import notation_of
from ..shared.figures import Size, Style, panels, root
from .legends import place_legend
from .style import BLUE, RED, axis_label

COLORS = (BLUE, RED, "#1b7837", "#7b3294", "#a6611a", "#017a79")
DASHES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (1, 1.5)))
SHOWN = 1e-4, 1e4  # smallest and largest modulus on the axis: at a graze one becomes infinite
MOST = 12  # largest number of curves


@hinting
def plot_multipliers(
    branch: Branch,
    *,
    axes: Axes | Sequence[Axes] | None = None,
    legend: bool | str = True,
    figsize: Size = None,
    style: Style = None,
) -> Figure:
    """Draw the moduli of a branch's multipliers over the parameter, and the multipliers in the complex plane.

    Spectrum "flow" (equilibria): eigenvalues, with their real parts instead of moduli and the imaginary axis instead of the circle. Curves are
    coloured by rank in size, dots by the value of the parameter.

    Parameters
    ----------
    branch : Branch
    axes, legend, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`; one of them for the moduli, or two for moduli and
        plane. A small new figure has the moduli only.

    Raises
    ------
    ValueError
        If the branch has no multipliers, or the number of `axes` is not one or two.
    """
    spectrum = np.asarray(branch.multipliers)
    if spectrum.ndim != 2 or spectrum.shape[1] == 0:
        raise ValueError(f"{branch.label} has no multipliers to draw: its problem has no spectrum.")
    flow = branch.problem is not None and branch.problem.spectrum == "flow"
    beside = {"mosaic": "ab", "width_ratios": (1.25, 1)}
    below = {"mosaic": "a;b", "height_ratios": (1, 1.25)}
    what, size = "the multipliers are drawn on", figsize or (8.6, 4.0)
    with panels(axes, (1, 2), what, size, style, beside, below) as (figure, drawn):
        unit = (branch.description.get("units") or {}).get(branch.parameter)
        label = axis_label(branch.parameter, unit, notation_of(branch.problem))
        _sizes(drawn[0], branch, spectrum, flow)
        drawn[0].set_xlabel(label)
        if spectrum.shape[1] > 1:
            place_legend(drawn[0], (), legend, len(drawn) == 1 and axes is None)
        if len(drawn) == 2:
            _plane(drawn[1], branch, spectrum, flow, label)
    return figure


def _sizes(axes: Axes, branch: Branch, spectrum: np.ndarray, flow: bool) -> None:
    size = np.real(spectrum) if flow else np.abs(spectrum)
    ranked = -np.sort(-size, axis=1)
    for j in range(min(spectrum.shape[1], MOST)):
        label = "largest" if j == 0 else "smallest" if j == spectrum.shape[1] - 1 else f"{j + 1}."
        look = {"color": COLORS[j % len(COLORS)], "linestyle": DASHES[j % len(DASHES)]}
        axes.plot(branch.values, ranked[:, j], label=label, **look)
    axes.axhline(0.0 if flow else 1.0, color="black", linewidth=0.9)
    if not flow and np.nanmax(ranked) > 20:
        axes.set_yscale("log")
        low, high = ranked[ranked > 0].min(initial=1.0), np.nanmax(ranked)
        axes.set_ylim(max(low, SHOWN[0]) / 1.5, min(high, SHOWN[1]) * 1.5)
    axes.set_ylabel(r"Re $\lambda_j$" if flow else r"$|\lambda_j|$")
    axes.set_title(f"{branch.label}: {'eigenvalues' if flow else 'multipliers'} in order of size")


def _plane(axes: Axes, branch: Branch, spectrum: np.ndarray, flow: bool, label: str) -> None:
    if flow:
        axes.axvline(0, color="black", linewidth=0.9)
    else:
        angle = np.linspace(0, 2 * np.pi, 361)
        axes.plot(np.cos(angle), np.sin(angle), color="black", linewidth=0.9)
    flat = spectrum.ravel()
    where = np.repeat(branch.values, spectrum.shape[1])
    reach = min(max(1.6, np.nanpercentile(np.abs(flat), 75) * 1.2), 4.0)
    shown = np.isfinite(flat) if flow else np.abs(flat) <= reach * 1.05
    x, y = np.real(flat)[shown], np.imag(flat)[shown]
    dots = axes.scatter(x, y, c=where[shown], s=9, cmap="viridis_r", zorder=3)
    if not flow:
        axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    root(axes).colorbar(dots, ax=axes, shrink=0.85, label=label)
    axes.set(xlabel=r"Re $\lambda$", ylabel=r"Im $\lambda$")
    hidden = int((~shown).sum())
    axes.set_title(f"the complex plane ({hidden} outside)" if hidden else "the complex plane", wrap=True)
