"""The bordered elimination of cycles against dense linear algebra, short and long, with one and the other closure."""

import numpy as np
import pytest

from orbits.arguments import workspace
from tests.orbits.elimination.closures import both_cores, closed_by, kernels_of


def dense(work, twist, border):
    """The bordered matrix [[J, F_p], [border]] written out."""
    F, A, D, Q = work[:4]
    length, n = F.shape
    size = length * n
    matrix = np.zeros((size + 1, size + 1))
    for i in range(length):
        rows, columns = slice(i * n, i * n + n), slice(i * n, i * n + n)
        matrix[rows, columns] += A[i]
        ahead = (i + 1) % length
        closure = np.diag(np.r_[1.0, np.full(n - 1, twist)]) if i + 1 == length else np.eye(n)
        matrix[rows, ahead * n : ahead * n + n] += D[i] @ closure
    matrix[:size, size] = Q.ravel()
    matrix[size] = border
    return matrix


@both_cores
@pytest.mark.parametrize("node", [2, 3, 4])
@pytest.mark.parametrize("twist", [1.0, -1.0])
@pytest.mark.parametrize("length", [1, 2, 3, 10, 31, 32, 33, 47, 48, 63, 64, 100, 200])
def test_against_dense_algebra(core, node, twist, length):
    draw = np.random.default_rng(1000 * node + length)
    work = workspace(length, node, 6)
    for part in work[:4]:
        part[...] = draw.normal(size=part.shape)
    size = node * length
    border, step, tangent = draw.normal(size=size + 1), np.zeros(size + 1), np.zeros(size + 1)
    sign = kernels_of(core).bordered(closed_by(twist), work, border, 0.7, step, tangent)
    matrix = dense(work, twist, border)
    tolerance = 1e-13 * np.linalg.cond(matrix)
    for found, side in ((step, np.append(-work[0].ravel(), 0.7)), (tangent, np.append(np.zeros(size), 1.0))):
        exact = np.linalg.solve(matrix, side)
        assert np.abs(found - exact).max() <= tolerance * np.abs(exact).max()
    constant = -1.0 if core == "native" and node % 2 and length % 2 == 0 else 1.0
    assert sign == constant * np.linalg.slogdet(matrix)[0]


@both_cores
@pytest.mark.parametrize("length", [31, 1024])
def test_unstable_cycles_lose_nothing(core, length):
    """Saddles that stretch by 8 and shrink by 8 per node: forward products reach 1e3700, the elimination must not."""
    draw = np.random.default_rng(length)
    work = workspace(length, 2, 6)
    F, A, D, Q = work[:4]
    angles = draw.uniform(0.0, 0.3, length + 1)
    turn = np.array([[np.cos(angles), -np.sin(angles)], [np.sin(angles), np.cos(angles)]]).transpose(2, 0, 1)
    turn[length] = turn[0]
    A[...] = turn[1:] @ np.diag([8.0, 0.125]) @ turn[:-1].transpose(0, 2, 1)
    D[...] = -np.eye(2)
    Q[...] = draw.normal(size=Q.shape)
    F[...] = draw.normal(size=F.shape)
    size = 2 * length
    border, step, tangent = np.zeros(size + 1), np.zeros(size + 1), np.zeros(size + 1)
    border[size] = 1.0
    kernels_of(core).bordered(closed_by(1.0), work, border, 0.25, step, tangent)
    x = step[:size].reshape(length, 2)
    left = np.einsum("ijk,ik->ij", A, x) - np.roll(x, -1, axis=0) + 0.25 * Q + F
    assert step[size] == pytest.approx(0.25, abs=1e-14) and np.abs(left).max() < 1e-13 * np.abs(x).max() * 8.0
