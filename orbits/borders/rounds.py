"""Orbits of less symmetry or longer period that leave at a border, because the word changes in some rounds of the cycle only.

A round is a whole cycle, or half of a symmetric one. The derivatives of unchanged and of changed rounds decide which cycles of several rounds can
be real and stable.

At the border every round is the border cycle itself, seen with the old word or with the new one. Next to it the map of a round is, to
first order, x -> A x + b with the old word and x -> B x + b with the new one, where A and B, the derivatives of these cycles' own
maps, agree on the border. Cycles of this piecewise linear map are known in closed form: the multipliers are the
eigenvalues of the product M of its matrices, and the distances from the border of its points are proportional to det P_i, where P_i = 1 +
M_{n-1} + M_{n-1} M_{n-2} + ... + M_{n-1} ... M_1 when the cycle is read from its i-th point (Simpson & Meiss, SIAM J. Appl. Dyn. Syst. 8
(2009) 795, lemma 2: s_i = det(P_i) rho.b / det(1 - M)). So a cycle is real, on one side of the border, only where these have one
sign in all unchanged rounds and the other one in all changed ones.

At an impact of vanishing speed s one of the derivatives grows as 1/s, since a touch displaces x by g s along some vector g, with s^2 the
distance beyond the border (Nordmark, J. Sound Vib. 145 (1991) 279): to first order in s the cycle has s_i = 0 in a changed round, as if
that round were linear with a slope without bound. So the signs of det P_i that count are those for s to 0, distinguished from two sizes of s.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from orbits.borders.neighbours import Border, branch_at_border, followed, parameter_unit, rewrite
from orbits.borders.rewriting import Edit, edits_at
from orbits.orbit import Orbit
from orbits.protocol import CycleProblem, Seed
from orbits.settings import BORDERING, ROUNDING, SOLVING

MOST = 8  # rounds of a cycle at most
UNSTABLE = 1.5  # largest multiplier of a product computed next to the border, above which the cycle is unstable at the border, too
BOUNDED = 0.05  # largest relative change of the derivatives, from one size of the growing quantity to the next, if they have a limit


def escapes(border: Border, neighbours: list[Border]) -> Iterator[Seed]:
    """Find orbits of less symmetry or longer period that leave at a border.

    A change in every other round breaks the symmetry or doubles the period; these orbits are yielded whether they are stable or not. Changes in one of
    several rounds, or in all but one (period adding), may give many orbits; of these only stable ones are yielded. `neighbours` are solutions
    with the old word next to the border, from far to near.
    """
    problem, p, orbit, edits = border.problem, border.p, border.orbit, border.edits
    unchanged = [_derivative(near.problem, near.u, near.p) for near in neighbours[-2:]]
    by_edit = [_rounds_at(border, edit, unchanged) for edit in edits]
    hopeless = [set() if rounds is None else rounds.hopeless(MOST) for rounds in by_edit]
    if hopeless and all(len(excluded) == len(choices(MOST)) for excluded in hopeless):
        return
    first = edits_at(_repeated(problem, orbit, 2)[1], border.margin, problem.length)
    if [edit.change for edit in first] != [edit.change for edit in edits]:
        hopeless = [set() for _ in first]
    for rounds, changed in choices(MOST):  # the first `changed` rounds have the new word
        wanted = [edit for edit, excluded in zip(first, hopeless) if (rounds, changed) not in excluded]
        if not wanted or (changed > 1 and not problem.forced):
            continue
        wider, whole = _repeated(problem, orbit, rounds)
        trials = BORDERING.sizes if rounds == 2 else BORDERING.sizes[:2]
        for edit in wanted:
            changes = [edit.later(k, problem, p) for k in range(changed)]
            found = branch_at_border(rewrite(wider, whole, p, changes), trials, steady=rounds > 2)
            if found is not None:
                break
        else:
            continue
        other, new_orbit = found.problem, found.orbit()
        root = new_orbit.root()
        shorter = (len(root.word), root.periods) != (len(other.word), other.periods)
        if not shorter and (other.symmetric or not new_orbit.symmetric) and followed(new_orbit):
            note = f"{edit.change.effect.value}: {escape(problem.symmetric, rounds)}"
            yield Seed(*found, "border", note, False)


def _repeated(problem: CycleProblem, orbit: Orbit, rounds: int) -> tuple[CycleProblem, Orbit]:
    """The problem of orbits with several rounds, and the border orbit repeated over these rounds."""
    if problem.symmetric and rounds % 2:
        whole = orbit.repeat(rounds)  # an odd number of halves, and their mirror image
        return problem.sibling(whole.word, whole.periods, True), whole
    whole = orbit.repeat(rounds // 2 if problem.symmetric else rounds)
    return problem.sibling(whole.word, whole.periods, False), whole


def _rounds_at(border: Border, edit: Edit, unchanged: list[tuple[np.ndarray, float] | None]) -> Rounds | None:
    """Derivatives of unchanged and changed rounds of a border cycle; None if they cannot be determined.

    They come from solutions with the new word at or next to the border, real or virtual, which must tend to the border.
    """
    new = border.rewrite(edit)
    if new is None:
        return None
    other, solutions = new.stated.problem, [(new.guess, border.p)]
    if new.growing is not None:
        climbed = new.climbed(BORDERING.sizes[0])[-2:]
        if len(climbed) < 2:
            return None
        far, near = (abs(held.p - border.p) for held in climbed)
        # a tenth of the size gives at most a tenth of the distance, up to higher orders; twice as much is another branch
        share = 2.0 * climbed[1].size / climbed[0].size
        if not near <= max(share * far, BORDERING.placed * parameter_unit(border.problem, border.p)):
            return None
        solutions = [(held.u, held.p) for held in climbed]
    kinds = [unchanged, [_derivative(other, u, p) for u, p in solutions]]
    flow, model = border.orbit.flow, border.orbit.model
    loose = {*flow.loose(model, border.problem.word)} & {*flow.loose(model, other.word)}
    if loose:  # shifts of the whole motion are left out
        entries = [entry - (not other.forced) for entry in sorted(loose)]
        kinds = [[None if m is None else (_elsewhere(m[0], entries), m[1]) for m in maps] for maps in kinds]
    return judged(kinds)


def _elsewhere(derivative: np.ndarray, entries: list[int]) -> np.ndarray:
    return np.delete(np.delete(derivative, entries, axis=0), entries, axis=1)


def _derivative(problem: CycleProblem, u: np.ndarray, p: float) -> tuple[np.ndarray, float] | None:
    """Derivative of a round (followed by the mirror image if it is half a cycle) and its rounding error; None if it is not finite."""
    found = problem.equations.through_flights(u, p)
    return None if found is None else derived(*found)


@np.errstate(all="ignore")
def sides_of_cycles(maps: np.ndarray, keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smallest and largest distance of a cycle's points from the border, and the product of its rounds, for each of several cycles.

    Parameters
    ----------
    maps : ndarray, shape (2, n, n)
        Derivatives of an unchanged and of a changed round.
    keys : ndarray of int, shape (c, 2)
        Number of rounds of each cycle, and of changed ones, which come first.

    Returns
    -------
    sides : ndarray, shape (c, 2)
        Extremes of det P_i (see the top of this module), positive on the side on which the first round is real; NaN if one is not finite.
    products : ndarray, shape (c, n, n)
        Products of the rounds from the first point on.
    """
    rounds, changed = keys[:, :1], keys[:, 1:]
    firsts = np.arange(rounds.max(initial=1))[None, :]  # all points of all cycles at once
    P = np.broadcast_to(np.eye(maps.shape[1]), (len(keys), firsts.size, *maps.shape[1:]))
    M = maps[(changed[:, 0] > 0).astype(int)]
    for shift in range(1, firsts.size):
        factors = maps[((firsts + shift) % rounds < changed).astype(int)]
        goes_on = (shift < rounds)[:, :, None, None]
        P = np.where(goes_on, np.eye(maps.shape[1]) + factors @ P, P)
        M = np.where(goes_on[:, 0], factors[:, 0] @ M, M)
    found = np.where(firsts < changed, 1.0, -1.0) * np.linalg.det(P)
    exists = firsts < rounds
    low = np.where(exists, found, np.inf).min(axis=1)
    high = np.where(exists, found, -np.inf).max(axis=1)
    finite = (np.isfinite(found) | ~exists).all(axis=1)
    return np.where(finite[:, None], np.stack([low, high], axis=1), np.nan), M


