"""How far an attractor is from being lost: kicks of its state, shares of starts, changes of its parameters."""

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
"""Starts that tell a share: many of a population whose basins are drawn with so many starts each way, few where each start is flown alone."""
MIRRORED = "its mirror image"
AT_ONCE = 256  # starts of kicks, the smallest first
LEVELS = 24  # starts along each ray from the attractor outwards
HALVINGS = 14  # of the part of a ray in which the motion is lost


@dataclass(frozen=True)
class Robustness:
    """How far a stable motion is from being lost at one value of the parameter.

    Attributes
    ----------
    parameter, value, word, periods
        The motion.
    names : tuple of str
        Coordinates of the section on which it is kicked: the states when the forcing passes phase zero, or the map's own.
    place, kick : float array (d,)
        The point of the motion, and the change of it, of the smallest kick found that leads elsewhere, in the machine's own
        numbers, as starts of a simulation are; a kick of nan: none did.
    distance : float
        Length of the kick, each coordinate in its unit (of a machine of physical quantities half-widths, and as many per
        radian of the free oscillation); inf if no kick within the box of starts leads elsewhere. Where the boundary
        is smooth it is exact up to about a percent; it is an upper bound always.
    reaches : str
        What the kicked motion goes to.
    share, share_interval
        Share of the starts in the machine's box that reach the motion itself (not its mirror image), with a 95 % interval.
    parameters : dict
        By name the interval of a parameter in which the motion stays stable and real, the others as they are.
    lost : dict
        By name of such a parameter, for either end of its interval, whether the motion is lost there; False: the search
        ended there, half the parameter's size from its value or where the machine allows no further value.
    units : dict
        Units of parameters by name, empty where they are plain numbers.
    gauges : dict
        What one of a coordinate is in the unit in which it is shown, and that unit, by name; empty for plain numbers.
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
        """A state, or a change of one, in the units in which it is shown."""
        return state * np.array([self.gauges.get(name, (1.0, ""))[0] for name in self.names])

    @property
    def shown_units(self) -> dict[str, str]:
        """Units of the numbers that are shown, by name of parameter and coordinate."""
        named = (self.parameter, *self.parameters)
        own = {name: self.units[name] for name in named if self.units.get(name)}
        return own | {name: unit for name, (_, unit) in self.gauges.items()}

    def to_dict(self) -> dict[str, Any]:
        """Ready for JSON, in the units that stand beside the numbers; no finite kick is null."""
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
    """An interval for people; an end at which the search ended is a bound of the motion's true limit."""
    low, high = (f"{figures(x)} {unit}".rstrip() for x in (first, last))
    text = f"from {'' if lost[0] else 'at most '}{figures(first)} to {'' if lost[1] else 'at least '}{high}"
    beyond = ((False, "down to", low), (True, "up to", high))
    unlost = " and ".join(f"{way} {end}" for above, way, end in beyond if not lost[above])
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
    """How far a branch's stable motion at a value of the parameter is from being lost.

    From every point of the motion on the section rays go out in all directions of the states; along each, starts are
    simulated, and where the motion is lost first the distance is halved down.

    Parameters
    ----------
    branch : Branch
    at : float
        Value of its parameter.
    units : mapping, optional
        What counts as 1 of a coordinate, by name; 1 by default.
    directions : int
        Rays from each point.
    starts : int, optional
        Starts that tell the share, 1024 (of a declared machine 256); 0: none are made, the share is nan.
    seed : int
        Of the starts, and of the rays where states have more than two coordinates.
    vary : sequence of str
        Parameters whose stable intervals are wanted.

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
    """Refuse a branch whose stability is not computed.

    Raises
    ------
    ValueError
        If it is not.
    """
    if branch.stable is None:
        raise ValueError(
            f'{branch.label}: its stability is not computed; trace it with spectrum="flow", if F(u, p) are the rates of u'
        )


def stable_at(branch: Branch, at: float) -> np.ndarray:
    """The unknowns of a branch's stable real solution at a value of its parameter.

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
    """Unit vectors, shape (count, dimension): evenly round a circle, else drawn."""
    if dimension == 1:
        return np.array([[-1.0], [1.0]])
    if dimension == 2:
        angles = 2.0 * np.pi * (np.arange(count) + 0.5) / count
        return np.column_stack([np.cos(angles), np.sin(angles)])
    drawn = np.random.default_rng(seed).standard_normal((count, dimension))
    return drawn / np.linalg.norm(drawn, axis=1)[:, None]


