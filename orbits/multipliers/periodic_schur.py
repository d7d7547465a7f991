"""Eigenvalues of a long product of small matrices, without trusting the product.

A cycle of L maps has the linearised factors M_i = -D_i^{-1} A_i (A_i = dg_i/dx_i, D_i = dg_i/dx_{i+1}); its
multipliers are the eigenvalues of S M_{L-1} ... M_0, with S = diag(1, twist, twist, ...) the closure.

Two levels. The product is formed in scaled form together with a bound on its rounding error, the trace of
sum_j |M_{L-1} .. M_{j+1}| |M_j| |M_{j-1} .. M_0| (entry by entry, so that badly scaled nodes do no harm). Where
that is small, or hardly more than what rounding the factors alone does, sum_j |M_j| |M_{j-1} .. M_0 M_{L-1} ..
M_{j+1}|, the product is the answer; for 2 x 2 factors the smaller multiplier comes from the product of the
determinants, so it keeps its relative accuracy however small it is. Otherwise the periodic QR algorithm
(`orbits.multipliers.periodic_qr`) works on the factors. Both cost O(L) time and memory, and neither allocates.
"""

import ctypes
import math

import numpy as np
from llvmlite.binding import add_symbol
from numba import types

from orbits.compiling.decorators import kernel
from orbits.compiling.waiting import wait_for
from orbits.multipliers.factors import scratch_size
from orbits.multipliers.periodic_qr import periodic_multipliers
from orbits.multipliers.product_of_any import product_of_any
from orbits.multipliers.product_of_two import CERTAIN, UNCERTAIN, UNDEFINED, dominant_of_two, product_of_two

__all__ = [
    "multipliers",
    "multipliers_of",
    "multipliers_of_any",
    "multipliers_of_two",
    "periodic_multipliers",
    "scratch_size",
]


@ctypes.CFUNCTYPE(
    ctypes.c_int32, *[ctypes.c_void_p] * 2, *[ctypes.c_int64] * 2, ctypes.c_double, *[ctypes.c_void_p] * 3
)
def _late(A, D, length, n, twist, re, im, scratch):
    """`periodic_multipliers`, called by address from compiled code: most runs never need it, nor wait for it."""

    def array(address, *shape):
        return np.ctypeslib.as_array((ctypes.c_double * math.prod(shape)).from_address(address)).reshape(
            shape
        )

    wait_for(periodic_multipliers.__name__, periodic_multipliers)
    return periodic_multipliers(
        array(A, length, n, n),
        array(D, length, n, n),
        twist,
        array(re, n),
        array(im, n),
        array(scratch, scratch_size(length, n)),
    )


add_symbol("contvines_periodic_multipliers", ctypes.cast(_late, ctypes.c_void_p).value)
_periodic = types.ExternalFunction(
    "contvines_periodic_multipliers",
    types.int32(
        types.uintp,
        types.uintp,
        types.int64,
        types.int64,
        types.float64,
        types.uintp,
        types.uintp,
        types.uintp,
    ),
)


@kernel
def _otherwise(found, A, D, twist, re, im, scratch):
    """What is left to do after the scaled product."""
    length, n = A.shape[0], A.shape[1]
    if found == CERTAIN:
        return True
    if found == UNDEFINED:
        for j in range(n):
            re[j] = im[j] = math.nan
        return False
    converged = _periodic(
        A.ctypes.data, D.ctypes.data, length, n, twist, re.ctypes.data, im.ctypes.data, scratch.ctypes.data
    )
    return converged != 0


@kernel
def multipliers_of_two(A, D, twist, re, im, scratch):
    """`multipliers` for nodes of two unknowns."""
    found = product_of_two(A, D, twist, re, im, scratch)
    if found == UNCERTAIN:
        found = dominant_of_two(A.shape[0], twist, re, im, scratch)
    return _otherwise(found, A, D, twist, re, im, scratch)


@kernel
def multipliers_of_any(A, D, twist, re, im, scratch):
    """`multipliers` for nodes of more than two unknowns."""
    return _otherwise(product_of_any(A, D, twist, re, im, scratch), A, D, twist, re, im, scratch)


def multipliers_of(node):
    """The kernel for nodes of so many unknowns."""
    return multipliers_of_two if node == 2 else multipliers_of_any


@kernel
def multipliers(A, D, twist, re, im, scratch):
    """Multipliers of a cycle: eigenvalues of diag(1, twist, ..) M_{L-1} .. M_0, M_i = -D_i^{-1} A_i.

    Parameters
    ----------
    A, D : ndarray (L, n, n)
        Derivatives of the i-th map with respect to its first and its second node.
    twist : float
        +1 for a full period, -1 for half a period followed by the mirror.
    re, im : ndarray (n,)
        Filled: descending modulus, then real part; pairs exactly conjugate; exact zeros where a stick
        forgets. Beyond the range of floats they are clamped to 2**1023 or 2**-1021 in size. NaN if a D_i is
        singular.
    scratch : ndarray (scratch_size(L, n),)

    Returns
    -------
    converged : bool
    """
    if A.shape[1] == 2:
        return multipliers_of_two(A, D, twist, re, im, scratch)
    return multipliers_of_any(A, D, twist, re, im, scratch)
