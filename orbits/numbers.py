"""Facts of floating point, and numbers as the formulas of the machines take them."""

import numpy as np

Reals = float | np.ndarray
"""A number, or an array of them: the shapes of what goes in decide."""

ROUNDOFF = 2.3e-16
"""Just above the distance of neighbouring floats, relative: what is smaller than this share of a number does not change it."""
SMALLEST = 1e-300
"""Divisors are at least this, so that no quotient of ordinary numbers is undefined; what is smaller is zero."""
UNBOUNDED = 1e15
"""Stands for a multiplier that grows without bound towards a border: larger than any that double precision can tell from infinity."""
COMPLEX_STEP = 1e-200
"""Its square is zero, so that real parts of complex steps are those of real arithmetic; it changes no bit of an ordinary number."""
