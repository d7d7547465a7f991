"""Facts of double precision, by name, and numbers for people."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Sequence

EPSILON = sys.float_info.epsilon
"""Distance from one to the next number: relative error of a rounding, twice over."""
ROUNDED = 64.0 * EPSILON
"""Relative size of what is rounding after some tens of operations."""
TINY = sys.float_info.min
"""The smallest number with all its digits: stands for a zero that is divided by."""
PIVOT = 1e-300
"""Stands for a pivot that is zero; native/ has the same."""
CENTRAL = EPSILON ** (1.0 / 3.0)
"""Relative step of a central difference at which rounding and the third derivative weigh the same (Nocedal and Wright, section 8.1)."""
LEAST = 1e-18
"""Takes the place of singular values that are zero, relative to the largest: below all that rounding leaves of them."""
COMPLEX_STEP = 1e-40
"""Imaginary step of a derivative (Squire and Trapp, SIAM Review 40 (1998) 110): its square vanishes beside any number of a problem."""


ROUNDING_APART = 1e-6  # beside what is to be told apart this is zero
PART = 0.001  # of an interval, which can be told apart in tables
WHOLE = 1_000_000.0  # numbers below it have no exponent
DIGITS = 4  # that mean something to who reads a table; files and JSON have all


def number_text(value: float, digits: int = 10, unit: float = 1.0) -> str:
    """A number with so many digits; what is only rounding beside ``unit`` is 0."""
    return "0" if abs(value) <= ROUNDED * abs(unit) else f"{value:.{digits}g}"


def figures(value: float, apart: float = 0.0) -> str:
    """A number as tables for people have it: four digits, and more where numbers so far `apart` would look the same.

    What is a millionth of `apart` or rounding beside one is 0; numbers below a million have no exponent.

    >>> [figures(x) for x in (86.9812, 0.0123456, 12345.6, 1.5e7, 0.7)]
    ['86.98', '0.01235', '12346', '1.5e+07', '0.7']
    >>> figures(7.951237, apart=2e-5)
    '7.95124'
    """
    size = abs(value)
    if not math.isfinite(value):
        return str(value)
    if size <= max(ROUNDED, ROUNDING_APART * apart):
        return "0"
    whole = math.floor(math.log10(size)) + 1
    digits = max(DIGITS, whole + math.ceil(-math.log10(apart)) if apart > 0.0 else 0)
    return f"{value:.0f}" if digits < whole and size < WHOLE else f"{value:.{digits}g}"


def complex_figures(values: Iterable[complex]) -> str:
    """`figures` of complex numbers such as multipliers; what lies near the unit circle can be distinguished from it.

    >>> complex_figures([-0.22232 + 0.26142j, 0.999987])
    '-0.2223 + 0.2614i, 0.99999'
    """

    def text(value: complex) -> str:
        apart = max(abs(abs(value) - 1.0), ROUNDING_APART) if abs(value) < 2.0 else 0.0
        real, imaginary = (figures(part, min(apart, PART)) for part in (value.real, abs(value.imag)))
        return real if imaginary == "0" else f"{real} {'+' if value.imag > 0.0 else '-'} {imaginary}i"

    return ", ".join(text(value) for value in values)


def pairs(values: Iterable[complex]) -> list[list[float]]:
    """Complex numbers as JSON has them: real and imaginary part."""
    return [[float(value.real), float(value.imag)] for value in values]


def figures_in(
    within: tuple[float, float], others: Sequence[float] = (), same: float = 0.0
) -> Callable[[float], str]:
    """`figures` for values of a parameter in an interval: a thousandth of it can be distinguished, and so can those of some values that are farther than `same` apart."""
    width = within[1] - within[0]
    apart = PART * width if 0.0 < width < math.inf else 0.0
    known = sorted(others)

    def text(value: float) -> str:
        gaps = [abs(value - other) for other in known if abs(value - other) > max(same, ROUNDED * abs(value))]
        return figures(value, min([apart, *(0.5 * gap for gap in gaps)]))

    return text
