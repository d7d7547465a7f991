"""How near a problem with many unknowns is to a branch point, where computing all its eigenvalues would be dear.

At every point of a branch there is a cheap number, the distance: with M = [[F_u, F_p], [border]] and a fixed random b it is 1/|M^-1 b|, which falls
to zero like the smallest singular value of M, linearly, at branch points and not at folds (rows hold it with a minus: nothing is past zero). Where it could have been zero between
two points though the sign of det M is the same (:meth:`contvines.bifurcation.detect.Detector.look`), another copy of the
problem is asked (`closer`): its rows hold the NEAREST eigenvalues to zero of F_u relative to its value at the start.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .protocol import Problem

LARGEST = 300  # unknowns up to which a dense matrix of a sparse Jacobian is made for normal forms
NEAREST = 4  # as many null vectors as a branch point may have


def side(rows: np.ndarray) -> np.ndarray:
    """The fixed right-hand side b, in units of the equations, and zero for the border."""
    return np.append(rows * np.random.default_rng(11).standard_normal(len(rows)), 0.0)


def distance(image: np.ndarray) -> float:
    """1/|M^-1 b|, with M^-1 b in units of unknowns and parameter."""
    square = float(image.dot(image))
    return math.sqrt(len(image) / square) if 0.0 < square < math.inf else 0.0


def nearest(values: np.ndarray) -> np.ndarray:
    """The NEAREST eigenvalues to zero, a pair never torn apart."""
    order = np.argsort(np.abs(values), kind="stable")
    return values[order][:NEAREST]


def is_large(problem: Problem) -> bool:
    """Whether F_u is sparse and no dense matrix of it is made."""
    functions = getattr(problem, "functions", None)
    return getattr(functions, "structure", "dense") == "sparse" and problem.dimension > LARGEST
