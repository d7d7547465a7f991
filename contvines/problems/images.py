"""Symmetries as users give them: callables, matrices or permutations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cmp_to_key
from typing import TYPE_CHECKING, Any

import numpy as np

from .settings import IDENTITY

if TYPE_CHECKING:
    from _typeshed import SupportsRichComparison
    from numpy.typing import ArrayLike

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
