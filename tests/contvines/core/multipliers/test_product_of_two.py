"""Multipliers of 2 x 2 factors of very different sizes, against many digits."""

import mpmath as mp
import numpy as np
import pytest

from contvines.core.multipliers.periodic_schur import multipliers, reference
from contvines.core.multipliers.product_of_any import product_of_any
from contvines.core.multipliers.product_of_two import (
    CERTAIN,
    dominant_of_two,
    product_of_two,
)


def exact(A, D, twist):
    with mp.workdps(200):
        product = mp.eye(2)
        for a, d in zip(A, D):
            product = -mp.inverse(mp.matrix(d.tolist())) * mp.matrix(a.tolist()) * product
        product = mp.diag([1, int(twist)]) * product
        values = mp.eig(product)[0]
        return sorted(values, key=lambda v: -abs(v))


@pytest.mark.parametrize("twist", [1.0, -1.0])
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("length", [1, 4, 30])
def test_the_dominant_one_has_its_sign(twist, seed, length):
    draw = np.random.default_rng(100 * seed + length)
    A, D = draw.normal(size=(2, length, 2, 2))
    A[0] = A[0] @ np.diag([1.0, 1e-6])  # two multipliers of different size, both signs among the seeds
    re, im, scratch = np.zeros(2), np.zeros(2), np.zeros(10 * length + 2)
    wanted = exact(A, D, twist)
    product_of_two(A, D, twist, re, im, scratch)
    assert dominant_of_two(length, twist, re, im, scratch) == CERTAIN
    assert im.tolist() == [0.0, 0.0]
    assert abs(re[0] / mp.re(wanted[0]) - 1) < 1e-9
    assert abs(re[1] / mp.re(wanted[1]) - 1) < 1e-6


@pytest.mark.parametrize("method", [multipliers, reference])
def test_conjugate_pairs(method):
    angle, size = 0.7, 0.9
    turn = size * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    re, im = np.zeros(2), np.zeros(2)
    assert method(turn[None], -np.eye(2)[None], 1.0, re, im)
    assert re == pytest.approx([size * np.cos(angle)] * 2) and im == pytest.approx(
        [size * np.sin(angle), -size * np.sin(angle)]
    )


@pytest.mark.parametrize("size", [1e-40, 1.0, 1e60])
def test_pairs_of_any_size_in_products_of_any_order(size):
    """Long products are scaled by powers of two on the way; real and imaginary parts must come back alike."""
    draw = np.random.default_rng(3)
    length, n = 12, 3
    basis = np.eye(n) + 0.1 * draw.normal(size=(n, n))
    angle = 0.4
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 0.5]]
    )
    step = basis @ (size ** (1.0 / length) * turn) @ np.linalg.inv(basis)
    A, D = np.tile(step, (length, 1, 1)), np.tile(-np.eye(n), (length, 1, 1))
    re, im = np.zeros(n), np.zeros(n)
    assert product_of_any(A, D, 1.0, re, im) == CERTAIN
    pair = size * np.exp(1j * angle * length)
    assert re[0] + 1j * im[0] == pytest.approx(complex(pair.real, abs(pair.imag)), rel=1e-8)
    assert re[1] - 1j * im[1] == pytest.approx(complex(pair.real, abs(pair.imag)), rel=1e-8)
