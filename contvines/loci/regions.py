"""Regions: the parts into which loci divide the plane of two parameters, and the stable motions in each."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..branches import Branch
from ..continuation.engine import Engine
from ..continuation.layout import MARGIN, Solved
from ..continuation.settings import Settings
from ..problems.abilities import Attracting
from .kernels import BRANCH, FOLD
from .locus import Locus
from .settings import VANISHING

if TYPE_CHECKING:
    from ..problems.protocol import Problem


CELLS = 360  # cells of the raster along each side
SMALLEST = 60  # fewest cells of a region; smaller ones are slivers between loci
FEWEST, MOST = 2, 5  # fewest and most places of a region that are simulated
PER_PLACE = 0.05  # share of the plane for each further place
INNER = 0.3  # smallest distance of a place from the loci, relative to the largest one in its region


@dataclass(eq=False)
class Region:
    """A connected part of the plane that no locus crosses.

    Attributes
    ----------
    at : (float, float)
        (p, q) of the main place, well inside the region, at which motions were simulated.
    share : float
        Part of the plane that the region covers.
    attractors : list of dict
        Stable motions at the main place: "word", "periods" and "kind"; for a modulated motion also "modulation" and its band.
    elsewhere : list of dict
        Further places of the region, far from one another, with "at" and "attractors".
    cells : ndarray of bool
        Its cells in a raster of the plane; rows are values of p, columns values of q.
    """

    at: tuple[float, float]
    share: float
    attractors: list[dict[str, Any]] = field(default_factory=list)
    cells: np.ndarray = field(default_factory=lambda: np.zeros((0, 0), bool), repr=False)
    elsewhere: list[dict[str, Any]] = field(default_factory=list)

    @property
    def words(self) -> list[str]:
        """Words of the stable motions at the main place; "chaotic", "modulated" and so on for motions without a word."""
        return words_of(self.attractors)

    @property
    def others(self) -> list[tuple[tuple[float, float], list[str]]]:
        """Places with other stable motions than at the main place, and their words; between them there is a change that no locus of the chart shows."""
        places = [
            ((place["at"][0], place["at"][1]), words_of(place["attractors"])) for place in self.elsewhere
        ]
        return [(at, words) for at, words in places if sorted(words) != sorted(self.words)]

    def to_dict(self, parameters: tuple[str, str]) -> dict[str, Any]:
        """Return the entry of this region in the JSON of a chart."""
        return {
            "at": dict(zip(parameters, map(float, self.at))),
            "share": float(self.share),
            "words": self.words,
            "attractors": self.attractors,
            "agrees": not self.others,
            "elsewhere": [
                {
                    **place,
                    "at": dict(zip(parameters, map(float, place["at"]))),
                    "words": words_of(place["attractors"]),
                }
                for place in self.elsewhere
            ],
        }


def words_of(attractors: list[dict[str, Any]]) -> list[str]:
    """Return the names of attractors, with a number if several have the same name."""
    names = [name_of(found) for found in attractors]
    return [
        name if names.count(name) == 1 else f"{names.count(name)} x {name}" for name in dict.fromkeys(names)
    ]


def name_of(found: dict[str, Any]) -> str:
    """Return the word of an attractor, with the number of periods if it is more than one; without a word, its modulation or kind."""
    if modulation := found.get("modulation"):
        return str(modulation)
    word, periods = found.get("word"), int(found.get("periods") or 0)
    if found.get("kind") == "stuck":
        return "stuck"
    if not word:
        return str(found.get("kind") or "?")
    return word if periods <= 1 or found.get("kind") == "cycle" else f"{word} k={periods}"


def divide(
    curves: Iterable[np.ndarray], within: tuple[tuple[float, float], tuple[float, float]]
) -> list[Region]:
    """Compute the regions between curves, largest first, with places but without attractors.

    Parameters
    ----------
    curves : iterable of ndarray, shape (n, 2)
        (p, q) along each.
    within : ((float, float), (float, float))
        Intervals of p and q.
    """
    from scipy.ndimage import distance_transform_edt, label

    free = np.ones((CELLS, CELLS), dtype=bool)
    lows = np.array([within[0][0], within[1][0]])
    widths = np.array([within[0][1] - within[0][0], within[1][1] - within[1][0]])
    for curve in curves:
        scaled = (np.asarray(curve) - lows) / widths * CELLS
        for a, b in pairwise(scaled):
            if not (np.isfinite(a).all() and np.isfinite(b).all()):
                continue
            steps = int(np.ceil(2.0 * np.abs(b - a).max())) + 1
            places = np.floor(a + np.linspace(0.0, 1.0, steps + 1)[:, None] * (b - a)).astype(int)
            inside = ((places >= 0) & (places < CELLS)).all(axis=1)
            free[places[inside, 0], places[inside, 1]] = False
    marked, count = label(free)  # type: ignore[misc]
    padded = np.pad(free, 1, constant_values=False)
    depth = distance_transform_edt(padded)[1:-1, 1:-1]  # type: ignore[index]
    regions = []
    for number in range(1, count + 1):
        cells = marked == number
        size = int(cells.sum())
        if size < SMALLEST:
            continue
        inner = np.where(cells, depth, -1.0)
        (p, q), *more = lows + (_places(inner, size / CELLS**2) + 0.5) / CELLS * widths
        further = [{"at": [float(a), float(b)], "attractors": []} for a, b in more]
        regions.append(Region((float(p), float(q)), size / CELLS**2, [], cells, further))
    return sorted(regions, key=lambda region: -region.share)


def _places(depth: np.ndarray, share: float) -> np.ndarray:
    """Places of a region as cells, shape (n, 2): first the cell farthest from the edges, then each time the one farthest from the others and not near an edge."""
    count = int(np.clip(FEWEST + share / PER_PLACE, FEWEST, MOST))
    inner = np.argwhere(depth >= max(INNER * depth.max(), 1.0))
    chosen = [np.array(np.unravel_index(int(np.argmax(depth)), depth.shape))]
    away = np.full(len(inner), np.inf)
    while len(chosen) < count:
        away = np.minimum(away, np.hypot(*(inner - chosen[-1]).T))
        if not away.max() > 0.0:
            break
        chosen.append(inner[int(np.argmax(away))])
    return np.array(chosen)


STEPS = (1, 6, 24)  # numbers of steps from a start to a place that are tried in turn
NEAREST = 3  # most starts of one word that are tried


class Start(NamedTuple):
    """A motion at (p, q), and a key for its word."""

    problem: Problem
    u: np.ndarray
    p: float
    q: float
    key: str


class KnownMotions:
    """Known motions, from which the stable motions at other parameter values are continued: those of stable branches, and of loci without folds.

    Parameters
    ----------
    branches : iterable of Branch
        Branches at one value of the second parameter.
    loci : iterable of Locus
    over : str
        Name of the second parameter.
    within : (interval, interval)
        Intervals of the two parameters.
    """

    def __init__(
        self,
        branches: Iterable[Branch],
        loci: Iterable[Locus],
        over: str,
        within: tuple[tuple[float, float], tuple[float, float]],
    ) -> None:
        self.over, self.within = over, within
        self.starts = [start for branch in branches for start in self._of_branch(branch)]
        self.starts += [start for locus in loci for start in self._of_locus(locus)]

    def _of_branch(self, branch: Branch) -> list[Start]:
        problem = branch.problem
        if problem is None or not branch.real or not _can_be_listed(problem):
            return []
        q, key, found = problem.parameters[self.over], _key(problem, branch.label), []
        for first, last, stable in branch.pieces():
            if stable:
                for i in sorted({first, (first + last) // 2, last}):
                    found.append(Start(problem, branch.points[i], float(branch.values[i]), q, key))
        return found

    def _of_locus(self, locus: Locus) -> list[Start]:
        problem = locus.problem
        if problem is None or problem.condition in (FOLD, BRANCH) or not _can_be_listed(problem.base):
            return []
        key, found = _key(problem.base, locus.label), []
        for i in np.linspace(0, len(locus) - 1, 12).astype(int):
            u, p = problem.split(locus.branch.points[i])
            found.append(Start(problem.base, u, float(p), float(locus.branch.values[i]), key))
        return found

    def at(self, place: tuple[float, float]) -> list[dict[str, Any]]:
        """Return the stable motions at (p, q), each word once, as entries of `simulated_attractors`."""
        (plow, phigh), (qlow, qhigh) = self.within
        found: dict[str, dict[str, Any]] = {}
        tried: dict[str, int] = {}

        def far(start: Start) -> float:
            return max(abs(start.p - place[0]) / (phigh - plow), abs(start.q - place[1]) / (qhigh - qlow))

        for start in sorted(self.starts, key=far):
            if start.key in found or tried.get(start.key, 0) >= NEAREST:
                continue
            tried[start.key] = tried.get(start.key, 0) + 1
            entry = self._carried(start, place)
            if entry is not None:
                found[start.key] = entry
        return list(found.values())

    def _carried(self, start: Start, place: tuple[float, float]) -> dict[str, Any] | None:
        for steps in STEPS:
            reached = self._followed(start, place, steps)
            if reached is None:
                continue
            engine, solved = reached
            if not _counts(engine, solved):
                return None
            problem, u, p = engine.problem, solved.u, solved.p
            deviation = problem.replay(u, p)
            if deviation is not None and not deviation < Settings.same:
                return None
            while (smaller := problem.root(u, p)) is not None:
                problem, u = smaller
            if problem is not engine.problem and not self._shorter_is_stable(problem, u, p):
                return None
            return problem.attractor(u, p) if isinstance(problem, Attracting) else None
        return None

    def _shorter_is_stable(self, problem: Problem, u: np.ndarray, p: float) -> bool:
        """Whether the shorter motion that a motion repeats is a solution, and stable: a cycle whose period tends to zero stays at a state that need not be an equilibrium."""
        engine = Engine(problem, self.within[0], Settings())
        solved = engine.at_value(u, p)
        if solved is None or not _counts(engine, solved):
            return False
        far = np.abs(solved.u - u)
        return bool((far <= VANISHING.loose * np.maximum(np.abs(u), engine.scale[:-1])).all())

    def _followed(self, start: Start, place: tuple[float, float], steps: int) -> tuple[Engine, Solved] | None:
        """Continue the motion of a start to a place in equal steps; None if Newton's method fails."""
        wide, reached, u = self.within[0][1] - self.within[0][0], None, start.u
        for share in np.arange(1, steps + 1) / steps:
            p = start.p + share * (place[0] - start.p)
            q = start.q + share * (place[1] - start.q)
            problem = start.problem.against(start.problem.parameter, {self.over: float(q)})
            engine = Engine(problem, (p - wide, p + wide), Settings())
            solved = engine.at_value(u, p)
            if solved is None:
                return None
            reached, u = (engine, solved), solved.u
        return reached


