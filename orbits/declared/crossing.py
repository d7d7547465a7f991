"""Across a border of a declared machine: the word on the other side, and the orbit with which its branch begins.

The rules of `edits` propose the word, and what vanishes at the border is given a size; where they do not lead on, the simulator
writes the word. A proposal counts only if its equations have a real solution next to the border and the simulator follows it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from orbits.contacts.changes import Change
from orbits.contacts.letters import SLIP, STICK
from orbits.cycles.claim import REAL
from orbits.declared.attractor import settle
from orbits.declared.deviation import deviation
from orbits.declared.distance import distance
from orbits.declared.edits import edits_at
from orbits.declared.neighbours import Found, grown, margins_of
from orbits.declared.orbit import DeclaredOrbit
from orbits.declared.rounds import escapes
from orbits.flows.page.cycle_equations import DeclaredSystem
from orbits.flows.page.margins import per_node
from orbits.flows.page.solving import SOLVED, newton
from orbits.flows.page.stepper import SimulationError, Stepper
from orbits.protocol import Seed

FOLLOWED = 1e-5  # deviation of the simulation up to which it follows an orbit next to a border
CLOSE = 0.05  # of one that goes on from the border
BESIDE = (1e-4, 1e-5)  # distances from a border at which the branch that ends there is looked at
ROOM = 4  # events that may stand before that of the margin


def cross(problem: DeclaredSystem, point: Any, every: bool = True) -> list[Seed]:
    """Seeds of the branches on the other side of a border (as `orbits.borders.crossing.cross`)."""
    u, p = np.asarray(point.u, dtype=float), float(point.value)
    index = int(point.margin_index)
    tangent_here = np.asarray(point.tangent, dtype=float)
    found = [_real_part(problem, u, p, tangent_here, index, length) for length in BESIDE]
    nearby = [side for side in found if side is not None]
    old_side = 0.0 if found[0] is None else float(np.sign(found[0][1] - p))
    seeds = []
    for other, v, q, tangent, note in (*proposals(problem, u, p, index), *_simulated(problem, u, p)):
        if not _followed(DeclaredOrbit.of(other, v, q)):
            continue
        smallest, v, tangent = _simplest(other, v, q, tangent)
        persistence = bool(np.sign(q - p) != old_side)
        kind = "persistence" if persistence else "nonsmooth fold"
        text = f"{note}: {kind}, the word becomes {smallest.word.text or 'free of events'}"
        seeds.append(Seed(smallest, v, q, tangent, "border", text, persistence))  # type: ignore[arg-type]
        break
    if seeds and not every:
        return seeds
    return seeds + list(_escapes(problem, u, p, index, nearby))


def _followed(orbit: DeclaredOrbit) -> bool:
    return orbit.margin >= REAL and deviation(orbit) < FOLLOWED


def _simplest(
    problem: DeclaredSystem, u: np.ndarray, p: float, tangent: np.ndarray | None
) -> tuple[DeclaredSystem, np.ndarray, np.ndarray | None]:
    """The orbit in the smallest problem that has it: it may repeat a shorter one, or be symmetric."""
    root = DeclaredOrbit.of(problem, u, p).root()
    smallest = problem.sibling(root.word, root.periods, root.symmetric)
    if len(smallest.word) == len(problem.word) and smallest.symmetric == problem.symmetric:
        return problem, u, tangent
    return smallest, smallest.reduce(root.nodes), None


def usual_room(problem: DeclaredSystem, index: int) -> int:
    """Events that stand before that of a margin where a border is read: one, unless a word of two has no room for it and the next."""
    width = per_node(problem.contacts)
    return 1 if problem.length > 2 or index % width == width - 2 else 0


def turned(
    problem: DeclaredSystem, u: np.ndarray, p: float, index: int, ahead: int
) -> tuple[DeclaredSystem, np.ndarray, int]:
    """The same border read from another event, so that what changes does not straddle the end of the word."""
    width = per_node(problem.contacts)
    place, column = divmod(index, width)
    first = place - ahead
    if first % problem.length == 0 or not len(problem.word):
        return problem, u, index
    orbit = DeclaredOrbit.of(problem, u, p).rotate(first % len(problem.word))
    other = problem.sibling(orbit.word, problem.periods, problem.symmetric)
    return other, other.reduce(orbit.nodes), width * ((place - first) % problem.length) + column


def proposals(
    problem: DeclaredSystem, u: np.ndarray, p: float, index: int
) -> Iterator[tuple[DeclaredSystem, np.ndarray, float, np.ndarray, str]]:
    """Solutions next to the border with the words that the rules propose."""
    usual = usual_room(problem, index)  # a change may need more room on either side
    for ahead in dict.fromkeys((usual, *range(min(ROOM, problem.length)))):
        read, v, place = turned(problem, u, p, index, ahead)
        orbit = DeclaredOrbit.of(read, v, p)
        for edit in edits_at(orbit, place):
            found = grown(read, orbit, p, [edit])
            if found is not None:
                yield (*_read_alike(problem, read, edit.change, found), edit.change.what.value)


def _read_alike(first: DeclaredSystem, problem: DeclaredSystem, edit: Change, found: Found) -> Found:
    """The orbit found, read from the event from which the border orbit was read before it was turned; never from a slip."""
    ahead = next((k for k in range(len(first.word)) if problem.word.rotate(k) == first.word), 0)
    grown_by = len(edit.events) - (edit.stop - edit.start)
    places = ahead + grown_by
    if (
        problem.symmetric and ahead >= problem.length + edit.stop
    ):  # the mirrored edit stands before it as well
        places += grown_by
    if ahead == 0 or ahead < edit.stop or places <= 0:
        places = 0
    return _unslipped(_rotated(found, places))


def _rotated(found: Found, places: int) -> Found:
    """The same orbit and direction, read `places` events further on."""
    other, v, q, tangent = found
    if places == 0 or not len(other.word):
        return found
    orbit = DeclaredOrbit.of(other, v, q).rotate(places)
    again = other.sibling(orbit.word, other.periods, other.symmetric)
    direction = np.roll(other.expand_direction(tangent[:-1]), -places, axis=0)[: again.length]
    return again, again.reduce(orbit.nodes), q, np.append(direction.ravel(), tangent[-1])


def _unslipped(found: Found) -> Found:
    """Read from the stick before a slip that would come first."""
    word = found[0].word
    slips = len(word) > 1 and word.letter(0).kind == SLIP and word.letter(-1).kind == STICK
    return _rotated(found, len(word) - 1) if slips else found


def _real_part(
    problem: DeclaredSystem, u: np.ndarray, p: float, tangent: np.ndarray, index: int, length: float
) -> tuple[np.ndarray, float] | None:
    """A solution (u, p) in the branch's real part, close to the border."""
    length /= max(float(np.abs(tangent).max()), 1e-12)
    sides = []
    for sign in (1.0, -1.0):
        v, q, residual, _ = newton(
            problem, u + sign * length * tangent[:-1], p + sign * length * float(tangent[-1]), tangent
        )
        if residual < SOLVED:
            sides.append((v, q))
    return max(sides, key=lambda side: float(margins_of(problem, *side)[index]), default=None)


