"""Robustness of an attractor: the smallest kick that leads to another one, its share of starts, and the parameter intervals in which it is stable."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..branches import Branch, Reason
from ..branches.solutions import solutions_at
from ..circles.section import section_of
from ..continuation.settings import hinting
from ..continuation.starts import problem_and_start
from ..graph.automatic import diagram
from ..graph.table import short_word
from ..problems.abilities import Gauged, Population
from ..problems.maps import MapProblem
from ..shared.motions import called
from ..shared.numbers import figures
from ..text_table import fitted
from .basins import wilson
from .census import population_of
from .settings import ATLAS

if TYPE_CHECKING:
    from ..problems.protocol import Problem


MANY, FEW, MANY_ACROSS = 1024, 256, 100
"""Default number of starts for a share: `MANY` if the population's pictures of basins have `MANY_ACROSS` starts or more each way, otherwise `FEW`
(its starts are simulated one by one)."""
MIRRORED = "its mirror image"
AT_ONCE = 256  # kicks simulated in one batch; batches with small kicks come first
LEVELS = 24  # number of kicks along each ray from the attractor outwards
HALVINGS = 14  # bisections of the part of a ray in which the motion is lost


@dataclass(frozen=True)
class Robustness:
    """Robustness of a stable motion at one value of the parameter.

    Attributes
    ----------
    parameter, value, word, periods
        The motion.
    names : tuple of str
        Coordinates of the section on which it is kicked: the states when the forcing passes phase zero, or the states of a map.
    place, kick : float array (d,)
        The smallest kick found that leads to another attractor: the point of the motion at which it acts, and the change of state, in
        the machine's own units, as for starts of a simulation. The kick is nan if there is none.
    distance : float
        Length of the kick, each coordinate divided by its unit (for a machine in physical quantities: half-widths, and half-widths per
        radian of the free oscillation); inf if no kick within the box of starts leads to another attractor. It is an upper bound, exact to
        about a percent where the basin's boundary is smooth.
    reaches : str
        Name of the attractor that the kicked motion reaches.
    share, share_interval
        Share of the starts in the machine's box that reach the motion itself (not its mirror image), and its 95 % confidence interval.
    parameters : dict
        By parameter name, the interval in which the motion stays stable and real, with all other parameters fixed.
    lost : dict
        By parameter name, for each end of its interval, whether the motion is lost there. False: the search ended there, half the
        parameter's size from its value or at the limit of the values that the machine allows.
    units : dict
        Units of parameters by name; empty for plain numbers.
    gauges : dict
        For each coordinate with a unit: the factor from computed to displayed numbers, and the unit's name.
    """

    parameter: str
    value: float
    word: str
    periods: int
    names: tuple[str, ...]
    place: np.ndarray
    kick: np.ndarray
    distance: float
    reaches: str
    share: float
    share_interval: tuple[float, float]
    parameters: dict[str, tuple[float, float]] = field(default_factory=dict)
    lost: dict[str, tuple[bool, bool]] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    gauges: dict[str, tuple[float, str]] = field(default_factory=dict)

    def shown(self, state: np.ndarray) -> np.ndarray:
        """Convert a state, or a change of state, to the displayed units."""
        return state * np.array([self.gauges.get(name, (1.0, ""))[0] for name in self.names])

    @property
    def shown_units(self) -> dict[str, str]:
        """Units of the displayed numbers, by name of parameter or coordinate."""
        named = (self.parameter, *self.parameters)
        used_units = {name: self.units[name] for name in named if self.units.get(name)}
        return used_units | {name: unit for name, (_, unit) in self.gauges.items()}

    def to_dict(self) -> dict[str, Any]:
        """Return the results ready for JSON, in the units given under ``units``; without a finite kick, ``kick`` and ``distance`` are None."""
        finite = bool(np.isfinite(self.distance))
        units = self.shown_units
        return {
            **({"units": units} if units else {}),
            "parameter": self.parameter,
            "value": self.value,
            "word": self.word,
            "periods": self.periods,
            "coordinates": list(self.names),
            "place": [float(x) for x in self.shown(self.place)],
            "kick": [float(x) for x in self.shown(self.kick)] if finite else None,
            "distance": self.distance if finite else None,
            "reaches": self.reaches,
            "share": self.share,
            "share_interval": list(self.share_interval),
            "parameters": {name: list(ends) for name, ends in self.parameters.items()},
            "lost": {name: list(ends) for name, ends in self.lost.items()},
        }

    def __str__(self) -> str:
        low, high = self.share_interval
        units = self.shown_units

        def with_unit(number: str, name: str) -> str:
            return f"{number} {units.get(name, '')}".rstrip()

        text = f"{short_word(self.word)}  k={self.periods}  {self.parameter} = {with_unit(figures(self.value), self.parameter)}\n"
        if np.isfinite(self.share):
            text += f"  share of starts: {self.share:.2%} ({low:.2%} to {high:.2%})\n"
        if np.isfinite(self.distance):
            changes, at = self.shown(self.kick), self.shown(self.place)
            kick = ", ".join(f"{name} {with_unit(f'{x:+.4g}', name)}" for name, x in zip(self.names, changes))
            place = ", ".join(f"{name} = {with_unit(f'{x:.4g}', name)}" for name, x in zip(self.names, at))
            text += f"  smallest kick that leads elsewhere: {self.distance:.4g} ({kick} at {place}), to {short_word(self.reaches)}"
        else:
            text += "  no kick within the box of starts leads elsewhere"
        for name, (first, last) in self.parameters.items():
            text += f"\n  stable and real for {name} {_range_text(first, last, self.lost[name], units.get(name, ''))}"
        return fitted(text)


def _range_text(first: float, last: float, lost: tuple[bool, bool], unit: str) -> str:
    """Describe an interval; an end at which only the search ended is a bound of the motion's true limit."""
    low, high = (f"{figures(x)} {unit}".rstrip() for x in (first, last))
    text = f"from {'' if lost[0] else 'at most '}{figures(first)} to {'' if lost[1] else 'at least '}{high}"
    beyond = ((False, "down to", low), (True, "up to", high))
    unlost = " and ".join(f"{word} {end}" for above, word, end in beyond if not lost[above])
    return f"{text}; not lost {unlost}, where the search ended" if unlost else text


