"""Systems of cycles against dense linear algebra: bordered, short and long, transposed, and with one and the other closure."""

import numpy as np
import pytest

from orbits.arguments import jacobian, workspace
from tests.orbits.elimination.closures import both_cores, closed_by, drawn, kernels_of, turned, written_out

pytestmark = [both_cores, pytest.mark.parametrize("twist", [1.0, -1.0])]


@pytest.mark.parametrize("node", [2, 3, 4])
@pytest.mark.parametrize("length", [1, 2, 3, 10, 31, 32, 33, 47, 48, 63, 64, 100, 200])
def test_bordered_systems(core, node, twist, length):
    work, draw = drawn(length, node, 1000 * node + length)
    size = node * length
    border, found = draw.normal(size=size + 1), np.zeros((2, size + 1))
    matrix = np.block([[written_out(*work[1:3], turned(node, twist)), work[3].reshape(-1, 1)], [border]])
    sign = kernels_of(core).bordered(closed_by(twist), work, border, 0.7, *found)
    exact = np.linalg.solve(matrix, np.column_stack([np.append(-work[0].ravel(), 0.7), np.eye(size + 1)[-1]]))
    tolerance = 1e-13 * np.linalg.cond(matrix)
    assert np.all(np.abs(found - exact.T).max(axis=1) <= tolerance * np.abs(exact).max(axis=0))
    constant = -1.0 if core == "native" and node % 2 and length % 2 == 0 else 1.0
    assert sign == constant * np.linalg.slogdet(matrix)[0]


@pytest.mark.parametrize("node", [2, 4])
@pytest.mark.parametrize("length", [1, 2, 5])
def test_transposed_systems(core, node, twist, length):
    work, draw = drawn(length, node, 10 * node + length)
    data, size, other = closed_by(twist), node * length, workspace(length, node, 6)
    matrix = written_out(*work[1:3], turned(node, twist))
    np.testing.assert_allclose(jacobian(data, work), matrix, atol=1e-15)
    b, c = draw.normal(size=(2, size))
    kernels_of(core).transpose(data, work, c, other)
    other[0][...] = 0.0
    step, tangent = np.zeros((2, size + 1))
    kernels_of(core).bordered(data, other, np.append(b, 0.0), 0.0, step, tangent)
    whole = np.block([[matrix.T, c[:, None]], [b, np.zeros((1, 1))]])
    exact = np.linalg.solve(whole, np.append(np.zeros(size), 1.0))
    np.testing.assert_allclose(tangent, exact, atol=1e-12 * np.linalg.cond(whole) * np.abs(exact).max())


@pytest.mark.parametrize("length", [1, 3])
def test_the_closure_turned_round(core, twist, length):
    """Perturbations that come back with the opposite sign, in all entries: x_L = -T x_0."""
    work, _ = drawn(length, 2, length)
    for sign in (-1.0, 1.0):
        wanted = written_out(*work[1:3], -turned(2, twist))
        kernels_of(core).flip(closed_by(twist), work, sign)
        np.testing.assert_allclose(written_out(*work[1:3], turned(2, twist)), wanted, atol=1e-15)
