"""Solve for orbits with a rewritten word next to a border, with the size (duration or speed) of the vanishing event held fixed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from orbits.borders.rewriting import Edit, durations_after, edits_at, rewritten
from orbits.contacts import HIT, SLIP, STICK, Change, Grows, WordChange
from orbits.flows.equations import newton
from orbits.orbit import REAL, SHRINKS, Orbit, examined, gap, tends
from orbits.protocol import CycleProblem
from orbits.settings import BORDERING, GROWING, REPLAYING, SOLVING

ASTRAY = 0.1  # largest distance of a solution from its prediction, relative to that from the border; beyond, it belongs to another branch
CLOSER = 3  # further solutions, each ten times closer to the border, that must tend to the border orbit
ROOM = 4  # rotations tried, by events before the margin's


def parameter_unit(problem: CycleProblem, p: float) -> float:
    """Scale of parameter changes near p: its size there, or at the start of the branch."""
    return max(abs(p), abs(problem.equations.began)) or 1.0


def margins_of(problem: CycleProblem, u: np.ndarray, p: float) -> np.ndarray:
    """Margins of a solution; -inf in place of NaN."""
    return np.nan_to_num(examined(problem.equations, u, p)[2], nan=-np.inf, posinf=np.inf)


def stable_at(problem: CycleProblem, u: np.ndarray, p: float) -> bool:
    """Whether all multipliers of a solution lie inside the unit circle."""
    return bool((np.abs(examined(problem.equations, u, p)[1]) < 1.0).all())


class Border:
    """A border orbit, rotated to one of its events, and the edits that the local rules propose.

    Attributes
    ----------
    problem, u, p
        The border orbit as a solution.
    margin : int
        Index of the margin that vanishes.
    """

    def __init__(self, problem: CycleProblem, u: np.ndarray, p: float, margin: int) -> None:
        self.problem, self.u, self.p, self.margin = problem, u, p, margin
        self._rewritten: dict[int, RewrittenOrbit | None] = {}

    @cached_property
    def orbit(self) -> Orbit:
        """The border orbit."""
        return self.problem.orbit(self.u, self.p)

    @cached_property
    def edits(self) -> list[Edit]:
        """Edits that the local rules propose."""
        return edits_at(self.orbit, self.margin, self.problem.length)

    @property
    def event(self) -> int:
        """Index of the margin's event."""
        return self.margin // len(self.problem.word.alphabet.columns)

    def rewrite(self, edit: Edit) -> RewrittenOrbit | None:
        """The rewritten word of a single edit (see `rewrite`), computed once."""
        if id(edit) not in self._rewritten:
            self._rewritten[id(edit)] = rewrite(self.problem, self.orbit, self.p, [edit])
        return self._rewritten[id(edit)]

    def read_from(self, first: int) -> Border:
        """The same border, rotated to event `first`."""
        problem, width = self.problem, len(self.problem.word.alphabet.columns)
        orbit = self.orbit.rotate(first % len(problem.word))
        other = problem.sibling(orbit.word, problem.periods, problem.symmetric)
        margin = width * ((self.event - first) % problem.length) + self.margin % width
        return Border(other, other.reduce(orbit.nodes), self.p, margin)

    def with_room(self) -> Iterator[Border]:
        """Yield the same border with other numbers of events before the margin's: a change may need events on both sides."""
        for ahead in range(min(ROOM, self.problem.length)):
            if ahead != self.event and len(self.problem.word):
                yield self.read_from(self.event - ahead)


def placed(problem: CycleProblem, u: np.ndarray, p: float, index: int) -> Border:
    """The border at which margin `index` of a solution vanishes, rotated so that the changed events do not wrap around the end of the word."""
    border = Border(problem, u, p, index)
    place = border.event
    if not len(problem.word) or problem.length < 2:
        return border
    slip = problem.word.letter(place).kind == SLIP
    if 0 < place < problem.length - 1 or (place == 0 and not slip):
        return border
    return border.read_from(place - 1 if slip else place)


class BranchAtBorder(NamedTuple):
    """A solution next to the border, on a branch that begins there; `tangent` (None if unknown) points away from the border."""

    problem: CycleProblem
    u: np.ndarray
    p: float
    tangent: np.ndarray | None

    def orbit(self) -> Orbit:
        """The solution as an orbit."""
        return self.problem.orbit(self.u, self.p)