@hinting
def robustness(
    branch: Branch,
    at: float,
    *,
    units: Mapping[str, float] | None = None,
    directions: int = 64,
    starts: int | None = None,
    seed: int = 0,
    vary: Sequence[str] = (),
) -> Robustness:
    """Compute the robustness of a branch's stable motion at a value of the parameter.

    The smallest kick is searched along rays in all directions of state space from every point of the motion on its section: starts along
    each ray are simulated, and the first distance at which the motion is lost is refined by bisection.

    Parameters
    ----------
    branch : Branch
    at : float
        Value of its parameter.
    units : mapping, optional
        Unit of each coordinate in the length of a kick, by name; 1 by default.
    directions : int
        Number of rays from each point.
    starts : int, optional
        Number of starts for the share; by default 1024 (for a declared machine 256). 0: no simulation, the share is nan.
    seed : int
        Random seed of the starts, and of the rays if states have more than two coordinates.
    vary : sequence of str
        Parameters whose stable intervals are computed.

    Raises
    ------
    ValueError
        If the branch has no stable real motion there, or it cannot be simulated.
    """
    u = stable_at(branch, float(at))
    problem = branch.attached
    population = population_of(problem)
    section = section_of(problem, float(at))
    sizes = np.array([float((units or {}).get(name, 1.0)) for name in section.names])
    unknown = [name for name in units or {} if name not in section.names]
    if unknown or not np.all(sizes > 0.0):
        raise ValueError(
            f"units = {dict(units or {})!r}: give positive sizes of {', '.join(section.names)}, or of some of them"
        )
    if not directions >= 4:
        raise ValueError(f"directions = {directions}: give at least 4")
    ranges = {name: stable_range(problem, u, float(at), name) for name in vary}
    kicked = _Kicked(population, float(at), section.names, section.rounds(u), sizes)
    place, kick, reaches = kicked.smallest(_directions(len(sizes), int(directions), seed))
    starts = (FEW if population.across < MANY_ACROSS else MANY) if starts is None else starts
    share, interval = kicked.share(starts, seed) if starts else (float("nan"), (float("nan"), float("nan")))
    return Robustness(
        branch.parameter,
        float(at),
        str(branch.description.get("word") or branch.description.get("name", branch.label)),
        int(branch.description.get("periods", 1)),
        tuple(section.names),
        place,
        kick,
        float(np.linalg.norm(kick / sizes)) if np.all(np.isfinite(kick)) else float("inf"),
        reaches,
        share,
        interval,
        {name: ends for name, (ends, _) in ranges.items()},
        {name: lost for name, (_, lost) in ranges.items()},
        dict(branch.description.get("units") or {}),
        problem.gauges(section.names, float(at)) if isinstance(problem, Gauged) else {},
    )


