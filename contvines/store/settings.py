"""Tolerances with which two results are compared."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Agreement:
    """Differences up to which two results agree, relative to 1 + their size.

    Attributes
    ----------
    value : float
        Of values of special points, if no larger error is stated.
    end : float
        Of the ends of branches, loci and stable stretches, as borders are located from either side; and distance of points of one kind whose
        labels may change.
    multiplier : float
        Of multipliers, which move with the square root of the location error at a fold.
    """

    value: float = 1e-10
    end: float = 1e-8
    multiplier: float = 1e-5


AGREEMENT = Agreement()
