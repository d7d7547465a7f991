"""Basins of attraction on a plane of starts: the attractor of each start, the attractors' shares, the roughness of the boundary."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol, TypeVar, Unpack, runtime_checkable

import numpy as np

from ..continuation.settings import hinted, hinting
from ..graph import Graph
from ..graph.contents import Attractor
from ..graph.table import short_word
from ..problems.abilities import Gauged, Sectioned, notation_of
from ..shared.figures import PlotOptions
from ..shared.motions import Motion
from ..shared.numbers import figures
from ..text_table import Table, titled
from .census import attractors_of, population_of
from .manifolds import Manifold, check_plane, stable_manifolds

if TYPE_CHECKING:
    from matplotlib.figure import Figure


MOST = 4_000_000  # largest number of starts
# periods that may be simulated for manifolds, per start of a plane of the default size: about the work of the plane itself
PER_START = 30
Numbers = TypeVar("Numbers", float, np.ndarray)

CONFIDENCE = 1.96  # standard errors of a 95 % interval


@runtime_checkable
class OnCurve(Protocol):
    """A motion with a property ``curve``: states on it, shape (n, d), or None if it does not recur."""

    @property
    def curve(self) -> np.ndarray | None: ...


@hinted
@dataclass(repr=False)
class Basins:
    """A plane of starts and the attractor that each start reaches.

    Attributes
    ----------
    parameter : str
    value : float
        Of the parameter.
    axes : (str, str)
        Names of the two coordinates that vary.
    x, y : float array (n,), (m,)
        Their values.
    fixed : dict
        Values of the other coordinates by name.
    index : int array (m, n)
        Index in `attractors` of the attractor that the start at (x[j], y[i]) reaches.
    mirrored : bool array (m, n)
        Whether the start reaches the attractor's mirror image.
    attractors : list of Attractor
        With their shares of the plane.
    manifolds : list of Manifold
        Stable manifolds of saddles, which separate the basins.
    notation : dict
        Axis labels by name of coordinate.
    leftward : str
        The coordinate whose axis is drawn from right to left.
    unit : str
        Unit of the parameter; empty for a plain number.
    gauges : dict
        For each coordinate with a unit: the factor from computed to displayed numbers, and the unit's name.
    states : list of ndarray
        For each attractor a point of it in the plane, shape (2,), or None.
    """

    parameter: str
    value: float
    axes: tuple[str, str]
    x: np.ndarray
    y: np.ndarray
    fixed: dict[str, float]
    index: np.ndarray
    mirrored: np.ndarray
    attractors: list[Attractor] = field(default_factory=list)
    manifolds: list[Manifold] = field(default_factory=list)
    notation: dict[str, str] = field(default_factory=dict)
    leftward: str = ""
    unit: str = ""
    gauges: dict[str, tuple[float, str]] = field(default_factory=dict)
    states: list[np.ndarray | None] = field(default_factory=list)

    def told(self, k: int, most: int | None = None) -> str:
        """Return a name of attractor `k`; if another attractor has the same name, a state on this one is added.

        Parameters
        ----------
        k : int
        most : int, optional
            Largest number of letters of the name.
        """
        attractor, state = self.attractors[k], self.states[k] if self.states else None
        name = short_word(attractor.name) if most is None else short_word(attractor.name, most)
        namesakes = [a for a in self.attractors if (a.name, a.periods) == (attractor.name, attractor.periods)]
        if state is None or len(namesakes) < 2:
            return name
        places = (
            f"{axis} = {figures(float(self.shown(axis, x)))} {self.gauges.get(axis, (1.0, ''))[1]}".rstrip()
            for axis, x in zip(self.axes, state, strict=True)
        )
        return f"{name} through {', '.join(places)}"

    def shown(self, name: str, values: Numbers) -> Numbers:
        """Convert values of a coordinate to its displayed unit."""
        return values * self.gauges.get(name, (1.0, ""))[0]

    def __str__(self) -> str:
        return table(self)

    def _repr_html_(self) -> str:
        return page(self)

    def __repr__(self) -> str:
        rows, columns = self.index.shape
        found = ", ".join(f"{short_word(a.name)} {a.share:.1%}" for a in self.attractors)
        return f"Basins({self.axes[0]} x {self.axes[1]}, {columns} x {rows} starts at {self.parameter} = {self.value:.10g}: {found})"

    def interval(self, k: int) -> tuple[float, float]:
        """Return Wilson's 95 % confidence interval of the share of attractor `k`, with the starts taken as random draws from the plane."""
        return wilson(self.attractors[k].share, self.index.size)

    def uncertainty_exponent(self) -> tuple[float, float]:
        """Return the uncertainty exponent of the basin boundary and its standard error; 1 for a smooth curve, near 0 for a riddled basin.

        The share f(d) of points whose neighbour at distance d reaches another motion grows like d^alpha (Grebogi, McDonald,
        Ott and Yorke, Phys. Lett. A 99 (1983) 415). alpha is the slope of a straight line fitted to log f against log d,
        d = 1, 2, 4, ... points.

        Raises
        ------
        ValueError
            If all points reach one motion, or the plane has too few points.
        """
        inside = [k for k, attractor in enumerate(self.attractors) if attractor.kind == "impossible"]
        kinds = np.where(np.isin(self.index, inside), -1, 2 * self.index + self.mirrored)
        distances, shares = [], []
        d = 1
        while 4 * d <= min(kinds.shape):
            pairs = np.hstack(
                [(kinds[:, d:].ravel(), kinds[:, :-d].ravel()), (kinds[d:].ravel(), kinds[:-d].ravel())]
            )
            pairs = pairs[:, (pairs >= 0).all(axis=0)]
            other = pairs[0] != pairs[1]
            if other.any():
                distances.append(d)
                shares.append(other.mean())
            d *= 2
        if len(distances) < 3:
            raise ValueError(
                "the plane has too few points, or one motion alone, to tell how ragged a boundary is"
            )
        fit, covariance = np.polyfit(np.log(distances), np.log(shares), 1, cov=True)
        return float(fit[0]), float(np.sqrt(covariance[0, 0]))

    def to_dict(self) -> dict[str, Any]:
        """Return attractors, shares with their intervals, and the uncertainty exponent, ready for JSON and in the units given under ``units``."""
        try:
            exponent = list(self.uncertainty_exponent())
        except ValueError:
            exponent = None
        units = {name: unit for name, (_, unit) in self.gauges.items()}
        units |= {self.parameter: self.unit} if self.unit else {}
        sizes = np.array([self.shown(name, 1.0) for name in self.axes])
        return {
            "parameter": self.parameter,
            "value": self.value,
            "plane": list(self.axes),
            "points": list(self.index.shape),
            "fixed": {name: self.shown(name, value) for name, value in self.fixed.items()},
            **({"units": units} if units else {}),
            "attractors": [
                a.to_dict() | {"interval": list(self.interval(k))} for k, a in enumerate(self.attractors)
            ],
            "uncertainty_exponent": exponent,
            **({"manifolds": [m.to_dict(sizes) for m in self.manifolds]} if self.manifolds else {}),
        }

    def plot(self, **options: Unpack[PlotOptions]) -> Figure:
        """Plot the basins in colours; see :func:`contvines.plots.basins.plot_basins`."""
        from ..plots.basins import plot_basins

        return plot_basins(self, **options)


