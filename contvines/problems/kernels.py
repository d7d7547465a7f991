"""Kernels: the functions of a problem that a continuation calls; the contract is that of :mod:`contvines.problems.protocol`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Kernels:
    """The functions of a problem (see the contract above).

    Parameters
    ----------
    linearise, bordered, inspect : callable
        In Python. A compiled problem has a `contvines.core.table.TableKernels` in the place of this.
    compiled : bool
        False.
    assign, flip, transpose, matrix : callable, optional
    column : int
        For loci against a second parameter; see the contract.
    """

    linearise: Callable[..., float]
    bordered: Callable[..., float]
    inspect: Callable[..., None]
    compiled: bool = False
    assign: Callable[..., None] | None = None
    flip: Callable[..., None] | None = None
    transpose: Callable[..., None] | None = None
    column: int = -1
    matrix: Callable[..., np.ndarray] | None = None