def proposals(border: Border) -> Iterator[tuple[BranchAtBorder, str]]:
    """Yield solutions next to the border with the words that the local rules propose, and a description of each change."""
    problem, orbit, p = border.problem, border.orbit, border.p
    values = margins_of(problem, border.u, p)
    vanishing = [
        j for j in range(problem.n_margins) if j != border.margin and abs(values[j]) < BORDERING.simultaneous
    ]
    for first in border.edits:
        chosen = [first]
        for j in vanishing:
            for edit in edits_at(orbit, j, problem.length):
                same_change = edit.change.effect is first.change.effect
                if same_change and not any(_overlap(edit.change, other.change) for other in chosen):
                    chosen.append(edit)
                    break
        if len(chosen) > 1 and (found := branch_at_border(rewrite(problem, orbit, p, chosen))) is not None:
            yield found, first.change.effect.value
        if (found := branch_at_border(border.rewrite(first))) is not None:
            yield found, first.change.effect.value


def followed(orbit: Orbit) -> bool:
    """Whether all margins are positive and the simulation follows the orbit."""
    return orbit.real and orbit.replay() < REPLAYING.followed


def _overlap(a: Change, b: Change) -> bool:
    return a.start < max(b.stop, b.start + 1) and b.start < max(a.stop, a.start + 1)


class SizedSolution(NamedTuple):
    """A solution in which the growing quantity (duration or speed of the new event) has a given size."""

    u: np.ndarray
    p: float
    tangent: np.ndarray
    size: float


class GrowingQuantity(NamedTuple):
    """A quantity that grows from zero beyond a border at `p`: problem of the rewritten word, index of its new event, and the change of the word."""

    problem: CycleProblem
    first: int
    change: Change
    p: float

    def climb(self, guess: np.ndarray, sizes: tuple[float, ...]) -> list[SizedSolution]:
        """Solve with the quantity held at each of the sizes in turn, until Newton's method fails."""
        found: list[SizedSolution] = []
        u, q = guess, self.p
        for wanted in sizes:
            held = self.hold(u, q, wanted)
            if held is None:
                break
            found.append(held)
            u, q = held.u, held.p
        return found

    def outwards(self, found: list[SizedSolution]) -> Iterator[SizedSolution]:
        """Yield the solutions found from small to large sizes, then solutions of still larger sizes."""
        yield from found[-2::-1]
        held: SizedSolution | None = found[0]
        while held is not None and held.size < GROWING.first:
            held = self.hold(held.u, held.p, min(10.0 * held.size, GROWING.first))
            if held is not None:
                yield held

    def hold(self, guess: np.ndarray, q: float, wanted: float) -> SizedSolution | None:
        """Solve with the quantity held at a size; None if there is no such solution near the border."""
        other, first, change, p = self
        size = other.dimension
        n = size // other.length
        border = np.zeros(size + 1)
        u, place, following = guess.copy(), first * n, (first + 1) * n % size
        if change.grows is Grows.GAP and not other.forced:
            border[place], u[place] = 1.0, wanted
        elif change.grows is Grows.GAP:
            border[place], border[following] = -1.0, 1.0
            if change.effect is WordChange.CROSSINGS_APPEAR:
                u[place] = 0.5 * (u[place] + u[following] - wanted)
                u[following] = u[place] + wanted
            elif change.start == change.stop:  # the later event, at which friction gives way, stays
                u[place] = u[following] - wanted
            else:
                u[following] = u[place] + wanted
        else:
            near = BORDERING.simultaneous * parameter_unit(other, p)
            speed, slopes, by_parameter, push = other.equations.approach(u, q, first, near)
            border[place : place + n], border[size] = slopes, by_parameter
            u[place : place + n] += push * (wanted - speed) / float(slopes @ push)
            if (
                len(change.events) > 1
                and other.word.letter(first + 1).kind == STICK
                and abs(speed) > BORDERING.simultaneous
            ):  # the time until it comes to rest is proportional to its speed
                clock = place if not other.forced else following
                duration = u[following] - u[place] if other.forced else u[place]
                u[clock] += duration * (wanted / speed - 1.0)
        u, q, residual, tangent = newton(other.equations, u, q, border)
        if not residual < SOLVING.residual:
            return None
        return SizedSolution(u, q, tangent, wanted)


