"""What a continuation calls of a problem, whether in Python or native."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np


class KernelFunctions(Protocol):
    """The functions of a problem (see the contract in `contvines.problems.protocol`): `contvines.problems.protocol.Kernels`, or a compiled problem's `contvines.core.table.TableKernels`."""

    @property
    def linearise(self) -> Callable[..., float]: ...
    @property
    def bordered(self) -> Callable[..., float]: ...
    @property
    def inspect(self) -> Callable[..., None]: ...
    @property
    def compiled(self) -> bool: ...
    @property
    def assign(self) -> Callable[..., None] | None: ...
    @property
    def flip(self) -> Callable[..., None] | None: ...
    @property
    def transpose(self) -> Callable[..., None] | None: ...
    @property
    def column(self) -> int: ...
    @property
    def matrix(self) -> Callable[..., np.ndarray] | None: ...
