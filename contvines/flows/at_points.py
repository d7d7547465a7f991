"""Evaluation of functions at many points at once: users' functions in Python, and tables of C functions."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.sparse import issparse

from ..core.library import address
from ..problems.functions import NotEvaluable

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..problems.functions import Parameters

TRIED = 7  # points at which it is tested whether a function accepts arrays of points
_FUNCTION = ctypes.CFUNCTYPE(None, ctypes.c_int64, *[ctypes.c_void_p] * 4)


class AtPoints:
    """A user's function of (x, p), or (x, p, t), evaluated at points (n, d) and times (n,).

    If the function is vectorised, it is called once with all points as columns, else once for each point.

    Parameters
    ----------
    f : callable
    forced : bool
        Whether f depends on time.
    shape : tuple of int
        Shape of the result for one point.
    """

    many: bool | None = None  # whether f is vectorised; None: unknown

    def __init__(self, f: Callable, forced: bool, shape: tuple[int, ...]) -> None:
        self.f, self.forced, self.shape = f, forced, shape

    def __call__(
        self, x: np.ndarray, parameters: Parameters | complex, t: np.ndarray | None = None
    ) -> np.ndarray:
        """Return the values, shape (n, *shape).

        Raises
        ------
        NotEvaluable
            If a value has another shape. Errors of the function itself are not caught.
        """
        return (self._all_at_once if self.many else self._one_by_one)(x, parameters, t)

    def _call(self, x: np.ndarray, parameters: Parameters | complex, t: object) -> object:
        return self.f(x, parameters, t) if self.forced else self.f(x, parameters)

    def _one_by_one(
        self, x: np.ndarray, parameters: Parameters | complex, t: Sequence | np.ndarray | None
    ) -> np.ndarray:
        times = [None] * len(x) if t is None else t
        found = [_full(self._call(y.copy(), parameters, s)) for y, s in zip(x, times, strict=True)]
        for value in found:
            if value.shape != self.shape:
                raise NotEvaluable(f"the right-hand side has shape {value.shape}; {self.shape} is needed")
        return np.array(found)

    def _all_at_once(
        self, x: np.ndarray, parameters: Parameters | complex, t: np.ndarray | None
    ) -> np.ndarray:
        return _stacked(self._call(x.T.copy(), parameters, t), len(x), self.shape)

    def find(
        self, agree: float, x: np.ndarray, parameters: Parameters | complex, t: np.ndarray | None
    ) -> None:
        """Test whether f is vectorised: values of one call and of single calls must agree to the relative accuracy `agree`."""
        if self.many is not None or len(x) < 3:
            return
        x, t = x[:TRIED], None if t is None else t[:TRIED]
        try:
            single = self._one_by_one(x, parameters, t)
        except Exception:  # the points may be outside the domain of f
            return
        try:
            values = self._all_at_once(x, parameters, t)
        except Exception:  # a function for one point may fail in any way when it is called with many
            self.many = False
            return
        size = agree * np.abs(single).max(initial=0.0)
        self.many = bool(np.allclose(single, values, rtol=agree, atol=size))


def _full(given: object) -> np.ndarray:
    return np.asarray(given.toarray()) if issparse(given) else np.array(given)  # type: ignore[union-attr]


def _stacked(given: object, n: int, shape: tuple[int, ...]) -> np.ndarray:
    """Convert the result of a vectorised function, nested lists or arrays of shape (*shape, n), to an array (n, *shape)."""
    if not shape or (isinstance(given, np.ndarray) and given.dtype != object):
        value = np.asarray(given)
        if value.shape != (*shape, n):
            raise ValueError(f"shape {value.shape}")
        return np.moveaxis(value, -1, 0)
    assert isinstance(given, Iterable)
    flat = list(given)
    if len(flat) != shape[0]:
        raise ValueError(f"{len(flat)} entries")
    if len(shape) == 2:
        return np.stack([_stacked(row, n, shape[1:]) for row in flat], axis=1)
    values = [np.asarray(value) for value in flat]
    result = np.empty((n, len(values)), dtype=np.result_type(*values))
    for j, value in enumerate(values):
        result[:, j] = value
    return result


class CompiledRates:
    """The right-hand side of a flow in C, C++, Rust or Fortran, for ``FlowProblem(CompiledRates("vdp.so"), x0, params)``.

    The library holds a table of three pointers to functions of one signature, ``void *table[3] = {f, dfdx, dfdp}``::

        void f(int64_t n, const double *x, const double *t, const double *p, double *out)

    with n points x (n, d), their times t (n; null for autonomous flows), the parameters p in the order of ``params``, and the result
    ``out``: f (n, d), df/dx (n, d, d), df/dp (n, d, number of parameters). Arrays are stored row by row. Outside the domain of f the
    functions write NaN. The second and third pointer may be null: derivatives are then computed by differences.

    Parameters
    ----------
    library : str, Path or int
        A shared library, or the address of a table.
    table : str
        Name of the table in the library.

    Raises
    ------
    ValueError
        If there is no such library or table, or its first pointer is null.
    """

    def __init__(self, library: str | Path | int, table: str = "table") -> None:
        if isinstance(library, int):
            addresses = (ctypes.c_void_p * 3).from_address(library)
        else:
            try:
                # a reference keeps the library loaded while its functions are in use
                self.library = ctypes.CDLL(str(Path(library).resolve()))
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
        """Whether the table has both derivatives."""
        return all(self.addresses)

    def at_points(
        self,
        call: Callable[..., Any],
        x: np.ndarray,
        parameters: Parameters | complex,
        t: np.ndarray | float | None,
        shape: tuple[int, ...],
    ) -> np.ndarray:
        """Call one of the three functions at points (n, d); return an array of shape (n, *shape)."""
        x = np.ascontiguousarray(x, dtype=float)
        p = np.array(
            [*vars(parameters).values()] if hasattr(parameters, "__dict__") else [parameters], dtype=float
        )
        out = np.empty((len(x), *shape))
        times = None if t is None else np.ascontiguousarray(np.broadcast_to(t, len(x)), dtype=float)
        call(len(x), address(x), None if times is None else address(times), address(p), address(out))
        return out

    def _call_native(
        self,
        call: Callable[..., Any],
        x: np.ndarray,
        parameters: Parameters | complex,
        t: np.ndarray | float | None,
        shape: tuple[int, ...],
    ) -> np.ndarray:
        """Call one of the three functions with the arguments of a function in Python: a point (d,), or points (d, n)."""
        x = np.asarray(x)
        if np.iscomplexobj(x):
            raise TypeError("compiled functions take real numbers")
        found = self.at_points(call, x.T if x.ndim == 2 else x[None, :], parameters, t, shape)
        return np.moveaxis(found, 0, -1) if x.ndim == 2 else found[0]

    def __call__(
        self, x: np.ndarray, parameters: Parameters | complex, t: np.ndarray | None = None
    ) -> np.ndarray:
        """Return f."""
        return self._call_native(self.f, x, parameters, t, (len(x),))

    def jacobian(
        self, x: np.ndarray, parameters: Parameters | complex, t: np.ndarray | None = None
    ) -> np.ndarray:
        """Return df/dx."""
        return self._call_native(self.dfdx, x, parameters, t, (len(x), len(x)))

    def derivatives(self, names: list[str]) -> dict[str, Callable[..., np.ndarray]]:
        """Return functions for df/dp by the names of the parameters."""

        def slope(k: int) -> Callable[..., np.ndarray]:
            return lambda x, p, t=None: self._call_native(self.dfdp, x, p, t, (len(x), len(names)))[:, k]

        return {name: slope(k) for k, name in enumerate(names)}