def _escapes(
    problem: DeclaredSystem, u: np.ndarray, p: float, index: int, nearby: list[tuple[np.ndarray, float]]
) -> Iterator[Seed]:
    """Orbits of less symmetry or longer period that leave at the border itself."""
    if not len(problem.word):
        return
    room = usual_room(problem, index)
    beside = [(*turned(problem, v, q, index, room)[:2], q) for v, q in nearby]
    read, there, place = turned(problem, u, p, index, room)
    for (other, v, q, tangent), note in escapes(read, there, p, place, beside):
        if _followed(DeclaredOrbit.of(other, v, q)):
            text = f"{note}, the word becomes {other.word.text}"
            yield Seed(other, v, q, tangent, "border", text, False)  # type: ignore[arg-type]


def _simulated(
    problem: DeclaredSystem, u: np.ndarray, p: float
) -> Iterator[tuple[DeclaredSystem, np.ndarray, float, None, str]]:
    """Attractors that the simulator reaches from the border orbit, a little to both sides of it."""
    orbit = DeclaredOrbit.of(problem, u, p)
    here = problem.canonical(u, p)[0]
    for side in (1.0, -1.0):
        q = p + side * 1e-6 * max(1.0, abs(p))
        stepper = Stepper(problem.machine, problem.values(q))
        try:
            stepper.start(
                orbit.nodes[0, 1:], float(orbit.nodes[0, 0]) if problem.forced else 0.0, orbit.word.modes[0]
            )
            found = settle(stepper, 60, max(2 * problem.periods, 4))
        except SimulationError:
            continue
        if found is None or (problem.forced and found.periods % problem.periods):
            continue
        other = problem.sibling(found.word, found.periods, found.symmetric, found.params)
        if other.canonical(other.reduce(found.nodes), q)[0] == here or distance(orbit, found) > CLOSE:
            continue
        yield other, other.reduce(found.nodes), q, None, "the simulator goes on"
