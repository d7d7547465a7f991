"""Averages along quasi-periodic sequences that converge faster than any power of their length.

Source: Das, Saiki, Sander and Yorke, Nonlinearity 30 (2017) 4111: the weight exp(-1/(t (1 - t))) in the place of 1.
"""

from __future__ import annotations

import numpy as np


def weights(count: int) -> np.ndarray:
    """Weights of `count` values in a row, with sum one."""
    t = (np.arange(count) + 1.0) / (count + 1.0)
    bump = np.exp(-1.0 / (t * (1.0 - t)))
    return bump / bump.sum()


def rotation_number(z: np.ndarray, near: float) -> tuple[float, float]:
    """(turns per step, estimate of its error) of a sequence of complex numbers that goes round zero.

    Parameters
    ----------
    z : ndarray of complex, shape (m,)
    near : float
        A rotation number that is at most half a turn off.
    """
    turns = np.angle(z[1:] / z[:-1]) / (2.0 * np.pi)
    turns = near + (turns - near + 0.5) % 1.0 - 0.5
    whole = float(weights(len(turns)) @ turns)
    half = len(turns) // 2
    return whole, abs(whole - float(weights(half) @ turns[:half]))
