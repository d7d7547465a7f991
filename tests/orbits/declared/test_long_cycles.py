"""Long cycles of a declared machine: words that repeat a shorter one lose nothing, and their bordered system is solved as the whole matrix has it."""

from types import SimpleNamespace

import numpy as np
import pytest

from orbits.flows.page import cycle_equations as flights
from orbits.flows.page.pieces import workspace
from tests.orbits.elimination.closures import written_out
from tools.pages.pages import page


@pytest.mark.parametrize("times", [3, 61])
def test_a_word_that_repeats_a_shorter_one_loses_nothing(times):
    orbit = page("impact_oscillator").attractor(frequency=2.3).orbit
    long = orbit.repeat(times)
    guess = long.nodes + 1e-4 * np.random.default_rng(times).standard_normal(long.nodes.shape)
    again = orbit.model.orbit(long.word, long.periods, guess, **orbit.parameters)
    assert again.nodes == pytest.approx(long.nodes, abs=1e-9)
    expected = np.sort_complex(orbit.multipliers**times)
    np.testing.assert_allclose(np.sort_complex(again.multipliers), expected, rtol=1e-7)


@pytest.mark.parametrize(("states", "length"), [(2, 41), (2, 60), (6, 18), (6, 25)])
@pytest.mark.parametrize("transposed", [False, True])
def test_by_blocks_as_the_whole_matrix_has_it(states, length, transposed):
    size = length * (states + 1)
    assert size > flights.CYCLIC
    draw = np.random.default_rng(length).standard_normal
    work = workspace(length, states, 3)
    for part in (work.own, work.following, work.derivative, work.residual):
        part[:] = draw(part.shape)
    mirror, border = np.array([1.0, *[-1.0] * states]), draw(size + 1)
    matrix = written_out(work.own, work.following, mirror)
    work.turned[0] = float(transposed)
    matrix = matrix.T if transposed else matrix
    whole = np.block([[matrix, work.derivative.reshape(-1, 1)], [border]])
    expected = np.linalg.solve(whole, np.column_stack([[*-work.residual.ravel(), 0.7], np.eye(size + 1)[-1]]))
    data = SimpleNamespace(
        dimension=size, size=states, length=length, pinned=(), turned=mirror, still=(), resting=()
    )
    found = np.empty((2, size + 1))
    sign = flights.by_blocks(data, work, border, 0.7, *found)
    assert sign == np.linalg.slogdet(whole)[0]
    np.testing.assert_allclose(found, expected.T, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
