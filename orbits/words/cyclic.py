"""Cyclic sequences: the smallest rotation, and how often the shortest root is written."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any


def least_rotation(items: Sequence[Any]) -> int:
    """Where the smallest rotation of a cyclic sequence begins; the first such place. Two pointers, linear time."""
    n, i, j, k = len(items), 0, 1, 0
    while i < n and j < n and k < n:
        a, b = items[(i + k) % n], items[(j + k) % n]
        if a == b:
            k += 1
            continue
        if a > b:
            i += k + 1
        else:
            j += k + 1
        j += i == j
        k = 0
    return min(i, j)


def power(items: Sequence[Any]) -> int:
    """How often the shortest root is written in a sequence."""
    n = len(items)
    return next(n // r for r in range(1, n + 1) if n % r == 0 and items[r:] == items[: n - r])
