"""What a locus in a second parameter, or a normal form, asks of the equations of a declared machine beside solving them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from orbits.flows.page.flights import Work, fill

if TYPE_CHECKING:
    from orbits.flows.page.flights import Pieces


def assign(data: Pieces, other: Pieces, value: float) -> None:
    """Give the parameter that varies in ``other`` a value in ``data``, in place."""
    data.params[other.index] = value
    data.base_numbers[:, other.index] = value


def flip(data: Pieces, work: Work, sign: float) -> None:
    """Turn F_u to perturbations that change sign over the period (sign = -1), and back (sign = 1)."""
    work.following[-1] *= -1.0


def transpose(data: Pieces, work: Work, column: np.ndarray, other: Work) -> None:
    """The transposed F_u, with another last column, into another workspace."""
    for name in ("own", "following", "drift", "still", "numbers"):
        getattr(other, name)[:] = getattr(work, name)
    other.derivative.reshape(-1)[:] = column
    other.turned[0] = 1.0


def matrix(data: Pieces, work: Work) -> np.ndarray:
    """F_u as it stands in a workspace, shape (N, N)."""
    found = np.zeros((data.dimension, data.dimension))
    fill(data, work, found)
    return found
