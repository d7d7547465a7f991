"""What the compiled kernels of a cycle are handed: its data, and arrays to work in. Both are plain tuples to the compiler."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class CycleData(NamedTuple):
    """The equations of cycles with one word against one parameter, which do not change while a branch is traced."""

    events: np.ndarray
    """Codes of the letters (`orbits.words.alphabet.CODES`), shape (L,)."""
    modes: np.ndarray
    """Direction of sliding after each event, 0 while the absorber sticks, shape (L,)."""
    params: np.ndarray
    """The machine's numbers, shape (P,)."""
    path: np.ndarray
    """How they follow the parameter that varies, shape (2, P); see `orbits.machines.path`."""
    twist: float
    """-1 where the second half of the cycle mirrors the first, else 1."""
    shift: float
    """Forcing phase from the first event to its return, in radians."""
    pinned: int
    """0, or, of a motion without impacts, which may be moved as a whole: 2 of half a cycle, 1 of a whole one."""
    active: int
    """Place of the parameter that varies among the amounts."""
    amounts: np.ndarray
    """Values of all parameters that may vary, shape (Q,)."""
    law: np.ndarray
    """The numbers as products of powers of the amounts, shape (Q + 1, P); no rows where they are the numbers themselves."""


class Workspace(NamedTuple):
    """Arrays for one system of L nodes with n unknowns: allocated once, used by every kernel."""

    F: np.ndarray
    """Residuals, shape (L, n)."""
    A: np.ndarray
    """Their derivatives by the node before each segment, shape (L, n, n)."""
    D: np.ndarray
    """Their derivatives by the node after it, shape (L, n, n)."""
    Q: np.ndarray
    """Their derivatives by the parameter that varies, shape (L, n)."""
    numbers: np.ndarray
    """The machine's numbers and their derivatives by that parameter, shape (2 P,)."""
    trig: np.ndarray
    """What a machine keeps of sines and cosines at its nodes, shape (L + 1, 8)."""
    stored: np.ndarray
    """Rows of the elimination, shape (L, n, 3 n + 2)."""
    panel: np.ndarray
    """Two rows of blocks while one is eliminated, shape (2 n, 3 n + 2)."""
    small: np.ndarray
    """The closure's system, shape (n, n + 2)."""
    solution: np.ndarray
    """A particular solution and the null vector, shape (2, L n + 1)."""
    pin: np.ndarray
    """The row that a pinned motion replaces, shape (4 n + 2,)."""
    scratch: np.ndarray
    """For multipliers; shape as in `orbits.multipliers.periodic_schur`."""
    re: np.ndarray
    """Real parts of the multipliers, shape (n,)."""
    im: np.ndarray
    """Imaginary parts of the multipliers, shape (n,)."""
    order: np.ndarray
    """Columns as the closure's pivots choose them, shape (n + 1,)."""
    trial: np.ndarray
    """Unknowns that Newton's method tries, shape (L n,)."""
    lanes: np.ndarray
    """For `orbits.elimination.vectorised`: long cycles of two unknowns per node are condensed to short ones; empty for others."""
    sines: np.ndarray
    """Of the phases of the nodes, the first one's return included, shape (L + 1,)."""
    cosines: np.ndarray
    links: np.ndarray
    """Addresses of `orbits.elimination.by_address`."""
