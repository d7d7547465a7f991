"""Interval Gauss elimination of bordered block-cyclic systems, O(l).

    A_i x_i + D_i x_{i+1} + E_i e = b_i   (i = 0 ... l - 1, x_l = x_0),        sum_i r_i x_i + s e = c   (as many rows as e has entries)

Every entry is a ball. The result encloses the solutions of all real systems inside; if no pivot contains zero, all of
them are regular (Neumaier, *Interval Methods for Systems of Equations*, section 4.5). The unknowns x_1 ... x_{l-1} are eliminated
one after another from two block rows (and those border rows that contain them), with pivoting among these rows; x_0 and e come last.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import arb

    Nodes = Sequence[Sequence[arb]]
    Solution = tuple[list[list[arb]], list[arb]]
    """The unknowns x_i block by block, and the further unknowns e."""


class Singular(ArithmeticError):
    """A pivot may be zero: some real matrix inside the interval matrix may be singular."""


@dataclass
class Blocks:
    """A bordered block-cyclic system of balls; zeros may be the integer 0.

    Attributes
    ----------
    A, D : list (l) of lists (k) of lists (k)
        Coefficients of x_i and of x_{i+1}.
    E : list (l) of lists (k) of lists (m)
        Coefficients of the m further unknowns.
    b : list (l) of lists (k)
        Right sides.
    rows : list (m) of dict of int to list (k)
        For each border row {i: coefficients of x_i}, with the only i on which it depends.
    corner : list (m) of lists (m)
        Coefficients of the further unknowns in the border rows.
    c : list (m)
        Right sides of the border rows.
    """

    A: list[list[list[Any]]]
    D: list[list[list[Any]]]
    E: list[list[list[Any]]]
    b: list[list[Any]]
    rows: list[dict[int, list[Any]]]
    corner: list[list[Any]]
    c: list[Any]


def solve(system: Blocks) -> tuple[list[list[Any]], list[Any]]:
    """Return enclosures of x_0 ... x_{l-1} and of the further unknowns.

    Raises
    ------
    Singular
        If a pivot may be zero.
    """
    length, k, m = len(system.A), len(system.A[0]), len(system.c)
    last = length - 1
    nothing = [0] * k
    # block i -> border rows that depend on it: coefficients of x_i, [coefficients of e, right side]
    borders: dict[int, list[list[Any]]] = {}
    for row, corner, c in zip(system.rows, system.corner, system.c):
        for i, columns in row.items():
            borders.setdefault(i, []).append([columns, [*corner, c]])
    # columns of a running row: x_i, x_{i+1}, x_0, e, right side; after the last block: x_0, e, right side
    running: list[list[Any]] = []
    for row in range(k):
        tail = [*system.E[0][row], system.b[0][row]]
        A, D = system.A[0][row], system.D[0][row]
        running.append([*[p + q for p, q in zip(A, D)], *tail] if length == 1 else [*D, *nothing, *A, *tail])
    for columns, tail in borders.get(0, []):
        running.append([*columns, *tail] if length == 1 else [*nothing, *nothing, *columns, *tail])
    pivot_rows: list[list[list[Any]]] = []
    for i in range(1, length):
        rows = running
        for row in range(k):
            D = system.D[i][row]
            middle = [*nothing, *D] if i == last else [*D, *nothing]
            rows.append([*system.A[i][row], *middle, *system.E[i][row], system.b[i][row]])
        rows += [[*columns, *nothing, *nothing, *tail] for columns, tail in borders.get(i, [])]
        pivot_rows.append(_eliminate(rows, k))
        running = [row[2 * k :] if i == last else [*row[k : 2 * k], *nothing, *row[2 * k :]] for row in rows]
    pivots = _eliminate(running, k + m)
    solution = _back_substitute(pivots, k + m, [])
    head, extra = solution[:k], solution[k:]
    nodes: list[list[Any]] = [head]
    following = nothing
    for pivots in reversed(pivot_rows):
        following = _back_substitute(pivots, k, [*following, *head, *extra])
        nodes.insert(1, following)
    return nodes, extra


def _eliminate(rows: list[list[Any]], count: int) -> list[list[Any]]:
    """Eliminate the first `count` columns from `rows` in place; remove the pivot rows and return them."""
    pivots = []
    for column in range(count):
        sizes = [0.0 if _zero(row[column]) else float(row[column].abs_lower()) for row in rows]
        best = max(range(len(rows)), key=sizes.__getitem__)
        if not (sizes[best] > 0.0 or (not _zero(rows[best][column]) and rows[best][column].abs_lower() > 0)):
            raise Singular
        pivot = rows.pop(best)
        pivots.append(pivot)
        used = [j for j in range(column + 1, len(pivot)) if not _zero(pivot[j])]
        for row in rows:
            if _zero(row[column]):
                continue
            factor = row[column] / pivot[column]
            for j in used:
                row[j] = row[j] - factor * pivot[j]
            row[column] = 0
    return pivots


def _back_substitute(pivots: list[list[Any]], count: int, later: list[Any]) -> list[Any]:
    """Solve `count` pivot rows by back substitution; the `later` values are those of all later unknowns."""
    result: list[Any] = [0] * count
    for column in reversed(range(count)):
        row = pivots[column]
        value = row[-1]
        for j in range(column + 1, count):
            if not _zero(row[j]):
                value = value - row[j] * result[j]
        for j, number in enumerate(later, start=count):
            if not _zero(row[j]) and not _zero(number):
                value = value - row[j] * number
        result[column] = value / row[column]
    return result


def _zero(value: object) -> bool:
    """Whether an entry is an exact zero (the only integer that occurs)."""
    return isinstance(value, int)
