"""Whether an image of the unknowns that a user calls a symmetry of the equations is one."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from .functions import NotEvaluable
from .images import Image, linear_part
from .settings import IDENTITY

if TYPE_CHECKING:
    from .derivatives import Differentiated
    from .parameters import ParameterSet
    from .pieces import Pieces

REACHES = (0.01, 0.1, 0.4, 1.0)  # of the states tried, in lengths over which the equations bend
ALIKE = 2  # in so many more states all unknowns move alike: random ones of a field are all stiffness
NOISY = 30.0  # disagreement in units of the noise of a row that is no matter
MIXED = 60  # unknowns up to which any constant matrix may stand between the rows of a state and of its image
MORE = 6  # states more than such a matrix needs, which try it

Values = Callable[[np.ndarray, float], np.ndarray]


class Asymmetry(NamedTuple):
    """Where the equations at the image of a state are not the image of the equations.

    ``found`` and ``wanted`` are a row there and what it should be, ``relative`` their difference, relative to the row's size; ``row``
    is -1 where the images cannot be evaluated.
    """

    row: int
    found: float
    wanted: float
    relative: float
    u: np.ndarray
    p: float


class Symmetrical(Protocol):
    """A problem whose images are said to be symmetries of it."""

    @property
    def values(self) -> ParameterSet: ...
    @property
    def functions(self) -> Differentiated: ...
    @property
    def pieces(self) -> Pieces: ...
    @property
    def generators(self) -> Sequence[tuple[str, Image]]: ...
    @property
    def symmetric_for(self) -> set[tuple[Hashable, ...]]: ...
    @property
    def mixed_rows(self) -> bool: ...
    @property
    def node(self) -> int: ...
    @property
    def u0(self) -> np.ndarray: ...
    @property
    def p0(self) -> float: ...
    def functions_in(self, pieces: Pieces) -> Differentiated: ...


def refuse_asymmetry(problem: Symmetrical) -> None:
    """Refuse a mirror or a symmetry of which the equations know nothing, once for each choice of parameters.

    Parameters
    ----------
    problem : AlgebraicProblem or MapProblem
        With ``generators``, names and images, and ``mixed_rows``, whether its rows may stand in any order.

    Raises
    ------
    ValueError
        A sentence with the row, the state and the size of the disagreement.
    """
    values = problem.values
    fixed = {name: value for name, value in values.values.items() if name != values.varying}
    key = (values.varying, *sorted(fixed.items()))
    if not problem.generators or key in problem.symmetric_for:
        return
    n, p, functions = problem.node, problem.p0, problem.functions
    u = problem.u0[:n]
    for name, image in problem.generators:
        lengths = functions.lengths, functions.parameter_length(u, p)
        found = asymmetry(_in_pieces(problem), image, (u, p), lengths, functions.noise, problem.mixed_rows)
        if found is not None:
            where = f"at u = {np.array2string(found.u, precision=4, threshold=6)}, {values.varying} = {found.p:.6g}"
            if found.row < 0:
                raise ValueError(
                    f"{name} is no symmetry of {functions.name}, which cannot be evaluated at the images of the states that were "
                    f"tried, of that {where} for one"
                )
            raise ValueError(
                f"{name} is no symmetry of {functions.name}: {where}, row {found.row} of {functions.name} at the image is "
                f"{found.found:.8g}, and {found.wanted:.8g} is the image of {functions.name} there ({found.relative:.1g} of its size); "
                f"leave it out, or give an image that solves the same equations"
            )
    problem.symmetric_for.add(key)


def asymmetry(
    values: Values,
    image: Image,
    start: tuple[np.ndarray, float],
    lengths: tuple[np.ndarray, float],
    noise: np.ndarray,
    mixed: bool,
) -> Asymmetry | None:
    """The largest disagreement with F(R u, p) = S F(u, p), for an image R; None where it holds, or cannot be tried.

    States round the start and values of the parameter are tried. S is the linear part of R or, if `mixed`, any constant matrix:
    rows may be written in another order or multiplied by numbers.

    Parameters
    ----------
    values : callable
        (u, p) -> F, shape (n,); NotEvaluable or not finite where it is not defined.
    image : callable
        R.
    start, lengths : (ndarray of shape (n,), float)
        Unknowns and parameter, and over which lengths F bends in them.
    noise : ndarray, shape (n,)
        Standard deviation of each row.
    mixed : bool
    """
    states, n = _states(*start, *lengths), len(start[0])
    wanted = [next(states) for _ in range(len(REACHES) + ALIKE)]

    tried, lost = _tried(values, image, wanted)
    if len(lost) > len(tried):
        return Asymmetry(-1, np.nan, np.nan, np.nan, *lost[0])
    if not tried:
        return None
    worst = _worst(tried, linear_part(image, n), noise)
    if worst is None or not (mixed and n <= MIXED):
        return worst
    tried += _tried(values, image, [next(states) for _ in range(n + MORE)])[0]
    return None if len(tried) > n and _constant(tried, noise) else worst


class Pair(NamedTuple):
    """F at a state and at its image."""

    u: np.ndarray
    p: float
    here: np.ndarray
    there: np.ndarray


def _tried(
    values: Values, image: Image, states: Sequence[tuple[np.ndarray, float]]
) -> tuple[list[Pair], list[tuple[np.ndarray, float]]]:
    """F at states and at their images, and the states at which only one of both can be evaluated."""
    tried, lost = [], []
    for u, p in states:
        here, there = _finite(values, u, p), _finite(values, image(u), p)
        if here is not None and there is not None:
            tried.append(Pair(u, p, here, there))
        elif here is not None or there is not None:
            lost.append((u, p))
    return tried, lost


def _in_pieces(problem: Symmetrical) -> Values:
    """The equations, each state in its own piece."""
    pieces = problem.pieces
    if not pieces.count:
        return problem.functions.value
    pieces = pieces.repeated(1, 1)
    functions = problem.functions_in(pieces)

    def value(u: np.ndarray, p: float) -> np.ndarray:
        pieces.choose(u, p)
        return functions.value(u, p)

    return value


def _states(u: np.ndarray, p: float, lengths: np.ndarray, reach: float) -> Iterator[tuple[np.ndarray, float]]:
    draw, size = np.random.default_rng(12), float(np.median(lengths))
    for part in (1.0, -1.0):
        yield u + part * size, p + 0.1 * part * reach
    while True:
        for part in REACHES:
            yield (
                u + part * lengths * draw.uniform(-1.0, 1.0, len(u)),
                p + part * reach * draw.uniform(-1.0, 1.0),
            )


def _finite(values: Values, u: np.ndarray, p: float) -> np.ndarray | None:
    """F, or None where it cannot be evaluated."""
    try:
        with np.errstate(all="ignore"):
            found = values(u, p)
    except NotEvaluable:
        return None
    return found if np.isfinite(found).all() else None


def _worst(tried: list[Pair], turn: Image, noise: np.ndarray) -> Asymmetry | None:
    """The largest disagreement with the image of F."""
    expected = [turn(pair.here) for pair in tried]
    sizes = [
        np.maximum(np.abs(pair.there), np.abs(other)) for pair, other in zip(tried, expected, strict=True)
    ]
    allowed = IDENTITY.cancelled * np.max(sizes, axis=0) + NOISY * (noise + np.abs(turn(noise)))
    worst = None
    for (u, p, _, there), other, size in zip(tried, expected, sizes, strict=True):
        gap = np.abs(there - other)
        with np.errstate(all="ignore"):
            relative = np.where(gap > IDENTITY.same * size + allowed, gap / size, 0.0)
        row = int(np.argmax(relative))
        if relative[row] > (0.0 if worst is None else worst.relative):
            worst = Asymmetry(row, float(there[row]), float(other[row]), float(relative[row]), u, p)
    return worst


def _constant(tried: list[Pair], noise: np.ndarray) -> bool:
    """Whether one constant matrix makes F at the images from F at the states."""
    here, there = np.array([pair.here for pair in tried]), np.array([pair.there for pair in tried])
    sizes = np.maximum(np.abs(here).max(axis=0), np.abs(there).max(axis=0))
    sizes[sizes == 0.0] = 1.0
    here, there = here / sizes, there / sizes
    weights = np.linalg.norm(np.hstack([here, there]), axis=1)
    weights[weights == 0.0] = 1.0  # near states are small, and tell as much
    matrix = np.linalg.lstsq(here / weights[:, None], there / weights[:, None], rcond=None)[0]
    mixing = 1.0 + np.abs(matrix).sum(axis=0)
    allowed = IDENTITY.same * mixing * weights[:, None] + NOISY * mixing * float((noise / sizes).max())
    return bool((np.abs(here @ matrix - there) <= allowed).all())
