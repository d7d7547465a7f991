"""Multipliers of a branch: against the parameter, and on the complex plane with the unit circle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..continuation.settings import hinting
from ..problems.abilities import notation_of
from .figures import Size, Style, narrower, panels, root
from .legends import place_legend
from .settings import DRAWING
from .style import axis_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..branches.branch import Branch

COLORS = ("#0b3c6f", "#b5121b", "#1b7837", "#7b3294", "#a6611a", "#017a79")
DASHES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (1, 1.5)))
MOST = 12  # curves drawn: the largest ones
NARROW = 5.5  # inches: in a narrower figure the two panels stand under one another
LOW = 3.4  # inches: a lower narrow figure has no room for the plane


@hinting
def plot_multipliers(
    branch: Branch,
    *,
    axes: Axes | Sequence[Axes] | None = None,
    legend: bool | str = True,
    figsize: Size = None,
    style: Style = None,
) -> Figure:
    """Draw the moduli of a branch's multipliers against the parameter, and the multipliers themselves.

    For flows (spectrum "flow") the real parts and the imaginary axis take the place of moduli and circle. Colours of
    curves are the ranks by size (keyed on the left), colours of dots the parameter (keyed beside the plane).

    Parameters
    ----------
    branch : Branch
    axes, legend, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`; of two axes the second has the plane, and a small new figure has the moduli alone.

    Raises
    ------
    ValueError
        If the branch has no multipliers, or there are more than two `axes`.
    """
    spectrum = np.asarray(branch.multipliers)
    if spectrum.ndim != 2 or spectrum.shape[1] == 0:
        raise ValueError(f"{branch.label} has no multipliers to draw: its problem has no spectrum.")
    flow = branch.problem is not None and branch.problem.spectrum == "flow"
    size = figsize or (8.6, 4.0)

    def arranged(figure: Figure) -> Sequence[Axes]:
        if size[0] >= NARROW:
            return figure.subplots(1, 2, width_ratios=(1.25, 1))
        if size[1] < LOW:
            return [figure.add_subplot()]  # no room for the plane as well
        return figure.subplots(2, 1, height_ratios=(1, 1.25))

    with panels(axes, (1, 2), "the multipliers are drawn on", arranged, size, style) as (figure, drawn):
        _sizes(drawn[0], branch, spectrum, flow, legend)
        if len(drawn) == 2:
            _plane(drawn[1], branch, spectrum, flow)
    return figure


def parameter_label(branch: Branch) -> str:
    """The label of the parameter's axis."""
    unit = (branch.description.get("units") or {}).get(branch.parameter)
    return axis_label(branch.parameter, unit=unit, notation=notation_of(branch.problem))


def _sizes(axes: Axes, branch: Branch, spectrum: np.ndarray, flow: bool, legend: bool | str) -> None:
    size = np.real(spectrum) if flow else np.abs(spectrum)
    ranked = np.take_along_axis(size, np.argsort(-size, axis=1), axis=1)
    drawn = min(spectrum.shape[1], MOST)
    for j in range(drawn):
        label = "largest" if j == 0 else "smallest" if j == spectrum.shape[1] - 1 else f"{j + 1}."
        look = {"color": COLORS[j % len(COLORS)], "linestyle": DASHES[j % len(DASHES)]}
        axes.plot(branch.values, ranked[:, j], label=label, **look)
    axes.axhline(0.0 if flow else 1.0, color="black", linewidth=0.9)
    if not flow and np.nanmax(ranked) > 20:
        axes.set_yscale("log")
        low, high = ranked[ranked > 0].min(initial=1.0), np.nanmax(ranked)
        axes.set_ylim(max(low, DRAWING.smallest) / 1.5, min(high, DRAWING.largest) * 1.5)
    axes.set(xlabel=parameter_label(branch), ylabel=r"Re $\lambda_j$" if flow else r"$|\lambda_j|$")
    what = f"{branch.label}: {'eigenvalues' if flow else 'multipliers'} in order of size"
    if legend is True and drawn > 1 and narrower(axes, NARROW):
        above = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "title": what, "alignment": "left"}
        axes.legend(ncols=4, frameon=False, borderpad=0.0, handlelength=1.4, columnspacing=0.9, **above)
        return
    axes.set_title(what)
    if drawn > 1:
        place_legend(axes, None, legend, False)


def _plane(axes: Axes, branch: Branch, spectrum: np.ndarray, flow: bool) -> None:
    if flow:
        axes.axvline(0, color="black", linewidth=0.9)
    else:
        angle = np.linspace(0, 2 * np.pi, 361)
        axes.plot(np.cos(angle), np.sin(angle), color="black", linewidth=0.9)
    flat = spectrum.ravel()
    where = np.repeat(branch.values, spectrum.shape[1])
    reach = 1.15 if flow else min(max(1.6, np.nanpercentile(np.abs(flat), 75) * 1.2), 4.0)
    shown = np.isfinite(flat) if flow else np.abs(flat) <= reach * 1.05
    x, y = np.real(flat)[shown], np.imag(flat)[shown]
    dots = axes.scatter(x, y, c=where[shown], s=9, cmap="viridis_r", zorder=3)
    if not flow:
        axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    bar = root(axes).colorbar(dots, ax=axes, shrink=0.85)
    bar.set_label(parameter_label(branch))
    axes.set(xlabel=r"Re $\lambda$", ylabel=r"Im $\lambda$")
    hidden = int((~shown).sum())
    apart = "\n" if narrower(axes, NARROW) else " "
    axes.set_title(f"the complex plane{apart}({hidden} outside)" if hidden else "the complex plane")
