"""Line styles, colours, marks of special points, and labels of axes of all pictures."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ..bifurcation.kinds import BY_NAME

if TYPE_CHECKING:
    from ..graph import Graph
    from ..loci.locus import Locus
    from ..survey.results import Survey

# line styles by state; unknown: stability was not computed
LINES: dict[str, Any] = {"stable": "-", "unknown": "-", "unstable": (0, (5, 2.2)), "virtual": (0, (1, 1.8))}
WIDTHS = {"stable": 1.25, "unknown": 1.1, "unstable": 0.88, "virtual": 0.88}  # relative to lines.linewidth
BLUE, RED, BARE = "#0b3c6f", "#b5121b", "0.55"  # computed; measured or failed; for comparison
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


@dataclass(frozen=True)
class Mark:
    """Name and marker of a kind of special points."""

    name: str
    marker: str
    filled: bool = False

    def look(self, color: str, size: float) -> dict[str, Any]:
        """Return arguments of `Axes.plot` for the mark; `size` in points."""
        return {
            "linestyle": "none",
            "marker": self.marker,
            "color": color,
            "markersize": size,
            "markerfacecolor": color if self.filled else "white",
            "markeredgecolor": "black" if self.filled else color,
            "markeredgewidth": (0.5 if self.filled else 1.3) * size / 6.0,
        }


MARKS = {kind.name: Mark(kind.text, kind.marker, kind.filled) for kind in BY_NAME.values()}
PLAIN = Mark("special point", "o")
LIMITS = {  # names of loci of cycles of long period, by their limit
    "heteroclinic": "heteroclinic cycle",
    "saddle-node": "saddle-node on the cycle",
    "at-rest": "cycle that comes to rest",
}
UNRESOLVED = Mark("unresolved", "s")


def mark_of_locus(locus: Locus) -> Mark:
    """Return the mark of a locus: that of its special points, with the name of the limit for cycles of long period."""
    mark = MARKS.get(locus.kind, PLAIN)
    return replace(mark, name=LIMITS.get(locus.limit, mark.name))


def line_of(state: str, color: str) -> dict[str, Any]:
    """Return arguments of `Axes.plot` for a branch in a state, a key of `STATES`."""
    from matplotlib import rcParams

    width = WIDTHS[state] * float(rcParams["lines.linewidth"])
    return {"color": color, "linestyle": LINES[state], "linewidth": width}


def mark_of(kind: str, graph: Graph) -> Mark:
    """Return the mark of a kind of special points, which may be defined by the user."""
    own = graph.own_kinds.get(kind)
    return Mark(own.text, own.marker, own.filled) if own else MARKS.get(kind, PLAIN)


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
        "covered": "share of the interval with a stable response",
    }
    return axis_label(name, survey.units.get(name), {**survey.notation, **words})
