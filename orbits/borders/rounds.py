"""What changes at a border in some rounds of a cycle only: orbits of less symmetry or longer period that leave there.

A round is a whole cycle, or half a symmetric one. From the derivatives of unchanged and of changed rounds `orbits.cycles.rounds` judges cycles of several.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from orbits.borders.neighbours import Border, begun, followed, grown, parameter_unit
from orbits.borders.rewriting import Edit, edits_at
from orbits.cycles.rounds import MOST, Rounds, choices, derived, escape, judged
from orbits.orbit import Orbit
from orbits.protocol import CycleProblem, Seed
from orbits.settings import BORDERING


def escapes(border: Border, beside: list[Border]) -> Iterator[Seed]:
    """Orbits of less symmetry or longer period that leave at the border itself: the change happens in some rounds only.

    A round is a whole cycle, or half a symmetric one. A change in every other round breaks the symmetry or doubles the
    period, and is followed whether it is stable or not; of those that change in one of several rounds, or in all but one
    (period adding), there may be many at once: the stable ones are followed. `beside` are solutions next to the border with the old word, from
    far to near.
    """
    problem, p, orbit, edits = border.problem, border.p, border.orbit, border.edits
    unchanged = [_derivative(near.problem, near.u, near.p) for near in beside[-2:]]
    known = [_rounds_at(border, edit, unchanged) for edit in edits]
    hopeless = [set() if rounds is None else rounds.hopeless(MOST) for rounds in known]
    if hopeless and all(len(no) == len(choices(MOST)) for no in hopeless):
        return
    first = edits_at(_repeated(problem, orbit, 2)[1], border.margin, problem.length)
    if [edit.change for edit in first] != [edit.change for edit in edits]:
        hopeless = [set() for _ in first]
    for rounds, changed in choices(MOST):  # the first rounds, as many as `changed`, go through the change
        wanted = [edit for edit, no in zip(first, hopeless) if (rounds, changed) not in no]
        if not wanted or (changed > 1 and not problem.forced):
            continue
        wider, whole = _repeated(problem, orbit, rounds)
        ways = BORDERING.sizes if rounds == 2 else BORDERING.sizes[:2]
        for edit in wanted:
            changes = [edit.later(k, problem, p) for k in range(changed)]
            found = grown(begun(wider, whole, p, changes), ways, steady=rounds > 2)
            if found is not None:
                break
        else:
            continue
        other, there = found.problem, found.orbit()
        root = there.root()
        shorter = (len(root.word), root.periods) != (len(other.word), other.periods)
        if not shorter and (other.symmetric or not there.symmetric) and followed(there):
            note = f"{edit.change.what.value}: {escape(problem.symmetric, rounds)}"
            yield Seed(*found, "border", note, False)


def _repeated(problem: CycleProblem, orbit: Orbit, rounds: int) -> tuple[CycleProblem, Orbit]:
    """The border orbit over some rounds, and the problem of the orbits with that many."""
    if problem.symmetric and rounds % 2:
        whole = orbit.repeat(rounds)  # an odd number of halves, and their mirror image
        return problem.sibling(whole.word, whole.periods, True), whole
    whole = orbit.repeat(rounds // 2 if problem.symmetric else rounds)
    return problem.sibling(whole.word, whole.periods, False), whole


def _rounds_at(border: Border, edit: Edit, unchanged: list[tuple[np.ndarray, float] | None]) -> Rounds | None:
    """Unchanged and changed rounds of a border cycle; None where they cannot be determined.

    Solutions with the new word at or next to the border count, real or not. Where those do not tend to the border they say nothing about what is next to it.
    """
    new = border.begun(edit)
    if new is None:
        return None
    other, solutions = new.stated.problem, [(new.guess, border.p)]
    if new.growing is not None:
        climbed = new.climbed(BORDERING.sizes[0])[-2:]
        if len(climbed) < 2:
            return None
        far, near = (abs(held.p - border.p) for held in climbed)
        # of the distances at which something has a tenth of its size none is more than a tenth, but for higher orders
        if not near <= max(0.5 * far, BORDERING.placed * parameter_unit(border.problem, border.p)):
            return None
        solutions = [(held.u, held.p) for held in climbed]
    kinds = [unchanged, [_derivative(other, u, p) for u, p in solutions]]
    flow, model = border.orbit.flow, border.orbit.model
    loose = {*flow.loose(model, border.problem.word)} & {*flow.loose(model, other.word)}
    if loose:  # nothing depends on where such a motion is
        entries = [entry - (not other.forced) for entry in sorted(loose)]
        kinds = [[None if m is None else (_elsewhere(m[0], entries), m[1]) for m in maps] for maps in kinds]
    return judged(kinds)


def _elsewhere(derivative: np.ndarray, entries: list[int]) -> np.ndarray:
    return np.delete(np.delete(derivative, entries, axis=0), entries, axis=1)


def _derivative(problem: CycleProblem, u: np.ndarray, p: float) -> tuple[np.ndarray, float] | None:
    """Derivative of a round, mirrored where it is half a cycle, and its rounding; None where there is none."""
    found = problem.equations.through_flights(u, p)
    return None if found is None else derived(*found)
