"""Scripts with numpy and scipy for the same branch, as a user would write them: vectorised, with analytic Jacobian and fixed steps.

Each function follows the branch from the start of `case` with a fixed step of arclength and at most three Newton iterations,
to 1e-10, and returns amplitudes and multipliers.
"""

import numpy as np
from scipy.optimize import fsolve
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from . import case


def residual(u, C):
    """Return the 2 l residuals."""
    r, mu, g, eps, omega = case.PARAMS[1:]
    a = (1.0 + eps) * mu * g
    psi, b = u[0::2], u[1::2]
    psi1, b1 = np.roll(psi, -1), np.roll(b, -1)
    psi1[-1] += np.pi * len(psi)
    s = np.where(np.arange(len(psi)) % 2, 1.0, -1.0)
    d = (psi1 - psi) / omega
    V = C * omega * np.cos(psi1) - b - s * a * d
    F = np.empty_like(u)
    F[0::2] = b1 - C * omega * np.cos(psi1) - r * V
    F[1::2] = -2.0 * s + C * (np.sin(psi1) - np.sin(psi)) - (b + 0.5 * s * a * d) * d
    return F


def blocks(u, C):
    """Return dF_i/dx_i and dF_i/dx_{i+1}, both (l, 2, 2), and dF/dC (2 l,)."""
    r, mu, g, eps, omega = case.PARAMS[1:]
    a = (1.0 + eps) * mu * g
    psi, b = u[0::2], u[1::2]
    l = len(psi)
    psi1 = np.roll(psi, -1)
    psi1[-1] += np.pi * l
    s = np.where(np.arange(l) % 2, 1.0, -1.0)
    d = (psi1 - psi) / omega
    pull = b + s * a * d
    V = C * omega * np.cos(psi1) - pull
    A, D, Q = np.zeros((l, 2, 2)), np.zeros((l, 2, 2)), np.empty(2 * l)
    A[:, 0, 0], A[:, 0, 1] = -r * s * a / omega, r
    A[:, 1, 0], A[:, 1, 1] = pull / omega - C * np.cos(psi), -d
    D[:, 0, 0], D[:, 0, 1], D[:, 1, 0] = (
        (1.0 + r) * C * omega * np.sin(psi1) + r * s * a / omega,
        1.0,
        V / omega,
    )
    Q[0::2], Q[1::2] = -(1.0 + r) * omega * np.cos(psi1), np.sin(psi1) - np.sin(psi)
    return A, D, Q


def jacobian(u, C):
    """Return the dense Jacobian (2 l, 2 l), and dF/dC."""
    A, D, Q = blocks(u, C)
    l = len(A)
    J = np.zeros((l, 2, l, 2))
    i = np.arange(l)
    J[i, :, i, :] += A
    J[i, :, (i + 1) % l, :] += D
    return J.reshape(2 * l, 2 * l), Q


def multipliers(u, C):
    """Return the eigenvalues of the product of -D^-1 A."""
    A, D, _ = blocks(u, C)
    product = np.eye(2)
    for factor in -np.linalg.solve(D, A):
        product = factor @ product
    return np.linalg.eigvals(product)


def _places(l):
    i = np.arange(l)
    rows = np.repeat(2 * i, 4) + np.tile([0, 0, 1, 1], l)
    here = np.repeat(2 * i, 4) + np.tile([0, 1, 0, 1], l)
    ahead = np.repeat(2 * ((i + 1) % l), 4) + np.tile([0, 1, 0, 1], l)
    return rows, here, ahead


def dense(l, points, step=case.STEP):
    """Solve the bordered system with numpy's dense solver."""

    def solve(u, C, row, sides):
        J, Q = jacobian(u, C)
        return np.linalg.solve(np.block([[J, Q[:, None]], [row[None, :]]]), sides)

    return _follow(l, points, step, solve)


def sparse(l, points, step=case.STEP):
    """Solve the bordered system with scipy's sparse LU factorisation."""
    rows, here, ahead = _places(l)
    n = 2 * l
    i = np.concatenate([rows, rows, np.arange(n), np.full(n + 1, n)])
    j = np.concatenate([here, ahead, np.full(n, n), np.arange(n + 1)])

    def solve(u, C, row, sides):
        A, D, Q = blocks(u, C)
        matrix = csc_matrix((np.concatenate([A.ravel(), D.ravel(), Q, row]), (i, j)), (n + 1, n + 1))
        return splu(matrix).solve(sides)

    return _follow(l, points, step, solve)


def _follow(l, points, step, solve):
    u, C, tangent = case.start(l)
    n = 2 * l
    weights = np.append(np.full(n, case.metric(l)[0]), case.metric(l)[1])
    amplitudes, spectra = [C], [multipliers(u, C)]
    for _ in range(points):
        row = weights * tangent
        z = np.append(u, C) + step * tangent
        target = row @ z
        for _ in range(8):
            sides = np.zeros((n + 1, 2))
            sides[:n, 0], sides[n] = -residual(z[:n], z[n]), (target - row @ z, 1.0)
            solution = solve(z[:n], z[n], row, sides)
            z = z + solution[:, 0]
            if np.abs(solution[:, 0]).max() < 1e-10:
                break
        u, C, tangent = z[:n], z[n], solution[:, 1]
        tangent = tangent / np.sqrt(weights @ tangent**2)
        amplitudes.append(C)
        spectra.append(multipliers(u, C))
    return np.array(amplitudes), np.array(spectra)


def by_fsolve(l, points, step=case.STEP):
    """Solve with scipy.optimize.fsolve at given amplitudes (without arclength), with analytic Jacobian."""
    u, C, _ = case.start(l)
    amplitudes, spectra = [C], [multipliers(u, C)]
    for _ in range(points):
        C = C + step * (case.INTERVAL[1] - case.INTERVAL[0])
        u = fsolve(residual, u, (C,), fprime=lambda u, C: jacobian(u, C)[0], xtol=1e-10)
        amplitudes.append(C)
        spectra.append(multipliers(u, C))
    return np.array(amplitudes), np.array(spectra)
