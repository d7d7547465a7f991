"""Symmetries as users give them, callables, matrices or permutations; and whether the equations have them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cmp_to_key
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .functions import NotEvaluable
from .settings import IDENTITY

if TYPE_CHECKING:
    from _typeshed import SupportsRichComparison
    from numpy.typing import ArrayLike

    from .derivatives import Differentiated


MOST = 400  # elements of a group

Image = Callable[[np.ndarray], np.ndarray]


def linear_part(image: Image, n: int) -> Image:
    """How an image acts on differences of states: without what it adds to all of them."""
    added = image(np.zeros(n))
    return image if not added.any() else lambda v: image(v) - added


def image_map(
    symmetry: Callable[[np.ndarray], ArrayLike] | ArrayLike, n: int, name: str = "mirror"
) -> Callable[[np.ndarray], np.ndarray]:
    """u -> image of u.

    Parameters
    ----------
    symmetry : callable, array of shape (n, n), or n whole numbers
        A function, a matrix, or a permutation: the image's entry j is u[symmetry[j]].
    n : int
        Number of unknowns.
    name : str
        For messages.

    Raises
    ------
    ValueError
        If it is none of these.
    """
    if callable(symmetry):
        call: Callable[[np.ndarray], Any] = symmetry

        def image(u: np.ndarray) -> np.ndarray:
            found = np.array(call(np.array(u, dtype=float)), dtype=float).reshape(-1)
            if len(found) != n:
                raise ValueError(f"{name} returns {len(found)} numbers for {n} unknowns; as many are needed")
            return found

        try:
            tried = image(_probe(n))
        except ValueError:
            raise
        except Exception as error:  # a user's function may fail in any way
            raise ValueError(f"{name} raises {type(error).__name__}: {error}, for {n} unknowns") from error
        if not np.isfinite(tried).all():
            raise ValueError(
                f"{name} returns {tried.tolist()} for {_probe(n).tolist()}; finite numbers are needed"
            )
        return image
    matrix = np.asarray(symmetry)
    if matrix.ndim == 1 and len(matrix) == n and np.array_equal(np.sort(matrix), np.arange(n)):
        order = matrix.astype(int)
        return lambda u: np.asarray(u, dtype=float)[order]
    if matrix.shape == (n, n):
        matrix = matrix.astype(float)
        return lambda u: matrix @ u
    raise ValueError(
        f"{name} must be a function of u, a matrix of shape ({n}, {n}) or a permutation of 0 to {n - 1}; "
        f"this one has shape {matrix.shape}"
    )


def order_of(image: Image, n: int, most: int) -> int | None:
    """How many times an image has to be applied before every point is back where it was; None if more than `most` times, or never."""
    probe = _probe(n)
    here = image(probe)
    within = IDENTITY.image * max(1.0, float(np.abs(here).max()))
    for times in range(1, most + 1):
        if np.abs(here - probe).max() <= within:
            return times
        here = image(here)
    return None


def refuse_no_mirror(image: Image, n: int) -> None:
    """Refuse a mirror that does not undo itself: of equivalent solutions only two are known as one, and a projection has no inverse.

    Raises
    ------
    ValueError
        A sentence with a state and what the mirror makes of it.
    """
    if order_of(image, n, 2) is None:
        probe = _probe(n)
        raise ValueError(
            f"mirror takes u = {_shown(probe)} to {_shown(image(probe))}, and that to {_shown(image(image(probe)))}: applied twice a "
            f"mirror must lead back to u; leave it out, or give one that does, such as lambda u: -u"
        )


def refuse_no_group(generators: Sequence[tuple[str, Image]], n: int) -> None:
    """Refuse images of which no power leads back, such as projections: they generate no finite group.

    Raises
    ------
    ValueError
        A sentence with the name, a state, and its image.
    """
    for name, image in generators:
        if order_of(image, n, MOST) is None:
            probe = _probe(n)
            raise ValueError(
                f"{name} takes u = {_shown(probe)} to {_shown(image(probe))}, and does not lead back to u however often it is applied "
                f"({MOST} times were tried); leave it out, or give one of a finite order, such as a reflection or a permutation"
            )


def _shown(u: np.ndarray) -> str:
    return np.array2string(u, precision=4, threshold=6)


def _probe(n: int) -> np.ndarray:
    return np.modf(np.sqrt(2.0) * np.arange(1.0, n + 1.0))[0]


def images_of(generators: list[Callable[[np.ndarray], np.ndarray]], n: int) -> list[Callable]:
    """All elements, but for the identity, of the finite group that some images generate.

    Parameters
    ----------
    generators : list of callable
    n : int

    Raises
    ------
    ValueError
        If there are more than `MOST` elements: the group is not finite, or too large to be listed.
    """
    probe = _probe(n)
    known, elements = [probe], []
    todo = list(generators)
    while todo:
        element = todo.pop()
        image = element(probe)
        if any(np.abs(image - other).max() < IDENTITY.image for other in known):
            continue
        known.append(image)
        elements.append(element)
        if len(elements) > MOST:
            raise ValueError(
                f"symmetries generate more than {MOST} images; give generators of a finite group"
            )
        todo += [lambda u, f=element, g=g: g(f(u)) for g in generators]
    return elements


def smallest_image(u: np.ndarray, images: list[Callable], scale: np.ndarray) -> np.ndarray:
    """Of u and its images the first in dictionary order; differences at roundoff do not count."""
    best = u
    for image in images:
        other = image(u)
        different = np.flatnonzero(np.abs(other - best) > IDENTITY.same * (scale + np.abs(best)))
        if len(different) and other[different[0]] < best[different[0]]:
            best = other
    return best


def in_order(scale: np.ndarray) -> Callable[[np.ndarray], SupportsRichComparison]:
    """A key of dictionary order, in which differences at roundoff do not count."""

    def compare(a: np.ndarray, b: np.ndarray) -> int:
        different = np.flatnonzero(np.abs(a - b) > scale)
        return 0 if not len(different) else (-1 if a[different[0]] < b[different[0]] else 1)

    return cmp_to_key(compare)


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


def refuse_asymmetry(
    functions: Differentiated, values: Values, symmetry: tuple[str, Image], u: np.ndarray, mixed: bool
) -> None:
    """Refuse a mirror or a symmetry of which the equations know nothing.

    Parameters
    ----------
    functions : Differentiated
        The equations.
    values : callable
        Their values, each state in its own piece.
    symmetry : (str, callable)
        What it is called, and the image.
    u : ndarray, shape (n,)
        The start.
    mixed : bool
        Whether rows may stand in any order.

    Raises
    ------
    ValueError
        A sentence with the row, the state and the size of the disagreement.
    """
    (name, image), varying, p = symmetry, functions.parameters.varying, functions.parameters.start
    lengths = functions.lengths, functions.parameter_length(u, p)
    found = asymmetry(values, image, (u, p), lengths, functions.noise, mixed)
    if found is None:
        return
    where = f"at u = {_shown(found.u)}, {varying} = {found.p:.6g}"
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
