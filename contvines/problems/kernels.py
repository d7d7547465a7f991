"""Kernels: the functions of a problem that a continuation calls; the contract is that of :mod:`contvines.problems.protocol`."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Kernels:
    """The functions of a problem (see the contract above).

    Parameters
    ----------
    linearise, bordered, inspect : callable
        All three compiled by numba in nopython mode, or all three plain Python.
    compiled : bool
        Whether they are compiled.
    digest : str
        Identifies their sources, the files they call included; part of the name under which the compiled
        continuation loop is cached on disk. Empty: taken from the files that define the three functions.
    assign, flip, transpose, matrix : callable, optional
    column : int
        For loci against a second parameter; see the contract.
    """

    linearise: Callable[..., float]
    bordered: Callable[..., float]
    inspect: Callable[..., None]
    compiled: bool = False
    digest: str = ""
    assign: Callable[..., None] | None = None
    flip: Callable[..., None] | None = None
    transpose: Callable[..., None] | None = None
    column: int = -1
    matrix: Callable[..., np.ndarray] | None = None


def kernels_digest(kernels: Any) -> str:
    """A short digest of the sources of some kernels: their own ``digest``, else of the files that define them."""
    if kernels.digest:
        return str(kernels.digest)
    digest = hashlib.blake2b(digest_size=8)
    for kernel in (kernels.linearise, kernels.bordered, kernels.inspect):
        code = getattr(kernel, "py_func", kernel).__code__
        digest.update(f"{code.co_filename}:{code.co_name}".encode())
        try:
            with open(code.co_filename, "rb") as source:
                digest.update(source.read())
        except OSError:
            digest.update(code.co_code)
    return digest.hexdigest()
