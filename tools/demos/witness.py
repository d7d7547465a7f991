"""Independent solution of the demos' special points in many digits, from their defining equations and without code of the package.

    fold, branch point   F = 0, det A = 0 with A = dF/du (for cycles d(f^n)/dx - 1); at a branch point, where this is singular,
                         F + b w = 0, A^T w = 0, F_p.w = 0, w.w = 1 (Moore and Spence 1980; b = 0 in the end)
    Hopf                 F = 0, the last but one Hurwitz determinant of A's characteristic polynomial = 0
    period doubling      f^n = x, det(M + 1) = 0;  Neimark-Sacker: det M = 1 (two unknowns), p(-c) = 0 (three)

The characteristic polynomial is computed by the method of Faddeev and LeVerrier, derivatives by mpmath.
"""

from __future__ import annotations

from typing import Any

import mpmath as mp
import numpy as np

from .demo import MANY_DIGITS, Demo

DIGITS = 30
SMALL = 8  # largest number of unknowns for which points are solved in many digits
SINGULAR = ("branch-point", "symmetry-breaking")


def polynomial(matrix: Any) -> list[Any]:
    """Return the coefficients of det(x - A), highest first."""
    n = matrix.rows
    coefficients, power = [mp.mpf(1)], mp.eye(n)
    for k in range(1, n + 1):
        product = matrix * power
        coefficients.append(-sum(product[i, i] for i in range(n)) / k)
        power = product + coefficients[-1] * mp.eye(n)
    return coefficients


def hurwitz(c: list[Any]) -> Any:
    """Return the last but one Hurwitz determinant, which vanishes if two eigenvalues have the sum zero."""
    n = len(c) - 1
    if n == 2:
        return c[1]

    def entry(i: int, j: int) -> Any:
        return c[2 * j - i + 1] if 0 <= 2 * j - i + 1 <= n else mp.mpf(0)

    return mp.det(mp.matrix([[entry(i, j) for j in range(n - 1)] for i in range(n - 1)]))


def equations(demo: Demo, cycle: int, m: Any = MANY_DIGITS) -> Any:
    """Return F as a function of (u, p): the equations, or f^n(x) - x."""
    if demo.kind == "flow":
        return lambda u, p: demo.equations(u, p, m)

    def around(u: list[Any], p: Any) -> list[Any]:
        x = list(u)
        for _ in range(cycle):
            x = demo.equations(x, p, m)
        return [a - b for a, b in zip(x, u)]

    return around


