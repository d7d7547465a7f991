"""Orthogonal block-cyclic elimination against a dense solve, and products of matrices against their construction."""

import numpy as np
import pytest

from contvines.flows.elimination import multipliers_of, reference, solve_collocation, solve_cyclic

SIZES = [(1, 2, 1, 2), (2, 3, 2, 1), (5, 3, 2, 2), (8, 2, 1, 1), (13, 1, 2, 2)]


def drawn(n, d, k, s, seed):
    rng = np.random.default_rng(seed)
    left, right = rng.standard_normal((2, n, d, d))
    columns, rows = rng.standard_normal((n, d, k + s)), rng.standard_normal((n + 1, k, d))
    rows[n] = 0.0
    return left, right, columns, rows, rng.standard_normal((k, k + s))


def written_out(left, right, columns, rows, foot, closure):
    n, d, _ = left.shape
    k = len(foot)
    whole = np.zeros((n * d + k, n * d + foot.shape[1]))
    for i in range(n):
        here, after = slice(i * d, (i + 1) * d), (i + 1) % n * d
        whole[here, here] += left[i]
        whole[here, after : after + d] += (closure if i == n - 1 else 1.0) * right[i]
        whole[here, n * d :], whole[n * d :, here] = columns[i], rows[i]
    whole[n * d :, n * d :] = foot
    return whole[:, : n * d + k], whole[:, n * d + k :]


@pytest.mark.parametrize(("n", "d", "k", "s"), SIZES)
@pytest.mark.parametrize("closure", [1.0, -1.0])
def test_a_block_cyclic_system_is_solved_as_a_dense_one(n, d, k, s, closure):
    system = drawn(n, d, k, s, n)
    found = solve_cyclic(*system, closure)
    expected = np.linalg.solve(*written_out(*system, closure))
    assert np.allclose(found.mesh[:n].reshape(n * d, s), expected[: n * d], atol=1e-11)
    assert np.allclose(found.mesh[n], closure * found.mesh[0])
    assert np.allclose(found.shared, expected[n * d :], atol=1e-11)


@pytest.mark.parametrize(("n", "d", "k", "s"), SIZES)
def test_the_sign_changes_with_that_of_the_determinant(n, d, k, s):
    systems = [drawn(n, d, k, s, seed) for seed in range(12)]
    signs = np.array([solve_cyclic(*system).sign for system in systems])
    dense = np.array([np.sign(np.linalg.det(written_out(*system, 1.0)[0])) for system in systems])
    assert len(set(signs * dense)) == 1  # the order of rows and columns is another one, always the same
    assert len(set(dense)) == 2


def test_multipliers_keep_their_own_digits_over_seventy_decades():
    rng = np.random.default_rng(0)
    frames = np.linalg.qr(rng.standard_normal((40, 3, 3)))[0]
    wanted = np.array([1e30, 10**-0.8, 1e-40])
    factors = [frames[(i + 1) % 40] @ np.diag(wanted ** (1 / 40)) @ frames[i].T for i in range(40)]
    found = np.abs(multipliers_of(-np.array(factors), np.tile(np.eye(3), (40, 1, 1))))
    assert np.allclose(found / wanted, 1.0, rtol=1e-11)


@pytest.mark.parametrize("method", [solve_collocation, reference])
@pytest.mark.parametrize(
    ("n", "m", "d", "k", "s"), [(1, 2, 1, 1, 1), (2, 3, 2, 2, 2), (7, 4, 3, 2, 2), (12, 7, 2, 1, 3)]
)
@pytest.mark.parametrize("closure", [1.0, -1.0])
def test_collocation_equations_are_solved_as_written_out(method, n, m, d, k, s, closure):
    rng = np.random.default_rng(n)
    blocks, rows = rng.standard_normal((n, m * d, (m + 1) * d)), rng.standard_normal((n, k, m * d))
    columns, foot = rng.standard_normal((n, m * d, k + s)), rng.standard_normal((k, k + s))
    size = n * m * d
    whole, sides = np.zeros((size + k, size + k)), np.zeros((size + k, s))
    for i in range(n):
        here, first = slice(i * m * d, (i + 1) * m * d), (i + 1) * m * d % size
        whole[here, here] += blocks[i][:, : m * d]
        whole[here, first : first + d] += (closure if i == n - 1 else 1.0) * blocks[i][:, m * d :]
        whole[here, size:], whole[size:, here] = columns[i][:, :k], rows[i]
        sides[here] = columns[i][:, k:]
    whole[size:, size:], sides[size:] = foot[:, :k], foot[:, k:]
    found = method(blocks, columns, rows, foot, d, closure)
    expected = np.linalg.solve(whole, sides)
    scale = np.abs(expected).max()
    assert np.abs(found.states.reshape(size, s) - expected[:size]).max() < 1e-11 * scale
    assert np.abs(found.shared - expected[size:]).max() < 1e-11 * scale
