"""A user's function, called so that it can harm nothing, and its failures as sentences."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from .parameters import ParameterSet
from .settings import DERIVATIVES

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from scipy.sparse import csc_array

FLOAT = np.dtype(np.float64)
CALLED = "two arguments, the unknowns and the parameters"


@runtime_checkable
class Sparse(Protocol):
    """A matrix of scipy.sparse, in any format."""

    @property
    def shape(self) -> tuple[int, ...] | None: ...
    def tocsc(self) -> csc_array: ...
    def toarray(self) -> np.ndarray: ...


@runtime_checkable
class Operator(Protocol):
    """A matrix that is known by its products alone, as scipy's LinearOperator."""

    @property
    def shape(self) -> tuple[int, ...]: ...
    def matvec(self, x: np.ndarray, /) -> np.ndarray: ...
    def __matmul__(self, x: np.ndarray, /) -> np.ndarray: ...


class NotEvaluable(ArithmeticError):
    """A user's function could not be evaluated; the message is a sentence with the function's own words."""


def readonly(u: np.ndarray) -> np.ndarray:
    """The array as a user's function sees it: it cannot be changed."""
    view = u.view()
    view.setflags(write=False)
    return view


class UserFunction:
    """f(u, p) of a user: sees a read-only u, and what it returns is copied.

    Parameters
    ----------
    f : callable
        (u, p) -> numbers.
    name : str
        For messages.
    parameters : ParameterSet
    called : str
        With what, for messages.
    """

    def __init__(
        self,
        f: Callable[..., ArrayLike | Sparse | Operator],
        name: str,
        parameters: ParameterSet,
        called: str = CALLED,
    ) -> None:
        self.f, self.name, self.parameters, self.called = f, name, parameters, called
        self.alone = not parameters.named

    def raw(self, u: np.ndarray, p: complex) -> ArrayLike | Sparse | Operator:
        """What f returns, whatever it is.

        Raises
        ------
        NotEvaluable
            If f raises anything but an interrupt.
        """
        try:
            seen = readonly(u) if u.flags.writeable else u
            return self.f(seen, p if self.alone else self.parameters.at(p))
        except Exception as error:
            hint = ""
            if isinstance(error, ValueError) and "read-only" in str(error):
                hint = f" ({self.name} must not change its argument; let it work on u.copy())"
            elif isinstance(error, TypeError) and "positional argument" in str(error):
                hint = f" (it is called with {self.called})"
            elif self.parameters.named and (
                isinstance(error, TypeError) or getattr(error, "name", None) in self.parameters.values
            ):
                hint = (
                    f" (it is called with {self.called}; parameters have names: p.{self.parameters.varying})"
                )
            raise NotEvaluable(f"{self.name} raises {type(error).__name__}: {error}{hint}") from error

    def __call__(self, u: np.ndarray, p: complex) -> np.ndarray:
        """A flat array of its own: real for real arguments, complex for complex ones.

        Raises
        ------
        NotEvaluable
            If f raises, or returns complex numbers for real ones, or no numbers at all.
        """
        return self.flat(self.raw(u, p), u, p)

    def flat(self, value: object, u: np.ndarray, p: complex) -> np.ndarray:
        """What f has returned at (u, p) as a flat array; see ``__call__``."""
        if value is None:
            raise NotEvaluable(f"{self.name} returns None; numbers are needed")
        if type(value) is np.ndarray and value.dtype == FLOAT:
            return value.flatten()
        if not isinstance(value, (list, tuple, np.ndarray)) and isinstance(value, Sparse | Operator):
            shape = value.shape or (0,)
            if not (isinstance(value, Sparse) and (len(shape) == 1 or min(shape) <= 1)):
                raise NotEvaluable(
                    f"{self.name} returns a matrix of shape {value.shape}; numbers in a row are needed"
                )
            value = value.toarray()
        try:
            result = np.array(value)
            if result.dtype.kind == "c":
                if u.dtype.kind != "c" and not isinstance(p, complex):
                    if np.any(np.imag(result)):
                        raise NotEvaluable(f"{self.name} returns complex numbers")
                    result = np.real(result).copy()
            elif result.dtype != np.float64:
                result = result.astype(np.float64)
        except (TypeError, ValueError) as error:
            raise NotEvaluable(f"{self.name} returns no array of numbers: {error}") from error
        return result.reshape(-1)


def difference_text(one: np.ndarray, other: np.ndarray) -> str:
    """A sentence on values that differ, by more than small noise, though a function was asked for the same; empty if they do not."""
    one, other = one.reshape(-1), other.reshape(-1)
    apart = np.abs(one - other)
    if not (apart > DERIVATIVES.felt * np.abs(one)).any():
        return ""
    i = int(np.nanargmax(apart))
    return (
        f"asked twice for the same arguments the equations have different values ({one[i]:.6g} and {other[i]:.6g} in row {i}); "
        "what is random, or remembers earlier calls, has no branches"
    )


def as_matrix(given: object, n: int) -> np.ndarray | csc_array | Operator:
    """What a user's jacobian returned, as a float array, a sparse matrix (csc) or a LinearOperator of shape (n, n).

    Raises
    ------
    NotEvaluable
        If it is none, or has another shape.
    """
    if type(given) is np.ndarray and given.dtype == FLOAT and given.shape == (n, n):
        return given.copy()
    if isinstance(given, Sparse | Operator):
        if given.shape != (n, n):
            raise NotEvaluable(f"jacobian returns shape {given.shape}; ({n}, {n}) is needed")
        return given.tocsc() if isinstance(given, Sparse) else given
    if given is None:
        raise NotEvaluable(f"jacobian returns None; a matrix of shape ({n}, {n}) is needed")
    try:
        matrix = np.array(given, dtype=float)
    except (TypeError, ValueError) as error:
        raise NotEvaluable(f"jacobian returns no matrix of numbers: {error}") from error
    if matrix.shape != (n, n):
        if matrix.size == 1 == n:
            return matrix.reshape(1, 1)
        raise NotEvaluable(f"jacobian returns shape {matrix.shape}; ({n}, {n}) is needed")
    return matrix
