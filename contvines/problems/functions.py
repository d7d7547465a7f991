"""Safe calls of a user's functions: read-only arguments, copied results, failures as messages; and the parameters they receive."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np

from contvines.shared.near_names import did_you_mean

from .settings import DERIVATIVES

if TYPE_CHECKING:
    from typing import NoReturn

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
    """A matrix-free operator, such as scipy's LinearOperator: only its products with vectors are available."""

    @property
    def shape(self) -> tuple[int, ...]: ...
    def matvec(self, x: np.ndarray, /) -> np.ndarray: ...
    def __matmul__(self, x: np.ndarray, /) -> np.ndarray: ...


class NotEvaluable(ArithmeticError):
    """A user's function could not be evaluated; the message quotes the function's own error."""


def readonly(u: np.ndarray) -> np.ndarray:
    """Return a read-only view of an array, as an argument of a user's function."""
    view = u.view()
    view.setflags(write=False)
    return view


class UserFunction:
    """A user's f(u, p), called with a read-only u; its result is copied.

    Parameters
    ----------
    f : callable
        (u, p) -> numbers.
    name : str
        For messages.
    parameters : ParameterSet
    called : str
        Description of the arguments of f, for messages.
    """

    def __init__(
        self,
        f: Callable[..., ArrayLike | Sparse | Operator],
        name: str,
        parameters: ParameterSet,
        called: str = CALLED,
    ) -> None:
        self.f, self.name, self.parameters, self.called = f, name, parameters, called
        self.single = not parameters.named

    def raw(self, u: np.ndarray, p: complex) -> ArrayLike | Sparse | Operator:
        """Return f's result unchanged.

        Raises
        ------
        NotEvaluable
            If f raises anything but an interrupt.
        """
        try:
            argument = readonly(u) if u.flags.writeable else u
            return self.f(argument, p if self.single else self.parameters.at(p))
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
        """Return f's result as a new flat array, real for real arguments, so that f may reuse its buffer.

        Raises
        ------
        NotEvaluable
            If f raises, or returns complex numbers for real ones, or no numbers at all.
        """
        return self.flat(self.raw(u, p), u, p)

    def flat(self, value: object, u: np.ndarray, p: complex) -> np.ndarray:
        """Convert f's result at (u, p) to a flat array; see ``__call__``."""
        if value is None:
            raise NotEvaluable(f"{self.name} returns None; numbers are needed")
        if type(value) is np.ndarray and value.dtype == FLOAT:
            return value.flatten()
        if not isinstance(value, (list, tuple, np.ndarray)) and isinstance(value, Sparse | Operator):
            shape = value.shape or (0,)
            if not (isinstance(value, Sparse) and (len(shape) == 1 or min(shape) <= 1)):
                raise NotEvaluable(
                    f"{self.name} returns a matrix of shape {value.shape}; a flat sequence of numbers is needed"
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
    """Return a message if two evaluations at the same arguments differ by more than small noise; else an empty string."""
    one, other = one.reshape(-1), other.reshape(-1)
    differences = np.abs(one - other)
    if not (differences > DERIVATIVES.noticed * np.abs(one)).any():
        return ""
    i = int(np.nanargmax(differences))
    return (
        f"two evaluations of the equations at the same arguments differ ({one[i]:.6g} and {other[i]:.6g} in row {i}); "
        "equations that are random, or depend on earlier calls, have no branches"
    )


def as_matrix(given: object, n: int) -> np.ndarray | csc_array | Operator:
    """Convert the result of a user's jacobian to a float array, a sparse matrix (csc) or a LinearOperator of shape (n, n).

    Raises
    ------
    NotEvaluable
        If it is no matrix, or has another shape.
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


class Parameters:
    """Named parameters, the second argument of ``F(u, p)``: ``p.damping`` or ``p["damping"]``. Read-only.

    Parameters
    ----------
    values : mapping of str to number
    """

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.__dict__.update(values)

    def __getattr__(self, name: str) -> NoReturn:
        hint = did_you_mean(name, self)
        raise AttributeError(f"there is no parameter {name!r}{hint}; the problem has {', '.join(self)}")

    def __getitem__(self, name: str) -> complex:
        if not isinstance(name, str):
            first = next(iter(self))
            raise TypeError(f"p[{name!r}]: parameters have names; p.{first} or p[{first!r}] is one")
        return getattr(self, name)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"parameter {name!r} cannot be changed by the equations")

    def __iter__(self) -> Iterator[str]:
        return iter(self.__dict__)

    def __len__(self) -> int:
        return len(self.__dict__)

    def __repr__(self) -> str:
        return f"Parameters({', '.join(f'{name}={value!r}' for name, value in self.__dict__.items())})"


UNNAMED = "p"  # default name of the parameter


class ParameterSet:
    """The parameters of a problem: their values, and the name of the varying one.

    If a plain number is given, there is one parameter, and ``F(u, p)`` receives its value as a plain number.

    Parameters
    ----------
    given : number, or mapping of str to number
    varying : str
        Name of the parameter that varies; "p", if the mapping has no such name, means its first parameter.

    Raises
    ------
    ValueError
        If a name is no identifier, a value no finite number, the mapping is empty, or `varying` is not in it.
    """

    def __init__(self, given: Mapping[str, float] | float, varying: str) -> None:
        self.named = isinstance(given, Mapping)
        values: dict[str, Any] = dict(given) if isinstance(given, Mapping) else {varying: given}
        if not values:
            raise ValueError("there is no parameter; give at least one, for example {'p': 1.0}")
        for name, value in values.items():
            if not (isinstance(name, str) and name.isidentifier()) and self.named:
                raise ValueError(
                    f"the parameter {name!r} must have a name that Python can read, such as 'p1'"
                )
            try:
                values[name] = float(value)
            except (TypeError, ValueError):
                hint = "" if self.named else "; several parameters have names: {'a': 1.0, 'b': 2.0}"
                raise ValueError(f"parameter {name} = {value!r} must be a number{hint}") from None
            if not math.isfinite(values[name]):
                raise ValueError(f"parameter {name} = {value!r} must be finite")
        if varying not in values and varying != UNNAMED:
            hint = did_you_mean(varying, values)
            raise ValueError(f"there is no parameter {varying!r}{hint}; the problem has {', '.join(values)}")
        self.values: dict[str, float] = values
        self.varying = varying if varying in values else next(iter(values))

    @property
    def start(self) -> float:
        """Value of the varying parameter at the start."""
        return self.values[self.varying]

    def assign(self, name: str, value: float) -> None:
        """Set a parameter's value, in place."""
        self.values[name] = float(value)

    def at(self, p: complex) -> Parameters | complex:
        """Return the second argument of the user's functions for the value `p` of the varying parameter."""
        return Parameters({**self.values, self.varying: p}) if self.named else p

    def against(self, varying: str, values: Mapping[str, float] | None = None) -> ParameterSet:
        """Return the same parameters with another one varying, and with some new values.

        Raises
        ------
        ValueError
            If there is no parameter of a given name.
        """
        changed = dict(values or {})
        for name in (varying, *changed):
            if name not in self.values:
                hint = did_you_mean(name, self.values)
                raise ValueError(
                    f"there is no parameter {name!r}{hint}; the problem has {', '.join(self.values)}"
                )
        merged = {**self.values, **changed}
        return ParameterSet(merged if self.named else merged[varying], varying)

    def given(self) -> dict[str, float] | float:
        """Return the values in the form in which they were given: a mapping, or a number."""
        return dict(self.values) if self.named else self.start


class Parametrised:
    """Mixin of problems whose parameters are a `ParameterSet`, ``values``."""

    values: ParameterSet

    @property
    def parameter(self) -> str:
        """Name of the parameter that varies."""
        return self.values.varying

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name; the varying one with its value at the start."""
        return dict(self.values.values)

    @property
    def p0(self) -> float:
        """Value of the varying parameter at the start."""
        return self.values.start


class Outputs:
    """A user's additional measures: functions (u, p) -> number by name.

    Parameters
    ----------
    given : mapping of str to callable, or None
    parameters : ParameterSet

    Raises
    ------
    ValueError
        If one is not callable or its name is no text.
    """

    def __init__(self, given: Mapping[str, Callable] | None, parameters: ParameterSet) -> None:
        self.given = dict(given or {})
        for name, f in self.given.items():
            if not (isinstance(name, str) and callable(f)):
                raise ValueError(f"outputs: {name!r} must be a name with a function (u, p) -> number")
        self.functions = {
            name: UserFunction(f, f"the output {name}", parameters) for name, f in self.given.items()
        }

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the outputs."""
        return tuple(self.given)

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Return their values for solutions u of shape (m, N) at parameter values p of shape (m,); NaN where a function fails."""
        return {
            name: np.array([self._value(name, *pair) for pair in zip(u, np.atleast_1d(p))]) for name in names
        }

    def _value(self, name: str, u: np.ndarray, p: float) -> float:
        try:
            return float(self.functions[name](u, float(p))[0])
        except (NotEvaluable, IndexError):
            return float("nan")
