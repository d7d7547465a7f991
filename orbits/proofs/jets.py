"""Forward automatic differentiation over balls, or over jets again.

A `Jet` is a value and its partial derivatives (sparse). Evaluated at balls, every partial derivative is an enclosure of the
derivative over the whole box, because the chain rule holds for sets. Nested jets give second derivatives.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from flint import arb

    Number: TypeAlias = "arb | Jet"
    """A ball, or a jet over balls."""
    Row = Sequence[Number]
    """Unknowns of a node, or the further ones."""


class Jet:
    """A value with first derivatives.

    Attributes
    ----------
    value : arb or Jet
    partials : dict of int to arb or Jet
        Derivative with respect to each variable that the value depends on.
    """

    __slots__ = ("partials", "value")

    def __init__(self, value: Number, partials: dict[int, Number]) -> None:
        self.value = value
        self.partials = partials

    def chain(self, value: Number, slope: Number) -> Jet:
        """Return f(self), given f and f' at the value."""
        return Jet(value, {i: slope * part for i, part in self.partials.items()})

    def __add__(self, other: Number | float) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.value + other, self.partials)
        parts = dict(self.partials)
        for i, part in other.partials.items():
            parts[i] = parts[i] + part if i in parts else part
        return Jet(self.value + other.value, parts)

    __radd__ = __add__

    def __neg__(self) -> Jet:
        return Jet(-self.value, {i: -part for i, part in self.partials.items()})

    def __sub__(self, other: Number | float) -> Jet:
        return self + (-other)

    def __rsub__(self, other: Number | float) -> Jet:
        return -self + other

    def __mul__(self, other: Number | float) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.value * other, {i: part * other for i, part in self.partials.items()})
        a, b = self.value, other.value
        parts = {i: part * b for i, part in self.partials.items()}
        for i, part in other.partials.items():
            term = a * part
            parts[i] = parts[i] + term if i in parts else term
        return Jet(a * b, parts)

    __rmul__ = __mul__

    def __truediv__(self, other: Number | float) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.value / other, {i: part / other for i, part in self.partials.items()})
        return self * other.inverse()

    def __rtruediv__(self, other: Number | float) -> Jet:
        return self.inverse() * other

    def inverse(self) -> Jet:
        """1 / self."""
        value = 1 / self.value
        return self.chain(value, -value * value)


def sin_cos(x: Number) -> tuple[Number, Number]:
    """Sine and cosine of a ball or a jet."""
    if not isinstance(x, Jet):
        return x.sin_cos()
    s, c = sin_cos(x.value)
    return x.chain(s, c), x.chain(c, -s)


def exp(x: Number) -> Number:
    """Exponential function of a ball or a jet."""
    if not isinstance(x, Jet):
        return x.exp()
    value = exp(x.value)
    return x.chain(value, value)


def sqrt(x: Number) -> Number:
    """Square root of a ball or a jet."""
    if not isinstance(x, Jet):
        return x.sqrt()
    value = sqrt(x.value)
    return x.chain(value, 1 / (2 * value))


def power(x: Number, exponent: int | float) -> Number:
    """A power of a ball or a jet; with a fractional exponent, of a positive one."""
    if exponent == 1:
        return x
    if not isinstance(x, Jet):
        return x ** type(x)(exponent)
    return x.chain(power(x.value, exponent), exponent * power(x.value, exponent - 1))


def base(x: Number) -> arb:
    """Innermost value of a nested jet."""
    while isinstance(x, Jet):
        x = x.value
    return x


def variables(values: Iterable[Number], first: int = 0) -> list[Jet]:
    """Return independent variables with these values, numbered from `first`."""
    return [Jet(value, {first + i: one(value)}) for i, value in enumerate(values)]


def one(like: Number) -> arb:
    """Return 1 as a ball of the same type."""
    return type(base(like))(1)


def partial(x: Number, index: int) -> Number | int:
    """Derivative with respect to one variable; the integer 0 if `x` does not depend on it."""
    return x.partials.get(index, 0) if isinstance(x, Jet) else 0