def refuse_uncomputed(branch: Branch) -> None:
    """Raise an error for a branch whose stability is not computed.

    Raises
    ------
    ValueError
        If it is not computed.
    """
    if branch.stable is None:
        raise ValueError(
            f'{branch.label}: its stability is not computed; trace it with spectrum="flow", if F(u, p) are the rates of u'
        )


def stable_at(branch: Branch, at: float) -> np.ndarray:
    """Return the unknowns of a branch's stable real solution at a value of its parameter.

    Raises
    ------
    ValueError
        If it has none.
    """
    if branch.real:
        engine, found = solutions_at(branch, at)
        for solved in found:
            if engine.stable(solved.row):
                return solved.u
    refuse_uncomputed(branch)
    raise ValueError(
        f"{branch.label} has no stable real motion at {branch.parameter} = {at:.10g}; its stable intervals are "
        + (", ".join(f"{a:.6g} to {b:.6g}" for a, b in branch.stable_intervals() if branch.real) or "none")
    )


def _directions(dimension: int, count: int, seed: int) -> np.ndarray:
    """Return unit vectors, shape (count, dimension): evenly spaced on a circle, in higher dimensions drawn at random."""
    if dimension == 1:
        return np.array([[-1.0], [1.0]])
    if dimension == 2:
        angles = 2.0 * np.pi * (np.arange(count) + 0.5) / count
        return np.column_stack([np.cos(angles), np.sin(angles)])
    drawn = np.random.default_rng(seed).standard_normal((count, dimension))
    return drawn / np.linalg.norm(drawn, axis=1)[:, None]


