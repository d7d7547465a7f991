"""Compare sparse problems with a short script that uses scipy.sparse: two-dimensional Bratu problem on n by n inner points.

    python -m tools.benchmarks.large [n]
    python -m tools.benchmarks.large 316 whole
    python -m tools.benchmarks.large 5000 line

The script does the minimum for a point: two factorisations in Newton's method for a bordered system by block elimination, without special
points and stability. Processor seconds per point, their ratios, and the largest memory are printed.
"""

from __future__ import annotations

import resource
import sys
import time
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

import contvines as cv
from tools.brusselator import brusselator


def bratu(n: int) -> tuple[Any, Any, Any]:
    """Return F, F_u, F_p of Laplace u + p exp(u) = 0 on the unit square."""
    line = (
        sp.diags_array([np.ones(n - 1), -2.0 * np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1]) * (n + 1) ** 2
    )
    laplace = (sp.kron(line, sp.identity(n)) + sp.kron(sp.identity(n), line)).tocsc()

    def F(u: np.ndarray, p: float) -> np.ndarray:
        return laplace @ u + p * np.exp(u)

    def jacobian(u: np.ndarray, p: float) -> Any:
        return (laplace + sp.diags_array(p * np.exp(u))).tocsc()

    return F, jacobian, lambda u, p: np.exp(u)


def script(n: int, points: int, step: float = 0.05) -> float:
    """Seconds per point of a simple script."""
    F, jacobian, derivative = bratu(n)
    N = n * n
    u, p = np.zeros(N), 0.0
    du, dp = np.zeros(N), 1.0
    began = time.process_time()
    for _ in range(points):
        u1, p1 = u + step * du, p + step * dp
        for _ in range(2):
            factors = splu(jacobian(u1, p1), permc_spec="MMD_AT_PLUS_A")
            a, b = factors.solve(np.column_stack([F(u1, p1), derivative(u1, p1)])).T
            gap = du @ (u1 - u) / N + dp * (p1 - p) - step
            shift = (gap - du @ a / N) / (dp - du @ b / N)
            u1, p1 = u1 - a + b * shift, p1 - shift
        tangent = -b
        size = np.sqrt(tangent @ tangent / N + 1.0) * np.sign(du @ tangent / N + dp)
        u, p, du, dp = u1, p1, tangent / size, 1.0 / size
    return (time.process_time() - began) / points


def package(n: int, points: int, spectrum: str = "none") -> tuple[float, int]:
    """Seconds per point of the package, and the number of points."""
    F, jacobian, derivative = bratu(n)
    problem = cv.AlgebraicProblem(
        F, np.zeros(n * n), 0.0, jacobian=jacobian, derivative=derivative, spectrum=spectrum, scale=1.0
    )
    began, count = time.process_time(), 0
    for _ in cv.trace(problem, within=(0.0, 8.0), settings={"max_points": points}):
        count += 1
    return (time.process_time() - began) / count, count


def fold(n: int, spectrum: str = "none") -> Any:
    """Return the fold of the diagram."""
    F, jacobian, derivative = bratu(n)
    problem = cv.AlgebraicProblem(
        F, np.zeros(n * n), 0.0, jacobian=jacobian, derivative=derivative, spectrum=spectrum
    )
    graph = cv.diagram(problem, within=(0.0, 8.0), bounds={"u0": (None, 0.2)})
    return graph.of_kind("fold")[0]