class Rounds(NamedTuple):
    """Derivatives of the two kinds of rounds.

    Attributes
    ----------
    maps : ndarray, shape (2, m, m)
        Derivatives of an unchanged and of a changed round.
    error : float
        Rounding error of both, relative to their largest entries.
    linear : bool
        Whether they have limits at the border, which agree on it.
    further : ndarray, shape (2, m, m), optional
        The same derivatives further from the border, where they grow without bound.
    """

    maps: np.ndarray
    error: float
    linear: bool
    further: np.ndarray | None = None

    def hopeless(self, most: int) -> set[tuple[int, int]]:
        """Cycles, as (number of rounds from 2 to `most`, number of changed ones: 1 or all but one), that are certainly virtual or, with more
        than two rounds, certainly unstable.
        """
        keys = choices(most)
        sides, products = sides_of_cycles(self.maps, np.array(keys))
        farther = sides if self.further is None else sides_of_cycles(self.further, np.array(keys))[0]
        old, new = np.abs(self.maps).sum(axis=2).max(axis=1).tolist()
        finite = np.isfinite(products).all(axis=(1, 2))
        largest = np.full(len(keys), np.nan)  # moduli of multipliers
        largest[finite] = np.abs(np.linalg.eigvals(products[finite])).max(axis=1)
        hopeless = set()
        for key, (low, high), before, product, size in zip(
            keys, sides.tolist(), farther.tolist(), products, largest.tolist()
        ):
            if self.linear:
                virtual = low < -ROUNDING.decided * high and high > -ROUNDING.decided * low
            elif self.further is not None and _stays(-low, -before[0]) and _stays(high, before[1]):
                virtual = key[0] * self.error * max(float(np.abs(product).max()), old * new) < ROUNDING.sure
            else:
                virtual = False
            if virtual or (key[0] > 2 and size > UNSTABLE + self._rounding(*key, old, new)):
                hopeless.add(key)
        return hopeless

    def _rounding(self, rounds: int, changed: int, own: float, other: float) -> float:
        """Rounding error of a product of rounds, given bounds of the derivatives: `own` of unchanged rounds, `other` of changed ones."""
        try:
            return rounds * self.error * own ** (rounds - changed) * other**changed
        except OverflowError:
            return math.inf