def wilson(share: float, n: int) -> tuple[float, float]:
    """Return Wilson's 95 % confidence interval of a share counted among n draws."""
    z2 = CONFIDENCE**2
    centre = (share + z2 / (2 * n)) / (1 + z2 / n)
    half = CONFIDENCE / (1 + z2 / n) * np.sqrt(share * (1 - share) / n + z2 / (4 * n * n))
    return float(max(centre - half, 0.0)), float(min(centre + half, 1.0))


@hinting
def basins(
    machine: object,
    over: str | None = None,
    at: float | None = None,
    plane: Sequence[str] | None = None,
    points: int | tuple[int, int] | None = None,
    within: Mapping[str, tuple[float, float]] | None = None,
    fixed: Mapping[str, float] | None = None,
    saddles: Graph | None = None,
) -> Basins:
    """Basins of attraction: simulate a plane of initial states and name the attractor that each reaches.

    Parameters
    ----------
    machine : machine, orbit or problem
        It must have a ``population``.
    over : str, optional
        Name of the parameter.
    at : float
        Value of the parameter.
    plane : two names, optional
        Coordinates of the plane; by default the last two of ``population.names`` among position and velocity.
    points : int or (int, int), optional
        Number of starts across and up; by default ``population.across``: 200, for declared machines 60.
    within : mapping, optional
        Ranges of the two coordinates by name; by default those of the machine's box.
    fixed : mapping, optional
        Values of the other coordinates by name; 0 by default.
    saddles : Graph, optional
        Its unstable motions' stable manifolds are computed on the plane. The plane must then be the section of motions with two
        states: position and velocity at phase zero, or the two states of a map.

    Returns
    -------
    Basins

    Raises
    ------
    ValueError
        If an argument is missing or invalid: the message names it.
    """
    population = population_of(machine, over)
    if at is None:
        raise ValueError(f"at = None: give the value of {population.parameter}, for example at=1.1")
    if not isinstance(at, float | int | np.number) or not np.isfinite(at):
        raise ValueError(f"at = {at!r}: the value of {population.parameter} must be a finite number")
    names = population.names
    if plane is not None and len(plane) != 2:
        raise ValueError(f"plane = {plane!r}: give two names of {', '.join(names)}")
    horizontal, vertical = (str(n) for n in (plane or (names[1:3] if len(names) > 2 else names[:2])))
    given = dict(fixed or {})
    ranges = dict(within or {})
    for name in (horizontal, vertical, *given, *ranges):
        if name not in names:
            raise ValueError(f"{name!r} is no coordinate of a start; choose from {', '.join(names)}")
    if horizontal == vertical:
        raise ValueError(
            f"plane = {horizontal!r}, {vertical!r}: choose two different coordinates of {', '.join(names)}"
        )
    points = population.across if points is None else points
    columns, rows = (points, points) if isinstance(points, int) else points
    if not (columns >= 2 and rows >= 2 and columns * rows <= MOST):
        raise ValueError(f"points = {columns} x {rows}: give at least 2 each way, and at most {MOST} in all")
    box = population.box(float(at))
    limits = {name: ranges.get(name, tuple(box[names.index(name)])) for name in (horizontal, vertical)}
    for name, (low, high) in limits.items():
        if not (np.isfinite(low) and np.isfinite(high) and low < high):
            raise ValueError(
                f"within: {name} = [{low:g}, {high:g}] is no interval; give the lower number first"
            )
    x = _cells(*limits[horizontal], columns)
    y = _cells(*limits[vertical], rows)
    starts = np.zeros((rows * columns, len(names)))
    for name, value in given.items():
        starts[:, names.index(name)] = value
    starts[:, names.index(horizontal)] = np.tile(x, rows)
    starts[:, names.index(vertical)] = np.repeat(y, columns)
    curves: list[Manifold] = []
    if saddles is not None:
        low, high = saddles.within
        if not low <= at <= high:
            raise ValueError(
                f"at = {at:.10g} lies outside the interval of saddles, {low:.10g} to {high:.10g}; give a value inside it, "
                f"or a graph over a wider interval"
            )
        others = {name: given.get(name, 0.0) for name in names if name not in (horizontal, vertical)}
        check_plane(saddles, population.parameter, (horizontal, vertical), others)
        most = PER_START * max(population.across**2, columns * rows)
        window = np.array([limits[horizontal], limits[vertical]])
        curves = stable_manifolds(saddles, float(at), window, most=most)
    motions, index, mirrored = population.settle(starts, float(at))
    attractors = attractors_of(motions, index, mirrored, float(at))
    shape = (rows, columns)
    return Basins(
        population.parameter,
        float(at),
        (horizontal, vertical),
        x,
        y,
        {name: float(given.get(name, 0.0)) for name in names if name not in (horizontal, vertical)},
        index.reshape(shape),
        mirrored.reshape(shape),
        attractors,
        curves,
        notation_of(population),
        getattr(population, "leftward", ""),
        getattr(population, "units", {}).get(population.parameter, ""),
        population.gauges(names, float(at)) if isinstance(population, Gauged) else {},
        [_on_plane(motion, names, (horizontal, vertical), float(at)) for motion in motions],
    )


