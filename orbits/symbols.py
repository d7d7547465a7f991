"""Elementary functions of numbers, arrays and symbols: the functions for machine files.

A machine file's formulas are called once with symbols in place of numbers, which records the operators ``+ - * / **`` and the functions of this
module. Operations that cannot be recorded (a comparison, ``abs``, ``math.cos``) raise an error with a remedy.
"""

from __future__ import annotations

from collections.abc import Callable
from numbers import Real
from typing import TYPE_CHECKING, Any, Protocol, overload
from weakref import WeakValueDictionary

import numpy as np

if TYPE_CHECKING:
    from typing import NoReturn, TypeAlias

    Plain: TypeAlias = "Symbol | float | np.ndarray"

LARGEST_PRODUCT = 64  # largest integer power written as products


class NotAnalytic(TypeError):
    """A formula of a machine file applies an operation to a symbol that is not analytic, for example a comparison."""


def _refuse(operation: str) -> NoReturn:
    raise NotAnalytic(
        f"{operation} of a symbol has no single formula, and a flight must be analytic; where a law changes at a surface, "
        "declare a Switch with that surface and use its contact.<name>, which is +1 or -1"
    )


class Symbol:
    """An expression in the states, the phase and the parameters of a machine.

    Equal expressions are one object, so that each is evaluated only once.

    Attributes
    ----------
    operation : str
        "variable", "number", an operator, or the name of an elementary function.
    operands : tuple
        The name, the number, or the operands as Symbols.
    """

    __slots__ = ("__weakref__", "operands", "operation")
    __hash__ = object.__hash__
    __array_priority__ = 1000.0
    operation: str
    operands: tuple[Any, ...]

    def __new__(cls, operation: str, *operands: Symbol | str | float) -> Symbol:
        key = (operation, *(id(x) if isinstance(x, Symbol) else repr(x) for x in operands))
        symbol = _MADE.get(key)
        if symbol is None:
            symbol = object.__new__(cls)
            symbol.operation, symbol.operands = operation, operands
            _MADE[key] = symbol
        return symbol

    def __reduce__(self) -> tuple[type[Symbol], tuple]:
        return Symbol, (self.operation, *self.operands)

    @property
    def number(self) -> float | None:
        """Its value if it is a number, else None."""
        return self.operands[0] if self.operation == "number" else None

    def _with(self, combine: Callable, other: Plain, turned: bool = False) -> Symbol:
        if isinstance(other, Symbol):
            right = other
        elif isinstance(other, Real) or (isinstance(other, np.ndarray) and other.ndim == 0):
            right = Symbol("number", float(other))  # type: ignore[arg-type]
        else:
            return NotImplemented
        return combine(right, self) if turned else combine(self, right)

    def __add__(self, other: Plain) -> Symbol:
        return self._with(_sum, other)

    def __radd__(self, other: Plain) -> Symbol:
        return self._with(_sum, other, turned=True)

    def __sub__(self, other: Plain) -> Symbol:
        return self._with(_difference, other)

    def __rsub__(self, other: Plain) -> Symbol:
        return self._with(_difference, other, turned=True)

    def __mul__(self, other: Plain) -> Symbol:
        return self._with(_product, other)

    def __rmul__(self, other: Plain) -> Symbol:
        return self._with(_product, other, turned=True)

    def __truediv__(self, other: Plain) -> Symbol:
        return self._with(_quotient, other)

    def __rtruediv__(self, other: Plain) -> Symbol:
        return self._with(_quotient, other, turned=True)

    def __pow__(self, other: Plain) -> Symbol:
        # as products, because the Taylor recursion of a general power divides by its base, which may be zero
        if isinstance(other, Real) and float(other).is_integer() and 1 <= float(other) <= LARGEST_PRODUCT:  # type: ignore[arg-type]
            half, odd = divmod(int(other), 2)  # type: ignore[call-overload]
            root = self**half if half else None
            square = self if root is None else root * root
            return square * self if odd and root is not None else square
        return self._with(_power, other)

    def __rpow__(self, other: float) -> Symbol:
        return exp(self * float(np.log(other)))

    def __neg__(self) -> Symbol:
        return _product(Symbol("number", -1.0), self)

    def __pos__(self) -> Symbol:
        return self

    def __float__(self) -> float:
        raise NotAnalytic(
            "a function that wants a number was given a symbol; take cos, sin, sqrt, exp ... from orbits.symbols"
        )

    def __repr__(self) -> str:
        if self.operation in ("variable", "number"):
            return str(self.operands[0])
        if len(self.operands) == 1:
            return f"{self.operation}({self.operands[0]})"
        return f"({self.operands[0]} {self.operation} {self.operands[1]})"


