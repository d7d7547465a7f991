"""Orthogonal elimination of collocation equations against a dense solve: both cores, all sizes, the sign of the determinant."""

import numpy as np
import pytest

from contvines.flows.elimination import reference, solve_collocation


def written_out(blocks, columns, rows, foot, d, closure):
    """The whole matrix, and its right-hand sides."""
    (n, k, _), size = rows.shape, blocks.shape[0] * blocks.shape[1]
    m = size // n
    whole = np.zeros((size + k, size + foot.shape[1]))
    for i in range(n):
        here, first = slice(i * m, (i + 1) * m), (i + 1) * m % size
        whole[here, here] += blocks[i][:, :m]
        whole[here, first : first + d] += (closure if i == n - 1 else 1.0) * blocks[i][:, m:]
        whole[here, size:], whole[size:, here] = columns[i], rows[i]
    whole[size:, size:] = foot
    return whole[:, : size + k], whole[:, size + k :]


@pytest.mark.parametrize("method", [solve_collocation, reference])
@pytest.mark.parametrize(
    ("n", "m", "d", "k", "s"), [(1, 2, 1, 1, 1), (2, 3, 2, 2, 2), (7, 4, 3, 2, 2), (12, 7, 2, 1, 3)]
)
@pytest.mark.parametrize("closure", [1.0, -1.0])
def test_collocation_equations_are_solved_as_written_out(method, n, m, d, k, s, closure):
    """The sign may be another one than that of the determinant, as the order of rows and columns is, but always the same."""
    signs, others = [], []
    for seed in range(12):
        draw = np.random.default_rng(seed).standard_normal
        blocks, rows = draw((n, m * d, (m + 1) * d)), draw((n, k, m * d))
        columns, foot = draw((n, m * d, k + s)), draw((k, k + s))
        found = method(blocks, columns, rows, foot, d, closure)
        whole, sides = written_out(blocks, columns, rows, foot, d, closure)
        expected = np.linalg.solve(whole, sides)
        both = np.concatenate([found.states.reshape(-1, s), found.shared])
        assert np.abs(both - expected).max() < 1e-11 * np.abs(expected).max()
        signs.append(found.sign)
        others.append(np.linalg.slogdet(whole)[0])
    assert len(set(np.multiply(signs, others))) == 1 and len(set(signs)) == 2
