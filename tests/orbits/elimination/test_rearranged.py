"""The transposed system and the one with the closure turned round, against dense matrices."""

import numpy as np
import pytest

from orbits.arguments import jacobian, workspace
from tests.orbits.elimination.closures import both_cores, closed_by, kernels_of


def drawn(length, node, seed):
    work = workspace(length, node, 6)
    draw = np.random.default_rng(seed)
    for part in work[:4]:
        part[...] = draw.normal(size=part.shape)
    return work, draw


def written_out(work, twist):
    """dF/du: row i is A_i x_i + D_i x_{i+1}, and x_L is x_0 with all but its first entry times the twist."""
    A, D = work[1], work[2]
    length, n = A.shape[:2]
    matrix = np.zeros((length * n, length * n))
    for i in range(length):
        for r in range(n):
            for c in range(n):
                matrix[i * n + r, i * n + c] += A[i, r, c]
                last = i + 1 == length
                matrix[i * n + r, (0 if last else i + 1) * n + c] += D[i, r, c] * (
                    twist if last and c else 1.0
                )
    return matrix


@both_cores
@pytest.mark.parametrize("node", [2, 4])
@pytest.mark.parametrize("twist", [1.0, -1.0])
@pytest.mark.parametrize("length", [1, 2, 5])
def test_transposed_systems(core, node, twist, length):
    work, draw = drawn(length, node, 10 * node + length)
    data, size = closed_by(twist), node * length
    matrix = written_out(work, twist)
    np.testing.assert_allclose(jacobian(data, work), matrix, atol=1e-15)
    other = workspace(length, node, 6)
    b, c = draw.normal(size=(2, size))
    kernels_of(core).transpose(data, work, c, other)
    other[0][...] = 0.0
    step, tangent = np.zeros(size + 1), np.zeros(size + 1)
    kernels_of(core).bordered(data, other, np.append(b, 0.0), 0.0, step, tangent)
    whole = np.block([[matrix.T, c[:, None]], [b, np.zeros((1, 1))]])
    exact = np.linalg.solve(whole, np.append(np.zeros(size), 1.0))
    np.testing.assert_allclose(tangent, exact, atol=1e-12 * np.linalg.cond(whole) * np.abs(exact).max())


@both_cores
@pytest.mark.parametrize("twist", [1.0, -1.0])
@pytest.mark.parametrize("length", [1, 3])
def test_the_closure_turned_round(core, twist, length):
    """Perturbations that come back with the opposite sign, in all entries: x_L = -T x_0."""
    work, _ = drawn(length, 2, length)
    before = written_out(work, twist)
    last = np.zeros_like(before)
    last[-2:, :2] = work[2][-1] * np.array([1.0, twist])
    kernels_of(core).flip(closed_by(twist), work, -1.0)
    np.testing.assert_allclose(written_out(work, twist), before - 2.0 * last, atol=1e-15)
    kernels_of(core).flip(closed_by(twist), work, 1.0)
    np.testing.assert_allclose(written_out(work, twist), before, atol=1e-15)