_MADE: WeakValueDictionary[tuple, Symbol] = WeakValueDictionary()


def _number(value: float) -> Symbol:
    return Symbol("number", float(value))


def _sum(a: Symbol, b: Symbol) -> Symbol:
    if a.number is not None and b.number is not None:
        return _number(a.number + b.number)
    return b if a.number == 0.0 else a if b.number == 0.0 else Symbol("+", a, b)


def _difference(a: Symbol, b: Symbol) -> Symbol:
    if a.number is not None and b.number is not None:
        return _number(a.number - b.number)
    if a is b:
        return _number(0.0)
    return -b if a.number == 0.0 else a if b.number == 0.0 else Symbol("-", a, b)


def _product(a: Symbol, b: Symbol) -> Symbol:
    if a.number is not None and b.number is not None:
        return _number(a.number * b.number)
    if a.number == 0.0 or b.number == 0.0:
        return _number(0.0)
    return b if a.number == 1.0 else a if b.number == 1.0 else Symbol("*", a, b)


def _quotient(a: Symbol, b: Symbol) -> Symbol:
    if b.number == 0.0:
        return Symbol("/", a, b)
    if a.number is not None and b.number is not None:
        return _number(a.number / b.number)
    return _number(0.0) if a.number == 0.0 else a if b.number == 1.0 else Symbol("/", a, b)


def _power(a: Symbol, b: Symbol) -> Symbol:
    return _number(1.0) if b.number == 0.0 else a if b.number == 1.0 else Symbol("**", a, b)


def _method(name: str) -> Callable:
    return lambda self: Symbol(name, self)


for _name in ("cos", "sin", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh"):
    setattr(Symbol, _name, _method(_name))  # called by numpy's functions
for _name in ("sin", "cos", "tan"):
    setattr(Symbol, f"arc{_name}", _method(f"a{_name}"))


def _refusing(operation: str) -> Callable[..., NoReturn]:
    return lambda self, *other: _refuse(operation)


for _name, _sign in {"eq": "==", "ne": "!=", "lt": "<", "le": "<=", "gt": ">", "ge": ">="}.items():
    setattr(Symbol, f"__{_name}__", _refusing(f"a comparison ({_sign})"))
for _name, _what in {
    "bool": "the truth value",
    "abs": "the absolute value",
    "mod": "a remainder (%)",
    "floordiv": "a whole quotient (//)",
}.items():
    setattr(Symbol, f"__{_name}__", _refusing(_what))


class Elementary(Protocol):
    """An elementary function: returns a symbol for a symbol, a number for a number, an array for an array."""

    @overload
    def __call__(self, x: Symbol, /) -> Symbol: ...
    @overload
    def __call__(self, x: float, /) -> float: ...
    @overload
    def __call__(self, x: np.ndarray, /) -> np.ndarray: ...


def _elementary(name: str, numeric: Callable, description: str) -> Elementary:
    def function(x: Plain, /):
        return numeric(x)  # numpy calls the method of a symbol

    function.__name__ = function.__qualname__ = name
    function.__doc__ = f"{description}, on a number, an array or a symbol."
    return function


cos = _elementary("cos", np.cos, "Cosine")
sin = _elementary("sin", np.sin, "Sine")
tan = _elementary("tan", np.tan, "Tangent")
exp = _elementary("exp", np.exp, "Exponential function")
log = _elementary("log", np.log, "Natural logarithm")
sqrt = _elementary("sqrt", np.sqrt, "Square root")
sinh = _elementary("sinh", np.sinh, "Hyperbolic sine")
cosh = _elementary("cosh", np.cosh, "Hyperbolic cosine")
tanh = _elementary("tanh", np.tanh, "Hyperbolic tangent")
asin = _elementary("asin", np.arcsin, "Inverse sine")
acos = _elementary("acos", np.arccos, "Inverse cosine")
atan = _elementary("atan", np.arctan, "Inverse tangent")
pi = float(np.pi)

ELEMENTARY = ("cos", "sin", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "asin", "acos", "atan")
__all__ = [*ELEMENTARY, "NotAnalytic", "Symbol", "pi"]
