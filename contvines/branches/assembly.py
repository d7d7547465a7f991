"""Finishing a branch: points between special points, stability, the Branch itself."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from ..bifurcation.segment import Segment
from ..continuation.engine import Engine, Solved
from .branch import Branch
from .ending import Ending
from .half_branch import HalfBranch

LOST = {"fold", "period-doubling", "symmetry-breaking", "neimark-sacker", "hopf"}
BEGINNING = ("fold",)  # where a branch begins at a bifurcation of another one, a multiplier is 1 as at a fold


def filled(half: HalfBranch, origin: int | None = None) -> HalfBranch:
    """The half with a solved point between neighbouring special points, or ends, that have none between them."""
    engine, special = half.engine, {i for i, _ in half.events} | {0, len(half) - 1}
    if origin is not None:
        special.add(origin)
    events = dict.fromkeys(i for i, _ in half.events)
    kinds: dict[int, list[str]] = {}
    for i, event in half.events:
        kinds.setdefault(i, []).append(event.kind)
    inserted: list[tuple[int, Solved]] = []
    for i in sorted(special):
        if i + 1 not in special or not (i in events or i + 1 in events):
            continue
        one, other = (
            Solved(u, p, tangent, np.zeros(0), 0.0, 0.0, 0.0) for u, p, tangent in map(half.at, (i, i + 1))
        )
        segment = Segment(engine, one, other)
        narrow = a_sliver(kinds.get(i, BEGINNING), kinds.get(i + 1, BEGINNING))
        if not segment.length > (engine.settings.sliver if narrow else engine.settings.one_place):
            continue
        middle = next((found for s in (0.5, 0.4, 0.6) if (found := segment.at(s)) is not None), None)
        if middle is not None:
            inserted.append((i + 1, middle))
    return half.inserted(inserted) if inserted else half


def a_sliver(one: Collection[str], other: Collection[str]) -> bool:
    """Whether solutions between neighbouring points of these kinds may be stable although those on both sides are not."""
    return any(a != b and {a, b} & LOST for a in one for b in other)


def stability(
    engine: Engine, spectrum: np.ndarray, special: list[int], twins: Sequence[int] = ()
) -> np.ndarray | None:
    """Which points count as stable; None where the problem has no spectrum that tells.

    A special point is stable when one of its neighbours is. A point with a multiplier on the circle to roundoff, as at the
    end of an interval or where a multiplier crosses, takes the stability of the nearest point that can tell, up to the next
    special point.

    Parameters
    ----------
    engine : Engine
    spectrum : ndarray, shape (n, 2 m)
        Multipliers as (re, im) pairs.
    special : list of int
        Indices of the special points.
    twins : sequence of int
        Indices of points that are a special point once more, as where a branch turns at a branch point: they do not tell.
    """
    if not engine.tells_stability:
        return None
    outermost = engine.outermost(spectrum)
    stable = outermost < 0.0
    if len(stable) < 2:
        return stable
    ordinary = np.ones(len(stable), dtype=bool)
    ordinary[special] = False
    doubtful = np.abs(outermost) <= engine.settings.marginal
    doubtful[list(twins)] = True
    doubtful &= ordinary
    if doubtful.any():
        _carry_over(stable, ordinary, doubtful)
    ahead = stable & ordinary
    beside = np.zeros(len(stable), dtype=bool)
    beside[1:] = ahead[:-1]
    beside[:-1] |= ahead[1:]
    return np.where(ordinary, stable, beside)


def _carry_over(stable: np.ndarray, ordinary: np.ndarray, doubtful: np.ndarray) -> None:
    """Give doubtful points the stability of the nearest one that can tell, up to the next special point."""
    for start, stop in _runs(ordinary):
        known = start + np.flatnonzero(~doubtful[start:stop])
        if len(known) == stop - start:
            continue
        if not len(known):
            stable[start:stop] = False  # conservative: nothing is attracted
            continue
        here = np.arange(start, stop)
        after = np.clip(np.searchsorted(known, here), 0, len(known) - 1)
        before = np.maximum(after - 1, 0)
        nearer = np.where(np.abs(known[before] - here) < np.abs(known[after] - here), before, after)
        stable[start:stop] = stable[known[nearer]]


def _runs(chosen: np.ndarray) -> list[tuple[int, int]]:
    """Maximal runs of chosen entries, as (start, stop)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], chosen, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2])]


def make_branch(
    label: str,
    half: HalfBranch,
    real: bool,
    endings: tuple[Ending, Ending],
    closed: bool,
    seed: str | None,
) -> Branch:
    """A Branch from what was found; ``marks``, and ``stable`` that depends on them, are left to the caller."""
    engine, whole = half.engine, half.joined()
    return Branch(
        label=label,
        problem=engine.problem,
        points=whole.points,
        values=whole.values,
        tangents=whole.tangents,
        multipliers=engine.multipliers(whole.spectrum),
        margin=whole.smallest,
        stable=None,
        real=real,
        endings=endings,
        closed=closed,
        seed=seed,
        description=dict(engine.problem.describe()),
        parameter=engine.problem.parameter,
    )
