"""Rounds of a cycle at a border, unchanged and changed: their derivatives, from which `orbits.cycles.rounds` judges cycles of several."""

from __future__ import annotations

import numpy as np

from orbits.borders.holding import Held, climb
from orbits.borders.neighbours import SIZES, examined, vanishing_in, with_edits
from orbits.contacts.changes import Grows
from orbits.cycles.rounds import Rounds, derived, judged
from orbits.cycles.solution import Solution
from orbits.protocol import CycleProblem
from orbits.words.edit import Edit


def rounds_at(
    problem: CycleProblem,
    orbit: Solution,
    p: float,
    edit: Edit,
    nearby: list[tuple[CycleProblem, np.ndarray, float]],
) -> Rounds | None:
    """Unchanged and changed rounds of a border cycle; None where they cannot be told.

    Parameters
    ----------
    problem : CycleProblem
    orbit : Solution
        The border cycle.
    p : float
    edit : Edit
    nearby : list
        Solutions (problem, u, p) next to the border with the old word, from far to near.
    """
    other, solutions = _near_border(problem, orbit, p, edit)
    solved = [nearby, [(other, held.u, held.p) for held in solutions]]
    kinds = [[_derivative(*solution) for solution in kind[-2:]] for kind in solved]
    if problem.word.impact_free and other.word.impact_free:  # nothing depends on where such a motion is
        kinds = [[None if m is None else (_elsewhere(m[0]), m[1]) for m in maps] for maps in kinds]
    return judged(kinds)


def _elsewhere(derivative: np.ndarray) -> np.ndarray:
    return np.delete(np.delete(derivative, 1, axis=0), 1, axis=1)


def _near_border(
    problem: CycleProblem, orbit: Solution, p: float, edit: Edit
) -> tuple[CycleProblem, list[Held]]:
    """The new word's solutions at or next to the border, real or not, with what grows at sizes that become smaller."""
    start = with_edits(problem, orbit, [edit])
    if start is None:
        return problem, []
    other, guess, first, change = start
    if change.grows is Grows.MARGIN:
        vanishing = vanishing_in(other, guess, p, first, change)
        if vanishing is None:
            return other, [Held(guess, p, guess, 0.0)]
        first, change = vanishing
    return other, climb(other, guess, first, change, p, SIZES[0])


def _derivative(problem: CycleProblem, u: np.ndarray, p: float) -> tuple[np.ndarray, float] | None:
    """Derivative of a round, mirrored where it is half a cycle, and its rounding; None where there is none."""
    examined(problem, u, p)
    work = problem.scratch
    found = derived(work.A, work.D)
    if found is not None:
        found[0][1:] *= problem.data.twist
    return found
