"""The bordered system of a long cycle of a declared machine, solved by blocks: against the whole matrix."""

from types import SimpleNamespace

import numpy as np
import pytest

from orbits.flows.page import cycle_equations as flights
from orbits.flows.page.pieces import workspace


@pytest.mark.parametrize(("states", "length"), [(2, 41), (2, 60), (6, 18), (6, 25)])
@pytest.mark.parametrize("transposed", [False, True])
def test_by_blocks_as_the_whole_matrix_has_it(states, length, transposed):
    d, size = states + 1, length * (states + 1)
    assert size > flights.CYCLIC
    draw = np.random.default_rng(length).standard_normal
    work = workspace(length, states, 3)
    for part in (work.own, work.following, work.derivative, work.residual):
        part[:] = draw(part.shape)
    mirror, border = np.array([1.0, *[-1.0] * states]), draw(size + 1)
    whole = np.zeros((size + 1, size + 1))
    for i in range(length):
        rows, after = slice(i * d, (i + 1) * d), (i + 1) % length
        whole[rows, rows] += work.own[i]
        whole[rows, after * d : (after + 1) * d] += work.following[i] * (mirror if after == 0 else 1.0)
    if transposed:
        whole[:size, :size] = whole[:size, :size].T.copy()
        work.turned[0] = 1.0
    whole[:size, size], whole[size] = work.derivative.ravel(), border
    expected = np.linalg.solve(whole, np.column_stack([[*-work.residual.ravel(), 0.7], np.eye(size + 1)[-1]]))
    data = SimpleNamespace(
        dimension=size, size=states, length=length, pinned=(), turned=mirror, still=(), resting=()
    )
    step, tangent = np.empty((2, size + 1))
    sign = flights.by_blocks(data, work, border, 0.7, step, tangent)
    assert sign == np.linalg.slogdet(whole)[0]
    for found, column in zip((step, tangent), expected.T):
        assert found == pytest.approx(column, rel=1e-9, abs=1e-9 * np.abs(column).max())
