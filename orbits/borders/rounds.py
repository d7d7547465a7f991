"""What changes at a border in some rounds of a cycle only: orbits of less symmetry or longer period that leave there.

A round is a whole cycle, or half a symmetric one. From the derivatives of unchanged and of changed rounds `orbits.cycles.rounds` judges cycles of several.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from orbits.borders.neighbours import Border, Grown, Held, begun, followed, grown, parameter_unit
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
    wider, whole = _repeated(problem, orbit, 2)
    first = edits_at(whole, border.margin, problem.length)
    if [edit.change for edit in first] != [edit.change for edit in edits]:
        hopeless = [set() for _ in first]
    for rounds in range(2, MOST + 1):
        for changed in (1, rounds - 1) if rounds > 2 else (1,):
            wanted = [edit for edit, no in zip(first, hopeless) if (rounds, changed) not in no]
            if not wanted or (changed > 1 and not problem.forced):
                continue
            if rounds > 2:
                wider, whole = _repeated(problem, orbit, rounds)
            found = _grown_in(problem, wider, whole, p, wanted, rounds, changed)
            if found is None:
                continue
            other, there = found[0].problem, found[0].orbit()
            root = there.root()
            if (len(root.word), root.periods) != (len(other.word), other.periods) or (
                there.symmetric and not other.symmetric
            ):
                continue
            if followed(there):
                note = f"{found[1]}: {escape(problem.symmetric, rounds)}"
                yield Seed(*found[0], "border", note, False)


def _repeated(problem: CycleProblem, orbit: Orbit, rounds: int) -> tuple[CycleProblem, Orbit]:
    """The border orbit over some rounds, and the problem of the orbits with that many."""
    if problem.symmetric and rounds % 2:
        whole = orbit.repeat(rounds)  # an odd number of halves, and their mirror image
        return problem.sibling(whole.word, whole.periods, True), whole
    whole = orbit.repeat(rounds // 2 if problem.symmetric else rounds)
    return problem.sibling(whole.word, whole.periods, False), whole


def _grown_in(
    problem: CycleProblem,
    wider: CycleProblem,
    whole: Orbit,
    p: float,
    choices: list[Edit],
    rounds: int,
    changed: int,
) -> tuple[Grown, str] | None:
    """The orbit in which the first rounds of the problem, as many as `changed`, go through one of the changes."""
    for edit in choices:
        ways = BORDERING.sizes if rounds == 2 else BORDERING.sizes[:2]
        edits = [edit.later(k, problem, p) for k in range(changed)]
        found = grown(begun(wider, whole, p, edits), ways, steady=rounds > 2)
        if found is not None:
            return found, edit.change.what.value
    return None


def _rounds_at(border: Border, edit: Edit, unchanged: list[tuple[np.ndarray, float] | None]) -> Rounds | None:
    """Unchanged and changed rounds of a border cycle; None where they cannot be determined."""
    other, solutions = _near_border(border, edit)
    if not solutions:
        return None
    kinds = [unchanged, [_derivative(other, held.u, held.p) for held in solutions[-2:]]]
    flow, model = border.orbit.flow, border.orbit.model
    loose = {*flow.loose(model, border.problem.word)} & {*flow.loose(model, other.word)}
    if loose:  # nothing depends on where such a motion is
        entries = [entry - (not other.forced) for entry in sorted(loose)]
        kinds = [[None if m is None else (_elsewhere(m[0], entries), m[1]) for m in maps] for maps in kinds]
    return judged(kinds)


def _elsewhere(derivative: np.ndarray, entries: list[int]) -> np.ndarray:
    return np.delete(np.delete(derivative, entries, axis=0), entries, axis=1)


def _near_border(border: Border, edit: Edit) -> tuple[CycleProblem, list[Held]]:
    """The new word's solutions at or next to the border, real or not, with what grows at sizes that become smaller.

    None where these do not tend to the border: they say nothing about what is next to it.
    """
    new = border.begun(edit)
    if new is None:
        return border.problem, []
    other = new.stated.problem
    if new.growing is None:
        return other, [Held(new.guess, border.p, new.guess, 0.0)]
    climbed = new.climbed(BORDERING.sizes[0])
    if len(climbed) < 2:
        return other, []
    far, near = (abs(held.p - border.p) for held in climbed[-2:])
    # of the distances at which something has a tenth of its size none is more than a tenth, but for higher orders
    nearer = near <= max(0.5 * far, BORDERING.placed * parameter_unit(border.problem, border.p))
    return other, climbed if nearer else []


def _derivative(problem: CycleProblem, u: np.ndarray, p: float) -> tuple[np.ndarray, float] | None:
    """Derivative of a round, mirrored where it is half a cycle, and its rounding; None where there is none."""
    found = problem.equations.through_flights(u, p)
    return None if found is None else derived(*found)
