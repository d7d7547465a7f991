"""Overhead of the package per point, for thirty unknowns with F and its Jacobian in Python and numpy.

    python -m tools.benchmarks.small

The processor time per point without the user's functions is compared with that of numpy's linear algebra alone: one solution of the
bordered system of 31 equations for each evaluation of the Jacobian.
"""

from __future__ import annotations

import time

import numpy as np

import contvines as cv

N, POINTS = 30, 1500


def main() -> None:
    """Print the comparison."""
    rng = np.random.default_rng(0)
    A = rng.standard_normal((N, N)) / 6.0 - 2.0 * np.eye(N)
    b = rng.standard_normal(N)
    calls = [0]

    def F(u, p):
        return A @ u + p * np.sin(u) + b

    def jacobian(u, p):
        calls[0] += 1
        return A + np.diag(p * np.cos(u))

    def derivative(u, p):
        return np.sin(u)

    u0 = np.linalg.solve(A, -b)
    problem = cv.AlgebraicProblem(F, u0, 0.0, jacobian=jacobian, derivative=derivative)
    problem.scale_within((0.0, 1.0))
    rounds = []
    M, sides = rng.standard_normal((N + 1, N + 1)), rng.standard_normal((N + 1, 2))
    for _ in range(5):
        calls[0] = 0
        began = time.process_time()
        points = sum(1 for _ in cv.trace(problem, within=(0.0, 1.0), settings={"max_step": 1.0 / POINTS}))
        whole, sweeps = time.process_time() - began, calls[0]
        began = time.process_time()
        for _ in range(sweeps):
            F(u0, 0.5), jacobian(u0, 0.5), derivative(u0, 0.5)
        own = time.process_time() - began
        began = time.process_time()
        for _ in range(sweeps):
            np.linalg.solve(M, sides)
        algebra = time.process_time() - began
        rounds.append([1e6 * x / points for x in (whole - own, algebra, own)] + [sweeps / points])
    overhead, algebra, own, sweeps = min(rounds)
    print(
        f"a point: overhead {overhead:.0f} us, numpy's linear algebra {algebra:.0f} us, the user's functions {own:.0f} us;"
    )
    print(f"{sweeps:.1f} Jacobians a point; overhead less linear algebra {overhead - algebra:.0f} us")


if __name__ == "__main__":
    main()
