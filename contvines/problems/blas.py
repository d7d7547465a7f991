"""BLAS for short vectors, which the loops of problems in Python call at every point: numpy's own functions take three times as long.

``dot(x, y, n)`` is the inner product (of the first n entries), ``position(x)`` where the largest absolute value stands.
"""

from scipy.linalg import blas

dot = blas.ddot  # type: ignore[attr-defined]
position = blas.idamax  # type: ignore[attr-defined]
