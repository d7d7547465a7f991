"""Numbers as the formulas of the machines take them."""

import numpy as np

Reals = float | np.ndarray
"""A number, or an array of them: the shapes of what goes in decide."""
