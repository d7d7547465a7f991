"""A user's symmetries (callables, matrices or permutations), and the test whether the equations have them."""

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


MOST = 400  # most elements of a group

Image = Callable[[np.ndarray], np.ndarray]


def linear_part(image: Image, n: int) -> Image:
    """Return the linear part of an affine image, which acts on differences of states."""
    added = image(np.zeros(n))
    return image if not added.any() else lambda v: image(v) - added


def image_map(
    symmetry: Callable[[np.ndarray], ArrayLike] | ArrayLike, n: int, name: str = "mirror"
) -> Callable[[np.ndarray], np.ndarray]:
    """Convert a user's symmetry to a function u -> image of u.

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
    """Order of an image: how many times it must be applied to give the identity; None if more than `most` times."""
    probe = _probe(n)
    state = image(probe)
    within = IDENTITY.image * max(1.0, float(np.abs(state).max()))
    for times in range(1, most + 1):
        if np.abs(state - probe).max() <= within:
            return times
        state = image(state)
    return None


def refuse_no_mirror(image: Image, n: int) -> None:
    """Raise an error for a mirror that is not its own inverse, such as a projection or a quarter turn.

    Raises
    ------
    ValueError
        The message shows a state and its images.
    """
    if order_of(image, n, 2) is None:
        probe = _probe(n)
        raise ValueError(
            f"mirror takes u = {_shown(probe)} to {_shown(image(probe))}, and that to {_shown(image(image(probe)))}: applied twice a "
            f"mirror must lead back to u; leave it out, or give one that does, such as lambda u: -u"
        )


def refuse_no_group(generators: Sequence[tuple[str, Image]], n: int) -> None:
    """Raise an error for images of infinite order, such as projections: they do not generate a finite group.

    Raises
    ------
    ValueError
        The message contains the name, a state, and its image.
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
    """A state without symmetry: fractional parts of multiples of sqrt(2)."""
    return np.modf(np.sqrt(2.0) * np.arange(1.0, n + 1.0))[0]


def images_of(generators: list[Callable[[np.ndarray], np.ndarray]], n: int) -> list[Callable]:
    """Return all elements, except the identity, of the finite group that some images generate.

    Parameters
    ----------
    generators : list of callable
    n : int

    Raises
    ------
    ValueError
        If there are more than `MOST` elements: the group is infinite or too large.
    """
    probe = _probe(n)
    images, elements = [probe], []
    todo = list(generators)
    while todo:
        element = todo.pop()
        image = element(probe)
        if any(np.abs(image - other).max() < IDENTITY.image for other in images):
            continue
        images.append(image)
        elements.append(element)
        if len(elements) > MOST:
            raise ValueError(
                f"symmetries generate more than {MOST} images; give generators of a finite group"
            )
        todo += [lambda u, f=element, g=g: g(f(u)) for g in generators]
    return elements


def smallest_image(u: np.ndarray, images: list[Callable], scale: np.ndarray) -> np.ndarray:
    """Return the first in dictionary order of u and its images; differences at roundoff are ignored."""
    best = u
    for image in images:
        other = image(u)
        different = np.flatnonzero(np.abs(other - best) > IDENTITY.same * (scale + np.abs(best)))
        if len(different) and other[different[0]] < best[different[0]]:
            best = other
    return best


def in_order(scale: np.ndarray) -> Callable[[np.ndarray], SupportsRichComparison]:
    """Return a sort key for dictionary order that ignores differences up to `scale`."""

    def compare(a: np.ndarray, b: np.ndarray) -> int:
        different = np.flatnonzero(np.abs(a - b) > scale)
        return 0 if not len(different) else (-1 if a[different[0]] < b[different[0]] else 1)

    return cmp_to_key(compare)


# distances of the test states from the start, in lengths over which the equations are nonlinear
REACHES = (0.01, 0.1, 0.4, 1.0)
UNIFORM_STATES = 2  # further test states at which all unknowns move alike: at random states of a discretised field stiff terms dominate
NOISY = 30.0  # largest accepted disagreement, in units of the noise of a row
MIXED = 60  # most unknowns for which any constant matrix S is accepted in F(R u) = S F(u)
MORE = 6  # states in addition to those that determine such a matrix; they test it

Values = Callable[[np.ndarray, float], np.ndarray]


