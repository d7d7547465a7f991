"""Eigenvalues of a long product of small matrices, without trusting the product.

A cycle of L maps has the linearised factors M_i = -D_i^{-1} A_i (A_i = dg_i/dx_i, D_i = dg_i/dx_{i+1}); its
multipliers are the eigenvalues of S M_{L-1} ... M_0, with S = diag(1, twist, twist, ...) the closure.

Two levels. The product is formed in scaled form together with a bound on its rounding error, the trace of
sum_j |M_{L-1} .. M_{j+1}| |M_j| |M_{j-1} .. M_0| (entry by entry, so that badly scaled nodes do no harm). Where
that is small, or hardly more than what rounding the factors alone does, sum_j |M_j| |M_{j-1} .. M_0 M_{L-1} ..
M_{j+1}|, the product is the answer. Otherwise the periodic QR algorithm (`contvines.core.multipliers.periodic_qr`) works on the
factors. Both cost O(L) time and memory.

`reference` here defines what is right. The native core (native/multipliers.hpp) does the same; for 2 x 2 factors it takes the smaller
multiplier from the product of the determinants, which keeps its relative accuracy however small it is.
"""

from __future__ import annotations

import numpy as np

from ..library import NUMBER, POINTER, WHOLE, address, function, native
from . import periodic_qr
from .scaled_product import scaled_product


def multipliers(A: np.ndarray, D: np.ndarray, twist: float, re: np.ndarray, im: np.ndarray) -> bool:
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

    Returns
    -------
    converged : bool
    """
    return _called("core_multipliers", A, D, twist, re, im) if native() else reference(A, D, twist, re, im)


def periodic_multipliers(A: np.ndarray, D: np.ndarray, twist: float, re: np.ndarray, im: np.ndarray) -> bool:
    """The same by the periodic QR algorithm alone."""
    if native():
        return _called("core_periodic_multipliers", A, D, twist, re, im)
    return periodic_qr.periodic_multipliers(A, D, twist, re, im)


def reference(A: np.ndarray, D: np.ndarray, twist: float, re: np.ndarray, im: np.ndarray) -> bool:
    """`multipliers` in plain Python and numpy."""
    with np.errstate(all="ignore"):
        return scaled_product(A, D, twist, re, im) or periodic_qr.periodic_multipliers(A, D, twist, re, im)


def _called(name: str, A: np.ndarray, D: np.ndarray, twist: float, re: np.ndarray, im: np.ndarray) -> bool:
    length, n = A.shape[0], A.shape[1]
    A, D = np.ascontiguousarray(A, dtype=float), np.ascontiguousarray(D, dtype=float)
    scratch = np.empty(length * (3 * n * n + 4) + 8 * n * (n + 1))
    call = function(name, WHOLE, POINTER, POINTER, WHOLE, WHOLE, NUMBER, POINTER, POINTER, POINTER)
    places = address(re), address(im), address(scratch)
    return bool(call(address(A), address(D), length, n, twist, *places))