def _on_plane(motion: object, names: Sequence[str], axes: tuple[str, str], p: float) -> np.ndarray | None:
    """Return the two coordinates `axes` of a state on a motion; None if it does not recur, or its section lacks these coordinates."""
    if isinstance(motion, OnCurve):
        states = motion.curve
    else:
        assert isinstance(motion, Motion)
        if not isinstance(motion.problem, Sectioned) or motion.u is None:
            return None
        section = motion.problem.section(p)
        names = section.names
        states = section.rounds(motion.u) if {*axes} <= {*names} else None
    return None if states is None else states[0][[names.index(name) for name in axes]]


def _cells(low: float, high: float, count: int) -> np.ndarray:
    """Return the centres of equal cells of an interval; no start lies exactly on its ends, which may be walls."""
    return low + (high - low) * (np.arange(count) + 0.5) / count


# text for each end of a manifold that the summary mentions
ENDS = {
    "leaves": "leaves the plane",
    "long": "cut, though it goes on",
    "breaks": "cut where it cannot be followed",
}


def table(basins: Basins) -> str:
    """Return the summary as text: the plane, a line per attractor with its share and confidence interval, and the boundary's exponent."""
    return titled(_title(basins), _shares(basins), _boundary(basins))


def page(basins: Basins) -> str:
    """Return the summary of `table` as HTML."""
    shares = _shares(basins).html()
    return "".join(
        [f"<p>{html.escape(_title(basins))}</p>", shares, *(f"<p>{t}</p>" for t in _boundary(basins))]
    )


