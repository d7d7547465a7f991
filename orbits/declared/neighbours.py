"""Orbits of a declared machine next to a border: with a changed word, what vanishes at the border is given a size."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from orbits.contacts.changes import Change, Grows, What
from orbits.cycles.claim import REAL
from orbits.declared.edits import FIRST
from orbits.declared.orbit import DeclaredOrbit
from orbits.flows.page.cycle_equations import DeclaredSystem
from orbits.flows.page.sampling import sample
from orbits.flows.page.solving import SOLVED, examined, newton
from orbits.words.edit import Edit
from orbits.words.rewriting import applied, spliced

SIZES = ((2e-3, 2e-4, 2e-5), (1e-4, 2e-5), (2e-6, 2e-7), (2e-8,))  # of what grows beyond the border
NEAR = 0.02  # change of the parameter, relative, beyond which an orbit is not next to the border
LEAST = 1e-6  # duration of a flight of a guess
GROWING = 1e-4  # least growth of the margins with the distance from a border
Found = tuple[DeclaredSystem, np.ndarray, float, np.ndarray]


def grown(
    problem: DeclaredSystem,
    orbit: DeclaredOrbit,
    p: float,
    edits: list[Edit],
    ways: Sequence[tuple[float, ...]] = SIZES,
    steady: bool = False,
) -> Found | None:
    """Solve for the new word with the vanishing quantity at small sizes; the smallest that converges.

    None if there is no real orbit, nor, if `steady`, if it is unstable at all of the sizes.
    """
    start = with_edits(problem, orbit, edits)
    if start is None:
        return None
    other, guess, first, change = start
    if change.grows is Grows.MARGIN:
        found = _beside(other, guess, p)
        return None if found is None or (steady and not stable_at(found)) else found
    for sizes in ways:
        climbed = climb(other, guess, first, change, p, sizes)
        if (
            climbed and steady
        ):  # beside a graze the multipliers grow without bound: stable from a flip close to it on
            climbed = [found for found in climbed if stable_at(found)]
            if not climbed:
                return None
        if climbed and margins_of(*climbed[-1][:3]).min() >= REAL:
            return climbed[-1]
    return None


def with_edits(
    problem: DeclaredSystem, orbit: DeclaredOrbit, edits: list[Edit]
) -> tuple[DeclaredSystem, np.ndarray, int, Change] | None:
    """The problem of the new word, its unknowns at the border, and where what grows stands, with its change; None for no word."""
    length = problem.length
    forced = problem.forced
    empty = not len(problem.word)
    changes, placed = [edit.change for edit in edits], [edit.nodes for edit in edits]
    halved = (
        problem.symmetric
        if not empty
        else problem.mirrored and bool(edits[0].change.events) and problem.word.mirror_symmetric_halves
    )
    if halved:  # the same happens half a period later to the mirror image
        if not empty and any(change.stop > length for change in changes):
            return None
        word, first = applied(orbit.word if empty else orbit.word.head(length), changes)
        nodes = spliced(orbit.nodes[:length], changes, placed, empty)
        word = word.with_image()
    else:
        word, first = applied(orbit.word, changes)
        nodes = spliced(orbit.nodes, changes, placed, empty)
    if not forced:
        nodes = _durations(orbit, nodes, edits[0])
    try:
        other = problem.sibling(word, problem.periods, halved and bool(len(word)))
    except ValueError:
        return None
    if not len(word):
        nodes = _strobed(orbit)
    return other, np.ascontiguousarray(nodes, dtype=float).ravel(), first, changes[0]


def stable_at(found: Found) -> bool:
    """Whether all multipliers of a solution lie inside the unit circle."""
    values = examined(found[0], found[1], found[2])[1]
    return bool(np.all(np.abs(found[0].to_multipliers(values)) < 1.0))


def margins_of(problem: DeclaredSystem, u: np.ndarray, p: float) -> np.ndarray:
    return np.nan_to_num(examined(problem, u, p)[2], nan=-np.inf, posinf=np.inf)


def _durations(orbit: DeclaredOrbit, nodes: np.ndarray, edit: Edit) -> np.ndarray:
    """Durations after an edit of a self-excited orbit, whose inserted nodes carry clocks from the flight's start."""
    nodes = nodes.copy()
    change, m = edit.change, len(edit.change.events)
    if change.start == change.stop and m:  # inserted into the flight before `start`
        whole = float(orbit.nodes[change.start - 1, 0])
        inside = edit.nodes[:, 0]
        nodes[change.start - 1, 0] = inside[0]
        for k in range(m):
            until = inside[k + 1] if k + 1 < m else whole
            nodes[change.start + k, 0] = until - inside[k]
    else:  # from the event before `start` to that at `stop` it takes as long as before
        alone = (
            len(nodes) == m
        )  # nothing of the old word is left: the last flight leads to the first new event
        durations = np.roll(orbit.nodes[:, 0], 1 - change.start)
        passed = np.cumsum(durations[: change.stop - change.start + 1])
        instants = []
        for spot in change.spots:
            event = spot.node if spot.clock is None else spot.clock
            assert event is not None  # nothing is met where events give way to others
            place = event - change.start
            ahead = 0.5 * (passed[place + 1] - passed[place]) if spot.between else 0.0
            instants.append(passed[place] + ahead + spot.later * FIRST)
        whole = np.array(
            [0.0, *instants, passed[-1]] if not alone else [*instants, instants[0] + durations.sum()]
        )
        spans = np.maximum(np.diff(whole), LEAST)
        nodes[(np.arange(len(spans)) + change.start - (0 if alone else 1)) % len(nodes), 0] = spans
    return nodes


