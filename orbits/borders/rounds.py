"""Rounds of a cycle at a border, unchanged and changed: their derivatives, from which `orbits.cycles.rounds` judges cycles of several."""

from __future__ import annotations

import numpy as np

from orbits.borders.neighbours import Held, Place, parameter_unit
from orbits.borders.rewriting import Edit
from orbits.cycles.rounds import Rounds, derived, judged
from orbits.protocol import CycleProblem
from orbits.settings import BORDERING


def rounds_at(border: Place, edit: Edit, unchanged: list[tuple[np.ndarray, float] | None]) -> Rounds | None:
    """Unchanged and changed rounds of a border cycle; None where they cannot be determined.

    Parameters
    ----------
    border : Place
    edit : Edit
    unchanged : list
        What `derivative` says of solutions next to the border with the old word, from far to near.
    """
    other, solutions = _near_border(border, edit)
    if not solutions:
        return None
    kinds = [unchanged[-2:], [derivative(other, held.u, held.p) for held in solutions[-2:]]]
    flow, model = border.orbit.flow, border.orbit.model
    loose = {*flow.loose(model, border.problem.word)} & {*flow.loose(model, other.word)}
    if loose:  # nothing depends on where such a motion is
        entries = [entry - (not other.forced) for entry in sorted(loose)]
        kinds = [[None if m is None else (_elsewhere(m[0], entries), m[1]) for m in maps] for maps in kinds]
    return judged(kinds)


def _elsewhere(derivative: np.ndarray, entries: list[int]) -> np.ndarray:
    return np.delete(np.delete(derivative, entries, axis=0), entries, axis=1)


def _near_border(border: Place, edit: Edit) -> tuple[CycleProblem, list[Held]]:
    """The new word's solutions at or next to the border, real or not, with what grows at sizes that become smaller.

    None where these do not tend to the border: they say nothing about what is next to it.
    """
    begun = border.begun(edit)
    if begun.start is None:
        return border.problem, []
    stated, guess = begun.start
    if begun.growing is None:
        return stated.problem, [Held(guess, border.p, guess, 0.0)]
    climbed = begun.climbed(BORDERING.sizes[0])
    if len(climbed) < 2:
        return stated.problem, []
    far, near = (abs(held.p - border.p) for held in climbed[-2:])
    # of the distances at which something has a tenth of its size none is more than a tenth, but for higher orders
    nearer = near <= max(0.5 * far, BORDERING.placed * parameter_unit(border.problem, border.p))
    return stated.problem, climbed if nearer else []


def derivative(problem: CycleProblem, u: np.ndarray, p: float) -> tuple[np.ndarray, float] | None:
    """Derivative of a round, mirrored where it is half a cycle, and its rounding; None where there is none."""
    found = problem.equations.through_flights(u, p)
    return None if found is None else derived(*found)