def _counts(engine: Engine, solved: Solved) -> bool:
    return bool(engine.stable(solved.row)) and float(engine.smallest_margin(solved.row)) > MARGIN


def _can_be_listed(problem: Problem) -> bool:
    """Whether a solution can be an entry of `simulated_attractors`; motions without events are left out, since every simulation finds them."""
    data = problem.describe()
    return isinstance(problem, Attracting) and data.get("word") != ""


def _key(problem: Problem, label: str) -> str:
    """Key that is equal for motions of one word; for motions without words it is the label of the branch."""
    data = problem.describe()
    if "word" not in data or "flow" in data:  # all cycles of flows have the word "cycle"
        return label
    return f"{data.get('word')} {data.get('periods')} {bool(data.get('symmetric'))}"


def together(
    simulated: list[dict[str, Any]], continued: list[dict[str, Any]], size: float = 0.0
) -> list[dict[str, Any]]:
    """Return the simulated motions, and the known ones that the simulation has missed; `size` is a typical size of the unknowns."""
    result = list(simulated)
    for one in continued:
        if not any(_same_motion(one, other, size) for other in result):
            result.append(one)
    return result


def _same_motion(a: dict[str, Any], b: dict[str, Any], unit: float) -> bool:
    if (a["word"], a["periods"]) != (b["word"], b["periods"]):
        return False
    if "u" not in a or "u" not in b:
        return True
    size = VANISHING.loose * max(float((np.abs(a["u"]) + np.abs(b["u"])).max()), unit)
    return bool(np.abs(np.subtract(a["u"], b["u"])).max() <= size)
