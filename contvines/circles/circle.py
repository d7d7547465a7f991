"""Circle and Circles: invariant circles as data that are shown and saved."""

from __future__ import annotations

import html
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from ..continuation.settings import hinted
from ..graph.table import with_unit
from ..shared.figures import PanelOptions
from ..shared.numbers import figures, figures_in
from ..text_table import Table, fitted, terminal_width
from .invariance import Curve

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Circle:
    """An invariant circle of the section's map at one parameter value: a modulated motion, seen once per period of its cycle.

    Attributes
    ----------
    value : float
        Parameter value.
    radius : float
        Root mean square distance of the circle from its centre, in the coordinates of the section.
    predicted : float
        Radius by the normal form.
    rotation : float
        Rotation number: turns around the circle per period of the cycle.
    points : ndarray, shape (n, d)
        Points on the section at equal steps of the phase; the map advances the phase by 2 pi rotation.
    tail : float
        Size of the last harmonics relative to the first, a measure of smoothness.
    residual : float
        Residual of the invariance equation, relative to the radius.
    replay : float
        Largest distance from the circle after one simulated period, from starts between the points at which the circle was solved.
    simulated : float or None
        Rotation number of a settled simulation; None if it settles on another motion, or if the circle is not stable.
    stable : bool or None
        Whether a displaced simulation returns to the circle; None if that cannot be determined.
    """

    value: float
    radius: float
    predicted: float
    rotation: float
    points: np.ndarray = field(repr=False)
    tail: float = 0.0
    residual: float = 0.0
    replay: float = np.nan
    simulated: float | None = None
    stable: bool | None = None

    def at(self, phases: np.ndarray) -> np.ndarray:
        """Return the points of the circle at phases in radians, shape (m, d)."""
        return Curve(self.points, self.rotation, self.value).at(phases)

    def to_dict(self) -> dict[str, Any]:
        """Return the circle as a JSON-able dict, without its points."""
        return {
            "value": self.value,
            "radius": self.radius,
            "predicted": self.predicted,
            "rotation": self.rotation,
            "tail": self.tail,
            "residual": self.residual,
            "replay": self.replay,
            "simulated": self.simulated,
            "stable": self.stable,
        }


@hinted
@dataclass(frozen=True, eq=False)
class Circles:
    """The circles that are born at a Neimark-Sacker point, in the order of growing radius.

    Attributes
    ----------
    label : str
        Label of the Neimark-Sacker point.
    parameter : str
    value : float
        Parameter value of the point.
    rotation : float
        Rotation number at the point.
    coefficient : float
        First Lyapunov coefficient, Re d of z -> m z (1 + d z z* + ...) (Kuznetsov, section 4.7).
    growth : float
        d(log abs(multiplier))/dp at the point; by the normal form radius^2 is proportional to -growth (p - value)/coefficient.
    names : tuple of str
        Coordinates of the section.
    centre : ndarray, shape (d,)
        The cycle at the point, on the section.
    circles : tuple of Circle
    ended : str
        Sentence why there are no more circles.
    beyond : dict
        Motion on which a simulation a little beyond the last circle settles: "value", "kind" and, for a locked motion, "periods".
    notation : dict
        Axis labels by name of parameter or coordinate.
    units : dict
        Units by name of parameter; coordinates and radii are the numbers of the computation.
    """

    label: str
    parameter: str
    value: float
    rotation: float
    coefficient: float
    growth: float
    names: tuple[str, ...]
    centre: np.ndarray = field(repr=False)
    circles: tuple[Circle, ...] = field(repr=False, default=())
    ended: str = ""
    beyond: dict[str, Any] = field(default_factory=dict)
    notation: dict[str, str] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.circles)

    def __getitem__(self, i: int) -> Circle:
        return self.circles[i]

    def __repr__(self) -> str:
        return (
            f"Circles({self.label}: {len(self)} from {self.parameter} = {self.value:.10g} on; {self.ended})"
        )

    @property
    def values(self) -> np.ndarray:
        """Parameter values."""
        return np.array([circle.value for circle in self.circles])

    @property
    def radius(self) -> np.ndarray:
        """Radii."""
        return np.array([circle.radius for circle in self.circles])

    @property
    def rotations(self) -> np.ndarray:
        """Rotation numbers."""
        return np.array([circle.rotation for circle in self.circles])

    def to_dict(self) -> dict[str, Any]:
        """Return the circles as a JSON-able dict."""
        return {
            "label": self.label,
            "parameter": self.parameter,
            "value": self.value,
            "rotation": self.rotation,
            "coefficient": self.coefficient,
            "section": list(self.names),
            "circles": [circle.to_dict() for circle in self.circles],
            "ended": self.ended,
            "beyond": self.beyond,
            **({"units": self.units} if self.units else {}),
        }

    def __str__(self) -> str:
        lines = self._table().lines(terminal_width())
        return "\n".join([fitted(self._title()), "", *lines, "", fitted(self.ended)])

    def _repr_html_(self) -> str:
        return f"<p>{html.escape(self._title())}</p>{self._table().html()}<p>{html.escape(self.ended)}</p>"

    def _title(self) -> str:
        kind = "stable" if self.coefficient < 0.0 else "unstable"
        return (
            f"{self.label}: {kind} circles from {self.parameter} = {figures(self.value)} on, "
            f"{figures(self.rotation)} turns per period there, first Lyapunov coefficient {figures(self.coefficient)}"
        )

    def _table(self) -> Table:
        name = with_unit(self.parameter, self.units.get(self.parameter))
        head = (name, "radius", "normal form", "turns per period", "simulated", "replay", "stable")
        value, turns = (
            _figures_of([c.value for c in self.circles]),
            _figures_of([c.rotation for c in self.circles]),
        )
        rows = [
            (
                value(c.value),
                figures(c.radius),
                figures(c.predicted),
                turns(c.rotation),
                "-" if c.simulated is None else turns(c.simulated),
                f"{c.replay:.1e}",
                {True: "yes", False: "no", None: "?"}[c.stable],
            )
            for c in self.circles
        ]
        return Table(head, rows, ("replay", "normal form", "simulated"))

    def plot(self, coordinates: tuple[str, str] | None = None, **options: Unpack[PanelOptions]) -> Figure:
        """Plot the section, the radius and the rotation number; see :func:`contvines.plots.circles.plot_circles`."""
        from ..plots.circles import plot_circles

        return plot_circles(self, coordinates, **options)


def _figures_of(values: list[float]) -> Callable[[float], str]:
    return figures_in((min(values), max(values)), values) if values else figures
