"""Balls (python-flint's `arb`): real numbers with a rigorous error bound, and conversion to and from decimal text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from decimal import Decimal, InvalidOperation
from typing import TYPE_CHECKING

from contvines.shared.on_demand import pip_install
from orbits.proofs.obstacles import ProofError

if TYPE_CHECKING:
    from types import ModuleType

    from flint import arb, arb_mat

#: accepted forms of a parameter: a float (stands for its shortest decimal), an exact decimal as text, or (middle, radius)
Given = float | int | str | tuple[str, str]


def library() -> ModuleType:
    """Import and return the module `flint`.

    Raises
    ------
    ProofError
        If python-flint is not installed.
    """
    try:
        import flint
    except ImportError:
        raise ProofError(
            f"proofs need the package python-flint, which is not installed: {pip_install('proofs')}"
        ) from None
    return flint


@contextmanager
def precision(bits: int) -> Iterator[None]:
    """Context manager: use `bits` bits for all ball arithmetic inside the block."""
    context = library().ctx
    before = context.prec
    context.prec = bits
    try:
        yield
    finally:
        context.prec = before


def decimal(value: Given) -> str | tuple[str, str]:
    """Return the exact decimal that a given value stands for; a ball stays (middle, radius).

    A float stands for the shortest decimal that is read as this float, which is the text of a study.

    Raises
    ------
    ProofError
        If the value is not a finite number.
    """
    if isinstance(value, tuple):
        middle, radius = (str(part) for part in value)
        if _finite(middle) is None or (_finite(radius) or Decimal(-1)) < 0:
            raise ProofError(
                f"{value!r} is no ball: give middle and radius as decimals, the radius 0 or above"
            )
        return middle, radius
    text = value if isinstance(value, str) else repr(float(value))
    if _finite(text) is None:
        raise ProofError(f"{value!r} is no finite decimal number: give one")
    return text


def _finite(text: str) -> Decimal | None:
    try:
        number = Decimal(text)
    except InvalidOperation:
        return None
    return number if number.is_finite() else None


def ball(value: Given) -> arb:
    """Return a ball that certainly contains a given value, at the current precision."""
    arb = library().arb
    text = decimal(value)
    return arb(*text) if isinstance(text, tuple) else arb(text)


def as_balls(nodes: Iterable[Iterable[float]]) -> list[list[arb]]:
    """Convert rows of floats to balls."""
    return [[ball(float(value)) for value in node] for node in nodes]


def diagonal(size: int, value: arb | int = 1) -> arb_mat:
    """Return the identity matrix times a number."""
    return library().arb_mat(size, size, [value * (i == j) for i in range(size) for j in range(size)])


def interval(low: arb, high: arb) -> arb:
    """Return a ball that contains both balls."""
    return low.union(high)


def texts(value: arb, digits: int = 40) -> list[str]:
    """Return middle and radius of a ball as decimals; the decimal ball contains the given one."""
    middle, radius, exponent = (int(part) for part in value.mid_rad_10exp(digits))
    drop = max(0, len(str(radius)) - 3)
    radius = -(-radius // 10**drop) if radius else 0
    return [_text(middle, exponent), f"{radius}e{exponent + drop}" if radius else "0"]


def upper_text(radius: arb) -> str:
    """Return a short decimal that is not below this radius."""
    middle, slack, exponent = (int(part) for part in radius.abs_upper().mid_rad_10exp(1))
    drop = max(0, len(str(middle)) - 3)
    return f"{(middle + slack) // 10**drop + 1}e{exponent + drop}"


def _text(integer: int, exponent: int) -> str:
    sign, size = ("-" if integer < 0 else ""), str(abs(integer))
    if integer == 0:
        return "0"
    digits = size.rstrip("0")
    exponent += len(size) - len(digits)
    if -400 <= exponent <= 0:
        whole = digits.rjust(1 - exponent, "0")
        cut = len(whole) + exponent
        return sign + whole[:cut] + ("." + whole[cut:] if exponent else "")
    return f"{sign}{digits}e{exponent}"
