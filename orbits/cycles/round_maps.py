"""Compiled: the derivative of a round from those of its flights, and products of rounds, for `orbits.cycles.rounds`."""

from __future__ import annotations

import math

import numpy as np

from orbits.compiling.decorators import kernel, stored_kernel


@kernel
def _multiplied(one, other, out):
    """The product of two square matrices into a third one."""
    n = one.shape[0]
    for i in range(n):
        for j in range(n):
            entry = 0.0
            for k in range(n):
                entry += one[i, k] * other[k, j]
            out[i, j] = entry


@kernel
def _copied(source, out):
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            out[i, j] = source[i, j]


@kernel
def _unit(out):
    for i in range(out.shape[0]):
        for j in range(out.shape[0]):
            out[i, j] = 1.0 if i == j else 0.0


@kernel
def _eliminated(matrix, side):
    """Gaussian elimination with partial pivoting in place; `side` (n, m) becomes the solution. Returns the determinant."""
    n, m = matrix.shape[0], side.shape[1]
    determinant = 1.0
    for i in range(n):
        pivot = i
        for j in range(i + 1, n):
            if abs(matrix[j, i]) > abs(matrix[pivot, i]):
                pivot = j
        if pivot != i:
            determinant = -determinant
            for k in range(n):
                matrix[i, k], matrix[pivot, k] = matrix[pivot, k], matrix[i, k]
            for k in range(m):
                side[i, k], side[pivot, k] = side[pivot, k], side[i, k]
        determinant *= matrix[i, i]
        if matrix[i, i] == 0.0:
            return 0.0
        for j in range(n):
            if j == i:
                continue
            share = matrix[j, i] / matrix[i, i]
            for k in range(i, n):
                matrix[j, k] -= share * matrix[i, k]
            for k in range(m):
                side[j, k] -= share * side[i, k]
    for i in range(n):
        for k in range(m):
            side[i, k] /= matrix[i, i]
    return determinant


@stored_kernel
def through_flights(A, D, whole, sizes, room):
    """The product of -D_i^-1 A_i over all flights, and that of their absolute values; False where one cannot be solved for.

    Parameters
    ----------
    A, D : ndarray, shape (l, n, n)
        Derivatives of the equations of each flight by the node before it and after it; without rows in D those of A are the factors.
    whole, sizes : ndarray, shape (n, n)
        Filled.
    room : ndarray, shape (3, n, n)
    """
    matrix, factor, product = room[0], room[1], room[2]
    _unit(whole)
    _unit(sizes)
    for i in range(A.shape[0]):
        _copied(A[i], factor)
        if D.shape[0] > 0:
            _copied(D[i], matrix)
            if _eliminated(matrix, factor) == 0.0:
                return False
            for j in range(factor.shape[0]):
                for k in range(factor.shape[0]):
                    factor[j, k] = -factor[j, k]
        _multiplied(factor, whole, product)
        _copied(product, whole)
        for j in range(factor.shape[0]):
            for k in range(factor.shape[0]):
                factor[j, k] = abs(factor[j, k])
        _multiplied(factor, sizes, product)
        _copied(product, sizes)
    return True


@stored_kernel
def sides_of_cycles(maps, keys, sides, products, room):
    """For each cycle of some rounds the least and the largest distance of its points from the border, and the product of its rounds.

    Parameters
    ----------
    maps : ndarray, shape (2, n, n)
        Derivatives of an unchanged and of a changed round.
    keys : ndarray of int, shape (c, 2)
        Numbers of rounds, and of changed ones, which come first.
    sides : ndarray, shape (c, 2)
        Filled: det P_i (see `orbits.cycles.rounds`), counted positive on the side on which its first round is real; NaN where one is no number.
    products : ndarray, shape (c, n, n)
        Filled, read from the first point.
    room : ndarray, shape (3, n, n)
    """
    P, M, product = room[0], room[1], room[2]
    n = maps.shape[1]
    for c in range(keys.shape[0]):
        rounds, changed = keys[c, 0], keys[c, 1]
        low, high = np.inf, -np.inf
        for first in range(rounds):
            begins = 1 if first < changed else 0
            _unit(P)
            _copied(maps[begins], M)
            for later in range(1, rounds):
                here = maps[1 if (first + later) % rounds < changed else 0]
                _multiplied(here, P, product)
                _copied(product, P)
                for i in range(n):
                    P[i, i] += 1.0
                if first == 0:
                    _multiplied(here, M, product)
                    _copied(product, M)
            if first == 0:
                _copied(M, products[c])
            _unit(product)
            side = (2.0 * begins - 1.0) * _eliminated(P, product)
            if side < low or side != side:
                low = side
            if side > high or side != side:
                high = side
            if not math.isfinite(side):
                low = high = np.nan
                break
        sides[c, 0], sides[c, 1] = low, high
