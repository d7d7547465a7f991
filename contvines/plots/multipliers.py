"""Multipliers of a branch: against the parameter, and on the complex plane with the unit circle."""

from typing import TYPE_CHECKING

import numpy as np

from .style import axis_label, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..branch import Branch


def plot_multipliers(branch: "Branch") -> "Figure":
    """Draw the moduli of a branch's multipliers against the parameter, and the multipliers themselves.

    For flows (spectrum "flow") the real parts and the imaginary axis take the place of moduli and circle.

    Raises
    ------
    ValueError
        If the branch has no multipliers.
    """
    spectrum = np.asarray(branch.multipliers)
    if spectrum.ndim != 2 or spectrum.shape[1] == 0:
        raise ValueError(f"{branch.label} has no multipliers to draw: its problem has no spectrum.")
    flow = getattr(branch.problem, "spectrum", "map") == "flow"
    size = np.real(spectrum) if flow else np.abs(spectrum)
    unit = (branch.description.get("units") or {}).get(branch.parameter)
    with styled():
        figure = new_figure(figsize=(8.6, 4.0))
        left, right = figure.subplots(1, 2, width_ratios=(1.25, 1))
        order = np.argsort(-size, axis=1)
        ranked = np.take_along_axis(size, order, axis=1)
        colors = ["#0b3c6f", "#b5121b", "#1b7837", "#7b3294", "#a6611a", "#017a79"]
        for j in range(min(spectrum.shape[1], 12)):
            shade = colors[j % len(colors)]
            left.plot(
                branch.values, ranked[:, j], color=shade, linestyle=["-", (0, (5, 2)), (0, (1, 1.5))][j % 3]
            )
        limit = 0.0 if flow else 1.0
        left.axhline(limit, color="black", linewidth=0.9)
        if not flow and np.nanmax(ranked) > 20:
            left.set_yscale("log")
            low, high = ranked[ranked > 0].min(initial=1.0), np.nanmax(ranked)
            left.set_ylim(
                max(low, 1e-4) / 1.5, min(high, 1e4) * 1.5
            )  # a graze sends a multiplier to infinity
        left.set_xlabel(axis_label(branch.parameter, unit))
        left.set_ylabel(r"Re $\lambda_j$" if flow else r"$|\lambda_j|$")
        left.set_title(f"{branch.label}: {'eigenvalues' if flow else 'multipliers'} in order of size")
        if flow:
            right.axvline(0, color="black", linewidth=0.9)
        else:
            angle = np.linspace(0, 2 * np.pi, 361)
            right.plot(np.cos(angle), np.sin(angle), color="black", linewidth=0.9)
        flat = spectrum.ravel()
        where = np.repeat(branch.values, spectrum.shape[1])
        reach = 1.15 if flow else min(max(1.6, np.nanpercentile(np.abs(flat), 75) * 1.2), 4.0)
        shown = np.isfinite(flat) if flow else np.abs(flat) <= reach * 1.05
        dots = right.scatter(
            np.real(flat)[shown], np.imag(flat)[shown], c=where[shown], s=9, cmap="viridis_r", zorder=3
        )
        if not flow:
            right.set_xlim(-reach, reach)
            right.set_ylim(-reach, reach)
            right.set_aspect("equal")
        bar = figure.colorbar(dots, ax=right, shrink=0.85)
        bar.set_label(axis_label(branch.parameter, unit))
        right.set_xlabel(r"Re $\lambda$")
        right.set_ylabel(r"Im $\lambda$")
        hidden = int((~shown).sum())
        right.set_title(f"the complex plane ({hidden} outside)" if hidden else "the complex plane")
    return figure
