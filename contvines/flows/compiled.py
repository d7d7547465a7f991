"""Right-hand sides in compiled code: a table of C functions that are called with many points at once."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..core.library import address

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..problems.functions import Parameters

_FUNCTION = ctypes.CFUNCTYPE(None, ctypes.c_int64, *[ctypes.c_void_p] * 4)


class CompiledRates:
    """The right-hand side of a flow in C, C++, Rust or Fortran, for ``FlowProblem(CompiledRates("vdp.so"), x0, params)``.

    The library holds a table of three pointers to functions of one signature, ``void *table[3] = {f, dfdx, dfdp}``::

        void f(int64_t n, const double *x, const double *t, const double *p, double *out)

    with n points x (n, d), their times t (n; null of autonomous flows), the parameters p in the order of ``params``, and what is
    asked for in ``out``: f (n, d), df/dx (n, d, d), df/dp (n, d, number of parameters). Arrays are stored row by row. Where a point is
    outside of the domain of f, NaN is the answer. The second and third pointer may be null: then derivatives are differences.

    Parameters
    ----------
    library : str, Path or int
        A shared library, or the address of a table.
    table : str
        Name of the table in the library.

    Raises
    ------
    ValueError
        If there is no such library or table, or no first function in it.
    """

    def __init__(self, library: str | Path | int, table: str = "table") -> None:
        if isinstance(library, int):
            addresses = (ctypes.c_void_p * 3).from_address(library)
        else:
            try:
                self.library = ctypes.CDLL(str(Path(library).resolve()))  # kept: the functions live in it
                addresses = (ctypes.c_void_p * 3).in_dll(self.library, table)
            except (OSError, ValueError) as error:
                raise ValueError(f"library = {str(library)!r} with a table {table!r}: {error}") from None
        calls: list[Any] = [_FUNCTION(at) if at else None for at in addresses]
        if calls[0] is None:
            raise ValueError(f"the first pointer of {table!r} is null: f is missing")
        self.f, self.dfdx, self.dfdp = calls
        self.addresses = tuple(at or 0 for at in addresses)

    @property
    def complete(self) -> bool:
        """Whether all derivatives are there."""
        return all(self.addresses)

    def at_points(
        self,
        call: Callable[..., Any],
        x: np.ndarray,
        parameters: Parameters | complex,
        t: np.ndarray | float | None,
        shape: tuple[int, ...],
    ) -> np.ndarray:
        """One of the three functions at points (n, d), with result of shape (n, *shape)."""
        x = np.ascontiguousarray(x, dtype=float)
        p = np.array(
            [*vars(parameters).values()] if hasattr(parameters, "__dict__") else [parameters], dtype=float
        )
        out = np.empty((len(x), *shape))
        times = None if t is None else np.ascontiguousarray(np.broadcast_to(t, len(x)), dtype=float)
        call(len(x), address(x), None if times is None else address(times), address(p), address(out))
        return out

    def _one(
        self,
        call: Callable[..., Any],
        x: np.ndarray,
        parameters: Parameters | complex,
        t: np.ndarray | float | None,
        shape: tuple[int, ...],
    ) -> np.ndarray:
        """For arguments as functions in Python have them: a point (d,), or points (d, n)."""
        x = np.asarray(x)
        if np.iscomplexobj(x):
            raise TypeError("compiled functions take real numbers")
        found = self.at_points(call, x.T if x.ndim == 2 else x[None, :], parameters, t, shape)
        return np.moveaxis(found, 0, -1) if x.ndim == 2 else found[0]

    def __call__(
        self, x: np.ndarray, parameters: Parameters | complex, t: np.ndarray | None = None
    ) -> np.ndarray:
        """f."""
        return self._one(self.f, x, parameters, t, (len(x),))

    def jacobian(
        self, x: np.ndarray, parameters: Parameters | complex, t: np.ndarray | None = None
    ) -> np.ndarray:
        """df/dx."""
        return self._one(self.dfdx, x, parameters, t, (len(x), len(x)))

    def derivatives(self, names: list[str]) -> dict[str, Callable[..., np.ndarray]]:
        """df/dp by the names of the parameters."""

        def by(k: int) -> Callable[..., np.ndarray]:
            return lambda x, p, t=None: self._one(self.dfdp, x, p, t, (len(x), len(names)))[:, k]

        return {name: by(k) for k, name in enumerate(names)}
