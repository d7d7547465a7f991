"""Numbers for people."""

from __future__ import annotations

import math

ROUNDING = 1e-14  # beside numbers of order one this is zero
ROUNDING_APART = 1e-6  # beside what is to be told apart this is zero
WHOLE = 1e6  # numbers below it have no exponent
DIGITS = 4  # that mean something to who reads a table; files and JSON have all


def number_text(value: float, digits: int = 10, unit: float = 1.0) -> str:
    """A number with so many digits; what is only rounding beside ``unit`` is 0."""
    return "0" if abs(value) <= ROUNDING * abs(unit) else f"{value:.{digits}g}"


def figures(value: float, apart: float = 0.0) -> str:
    """A number as tables for people have it: four digits, and more where numbers so far `apart` would look the same.

    What is a millionth of `apart` or rounding beside one is 0; whole numbers below a million are whole.

    >>> [figures(x) for x in (86.9812, 0.0123456, 12345.6, 1.5e7, 0.7)]
    ['86.98', '0.01235', '12346', '1.5e+07', '0.7']
    >>> figures(7.951237, apart=2e-4)
    '7.9512'
    """
    size = abs(value)
    if not math.isfinite(value):
        return str(value)
    if size <= max(ROUNDING, ROUNDING_APART * apart):
        return "0"
    digits = max(DIGITS, math.ceil(math.log10(size / apart)) + 1 if apart > 0.0 else 0)
    return f"{value:.0f}" if 10.0**digits <= size < WHOLE else f"{value:.{digits}g}"