class Asymmetry(NamedTuple):
    """A state (u, p) at which F at the image of u is not the image of F.

    ``found`` is the entry ``row`` of F at the image, ``wanted`` its value by the symmetry, ``relative`` their difference relative to the row's
    size; ``row`` is -1 if F cannot be evaluated at the images.
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
    """Raise an error if the equations do not have a given symmetry.

    Parameters
    ----------
    functions : Differentiated
        The equations.
    values : callable
        (u, p) -> F, with the signs of the switches at u.
    symmetry : (str, callable)
        Name and image.
    u : ndarray, shape (n,)
        The start.
    mixed : bool
        Whether the rows may be permuted, multiplied by numbers or combined; see `asymmetry`.

    Raises
    ------
    ValueError
        The message contains the row, the state and the size of the disagreement.
    """
    (name, image), varying, p = symmetry, functions.parameters.varying, functions.parameters.start
    lengths = functions.lengths, functions.parameter_length(u, p)
    found = asymmetry(values, image, (u, p), lengths, functions.noise, mixed)
    if found is None:
        return
    place = f"at u = {_shown(found.u)}, {varying} = {found.p:.6g}"
    if found.row < 0:
        raise ValueError(
            f"{name} is no symmetry of {functions.name}, which cannot be evaluated at the images of the tested states, "
            f"for example {place}"
        )
    raise ValueError(
        f"{name} is no symmetry of {functions.name}: {place}, row {found.row} of {functions.name} at the image is "
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
    """Return the largest disagreement with F(R u, p) = S F(u, p) for an image R; None if the symmetry holds or cannot be tested.

    It is tested at states around the start and at several parameter values. S is the linear part of R or, if `mixed`, any constant
    matrix: rows may be in another order or multiplied by numbers.

    Parameters
    ----------
    values : callable
        (u, p) -> F, shape (n,); NotEvaluable or not finite where it is not defined.
    image : callable
        R.
    start, lengths : (ndarray of shape (n,), float)
        Unknowns and parameter, and the lengths over which F is nonlinear in them.
    noise : ndarray, shape (n,)
        Standard deviation of each row.
    mixed : bool
    """
    states, n = _states(*start, *lengths), len(start[0])
    wanted = [next(states) for _ in range(len(REACHES) + UNIFORM_STATES)]

    tried, lost = _evaluated_pairs(values, image, wanted)
    if len(lost) > len(tried):
        return Asymmetry(-1, np.nan, np.nan, np.nan, *lost[0])
    if not tried:
        return None
    worst = _worst(tried, linear_part(image, n), noise)
    if worst is None or not (mixed and n <= MIXED):
        return worst
    tried += _evaluated_pairs(values, image, [next(states) for _ in range(n + MORE)])[0]
    return None if len(tried) > n and _constant(tried, noise) else worst


class Pair(NamedTuple):
    """F at a state and at its image."""

    u: np.ndarray
    p: float
    value: np.ndarray
    imaged: np.ndarray


def _evaluated_pairs(
    values: Values, image: Image, states: Sequence[tuple[np.ndarray, float]]
) -> tuple[list[Pair], list[tuple[np.ndarray, float]]]:
    """F at states and at their images, and the states at which only one of the two can be evaluated."""
    tried, lost = [], []
    for u, p in states:
        value, image_value = _finite(values, u, p), _finite(values, image(u), p)
        if value is not None and image_value is not None:
            tried.append(Pair(u, p, value, image_value))
        elif value is not None or image_value is not None:
            lost.append((u, p))
    return tried, lost


def _states(u: np.ndarray, p: float, lengths: np.ndarray, reach: float) -> Iterator[tuple[np.ndarray, float]]:
    """Generate test states: first those at which all unknowns move alike, then random ones at the distances `REACHES`."""
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
    expected = [turn(pair.value) for pair in tried]
    sizes = [
        np.maximum(np.abs(pair.imaged), np.abs(other)) for pair, other in zip(tried, expected, strict=True)
    ]
    allowed = IDENTITY.cancelled * np.max(sizes, axis=0) + NOISY * (noise + np.abs(turn(noise)))
    worst = None
    for (u, p, _, image_value), other, size in zip(tried, expected, sizes, strict=True):
        gap = np.abs(image_value - other)
        with np.errstate(all="ignore"):
            relative = np.where(gap > IDENTITY.same * size + allowed, gap / size, 0.0)
        row = int(np.argmax(relative))
        if relative[row] > (0.0 if worst is None else worst.relative):
            worst = Asymmetry(row, float(image_value[row]), float(other[row]), float(relative[row]), u, p)
    return worst


def _constant(tried: list[Pair], noise: np.ndarray) -> bool:
    """Whether one constant matrix maps F at all states to F at their images."""
    values, images = np.array([pair.value for pair in tried]), np.array([pair.imaged for pair in tried])
    sizes = np.maximum(np.abs(values).max(axis=0), np.abs(images).max(axis=0))
    sizes[sizes == 0.0] = 1.0
    values, images = values / sizes, images / sizes
    weights = np.linalg.norm(np.hstack([values, images]), axis=1)
    weights[weights == 0.0] = 1.0  # F is small at near states, which count as much as the others
    matrix = np.linalg.lstsq(values / weights[:, None], images / weights[:, None], rcond=None)[0]
    mixing = 1.0 + np.abs(matrix).sum(axis=0)
    allowed = IDENTITY.same * mixing * weights[:, None] + NOISY * mixing * float((noise / sizes).max())
    return bool((np.abs(values @ matrix - images) <= allowed).all())