def _shares(basins: Basins) -> Table:
    rows = []
    for k, attractor in enumerate(basins.attractors):
        low, high = basins.interval(k)
        rows.append(
            (
                basins.told(k),
                f"k={attractor.periods}" if attractor.periods else "",
                f"{attractor.share:.2%}",
                f"{low:.2%} to {high:.2%}",
                f"{attractor.mirror_share:.2%}" if attractor.mirror_share else "",
            )
        )
    head = ("motion", "periods", "share", "95 % interval", "of it the mirror image")
    images = any(row[-1] for row in rows)
    return Table(head, rows) if images else Table(head[:-1], [row[:-1] for row in rows])


def _title(basins: Basins) -> str:
    horizontal, vertical = basins.axes
    return f"{basins.index.size} starts in the plane {horizontal}, {vertical} at {basins.parameter} = {figures(basins.value)} {basins.unit}".rstrip()


def _boundary(basins: Basins) -> list[str]:
    lines = []
    try:
        exponent, error = basins.uncertainty_exponent()
        lines.append(f"uncertainty exponent of the boundary: {exponent:.2f} +- {error:.2f}")
    except ValueError:
        pass
    for branch, word in dict.fromkeys((curve.branch, curve.word) for curve in basins.manifolds):
        pieces = [curve for curve in basins.manifolds if (curve.branch, curve.word) == (branch, word)]
        ends = [curve.ended for curve in pieces if curve.ended in ENDS]
        counted = [f"{ends.count(name)} {text}" for name, text in ENDS.items() if name in ends]
        points = sum(len(curve.points) for curve in pieces)
        several = f" in {len(pieces)} pieces between walls" if len(pieces) > len(ends) else ""
        lines.append(
            f"stable manifold of {short_word(word)} on {branch}: {points} points{several}; of {len(ends)} halves {', '.join(counted)}"
        )
    return lines
