"""Multipliers of a branch: against the parameter, and on the complex plane with the unit circle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..continuation.hints import hinting
from ..problems.abilities import notation_of
from .figures import new_figure, settle, styled, thin_ticks
from .legends import place_legend
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
    figsize: tuple[float, float] | None = None,
    style: str | Mapping[str, Any] | None = None,
) -> Figure:
    """Draw the moduli of a branch's multipliers against the parameter, and the multipliers themselves.

    For flows (spectrum "flow") the real parts and the imaginary axis take the place of moduli and circle. Colours of
    curves are the ranks by size (keyed on the left), colours of dots the parameter (keyed beside the plane).

    Parameters
    ----------
    branch : Branch
    axes : Axes or two of them, optional
        Drawn on: one has the moduli, two have both. Without, a new figure of `figsize` inches; a small one has the moduli alone.
    legend : bool or str
        Whether the curves are named, or where: a place that matplotlib knows.
    style : str or mapping, optional
        A style or rcParams of matplotlib's that come before the package's.

    Raises
    ------
    ValueError
        If the branch has no multipliers, or there are more than two `axes`.
    """
    spectrum = np.asarray(branch.multipliers)
    if spectrum.ndim != 2 or spectrum.shape[1] == 0:
        raise ValueError(f"{branch.label} has no multipliers to draw: its problem has no spectrum.")
    given = None if axes is None else list(np.atleast_1d(np.asarray(axes, dtype=object)))
    if given is not None and len(given) > 2:
        raise ValueError("axes: the multipliers need one or two axes, for example plt.subplots(1, 2)[1]")
    flow = branch.problem is not None and branch.problem.spectrum == "flow"
    with styled(style):
        right: Any = None
        if given is None:
            size = figsize or (8.6, 4.0)
            figure = new_figure(figsize=size)
            narrow = size[0] < NARROW
            if narrow and size[1] < LOW:
                left = figure.add_subplot()  # no room for the plane as well
            elif narrow:
                left, right = figure.subplots(2, 1, height_ratios=(1, 1.25))
            else:
                left, right = figure.subplots(1, 2, width_ratios=(1.25, 1))
        else:
            left, right = given[0], given[1] if len(given) == 2 else None
            figure: Any = left.get_figure(root=True)
        _sizes(left, branch, spectrum, flow, legend)
        if right is not None:
            _plane(right, branch, spectrum, flow)
        if given is None:
            settle(figure)
            thin_ticks(*figure.axes)
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
        label = (
            ("largest" if j == 0 else "smallest" if j == spectrum.shape[1] - 1 else f"{j + 1}.")
            if drawn > 1
            else None
        )
        axes.plot(
            branch.values,
            ranked[:, j],
            color=COLORS[j % len(COLORS)],
            linestyle=DASHES[j % len(DASHES)],
            label=label,
        )
    axes.axhline(0.0 if flow else 1.0, color="black", linewidth=0.9)
    if not flow and np.nanmax(ranked) > 20:
        axes.set_yscale("log")
        low, high = ranked[ranked > 0].min(initial=1.0), np.nanmax(ranked)
        axes.set_ylim(max(low, 1e-4) / 1.5, min(high, 1e4) * 1.5)  # a graze sends a multiplier to infinity
    axes.set_xlabel(parameter_label(branch))
    axes.set_ylabel(r"Re $\lambda_j$" if flow else r"$|\lambda_j|$")
    what = f"{branch.label}: {'eigenvalues' if flow else 'multipliers'} in order of size"
    figure = axes.get_figure(root=True)
    if legend is True and figure is not None and figure.get_size_inches()[0] < NARROW and drawn > 1:
        look: dict[str, Any] = {
            "loc": "lower left",
            "bbox_to_anchor": (0.0, 1.0),
            "ncols": 4,
            "frameon": False,
            "borderpad": 0.0,
        }
        axes.legend(**look, handlelength=1.4, columnspacing=0.9, title=what, alignment="left")
        return
    axes.set_title(what)
    if drawn > 1:
        place_legend(axes, axes.get_legend_handles_labels()[0], legend, False)


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
    dots = axes.scatter(
        np.real(flat)[shown], np.imag(flat)[shown], c=where[shown], s=9, cmap="viridis_r", zorder=3
    )
    if not flow:
        axes.set_xlim(-reach, reach)
        axes.set_ylim(-reach, reach)
        axes.set_aspect("equal")
    figure = axes.get_figure(root=True)
    assert figure is not None
    bar = figure.colorbar(dots, ax=axes, shrink=0.85)
    bar.set_label(parameter_label(branch))
    axes.set_xlabel(r"Re $\lambda$")
    axes.set_ylabel(r"Im $\lambda$")
    hidden = int((~shown).sum())
    narrow = figure.get_size_inches()[0] < NARROW
    apart = "\n" if narrow else " "
    axes.set_title(f"the complex plane{apart}({hidden} outside)" if hidden else "the complex plane")
