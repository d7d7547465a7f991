"""Identity: decide whether a solution, branch or special point is known already.

The distance of two solutions is that of their canonical forms (`Problem.canonical`): the largest difference of their entries, in units of
the unknowns, relative to 1 + the largest entry; infinite if their keys differ.

* Two solutions are the same if their distance is within ``Settings.same``. At points with singular equations (bifurcations, borders, ends of
  branches) solutions have only half their digits, and the tolerance is the square root of it.
* Two parameter values are the same if they differ by at most ten times their stated errors plus 1e-4 times ``Settings.same``, in the
  parameter's unit; without a stated error, by a hundredth of ``Settings.same``.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from ..branches import Branch
from ..branches.special_point import SpecialPoint
from ..continuation.engine import Engine, Solved
from ..continuation.settings import Settings
from ..problems.protocol import Problem


@dataclass(frozen=True)
class Identity:
    """Tolerances for equal parameter values and solutions, relative to `Settings.same`.

    Attributes
    ----------
    stated : float
        For values with stated errors, in addition to these.
    unstated : float
        For values without stated errors.
    exact : float
        For solutions that are equal to rounding; solutions that differ by more may lie on two branches with a small angle.
    """

    stated: float = 1e-4
    unstated: float = 1e-2
    exact: float = 1e-3


IDENTITY = Identity()
SAME = Settings().same
ERRORS = 10.0  # safety factor on stated errors
FAR = 0.1  # two branches that stay together over this length are the same

Form = tuple[Hashable, np.ndarray]


def distance(one: np.ndarray, other: np.ndarray, scale: np.ndarray | None = None) -> float:
    """Return the largest difference of two canonical vectors, relative to 1 + the largest entry of the second one.

    Both are first divided by `scale`, typical sizes of the entries, unless they have more entries than it (those of a whole cycle).
    """
    if one.shape != other.shape:
        return float("inf")
    vectors = np.array([one - other, other])
    if scale is not None and one.size < scale.size:
        vectors = vectors / scale[: one.size]
    difference, size = np.abs(vectors).max(axis=1, initial=0.0).tolist()
    return difference / (1.0 + size)


def same_vector(
    one: np.ndarray, other: np.ndarray, tolerance: float = SAME, scale: np.ndarray | None = None
) -> bool:
    """Whether the `distance` of two canonical vectors is within a tolerance."""
    return distance(one, other, scale) <= tolerance


def same_form(one: Form, other: Form, scale: np.ndarray | None = None, tolerance: float = SAME) -> bool:
    """Whether two canonical forms belong to the same solution."""
    return one[0] == other[0] and same_vector(one[1], other[1], tolerance, scale)


def singular(tolerance: float = SAME) -> float:
    """Return the tolerance for solutions at points with singular equations."""
    return float(np.sqrt(tolerance))


class Place(NamedTuple):
    """A parameter value and its error (0: not stated)."""

    value: float
    error: float


def same_value(one: Place, other: Place, unit: float, tolerance: float = SAME) -> bool:
    """Whether two parameter values are the same within their errors; see the top of the module."""
    stated = one.error > 0.0 and other.error > 0.0
    reach = (
        IDENTITY.stated * tolerance * unit + ERRORS * (one.error + other.error)
        if stated
        else IDENTITY.unstated * tolerance * unit
    )
    return abs(one.value - other.value) <= min(reach, tolerance * unit)


def may_be_one(
    problem: Problem, u: np.ndarray, p: float, point: SpecialPoint, tolerance: float = SAME
) -> bool:
    """Whether a solution may be the same motion as a border point with another word; different motions can meet borders at the same parameter value.

    The motions are compared if both problems are of the same type; else the result is True. A problem may compare motions itself (`same_motion`);
    canonical forms are compared otherwise, if they have equally many entries.
    """
    if type(point.attached) is not type(problem):
        return True
    same = problem.same_motion(u, p, point.attached, point.u)
    if same is not None:
        return same
    one, other = problem.canonical(u, p)[1], point.attached.canonical(point.u, point.value)[1]
    scales = problem.scales
    return one.shape != other.shape or same_vector(
        one, other, singular(tolerance), None if scales is None else scales.vector
    )


def turns_at(engine: Engine, fold: Solved, u: np.ndarray, p: float) -> bool:
    """Whether a fold coincides with the branch point (u, p), at which a side branch turns."""
    if u.shape != fold.u.shape:
        return False
    gap = engine.join(u - fold.u, p - fold.p)
    tolerance = engine.settings.same
    near = abs(gap[-1]) <= IDENTITY.unstated * tolerance * engine.parameter_unit(fold.p)
    return near and engine.norm(gap) <= singular(tolerance)


class KnownBranch:
    """A known branch in the register; the keys of its solutions are computed at first use.

    Parameters
    ----------
    branch : Branch
    engine : Engine
        Engine of the branch's problem.
    special : collection of int
        Indices of its special points.
    """

    def __init__(self, branch: Branch, engine: Engine, special: Collection[int | None] = ()) -> None:
        self.branch, self.engine, self.special = branch, engine, special
        self.low, self.high = float(branch.values.min()), float(branch.values.max())
        self.unit = float(engine.scale[-1])

    @cached_property
    def keys(self) -> set[Hashable]:
        """Keys of the branch's solutions: that of one ordinary inner point; if there is none, those of all points.

        Special points may repeat shorter solutions, which have another key.
        """
        branch, problem, count = self.branch, self.engine.problem, len(self.branch)
        inner = (i for i in range(max(count // 2, 1), count - 1) if i not in self.special)
        places = list(islice(inner, 1)) or range(count)
        return {problem.canonical(branch.points[i], float(branch.values[i]))[0] for i in places}

    def reaches(self, p: float) -> bool:
        """Whether the branch passes a parameter value, or ends there."""
        around = self.engine.settings.same * (self.unit + abs(p))
        return self.low - around <= p <= self.high + around


class Register:
    """Known branches. A solution is compared only with branches that reach its parameter value and have its key."""

    def __init__(self) -> None:
        self.known: list[KnownBranch] = []

    def add(self, branch: Branch, engine: Engine, special: Collection[int | None] = ()) -> None:
        """Add a branch; ``special`` are the indices of its special points."""
        self.known.append(KnownBranch(branch, engine, special))

    def find(self, problem: Problem, u: np.ndarray, p: float, real: bool | None = None) -> Branch | None:
        """Return the known branch on which a solution lies, or None.

        A branch that passes the parameter value is interpolated there, solved and compared. `real` selects real or virtual branches; None both.
        """
        near = [entry for entry in self.known if real in (None, entry.branch.real) and entry.reaches(p)]
        if not near:
            return None
        form = problem.canonical(u, p)
        for entry in near:
            branch, engine = entry.branch, entry.engine
            if form[0] not in entry.keys:
                continue
            limits = {True: engine.settings.same, False: engine.settings.near}
            if any(gap <= limits[solved] for gap, solved in _crossings(branch, engine, form, p, 0.1)):
                return branch
            place = Place(p, 0.0)  # it may be an end point of the branch
            for i in () if branch.closed else (0, -1):
                at = Place(float(branch.values[i]), 0.0)
                if same_value(at, place, engine.parameter_unit(p), engine.settings.same) and is_end(
                    branch, engine, i, form
                ):
                    return branch
        return None


def _crossings(
    branch: Branch, engine: Engine, form: Form, p: float, far: float = np.inf
) -> Iterator[tuple[float, bool]]:
    """Generate (distance, solved) for each crossing of a branch with a parameter value: the distance of its solution from a given one.

    The branch is interpolated, and solved from there. If that fails, the interpolated solution is used and `solved` is False. Crossings whose
    interpolated solutions are farther away than `far` are skipped.
    """
    (key, vector), gaps = form, branch.values - p
    for i in np.flatnonzero((gaps[:-1] * gaps[1:] <= 0.0) & (gaps[:-1] != gaps[1:])):
        guess = _at_value(branch, engine, int(i), p)
        form_key, near = engine.problem.canonical(guess, p)
        gap = distance(near, vector, engine.scale) if form_key == key else None
        if gap is not None and gap > far:
            continue
        found = engine.at_value(guess, p)
        if found is not None:
            form_key, near = engine.problem.canonical(found.u, p)
            if form_key == key:
                yield distance(near, vector, engine.scale), True
        elif gap is not None:
            yield gap, False


def separates_further_on(branch: Branch, known_engine: Engine, engine: Engine, first: Solved) -> bool:
    """Whether a branch whose first point equals a point of a known branch, within `Settings.same`, is a different branch that leaves at a small angle.

    It is followed with steps that double until it is away from the known branch, or far along it. Example: solutions of x (x - 1) (p - 3 x) = 0
    that leave x = 0, beside another unknown that is hundreds of times as large.

    Parameters
    ----------
    branch : Branch
        The known branch.
    known_engine : Engine
        Its engine. It may have other unknowns for the same solutions: of half a cycle instead of the whole one.
    engine : Engine
        Engine of the new branch.
    first : Solved
        First point of the new branch.
    """

    def away(point: Solved) -> float:
        """Return the distance of a point from the known branch."""
        form = engine.problem.canonical(point.u, point.p)
        return min(
            (gap for gap, solved in _crossings(branch, known_engine, form, point.p) if solved), default=np.inf
        )

    same = engine.settings.same
    gap, length, point = away(first), same, first
    exactly = IDENTITY.exact * same
    while exactly < gap <= same and 100.0 * engine.noise < exactly and length < FAR:
        found = engine.beside(point, length)
        if found is None or not engine.lower <= found.p <= engine.upper:
            return False
        if engine.inner(point.tangent, found.tangent) < 0.9:
            length *= 0.25
            if length < engine.settings.sliver:
                return False
            continue
        before, gap, point, length = gap, away(found), found, 2.0 * length
        if gap < before:
            return False
    return same < gap < np.inf


def is_end(branch: Branch, engine: Engine, i: int, form: Form) -> bool:
    """Whether a solution, given as its canonical form, is point i of a branch, one of its ends."""
    end_form = engine.problem.canonical(branch.points[i], float(branch.values[i]))
    return same_form(end_form, form, engine.scale, singular(engine.settings.same))


def _at_value(branch: Branch, engine: Engine, i: int, p: float) -> np.ndarray:
    """Return u at parameter value p on the cubic Hermite interpolation between points i and i + 1."""
    za, zb = (engine.join(branch.points[j], branch.values[j]) for j in (i, i + 1))
    chord = engine.norm(zb - za)

    def at(t: float, a: Any, slope_a: Any, b: Any, slope_b: Any) -> Any:
        rest = 1.0 - t
        return rest * rest * ((1.0 + 2.0 * t) * a + t * slope_a) + t * t * (
            (3.0 - 2.0 * t) * b - rest * slope_b
        )

    ends = za, chord * branch.tangents[i], zb, chord * branch.tangents[i + 1]
    parameter = [float(end[-1]) for end in ends]  # only its cubic has to be solved
    low, high, first = 0.0, 1.0, parameter[0] - p
    for _ in range(30):
        middle = 0.5 * (low + high)
        value = at(middle, *parameter) - p
        low, high, first = (middle, high, value) if (value > 0.0) == (first > 0.0) else (low, middle, first)
    return at(0.5 * (low + high), *ends)[:-1]
