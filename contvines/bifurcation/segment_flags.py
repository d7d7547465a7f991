"""What a segment between two points of a branch may hold, as bits, the kinds of spectra that tell, and what is looked at."""

from typing import NamedTuple

import numpy as np

FOLD, SINGULAR, MULTIPLIER, BORDER, MEETING, SHALLOW, DAMPED, HUMP = 1, 2, 4, 8, 16, 32, 64, 128

LANDING = 8192  # behind those of `watch`: its end lies next to a meeting

APART = 1e-6  # parts that a symmetry changes below this are zero
NEXT = 0.1  # part of the distance from a symmetry's fixed space that a step which ends next to a meeting leaves ...
WITHIN = 1e-4  # ... and the distance below which it is one


class Scanned(NamedTuple):
    """Points of a chunk, in units of their scales: shapes (n, N), (n,), (n,), (n, row), (n,); ``slopes`` is the parameter's component of the tangents."""

    points: np.ndarray
    values: np.ndarray
    slopes: np.ndarray
    rows: np.ndarray
    signs: np.ndarray


class Symmetries(NamedTuple):
    """Signed permutations T: u - T(u) of column j is u[j] - (images[j] u[orders[j]] + constants[j]).

    ``orders``, ``images``, ``constants`` have shape (symmetries, columns); ``shift`` (columns,) is zero, or what shifts by one
    period add; ``gaps`` (2, symmetries, columns) is scratch.
    """

    orders: np.ndarray
    images: np.ndarray
    constants: np.ndarray
    shift: np.ndarray
    gaps: np.ndarray
