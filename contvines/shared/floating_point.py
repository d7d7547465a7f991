"""Facts of double precision, by name."""

import sys

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
