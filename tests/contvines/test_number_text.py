"""Digits of tables: four, or what tells numbers apart."""

import doctest
import math

from contvines.shared import numbers
from contvines.shared.numbers import complex_figures, figures, figures_in


def test_the_examples_of_the_docstrings():
    assert doctest.testmod(numbers).failed == 0 < doctest.testmod(numbers).attempted


def test_numbers_that_differ_look_different():
    values = [7.7271, 7.7273, 7.77, 7.770001]
    shown = [figures_in((7.0, 9.0), values)(value) for value in values]
    assert shown == ["7.7271", "7.7273", "7.77", "7.770001"]
    assert [float(text) for text in shown] == values
    assert figures_in((7.0, 9.0))(7.72712345) == "7.727"  # a thousandth of two, and four digits


def test_rounding_is_zero_and_nothing_is_lost_at_the_ends():
    assert figures(1e-17) == "0" and figures_in((0.0, 2000.0))(1e-9) == "0"
    assert figures(1.234e-9) == "1.234e-09" and figures(math.nan) == "nan"
    assert figures_in((0.0, math.inf))(1234.5) == "1234"


def test_multipliers_are_told_from_the_unit_circle():
    """Four digits, more where the modulus is nearer to one than these tell."""
    assert complex_figures([0.5 + 0.1234567j, -0.25]) == "0.5 + 0.1235i, -0.25"
    assert complex(complex_figures([0.99999713])).real < 1.0
