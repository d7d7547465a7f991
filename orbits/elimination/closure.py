"""The small system that closes a cycle once its inner nodes are eliminated: the first node and the parameter."""

from __future__ import annotations

from functools import cache
from typing import Any

from orbits.compiling.decorators import kernel

TINY = 1e-300


@cache
def closing(n: int) -> Any:
    """The compiled function for nodes of `n` unknowns."""

    @kernel
    def close(small, solution, order):
        """Solve n equations in x_0 and p by complete pivoting: a particular and a null solution, and a sign."""
        sign = 1.0
        for j in range(n + 1):
            order[j] = j
        for j in range(n):
            best, row, column = -1.0, j, j
            for i in range(j, n):
                for c in range(j, n + 1):
                    if abs(small[i, c]) > best:
                        best, row, column = abs(small[i, c]), i, c
            if row != j:
                sign = -sign
                for c in range(n + 2):
                    small[j, c], small[row, c] = small[row, c], small[j, c]
            if column != j:
                sign = -sign
                order[j], order[column] = order[column], order[j]
                for i in range(n):
                    small[i, j], small[i, column] = small[i, column], small[i, j]
            if abs(small[j, j]) < TINY:
                small[j, j] = TINY
            if small[j, j] < 0.0:
                sign = -sign
            for i in range(j + 1, n):
                ratio = small[i, j] / small[j, j]
                for c in range(j + 1, n + 2):
                    small[i, c] -= ratio * small[j, c]
        size = solution.shape[1] - 1
        free = order[n]
        place = free if free < n else size
        solution[0, place] = 0.0
        solution[1, place] = 1.0
        for j in range(n - 1, -1, -1):
            particular, null = small[j, n + 1], -small[j, n]
            for c in range(j + 1, n):
                where = order[c] if order[c] < n else size
                particular -= small[j, c] * solution[0, where]
                null -= small[j, c] * solution[1, where]
            where = order[j] if order[j] < n else size
            solution[0, where] = particular / small[j, j]
            solution[1, where] = null / small[j, j]
        return sign

    return close
