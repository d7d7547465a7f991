"""Orthogonal block-cyclic elimination against a dense solve, and products of matrices against their construction."""

import numpy as np
import pytest

from contvines.flows.elimination import condense, multipliers_of, solve_cyclic

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


def test_unknowns_inside_an_interval_are_eliminated():
    rng = np.random.default_rng(2)
    blocks, columns = rng.standard_normal((3, 6, 8)), rng.standard_normal((3, 6, 2))
    cond = condense(blocks, columns, 2)
    ends, shared = rng.standard_normal((3, 2)), rng.standard_normal(2)
    for i in range(3):
        # inside unknowns from the maps; the equations that are left then tell what remains of all six
        after = np.linalg.solve(cond.right[i], -(cond.left[i] @ ends[i] + cond.columns[i] @ shared))
        inside = -cond.maps[i] @ np.concatenate([ends[i], after, shared])
        residual = blocks[i] @ np.concatenate([ends[i], inside, after]) + columns[i] @ shared
        assert np.abs(residual).max() < 1e-11


def test_multipliers_keep_their_own_digits_over_seventy_decades():
    rng = np.random.default_rng(0)
    frames = np.linalg.qr(rng.standard_normal((40, 3, 3)))[0]
    wanted = np.array([1e30, 10**-0.8, 1e-40])
    factors = [frames[(i + 1) % 40] @ np.diag(wanted ** (1 / 40)) @ frames[i].T for i in range(40)]
    found = np.abs(multipliers_of(-np.array(factors), np.tile(np.eye(3), (40, 1, 1))))
    assert np.allclose(found / wanted, 1.0, rtol=1e-11)


def test_a_pair_beside_a_tiny_multiplier():
    rng = np.random.default_rng(1)
    frames = np.linalg.qr(rng.standard_normal((40, 3, 3)))[0]
    c, s = np.cos(0.3 / 40), np.sin(0.3 / 40)
    step = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 0.1]])
    factors = [frames[(i + 1) % 40] @ step @ frames[i].T for i in range(40)]
    found = multipliers_of(-np.array(factors), np.tile(np.eye(3), (40, 1, 1)))
    pair = found[np.abs(found.imag) > 0.1]
    assert np.allclose(np.sort_complex(pair), np.sort_complex(np.exp([0.3j, -0.3j])), atol=1e-12)
    assert np.isclose(np.abs(found).min(), 1e-40, rtol=1e-11)