def _stays(near: float, further: float) -> bool:
    """Whether a determinant that is positive near the border stays positive up to it: it grows towards the border, or is constant."""
    return near > ROUNDING.decided and further - near <= ROUNDING.decided * near


@cache
def choices(most: int) -> list[tuple[int, int]]:
    """Cycles that are tried, as (number of rounds, number of changed ones)."""
    return [(n, changed) for n in range(2, most + 1) for changed in dict.fromkeys((1, n - 1))]


def judged(kinds: Sequence[Sequence[tuple[np.ndarray, float] | None]]) -> Rounds | None:
    """Combine derivatives and errors of unchanged and of changed rounds, from far to near the border; None if they are not known well enough."""
    found, further, error, bounded = [], [], 0.0, True
    for maps in kinds:
        if not maps or any(m is None for m in maps):
            return None
        far, near = maps[0], maps[-1]
        assert far is not None and near is not None
        found.append(near[0])
        further.append(far[0])
        size = float(np.abs(near[0]).max())
        error = max(error, near[1] / size if size > 0.0 else 0.0)
        bounded = bounded and bool(np.abs(far[0] - near[0]).max() <= BOUNDED * max(size, 1.0))
    if not error <= ROUNDING.sure:
        return None
    return Rounds(np.array(found), error, bounded and _agree(*found), None if bounded else np.array(further))


def _agree(plain: np.ndarray, changed: np.ndarray) -> bool:
    """Whether two derivatives differ by a matrix of rank one, as those of maps that agree on the border do."""
    first, second = [*np.linalg.svd(changed - plain, compute_uv=False).tolist(), 0.0][:2]
    return second <= BOUNDED * max(first, float(np.abs(plain).max()))


@np.errstate(all="ignore")
def derived(A: np.ndarray, D: np.ndarray | None = None) -> tuple[np.ndarray, float] | None:
    """Derivative of a round, the product of those of its flights, and its rounding error; None if it is not finite.

    Parameters
    ----------
    A : ndarray, shape (l, n, n)
        Derivatives of the flights; with `D`, derivatives of the flights' equations by the node before each flight.
    D : ndarray, shape (l, n, n), optional
        Derivatives of the flights' equations by the node after each flight.
    """
    try:
        factors = A if D is None else -np.linalg.solve(D, A)
    except np.linalg.LinAlgError:
        return None
    whole = sizes = np.eye(A.shape[1])
    for factor in factors:
        whole, sizes = factor @ whole, np.abs(factor) @ sizes
    error = SOLVING.rounding * float(sizes.max())
    return (whole, error) if np.isfinite(whole).all() and math.isfinite(error) else None


def escape(symmetric: bool, rounds: int) -> str:
    """Text for the change of symmetry or period if only some of the rounds change."""
    if rounds == 2:
        return f"the {'symmetry breaks' if symmetric else 'period doubles'} at the border"
    if symmetric and rounds % 2 == 0:
        return f"at the border the symmetry breaks and the period becomes {rounds // 2} times as long"
    return f"at the border the period becomes {rounds} times as long"
