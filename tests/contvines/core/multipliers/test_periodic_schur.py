"""Multipliers of cycles against products in many digits (mpmath) and exact identities."""

import math

import mpmath
import numpy as np
import pytest

from contvines.core.library import native
from contvines.core.multipliers.periodic_schur import (
    multipliers,
    periodic_multipliers,
    periodic_reference,
    reference,
)

NATIVE = [multipliers, periodic_multipliers] if native() else []
REFERENCE = [reference, periodic_reference]
BOTH = pytest.mark.parametrize("method", [*NATIVE, *REFERENCE])


def compute(method, A, D=None, twist=1.0):
    """Multipliers as complex numbers; D defaults to minus the identity, so that A are the factors."""
    length, n = A.shape[:2]
    if D is None:
        D = np.tile(-np.eye(n), (length, 1, 1))
    re, im = np.empty(n), np.empty(n)
    assert method(A, D, twist, re, im)
    return re + 1j * im


def exact(A, D=None, twist=1.0, digits=80):
    """The same by forming the product in many digits."""
    length, n = A.shape[:2]
    with mpmath.workdps(digits + 2 * length):
        product = mpmath.eye(n)
        for i in range(length):
            product = mpmath.matrix(A[i].tolist()) * product
            if D is not None:
                product = -mpmath.inverse(mpmath.matrix(D[i].tolist())) * product
        for r in range(1, n):
            for c in range(n):
                product[r, c] *= twist
        values = [product[0, 0]] if n == 1 else mpmath.eig(product, left=False, right=False)
        return sorted(values, key=lambda z: -abs(z))


def distance(found, expected):
    """Largest relative difference when each expected value takes its nearest free match."""
    free = list(found)
    worst = 0.0
    for z in expected:
        nearest = min(free, key=lambda x: abs(mpmath.mpc(x) - z))
        free.remove(nearest)
        worst = max(worst, float(abs(mpmath.mpc(nearest) - z) / abs(z)))
    return worst


def normal(draw, length, n):
    return draw.normal(size=(length, n, n))


def graded(draw, n):
    """Growth and decay of 1e6 between neighbours in rotated bases; multipliers of order one to 1e-18."""
    bases = np.linalg.qr(draw.normal(size=(6, n, n)))[0]
    diagonals = np.ones((6, n))
    diagonals[:, 0] = [1e6, 1e-6, 1e5, 1e-5, 2.0, 1.0]
    diagonals[:, -1] = 1e-3
    return np.array([bases[(i + 1) % 6] @ np.diag(diagonals[i]) @ bases[i].T for i in range(6)])


def unlike(draw, length):
    """Two multipliers of different size; both signs are among the seeds."""
    A = normal(draw, length, 2)
    A[0] = A[0] @ np.diag([1.0, 1e-6])
    return A


def turning(draw, size):
    """A pair; long products are scaled by powers of two on the way, and real and imaginary parts must come back alike."""
    basis = np.eye(3) + 0.1 * draw.normal(size=(3, 3))
    block = np.diag([np.cos(0.4), np.cos(0.4), 0.5])
    block[1, 0], block[0, 1] = np.sin(0.4), -np.sin(0.4)
    return np.tile(basis @ (size ** (1.0 / 12) * block) @ np.linalg.inv(basis), (12, 1, 1))


SEVERAL = (0, 1, 2)
FACTORS = [
    *((normal, (length, n), 1e-9, SEVERAL) for n in (1, 2, 3, 4) for length in (1, 2, 5, 30)),
    (normal, (1, 6), 1e-9, range(6)),
    *((graded, (n,), 1e-8, seeds) for n, seeds in ((2, (3, 6, 7)), (4, (1,)))),  # of bases that are no worse
    *((unlike, (length,), 1e-6, SEVERAL) for length in (1, 4, 30)),
    *((turning, (size,), 1e-8, SEVERAL) for size in (1e-40, 1.0, 1e60)),
]


@BOTH
@pytest.mark.parametrize(("make", "of", "accuracy", "seeds"), FACTORS)
def test_multipliers_are_those_of_the_product_in_many_digits(method, make, of, accuracy, seeds):
    for seed in seeds:
        draw = np.random.default_rng(seed)
        A = make(draw, *of)
        D = draw.normal(size=A.shape)
        for twist in (1.0, -1.0):
            assert distance(compute(method, A, None, twist), exact(A, None, twist)) < accuracy
            assert distance(compute(method, D @ A, D, twist), exact(D @ A, D, twist)) < accuracy


@BOTH
def test_thousands_of_unstable_factors_neither_overflow_nor_lose_the_small_one(method):
    """One matrix repeated: lambda^L, where both powers leave the range of floats or nearly so."""
    A1 = np.array([[3.0, 1.0], [1.0, 0.5]])
    found = compute(method, np.tile(A1, (400, 1, 1)))
    assert found.real == pytest.approx(
        (1.75 + np.array([1.0, -1.0]) * math.sqrt(1.25**2 + 1.0)) ** 400, rel=1e-11
    )
    assert not found.imag.any()
    found = compute(method, np.tile(A1, (8192, 1, 1)))
    assert found[0] == 2.0**1023 and found[1] == 2.0**-1021


def test_singular_second_block_gives_nan():
    A, D = np.ones((2, 2, 2)), np.zeros((2, 2, 2))
    re, im = np.empty(2), np.empty(2)
    assert not multipliers(A, D, 1.0, re, im) and not reference(A, D, 1.0, re, im)
    assert np.isnan(re).all()


@pytest.mark.parametrize("n", [1, 2, 3, 4, 6])
def test_eigenvalues_of_special_matrices(n):
    """Of one factor: Francis' double shifts in the native core."""

    def values(matrix):
        return compute(multipliers, matrix[None])

    assert not np.any(values(np.diag(np.ones(n - 1), 1)))
    assert sorted(values(np.diag(np.arange(n) + 1.0)).real) == pytest.approx(range(1, n + 1))
    assert np.abs(values(np.roll(np.eye(n), 1, axis=0))) == pytest.approx(np.ones(n))


@pytest.mark.parametrize("length", [12, 33, 200])
def test_multipliers_of_very_different_size_where_the_product_is_useless(length):
    """Strong growth against strong decay in turning directions: the bound fails, the larger multiplier is still exact."""
    A = normal(np.random.default_rng(length), length, 2)
    A[::4] = np.diag([300.0, 0.01]) @ A[::4]
    A[1::4] = A[1::4] @ np.diag([0.01, 300.0])
    for twist in (1.0, -1.0):
        expected = exact(A, None, twist)
        assert distance(compute(multipliers, A, None, twist), expected) < 1e-8
        assert distance(compute(periodic_multipliers, A, None, twist)[:1], expected[:1]) < 1e-8


@BOTH
def test_entries_below_the_least_normal_number(method):
    """Blocks coupled by entries with a few bits only, as those of a state that has decayed to nothing: their multipliers are those of the blocks."""
    turn = np.array([[math.cos(0.1), -math.sin(0.1)], [math.sin(0.1), math.cos(0.1)]])
    A = np.zeros((40, 4, 4))
    A[:, :2, :2], A[:, 2:, 2:] = np.diag([-0.73, 0.88]), 1.05 * turn
    A[:, :2, 2:], A[:, 2:, :2] = 5e-324 * np.random.default_rng(0).integers(-2000, 2000, (2, 40, 2, 2))
    found = compute(method, A)
    pair = 1.05**40 * np.exp(4j)
    assert distance(found, [pair, pair.conjugate(), 0.73**40, 0.88**40]) < 1e-12
