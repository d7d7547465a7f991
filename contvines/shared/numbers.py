"""Constants of double precision, and formatting of numbers for tables and messages."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Sequence

EPSILON = sys.float_info.epsilon
"""Distance from one to the next number: twice the largest relative rounding error."""
ROUNDED = 64.0 * EPSILON
"""Relative size of rounding errors after some tens of operations."""
TINY = sys.float_info.min
"""Smallest normal number; replaces a zero divisor."""
PIVOT = 1e-300
"""Replaces a zero pivot; native/ has the same constant."""
CENTRAL = EPSILON ** (1.0 / 3.0)
"""Relative step of a central difference at which rounding error and truncation error are equal (Nocedal and Wright, section 8.1)."""
LEAST = 1e-18
"""Replaces zero singular values, relative to the largest one; smaller than rounding errors of them."""
COMPLEX_STEP = 1e-40
"""Imaginary step of a complex-step derivative (Squire and Trapp, SIAM Review 40 (1998) 110); its square is negligible beside any number."""


ROUNDING_APART = 1e-6  # relative to the difference that must stay visible: smaller numbers are shown as zero
PART = 0.001  # of an interval: differences of this size stay visible in tables
WHOLE = 1_000_000.0  # numbers below it are shown without exponent
DIGITS = 4  # significant digits in tables; files and JSON have all digits


def number_text(value: float, digits: int = 10, unit: float = 1.0) -> str:
    """Format a number with `digits` significant digits; a number that is only a rounding error relative to ``unit`` becomes 0."""
    return "0" if abs(value) <= ROUNDED * abs(unit) else f"{value:.{digits}g}"


def figures(value: float, apart: float = 0.0) -> str:
    """Format a number for tables: four significant digits, and more if numbers that differ by `apart` would look equal.

    Numbers below a millionth of `apart`, or below rounding errors relative to one, become 0; numbers below a million have no exponent.

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
    digits_before = math.floor(math.log10(size)) + 1
    digits = max(DIGITS, digits_before + math.ceil(-math.log10(apart)) if apart > 0.0 else 0)
    return f"{value:.0f}" if digits < digits_before and size < WHOLE else f"{value:.{digits}g}"


def complex_figures(values: Iterable[complex]) -> str:
    """Format complex numbers such as multipliers by `figures`, with enough digits to distinguish them from the unit circle.

    >>> complex_figures([-0.22232 + 0.26142j, 0.999987])
    '-0.2223 + 0.2614i, 0.99999'
    """

    def text(value: complex) -> str:
        distance = max(abs(abs(value) - 1.0), ROUNDING_APART) if abs(value) < 2.0 else 0.0
        real, imaginary = (figures(part, min(distance, PART)) for part in (value.real, abs(value.imag)))
        return real if imaginary == "0" else f"{real} {'+' if value.imag > 0.0 else '-'} {imaginary}i"

    return ", ".join(text(value) for value in values)


def pairs(values: Iterable[complex]) -> list[list[float]]:
    """Return complex numbers as pairs of real and imaginary part, for JSON."""
    return [[float(value.real), float(value.imag)] for value in values]


def figures_in(
    within: tuple[float, float], others: Sequence[float] = (), same: float = 0.0
) -> Callable[[float], str]:
    """Return `figures` for values of a parameter in an interval, with enough digits to distinguish a thousandth of the interval.

    The values `others` are distinguished as well, unless they are closer than `same`.
    """
    width = within[1] - within[0]
    difference = PART * width if 0.0 < width < math.inf else 0.0
    others_sorted = sorted(others)

    def text(value: float) -> str:
        gaps = [
            abs(value - other)
            for other in others_sorted
            if abs(value - other) > max(same, ROUNDED * abs(value))
        ]
        return figures(value, min([difference, *(0.5 * gap for gap in gaps)]))

    return text
