"""Motions of less symmetry or longer period that begin at a border of a declared machine: the change happens in some rounds only.

A round is a whole cycle, or half a symmetric one. A change in every other round breaks the symmetry or doubles the period, and is
followed whether it is stable or not; of those that change in one of several rounds, or in all but one (period adding), there may be many
at once: the stable ones are followed. What the derivatives of a round rule out is not tried (`orbits.cycles.rounds`).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from orbits.contacts.changes import Grows
from orbits.cycles.rounds import MOST, Rounds, choices, derived, escape, judged
from orbits.declared.distance import distance
from orbits.declared.edits import edits_at
from orbits.declared.neighbours import SIZES, Found, climb, grown, with_edits
from orbits.declared.orbit import DeclaredOrbit
from orbits.flows.page import flights
from orbits.flows.page.cycle_equations import DeclaredSystem
from orbits.words.edit import Edit

Solved = tuple[DeclaredSystem, np.ndarray, float]
NEAR = 0.02  # distance from the border orbit of one that begins there, relative to 1 + its states


class Escape(NamedTuple):
    """An orbit that begins at a border, and what it is in words."""

    found: Found
    note: str


def escapes(
    problem: DeclaredSystem, u: np.ndarray, p: float, index: int, beside: list[Solved]
) -> Iterator[Escape]:
    """Orbits that change in some rounds of a cycle at whose border margin `index` vanishes.

    Parameters
    ----------
    problem : DeclaredSystem
        Read so that the event of the margin is not the last one.
    u : ndarray
    p : float
    index : int
    beside : list
        Solutions next to the border with the same word, read alike, from far to near.
    """
    orbit = DeclaredOrbit.of(problem, u, p)
    wider, whole = _repeated(problem, orbit, 2)
    edits = edits_at(whole, index)
    plain = [_derivative(*solution) for solution in beside[-2:]]
    own = edits_at(orbit, index)
    hopeless: list[set[tuple[int, int]]] = [set() for _ in edits]
    if [edit.change for edit in own] == [
        edit.change for edit in edits
    ]:  # else one round has no room for them
        known = [_rounds(problem, orbit, p, edit, plain) for edit in own]
        hopeless = [set() if rounds is None else rounds.hopeless(MOST) for rounds in known]
    for rounds, changed in choices(MOST):
        wanted = [edit for edit, no in zip(edits, hopeless) if (rounds, changed) not in no]
        if not wanted or (changed > 1 and not problem.forced):
            continue
        wider, whole = _repeated(problem, orbit, rounds)
        ways = SIZES if rounds == 2 else SIZES[:2]
        for edit in wanted:
            parts = [edit.later(k, problem, p) for k in range(changed)]
            found = grown(wider, whole, p, parts, ways, steady=rounds > 2)
            if found is None:
                continue
            there = DeclaredOrbit.of(*found[:3])
            if there.symmetric and not found[0].symmetric:
                continue
            if len(there.root().word) != len(found[0].word) or distance(whole, there) > NEAR:
                continue
            yield Escape(found, f"{edit.change.what.value}: {escape(problem.symmetric, rounds)}")
            break


def _repeated(
    problem: DeclaredSystem, orbit: DeclaredOrbit, rounds: int
) -> tuple[DeclaredSystem, DeclaredOrbit]:
    """The problem of the orbits with some rounds, and the border orbit over them."""
    odd = problem.symmetric and rounds % 2 == 1  # an odd number of halves, and their mirror image
    whole = orbit.repeat(rounds if odd or not problem.symmetric else rounds // 2)
    return problem.sibling(whole.word, whole.periods, odd), whole


def _rounds(
    problem: DeclaredSystem,
    orbit: DeclaredOrbit,
    p: float,
    edit: Edit,
    plain: list[tuple[np.ndarray, float] | None],
) -> Rounds | None:
    """Unchanged and changed rounds; None where they cannot be told."""
    if edit.change.stop > problem.length:
        return None
    start = with_edits(problem, orbit, [edit])
    if start is None or not len(start[0].word):
        return None
    other, guess, first, change = start
    if change.grows is Grows.MARGIN:
        solved = [(other, guess, p)]
    else:
        solved = [found[:3] for found in climb(other, guess, first, change, p, SIZES[0])]
    return judged([plain, [_derivative(*solution) for solution in solved[-2:]]])


def _derivative(problem: DeclaredSystem, u: np.ndarray, p: float) -> tuple[np.ndarray, float] | None:
    """Derivative of a round, mirrored where it is half a cycle, and its rounding; None where there is none."""
    work = problem.workspace()
    if not np.isfinite(flights.linearise(problem, u, p, work)):
        return None
    with np.errstate(all="ignore"):
        return derived(flights.factors(problem, work))