def fold_by_itself(n: int, u: np.ndarray, p: float) -> float:
    """Solve for the fold near a solution by Newton's method with scipy alone.

    F = 0 and g = 0, where [[F_u, b], [b, 0]] (v, g) = (0, 1); F_u is symmetric, so g_z = -v.(F_u)_z v. Griewank and Reddien, IMA J. Numer.
    Anal. 4 (1984) 295.
    """
    F, jacobian, derivative = bratu(n)
    line = np.sin(np.pi * np.arange(1, n + 1) / (n + 1))
    b = np.outer(line, line).reshape(-1, 1)
    b /= np.linalg.norm(b)
    for _ in range(12):
        A = jacobian(u, p)
        right = np.append(np.zeros(n * n), 1.0)
        v = splu(sp.bmat([[A, b], [b.T, None]], format="csc"), permc_spec="MMD_AT_PLUS_A").solve(right)
        g, v = float(v[-1]), v[:-1]
        bend = np.exp(u) * v * v
        system = sp.bmat(
            [[A, derivative(u, p)[:, None]], [-p * bend[None, :], np.array([[-bend.sum()]])]], format="csc"
        )
        step = splu(system, permc_spec="MMD_AT_PLUS_A").solve(-np.append(F(u, p), g))
        u, p = u + step[:-1], p + float(step[-1])
        if abs(step[-1]) < 1e-14 * p:
            break
    return p


def whole(n: int) -> None:
    """Follow the whole branch from p = 0 through its fold, and compare the fold with the one solved by scipy."""
    F, jacobian, derivative = bratu(n)
    problem = cv.AlgebraicProblem(F, np.zeros(n * n), 0.0, jacobian=jacobian, derivative=derivative)
    began = time.process_time()
    graph = cv.diagram(problem, within=(0.0, 8.0), bounds={"norm": (None, 1.5 * n)})
    seconds = time.process_time() - began
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    (branch,) = graph
    (point,) = graph.of_kind("fold")
    exact = fold_by_itself(n, point.u, point.value)
    print(graph)
    print(
        f"N = {n * n}: {len(branch.values)} points, {seconds:.0f} s, {seconds / len(branch.values):.2f} s a point; {memory:.0f} MB"
    )
    print(
        f"largest unknown {branch.points[-1].max():.3f}; fold {point.value!r} +- {point.location_error:.1e}, by itself {exact!r}"
    )
    print(f"they differ by {abs(point.value - exact) / exact:.1e}")


def line(m: int) -> None:
    """Brusselator on a line of m cells: compare the first Turing point of the homogeneous state, and its Hopf point (with ten eigenvalues), with closed forms."""
    modes = 4.0 * m**2 * np.sin(np.arange(1, 9) * np.pi / (2 * m)) ** 2
    for kind, (A, D, E), within, spectrum in (
        ("branch-point", (2.0, 0.02, 0.5), (2.0, 2.16), "none"),
        ("hopf", (1.0, 0.008, 0.004), (1.5, 2.01), "flow"),
    ):
        exact = 1.0 + A**2
        if kind == "branch-point":
            exact = float(((1.0 + D * modes) * (A**2 + E * modes) / (E * modes)).min())
        F, jacobian, derivative = brusselator(m, A, D, E)
        start = np.tile([A, within[0] / A], m)
        began = time.process_time()
        problem = cv.AlgebraicProblem(
            F, start, within[0], "B", jacobian=jacobian, derivative=derivative, spectrum=spectrum
        )
        graph = cv.diagram(problem, within=within, depth=0)
        seconds, points = time.process_time() - began, len(graph["B1"].values)
        (found,) = graph.of_kind(kind)
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(f"N = {2 * m}, {kind}: {points} points, {seconds:.1f} s; {memory:.0f} MB")
        print(
            f"    {found.value!r} +- {found.location_error:.1e}, closed form {exact!r}, differ by {abs(found.value - exact):.1e}"
        )


def main(n: int) -> None:
    """Print the comparison."""
    points = 40
    plain = script(n, points)
    ours, count = package(n, points)
    stable, _ = package(n, points, "flow")
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"N = {n * n}: script {plain:.4f} s a point; ours {ours:.4f} ({ours / plain:.2f}), {count} points;")
    print(f"with ten leading eigenvalues {stable:.4f} ({stable / plain:.2f}); largest memory {memory:.0f} MB")


if __name__ == "__main__":
    (whole if "whole" in sys.argv else line if "line" in sys.argv else main)(
        int(sys.argv[1]) if len(sys.argv) > 1 else 100
    )
