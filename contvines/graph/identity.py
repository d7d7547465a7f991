"""Identity: is this solution, branch or special point known? One room, one distance, one tolerance.

The distance of two solutions is that of their canonical forms (`Problem.canonical`): the largest difference of their entries, in units of
the unknowns, relative to 1 + the largest entry; infinite where their keys differ. Two solutions are one up to ``Settings.same``. Where
equations are singular (at bifurcations, at borders, where branches end) solutions are known to half their digits, so that the
root of it counts. Values of the parameter are one up to ten times their stated errors and 1e-4 times that tolerance, in the parameter's unit, or, where no error
is stated, up to a hundredth of it.
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
    """When two values of the parameter, or two solutions, are one, in parts of `Settings.same`.

    Attributes
    ----------
    stated : float
        Of values whose errors are stated; the errors come on top of it.
    unstated : float
        Of values of which none is stated.
    exact : float
        Of solutions to roundoff: those that differ by more are two, though they count as the same.
    """

    stated: float = 1e-4
    unstated: float = 1e-2
    exact: float = 1e-3


IDENTITY = Identity()
SAME = Settings().same
ERRORS = 10.0  # times the stated errors
FAR = 0.1  # length along two branches after which they are one

Form = tuple[Hashable, np.ndarray]


def distance(one: np.ndarray, other: np.ndarray, scale: np.ndarray | None = None) -> float:
    """Largest difference of two canonical vectors, in units of a scale of the entries, relative to 1 + the largest entry of the second one.

    A vector that has more entries than there are unknowns, a whole cycle's, is in units of its own.
    """
    if one.shape != other.shape:
        return float("inf")
    both = np.array([one - other, other])
    if scale is not None and one.size < scale.size:
        both = both / scale[: one.size]
    apart, size = np.abs(both).max(axis=1, initial=0.0).tolist()
    return apart / (1.0 + size)


def same_vector(
    one: np.ndarray, other: np.ndarray, tolerance: float = SAME, scale: np.ndarray | None = None
) -> bool:
    """Whether the `distance` of two canonical vectors is within a tolerance."""
    return distance(one, other, scale) <= tolerance


def same_form(one: Form, other: Form, scale: np.ndarray | None = None, tolerance: float = SAME) -> bool:
    """Whether two canonical forms, as problems return them, are of one solution."""
    return one[0] == other[0] and same_vector(one[1], other[1], tolerance, scale)


def singular(tolerance: float = SAME) -> float:
    """The tolerance where equations are singular."""
    return float(np.sqrt(tolerance))


class Place(NamedTuple):
    """A parameter value, and how well it is known (0: not said)."""

    value: float
    error: float


def same_value(one: Place, other: Place, unit: float, tolerance: float = SAME) -> bool:
    """Whether two parameter values may be one, as far as they are known; see the top."""
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
    """Whether a solution may be a border point seen with another word: different motions do meet borders at one value.

    Only problems of one kind tell: those that can compare motions, and others where their forms have as many entries.
    """
    if type(point.attached) is not type(problem):
        return True
    alike = problem.same_motion(u, p, point.attached, point.u)
    if alike is not None:
        return alike
    one, other = problem.canonical(u, p)[1], point.attached.canonical(point.u, point.value)[1]
    scales = problem.scales
    return one.shape != other.shape or same_vector(
        one, other, singular(tolerance), None if scales is None else scales.vector
    )


def turns_at(engine: Engine, fold: Solved, u: np.ndarray, p: float) -> bool:
    """Whether a fold is so close to a branch point that it is that point, where a side branch only turns."""
    if u.shape != fold.u.shape:
        return False
    gap = engine.join(u - fold.u, p - fold.p)
    tolerance = engine.settings.same
    near = abs(gap[-1]) <= IDENTITY.unstated * tolerance * engine.parameter_unit(fold.p)
    return near and engine.norm(gap) <= singular(tolerance)


class Known:
    """A branch that is known, with its engine; what its solutions are is worked out when the first is looked for where it lies."""

    def __init__(self, branch: Branch, engine: Engine, special: Collection[int | None] = ()) -> None:
        self.branch, self.engine, self.special = branch, engine, special
        self.low, self.high = float(branch.values.min()), float(branch.values.max())
        self.unit = float(engine.scale[-1])

    @cached_property
    def keys(self) -> set[Hashable]:
        """The key of its inner points, which one of them tells; where all are special points, and so may repeat shorter solutions, those of all points."""
        branch, problem, count = self.branch, self.engine.problem, len(self.branch)
        inner = (i for i in range(max(count // 2, 1), count - 1) if i not in self.special)
        places = list(islice(inner, 1)) or range(count)
        return {problem.canonical(branch.points[i], float(branch.values[i]))[0] for i in places}

    def reaches(self, p: float) -> bool:
        """Whether it passes a parameter value, or ends there."""
        around = self.engine.settings.same * (self.unit + abs(p))
        return self.low - around <= p <= self.high + around


class Register:
    """Known branches; a seed is compared only with branches that reach its parameter value, and have its key."""

    def __init__(self) -> None:
        self.known: list[Known] = []

    def add(self, branch: Branch, engine: Engine, special: Collection[int | None] = ()) -> None:
        """Remember a branch; ``special`` are the indices of its special points."""
        self.known.append(Known(branch, engine, special))

    def find(self, problem: Problem, u: np.ndarray, p: float, real: bool | None = None) -> Branch | None:
        """The known branch on which a solution lies, or None.

        Where a branch passes the parameter value it is interpolated, solved there and compared.
        """
        near = [known for known in self.known if real in (None, known.branch.real) and known.reaches(p)]
        if not near:
            return None
        form = problem.canonical(u, p)
        for known in near:
            branch, engine = known.branch, known.engine
            if form[0] not in known.keys:
                continue
            limits = {True: engine.settings.same, False: engine.settings.near}
            if any(gap <= limits[solved] for gap, solved in _crossings(branch, engine, form, p, 0.1)):
                return branch
            place = Place(p, 0.0)  # it may be an end point of the branch, where the parameter is not passed
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
    """Distances of a solution, in its canonical form, from those of a branch that passes its parameter value, and whether these were solved for.

    Else they are those of the interpolated ones, of which those farther away than `far` are passed over.
    """
    (key, vector), gaps = form, branch.values - p
    for i in np.flatnonzero((gaps[:-1] * gaps[1:] <= 0.0) & (gaps[:-1] != gaps[1:])):
        guess = _at_value(branch, engine, int(i), p)
        here, near = engine.problem.canonical(guess, p)
        apart = distance(near, vector, engine.scale) if here == key else None
        if apart is not None and apart > far:
            continue
        found = engine.at_value(guess, p)
        if found is not None:
            here, near = engine.problem.canonical(found.u, p)
            if here == key:
                yield distance(near, vector, engine.scale), True
        elif apart is not None:
            yield apart, False


def parts_further_on(branch: Branch, known: Engine, engine: Engine, first: Solved) -> bool:
    """Whether a branch that begins on a known one, within what counts as the same, is another one: it may leave at a small angle.

    It is followed in steps of twice the length until it is away from the known one, or far along it. Solutions of x (x - 1) (p - 3 x) = 0 with
    another unknown that is hundreds of times as large leave x = 0 so.

    Parameters
    ----------
    branch : Branch
        The known one.
    known : Engine
        Its own: the same solutions may be written with other unknowns there, half a cycle's instead of the whole one's.
    engine : Engine
        Of the branch that begins.
    first : Solved
    """

    def away(point: Solved) -> float:
        form = engine.problem.canonical(point.u, point.p)
        return min(
            (gap for gap, solved in _crossings(branch, known, form, point.p) if solved), default=np.inf
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
    """Whether a solution, in its canonical form, is point i of a branch, an end of it."""
    here = engine.problem.canonical(branch.points[i], float(branch.values[i]))
    return same_form(here, form, engine.scale, singular(engine.settings.same))


def _at_value(branch: Branch, engine: Engine, i: int, p: float) -> np.ndarray:
    """u at parameter value p on the cubic between points i and i + 1."""
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