class RewrittenOrbit:
    """The rewritten word of a border orbit, and its solutions next to the border, each computed once.

    Attributes
    ----------
    orbit : Orbit
        The border orbit.
    stated : GrowingQuantity
        The growing quantity according to the edits.
    guess : float array (N,)
        Unknowns of the new orbit at the border.
    """

    def __init__(self, orbit: Orbit, stated: GrowingQuantity, guess: np.ndarray) -> None:
        self.orbit, self.stated, self.guess = orbit, stated, guess
        self._climbed: dict[tuple[float, ...], list[SizedSolution]] = {}

    @cached_property
    def growing(self) -> GrowingQuantity | None:
        """The quantity that grows from zero; None if the equations of the new word are regular at the border.

        If the edits name no growing quantity, another round of the cycle may still contain an impact of vanishing speed or a stick of
        vanishing length, which makes the equations singular at the border.
        """
        (other, _, change, p), guess = self.stated, self.guess
        if change.grows is not Grows.MARGIN:
            return self.stated
        if not len(other.word):
            return None
        orbit, near = other.orbit(guess, p), BORDERING.simultaneous * parameter_unit(other, p)
        for place in range(other.length):
            kind = other.word.letter(place).kind
            if (
                kind == HIT
                and abs(other.equations.approach(guess, p, place, near).speed) < BORDERING.simultaneous
            ):
                grows = Grows.SPEED
            elif (
                kind == STICK
                and place + 1 < other.length
                and abs(orbit.durations[place]) < BORDERING.simultaneous
            ):
                grows = Grows.GAP
            else:
                continue
            events = other.word.events[place : place + 2]
            return GrowingQuantity(
                other, place, replace(change, start=place, stop=place, events=events, grows=grows), p
            )
        return None

    def climbed(self, sizes: tuple[float, ...]) -> list[SizedSolution]:
        """Solutions in which the growing quantity has these sizes; see `GrowingQuantity.climb`."""
        if sizes not in self._climbed:
            assert self.growing is not None
            self._climbed[sizes] = self.growing.climb(self.guess, sizes)
        return self._climbed[sizes]


def rewrite(problem: CycleProblem, orbit: Orbit, p: float, edits: list[Edit]) -> RewrittenOrbit | None:
    """Rewrite the word of a border orbit by edits; None if no word is possible."""
    half, halved = problem.length, problem.symmetric
    if halved and len(problem.word):  # edit the half, and mirror it
        if any(edit.change.stop > half and edit.change.start != half for edit in edits):
            return None
        word, nodes, first = rewritten(orbit.word.head(half), orbit.nodes[:half], edits)
    else:
        word, nodes, first = rewritten(orbit.word, orbit.nodes, edits)
    if halved:
        word = word.with_image()
    if not len(word):
        event_free = orbit.flow.without_events(orbit)
        if event_free is None:
            return None
        nodes, halved = event_free, halved and word.mirror_symmetric_halves
    elif not problem.forced:
        nodes = durations_after(orbit.durations, nodes, edits[0])
    try:
        other = problem.sibling(word, problem.periods, halved)
    except ValueError:
        return None
    return RewrittenOrbit(orbit, GrowingQuantity(other, first, edits[0].change, p), other.reduce(nodes))


def branch_at_border(
    rewriting: RewrittenOrbit | None,
    trials: tuple[tuple[float, ...], ...] = BORDERING.sizes,
    steady: bool = False,
) -> BranchAtBorder | None:
    """Solve for an orbit of the new word next to the border, with the growing quantity at the smallest size for which Newton's method converges.

    None if no solution is real and tends to the border orbit or, with `steady`, if that solution is unstable.
    """
    if rewriting is None:
        return None
    (other, _, change, p), orbit = rewriting.stated, rewriting.orbit
    if change.grows is Grows.MARGIN:
        found = _solved_both_sides(other, rewriting.guess, p, orbit, steady)
        if found is not None or rewriting.growing is None:
            return found
    assert rewriting.growing is not None
    for sizes in trials:
        found = rewriting.climbed(sizes)
        if (
            found and steady
        ):  # at a graze multipliers are unbounded: an orbit may be stable only from a period doubling close to it on
            found = [held for held in found if stable_at(other, held.u, held.p)]
            if not found:
                return None
        if found and _begins_at(orbit, rewriting.growing, found):
            return BranchAtBorder(other, *found[-1][:3])
    return None