def jacobian(f: Any, u: list[Any], p: Any) -> Any:
    """dF/du by central differences of fourth order, in twice the digits."""
    n, h = len(u), mp.mpf(10) ** (-mp.mp.dps // 5)
    columns = []
    for j in range(n):
        size = h * (1 + abs(u[j]))

        def at(t: int, j: int = j, size: Any = size) -> list[Any]:
            return f([*u[:j], u[j] + t * size, *u[j + 1 :]], p)

        far, near = zip(at(2), at(-2)), zip(at(1), at(-1))
        columns.append([(8 * (c - d) - (a - b)) / (12 * size) for (a, b), (c, d) in zip(far, near)])
    return mp.matrix([[columns[j][i] for j in range(n)] for i in range(n)])


def condition(kind: str, demo: Demo, matrix: Any) -> Any:
    """Return the function of the Jacobian of F that vanishes at a special point."""
    n = matrix.rows
    if kind == "period-doubling":
        return mp.det(matrix + 2 * mp.eye(n))
    if kind == "neimark-sacker":
        c = polynomial(matrix + mp.eye(n))
        return c[2] - 1 if n == 2 else 1 - c[2] + c[1] * c[3] - c[3] ** 2
    return hurwitz(polynomial(matrix)) if kind == "hopf" else mp.det(matrix)


def solve(demo: Demo, kind: str, u: list[float], p: float, cycle: int = 1) -> tuple[list[Any], Any]:
    """Solve for a special point near a guess; return (u, p).

    Raises
    ------
    ValueError
        If Newton's method does not converge.
    """
    f, n = equations(demo, cycle), len(u)
    with mp.workdps(2 * DIGITS):
        z = [mp.mpf(float(x)) for x in u] + [mp.mpf(float(p))]
        if kind in SINGULAR:
            system, z = _singular(f, z), z + _left(f, z)
        else:

            def system(z: list[Any]) -> list[Any]:
                point, value = z[:n], z[n]
                return [*f(point, value), condition(kind, demo, jacobian(f, point, value))]

        for _ in range(12):
            step = mp.lu_solve(jacobian(lambda z, _: system(z), z, None), mp.matrix([-x for x in system(z)]))
            z = [a + b for a, b in zip(z, step)]
            if max(abs(b) / (1 + abs(a)) for a, b in zip(z, step)) < mp.mpf(10) ** -20:
                return z[:n], z[n]
    raise ValueError(f"{demo.name}: no {kind} near {p}")


def _left(f: Any, z: list[Any]) -> list[Any]:
    """Return start values of b and w: 0 and a left null vector of the Jacobian."""
    matrix = jacobian(f, z[:-1], z[-1])
    n = matrix.rows
    w = mp.matrix([mp.mpf(1) / (k + 2) for k in range(n)])
    for _ in range(3):
        w = mp.lu_solve(matrix.T + mp.mpf(10) ** -12 * mp.eye(n), w)
        w = w / mp.norm(w)
    return [mp.mpf(0), *w]


def _singular(f: Any, z: list[Any]) -> Any:
    n = len(z) - 1

    def system(z: list[Any]) -> list[Any]:
        u, p, b, w = z[:n], z[n], z[n + 1], z[n + 2 :]
        matrix = jacobian(f, u, p)
        slope = _slope(f, u, p)
        rows = [x + b * y for x, y in zip(f(u, p), w)]
        null = [sum(matrix[i, j] * w[i] for i in range(n)) for j in range(n)]
        across = sum(slope[i] * w[i] for i in range(n))
        return [*rows, *null, across, sum(y * y for y in w) - 1]

    return system


def _slope(f: Any, u: list[Any], p: Any) -> list[Any]:
    h = mp.mpf(10) ** (-mp.mp.dps // 5) * (1 + abs(p))
    parts = zip(f(u, p + 2 * h), f(u, p - 2 * h), f(u, p + h), f(u, p - h))
    return [(8 * (c - d) - (a - b)) / (12 * h) for a, b, c, d in parts]


def turning(demo: Demo, u: list[float], p: float) -> tuple[float, list[float]]:
    """Return (p, u) of a fold with many unknowns, at which p is stationary as a function of the middle unknown.

    Newton's method solves the equations with this unknown fixed; a parabola through three points that approach each other locates the fold.
    """
    middle = len(u) // 2

    def at(s: float) -> np.ndarray:
        z = np.append(u, p)
        for _ in range(20):
            rows = np.append(demo.function(z[:-1], z[-1]), z[middle] - s)
            columns = []
            for j in range(len(z)):
                moved = z.astype(complex)
                moved[j] += 1e-30j
                columns.append(
                    np.append(np.imag(demo.function(moved[:-1], moved[-1])) / 1e-30, 1.0 * (j == middle))
                )
            step = np.linalg.solve(np.array(columns).T, rows)
            z = z - step
            if np.abs(step).max() < 1e-13 * (1.0 + np.abs(z).max()):
                break
        return z

    s, h = u[middle], 1e-3 * (abs(u[middle]) or 1.0)
    for _ in range(4):
        low, here, high = (float(at(s + t)[-1]) for t in (-h, 0.0, h))
        s += 0.5 * h * (low - high) / (low - 2.0 * here + high)
    z = at(s)
    return float(z[-1]), z[:-1].tolist()