class _Kicked:
    """Starts beside the points of a motion on its section."""

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
        """Share of drawn starts that reach the motion, with its interval."""
        drawn = self.population.starts(count, seed, self.p)
        lost, _ = self._lost(drawn)
        share = 1.0 - float(lost.mean())
        return share, wilson(share, count)

    def smallest(self, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray, str]:
        """Place, kick and what it leads to, of the smallest kick found."""
        place = np.repeat(self.places, len(directions), axis=0)
        along = np.tile(directions * self.sizes, (len(self.places), 1))
        longest = self._room(place, along)
        levels = (np.arange(LEVELS) + 1.0) / LEVELS
        kicks = place[:, None, :] + (longest[:, None] * levels)[..., None] * along[:, None, :]
        lost, names = np.zeros(kicks.shape[:2], dtype=bool), np.full(kicks.shape[:2], "", dtype=object)
        ends, begins = longest[:, None] * levels, longest[:, None] * (levels - 1.0 / LEVELS)
        for part in np.array_split(np.argsort(begins, axis=None), max(begins.size // AT_ONCE, 1)):
            if begins.flat[part[0]] >= ends[lost].min(initial=np.inf):
                break  # these cannot hold the smallest
            lost.flat[part], names.flat[part] = self._lost(
                self._starts(kicks.reshape(-1, kicks.shape[2])[part])
            )
        rays = np.flatnonzero(lost.any(axis=1))
        if not len(rays):
            return self.places[0], np.full(self.places.shape[1], np.nan), ""
        first = lost[rays].argmax(axis=1)
        inside, outside, reaches = begins[rays, first], ends[rays, first], names[rays, first]
        near = inside < outside.min()  # the others cannot hold the smallest
        rays, inside, outside, reaches = rays[near], inside[near], outside[near], reaches[near]
        for _ in range(HALVINGS):
            middle = 0.5 * (inside + outside)
            gone, names = self._lost(self._starts(place[rays] + middle[:, None] * along[rays]))
            outside, inside = np.where(gone, middle, outside), np.where(gone, inside, middle)
            reaches = np.where(gone, names, reaches)
        best = int(outside.argmin())
        return place[rays[best]], outside[best] * along[rays[best]], str(reaches[best])

    def _room(self, place: np.ndarray, along: np.ndarray) -> np.ndarray:
        """How far each ray goes inside the box of starts, shape (m,)."""
        ends = np.where(along > 0.0, self.box[:, 1], self.box[:, 0])
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.where(along == 0.0, np.inf, (ends - place) / along)
        return np.maximum(room.min(axis=1), 0.0) * (1.0 - ATLAS.inside)

    def _starts(self, states: np.ndarray) -> np.ndarray:
        starts = np.zeros((len(states), len(self.population.names)))
        starts[:, self.columns] = states
        return starts

    def _lost(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Which starts do not reach the motion, and the names of what they reach; starts inside a wall are not lost."""
        own = self._starts(self.places[:1])
        motions, index, mirrored = self.population.settle(np.concatenate([own, starts]), self.p)
        names = np.array([called(m.word, m.kind) for m in motions], dtype=object)
        possible = np.array([m.kind != "impossible" for m in motions])
        lost = ((index != index[0]) | (mirrored != mirrored[0])) & possible[index]
        return lost[1:], np.where(index == index[0], MIRRORED, names[index])[1:]


REACH = 0.5  # of a parameter's size, to either side
REFUSALS = 12  # of an end of the interval that the machine refuses
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
    """Smallest and largest value of the parameter `name` up to which a motion stays stable and real, within half its size.

    For either of them also whether the motion loses its stability or ceases to be real there; False: the search ended there.

    Parameters
    ----------
    problem : Problem
    u, p
        The motion.
    name : str
        A parameter of the problem, its own or another.

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
    """Whether a branch ends at a value for a reason that lies in the continuation, not in the motion."""
    ends = zip((branch.values[0], branch.values[-1]), branch.endings)
    return not branch.closed and any(
        end == value and ending.reason not in AT_THE_MOTION for end, ending in ends
    )


def _allowed(problem: Problem, name: str, value: float, change: float) -> float:
    """The value changed, by less where the machine refuses it."""
    for _ in range(REFUSALS):
        try:
            problem.check_value(name, value + change)
            return value + change
        except ValueError:
            change *= 0.5
    return value + change