def _begins_at(border: Orbit, growing: GrowingQuantity, found: list[SizedSolution]) -> bool:
    """Whether the solutions, from large to small sizes, are real and tend to the border orbit.

    Margins that vanish at the border are too small for a sign next to it; solutions further away decide.
    """
    other, near, second, size = growing.problem, found[-1], None, found[-1].size
    values = margins_of(other, near.u, near.p)
    if values.min() < REAL:
        return False
    undecided = np.abs(values) < BORDERING.certain
    for held in growing.outwards(found):
        second, size = second or held, held.size
        if not undecided.any():
            break
        values = margins_of(other, held.u, held.p)
        if np.any(undecided & (values < -BORDERING.certain)):
            return False
        undecided &= values < BORDERING.certain
    if size < GROWING.first and np.any(undecided & (values < REAL)):
        return False  # no solution at a size where their sign is certain
    further = second or near
    distance = gap(border, other.orbit(near.u, near.p))
    if not tends(distance, lambda: gap(border, other.orbit(further.u, further.p))):
        return False
    return _keeps_tending(border, growing, near, distance)


def _keeps_tending(border: Orbit, growing: GrowingQuantity, near: SizedSolution, distance: float) -> bool:
    """Whether solutions of still smaller sizes, as far as Newton's method converges, go on tending to the border orbit and its parameter value.

    Solutions of a branch that only passes nearby stop doing so. `distance` is the distance of the solution `near` from the border orbit.
    """
    other, p = growing.problem, growing.p
    placed = BORDERING.placed * parameter_unit(other, p)
    for _ in range(CLOSER):
        held = growing.hold(near.u, near.p, 0.1 * near.size)
        if held is None:
            break
        closer = gap(border, other.orbit(held.u, held.p))
        if not tends(closer, lambda distance=distance: distance):
            return False
        if abs(held.p - p) > max(SHRINKS * abs(near.p - p), placed):
            return False
        near, distance = held, closer
    return True


def _solved_both_sides(
    other: CycleProblem, guess: np.ndarray, p: float, orbit: Orbit, steady: bool
) -> BranchAtBorder | None:
    """Solve for a regular word at fixed parameter values on both sides of the border, and return the solution that is real."""
    unit = parameter_unit(other, p)
    at_border, _, residual, tangent = newton(other.equations, guess, p)
    if not residual < SOLVING.residual:
        return None
    # if the branch has a fold, or its period is halved, close by, solutions at a fixed value may belong to another branch
    steep = np.abs(tangent).max() * unit > BORDERING.steep
    found = _solved_along(other, at_border, p, tangent) if steep else None
    for away in BORDERING.regular if found is None else ():
        sides = []
        for side in (1.0, -1.0):
            q = p + side * away * unit
            ahead = at_border + (q - p) * tangent[:-1]
            u, _, residual, along = newton(other.equations, ahead, q)
            astray = np.abs(u - ahead).max() > ASTRAY * np.abs(ahead - at_border).max() + BORDERING.certain
            if residual < SOLVING.residual and not astray:
                sides.append((float(margins_of(other, u, q).min()), u, q, side * along))
        if sides:
            margin, u, q, along = max(sides, key=lambda entry: entry[0])
            if (
                margin > BORDERING.growing * away
            ):  # the margin grows; it does not vanish along the whole branch, as at a wall touched without speed
                found = BranchAtBorder(other, u, q, along)
                break
    if found is None or (steady and not stable_at(other, found.u, found.p)):
        return None
    distance = gap(orbit, other.orbit(at_border, p))
    return found if tends(distance, lambda: gap(orbit, found.orbit())) else None


def _solved_along(
    other: CycleProblem, at_border: np.ndarray, p: float, tangent: np.ndarray
) -> BranchAtBorder | None:
    """The same if the new branch turns back close to the border: solve in both directions of its tangent."""
    length = np.hypot(np.linalg.norm(tangent[:-1]), tangent[-1] / parameter_unit(other, p))
    for away in BORDERING.turning:
        for side in (1.0, -1.0):
            direction = side * tangent / length
            ahead = at_border + away * direction[:-1]
            u, q, residual, _ = newton(other.equations, ahead, p + away * direction[-1], direction)
            if residual < SOLVING.residual and margins_of(other, u, q).min() > BORDERING.growing * away:
                return BranchAtBorder(other, u, q, direction)
    return None
