"""Line styles, colours, marks of special points, and labels of axes of all pictures."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..bifurcation.kind import Kind
from ..bifurcation.kinds import kind_named

if TYPE_CHECKING:
    from ..loci.locus import Locus
    from ..survey.results import Survey

# line styles by state; unknown: stability was not computed
LINES: dict[str, Any] = {"stable": "-", "unknown": "-", "unstable": (0, (5, 2.2)), "virtual": (0, (1, 1.8))}
WIDTHS = {"stable": 1.25, "unknown": 1.1, "unstable": 0.88, "virtual": 0.88}  # relative to lines.linewidth
BLUE, RED = "#0b3c6f", "#b5121b"  # computed; measured or failed
REFERENCES: dict[str, tuple[str, Any]] = {  # colours and dashes of responses for comparison
    "bare": ("0.35", (0, (1, 1.2))),
    "tuned": ("#a6611a", (0, (6, 1.5, 1, 1.5))),
    "friction": ("#7b3294", (0, (3, 1.2))),
}
STATE_COLORS = {"stable": BLUE, "unknown": "#4d4d4d", "unstable": "#d9484b", "virtual": "#8a8a8a"}
HATCHES = (None, "////", "....", "\\\\\\\\", "----", "xxxx", "||||", "++++")  # areas differ without colours
PROVED = {"color": "#7fc97f", "alpha": 0.45}  # bands below proved parts
LOCI = {  # colours of loci by kind
    "fold": BLUE,
    "symmetry-breaking": "#1b7f4b",
    "branch-point": "#5b8c1a",
    "period-doubling": "#c2410c",
    "neimark-sacker": "#7c3aed",
    "hopf": "#7c3aed",
}
BORDERS = {  # colours of loci of borders by kind
    "wall-graze": "#8b5e3c",
    "velocity-graze": "#4b5563",
    "stick": "#a3861a",
    "vanishing-event": "#a21caf",
}
STATES = {
    "stable": "stable",
    "unknown": "stability not computed",
    "unstable": "unstable",
    "virtual": "virtual (beyond a border)",
}
STATE_OF = {True: "stable", False: "unstable", None: "unknown"}


LIMITS = {  # names of loci of cycles of long period, by their limit
    "heteroclinic": "heteroclinic cycle",
    "saddle-node": "saddle-node on the cycle",
    "at-rest": "cycle that comes to rest",
}
UNRESOLVED = Kind("unresolved", "UR", marker="s", filled=False)


def kind_of_locus(locus: Locus) -> Kind:
    """Return the kind of the special points of a locus, with the name of the limit for cycles of long period."""
    kind = kind_named(locus.kind)
    return replace(kind, text=LIMITS.get(locus.limit, kind.text))


def mark_of(kind: Kind, color: str, size: float) -> dict[str, Any]:
    """Return arguments of `Axes.plot` for the mark of a kind of special points; `size` in points."""
    look = {"linestyle": "none", "marker": kind.marker, "color": color, "markersize": size}
    if kind.filled:
        return look | {"markeredgecolor": "black", "markeredgewidth": 0.5 * size / 6.0}
    return look | {"markerfacecolor": "white", "markeredgewidth": 1.3 * size / 6.0}


def line_of(state: str, color: str) -> dict[str, Any]:
    """Return arguments of `Axes.plot` for a branch in a state, a key of `STATES`."""
    from matplotlib import rcParams

    width = WIDTHS[state] * float(rcParams["lines.linewidth"])
    return {"color": color, "linestyle": LINES[state], "linewidth": width}


def axis_label(name: str, unit: str | None = None, notation: Mapping[str, str] | None = None) -> str:
    """Return the axis label of a parameter or measure.

    Parameters
    ----------
    name : str
    unit : str, optional
    notation : mapping, optional
        Labels by name, in the notation of the machine; other names are written with blanks.
    """
    label = (notation or {}).get(name, name.replace("_", " "))
    raised = re.sub(r"\^(-?\d+)", r"$^{\1}$", unit or "")
    return f"{label} [{raised}]" if unit else label


def label_of(survey: Survey, name: str) -> str:
    """Return the axis label of a parameter or outcome of a survey."""
    words = {
        "peak": "largest response, worst of the coexisting",
        "lower_peak": "largest response, best of the coexisting",
        "peak_at": "where the largest response is",
        "covered": "share of the interval in which a response is known",
    }
    return axis_label(name, survey.units.get(name), {**survey.notation, **words})