class _Kicked:
    """Simulation of a kicked motion.

    Parameters
    ----------
    population : Population
    p : float
        Value of the parameter.
    names : sequence of str
        Coordinates of the section.
    places : float array (m, d)
        Points of the motion on the section.
    sizes : float array (d,)
        Units of the coordinates in the length of a kick.
    """

    def __init__(
        self,
        population: Population,
        p: float,
        names: Sequence[str],
        places: np.ndarray,
        sizes: np.ndarray,
    ) -> None:
        self.population, self.p, self.places, self.sizes = population, p, places, sizes
        self.columns = [population.names.index(name) for name in names]
        self.box = population.box(p)[self.columns]

    def share(self, count: int, seed: int) -> tuple[float, tuple[float, float]]:
        """Return the share of drawn starts that reach the motion, and its 95 % confidence interval."""
        drawn = self.population.starts(count, seed, self.p)
        lost, _ = self._lost(drawn)
        share = 1.0 - float(lost.mean())
        return share, wilson(share, count)

    def smallest(self, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray, str]:
        """Return the smallest kick that leads to another attractor: place, kick (nan if there is none) and the attractor's name.

        Parameters
        ----------
        directions : float array (n, d)
            Unit vectors of the rays.
        """
        place = np.repeat(self.places, len(directions), axis=0)
        along = np.tile(directions * self.sizes, (len(self.places), 1))
        longest = self._ray_lengths(place, along)
        levels = (np.arange(LEVELS) + 1.0) / LEVELS
        kicks = place[:, None, :] + (longest[:, None] * levels)[..., None] * along[:, None, :]
        lost, names = np.zeros(kicks.shape[:2], dtype=bool), np.full(kicks.shape[:2], "", dtype=object)
        ends, begins = longest[:, None] * levels, longest[:, None] * (levels - 1.0 / LEVELS)
        for part in np.array_split(np.argsort(begins, axis=None), max(begins.size // AT_ONCE, 1)):
            if begins.flat[part[0]] >= ends[lost].min(initial=np.inf):
                break  # all further kicks are larger than the smallest one found
            lost.flat[part], names.flat[part] = self._lost(
                self._starts(kicks.reshape(-1, kicks.shape[2])[part])
            )
        rays = np.flatnonzero(lost.any(axis=1))
        if not len(rays):
            return self.places[0], np.full(self.places.shape[1], np.nan), ""
        first = lost[rays].argmax(axis=1)
        inside, outside, reaches = begins[rays, first], ends[rays, first], names[rays, first]
        near = inside < outside.min()  # only these rays can have the smallest kick
        rays, inside, outside, reaches = rays[near], inside[near], outside[near], reaches[near]
        for _ in range(HALVINGS):
            middle = 0.5 * (inside + outside)
            escapes, names = self._lost(self._starts(place[rays] + middle[:, None] * along[rays]))
            outside, inside = np.where(escapes, middle, outside), np.where(escapes, inside, middle)
            reaches = np.where(escapes, names, reaches)
        best = int(outside.argmin())
        return place[rays[best]], outside[best] * along[rays[best]], str(reaches[best])

    def _ray_lengths(self, place: np.ndarray, along: np.ndarray) -> np.ndarray:
        """Return the length of each ray inside the box of starts, shape (m,)."""
        ends = np.where(along > 0.0, self.box[:, 1], self.box[:, 0])
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.where(along == 0.0, np.inf, (ends - place) / along)
        return np.maximum(room.min(axis=1), 0.0) * (1.0 - ATLAS.inside)

    def _starts(self, states: np.ndarray) -> np.ndarray:
        starts = np.zeros((len(states), len(self.population.names)))
        starts[:, self.columns] = states
        return starts

    def _lost(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return for each start whether it does not reach the motion, and the name of the attractor reached; starts inside a wall do not count as lost."""
        undisturbed = self._starts(self.places[:1])
        motions, index, mirrored = self.population.settle(np.concatenate([undisturbed, starts]), self.p)
        names = np.array([called(m.word, m.kind) for m in motions], dtype=object)
        possible = np.array([m.kind != "impossible" for m in motions])
        lost = ((index != index[0]) | (mirrored != mirrored[0])) & possible[index]
        return lost[1:], np.where(index == index[0], MIRRORED, names[index])[1:]


REACH = 0.5  # half-width of the searched interval, relative to the parameter's size
REFUSALS = 12  # largest number of halvings of an interval whose end the machine does not allow
# reasons for which a branch ends that are properties of the motion, not of the continuation
AT_THE_MOTION = {
    Reason.BORDER,
    Reason.LEAVES,
    Reason.GOES_ON,
    Reason.REACHES,
    Reason.MEETS,
    Reason.MEETS_SYMMETRIC,
    Reason.COMES_BACK,
    Reason.STOPS,
}


def stable_range(
    problem: Problem, u: np.ndarray, p: float, name: str
) -> tuple[tuple[float, float], tuple[bool, bool]]:
    """Return the interval of a parameter in which a motion stays stable and real, within half the parameter's size of its value.

    Parameters
    ----------
    problem : Problem
    u, p
        The motion.
    name : str
        A parameter of the problem: the continuation parameter or another one.

    Returns
    -------
    interval : (float, float)
    lost : (bool, bool)
        For each end, whether the motion loses its stability or ceases to be real there; False: the search ended there.

    Raises
    ------
    ValueError
        If the problem has no such parameter.
    """
    if isinstance(problem, MapProblem):
        seed = problem.cycle_through(problem.section(p).rounds(u), p)
        if name != problem.parameter:
            seed = seed.against(name)
    else:
        seed = problem.orbit(u, p)
    other, _, value = problem_and_start(seed, name)
    low, high = (_allowed(other, name, value, side * REACH * (abs(value) or 1.0)) for side in (-1.0, 1.0))
    graph = diagram(seed, over=name, within=(low, high), depth=0)
    ends, lost = [value, value], [False, False]
    for branch in graph.branches.values():
        for interval in branch.stable_intervals() if branch.real else ():
            if interval[0] <= value <= interval[1]:
                for k, wider in enumerate((interval[0] < ends[0], interval[1] > ends[1])):
                    if wider:
                        ends[k], lost[k] = interval[k], not _search_ended(branch, interval[k])
    return (ends[0], ends[1]), (lost[0], lost[1])


def _search_ended(branch: Branch, value: float) -> bool:
    """Whether a branch ends at a value for a reason of the continuation (limits, step size), not of the motion."""
    ends = zip((branch.values[0], branch.values[-1]), branch.endings)
    return not branch.closed and any(
        end == value and ending.reason not in AT_THE_MOTION for end, ending in ends
    )


def _allowed(problem: Problem, name: str, value: float, change: float) -> float:
    """Return ``value + change``, with `change` halved until the machine allows the value."""
    for _ in range(REFUSALS):
        try:
            problem.check_value(name, value + change)
            return value + change
        except ValueError:
            change *= 0.5
    return value + change