def _strobed(orbit: DeclaredOrbit) -> np.ndarray:
    """Node at phase zero of a motion on which nothing happens any more."""
    table = sample(orbit, 4000)
    phase = table["phase"] / (2.0 * np.pi)
    k = int(np.argmin(np.abs(phase - np.round(phase))))
    return np.array([[0.0, *(table[name][k] for name in orbit.machine.states)]])


def climb(
    other: DeclaredSystem, guess: np.ndarray, first: int, change: Change, p: float, sizes: tuple[float, ...]
) -> list[Found]:
    """Solve with what grows beyond the border held at each of the sizes in turn, until one does not converge."""
    d, size = other.size + 1, other.dimension
    found: list[Found] = []
    u, q = guess.copy(), p
    for wanted in sizes:
        border = np.zeros(size + 1)
        if change.grows is Grows.GAP:
            if other.forced:
                border[first * d], border[((first + 1) * d) % size] = -1.0, 1.0
                middle = 0.5 * (u[first * d] + u[(first + 1) * d])
                early = middle - 0.5 * wanted
                if change.start != change.stop:
                    early = u[first * d]
                elif change.what is What.STICK_APPEARS:
                    early = u[(first + 1) * d] - wanted
                u[first * d], u[(first + 1) * d] = early, early + wanted
            else:
                border[first * d] = 1.0
                u[first * d] = wanted
        else:
            rate, slope, push = _approach(other, u, q, first)
            border[first * d + 1 : (first + 1) * d] = slope
            u[first * d + 1 : (first + 1) * d] += push * (wanted - rate) / float(slope @ push)
        trial, q_new, residual, tangent = newton(other, u, q, border)
        if not residual < SOLVED or abs(q_new - p) > NEAR * max(1.0, abs(p)):
            break
        u, q = trial, q_new
        found.append((other, u.copy(), q, tangent / np.abs(tangent).max()))
    return found


def _approach(
    problem: DeclaredSystem, u: np.ndarray, p: float, place: int
) -> tuple[float, np.ndarray, np.ndarray]:
    """Rate of a wall's gap after an impact, its slope by the states, and the push of that wall."""
    compiled, d = problem.machine.compiled, problem.size + 1
    wall = problem.letters[place].contact
    node = u[place * d : (place + 1) * d]
    numbers = compiled.numbers(problem.values(p), problem.word.modes[place])
    row = compiled.approach(wall)(node[None, 1:], node[:1] if problem.forced else np.zeros(1), numbers[None])[
        0
    ]
    return float(row[0]), row[1:d], row[d:]


def _beside(other: DeclaredSystem, guess: np.ndarray, p: float) -> Found | None:
    """The new word's branch through the border itself, on the side where its margins grow."""
    u, q, residual, tangent = newton(other, guess, p)
    if not residual < SOLVED:
        return None
    tangent = tangent / np.linalg.norm(tangent)
    for length in (1e-3, 1e-4, 1e-5, 1e-6):
        best, most = None, GROWING * length
        for sign in (1.0, -1.0):
            v, r, residual, along = newton(
                other, u + sign * length * tangent[:-1], q + sign * length * tangent[-1], tangent
            )
            if not residual < SOLVED:
                continue
            smallest = float(margins_of(other, v, r).min())
            if smallest > most:
                along = along / np.linalg.norm(along)
                best, most = (other, v, r, sign * along), smallest
        if best is not None:
            return best
    return None
