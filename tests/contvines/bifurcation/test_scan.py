"""The scan of chunks: numbers known by hand, and the native core against numpy on drawn rows."""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from contvines.bifurcation.scan import NativeScan, SymmetryTest, with_arrays
from contvines.continuation.engine import Engine
from contvines.continuation.layout import Chunk, Metric, Status
from contvines.core.library import native

TURN = 2.0 * np.pi


class Shown(Engine):
    """What a scan asks of an engine: n unknowns of which the first is an angle, m multipliers, w margins."""

    def __init__(self, n, m, w, detection="map", parameter_weight=0.25):
        self.n, self.m, self.row_size, self.detection = n, m, 2 * m + w, detection
        self.weights = np.append(np.full(n, 1.0 / n), parameter_weight)
        self.metric = Metric(self.weights, np.ones(n + 1), 1.0 / n, parameter_weight)
        self.shift = TURN * np.eye(n)[0]
        self.compiled = self.plain = True
        self.upright = lambda p: 1e-9


def chunk(points, values, rows):
    """A chunk on which the parameter rises."""
    tangents, ones = np.ones((len(points), points.shape[1] + 1)), np.ones(len(points))
    return Chunk(points, values, tangents, rows, ones, 0.0 * ones, Status.RUNNING)


def symmetry(apply, engine):
    """The test of a symmetry."""
    found = SimpleNamespace(apply=apply, offset=None, kind="symmetry-breaking")
    return SymmetryTest(found, engine.n, engine.shift)


NUMBERS = st.one_of(
    st.sampled_from([0.0, -0.0, 1.0, -1.0, np.inf, -np.inf, np.nan, 1e-300, -2e-12, 1e300]),
    st.floats(-8.0, 8.0, width=32),
)


@pytest.mark.skipif(not native(), reason="no native core")
@given(st.data())
def test_native_and_numpy_agree(data):
    count, n, m, w = (data.draw(st.integers(low, high)) for low, high in ((2, 9), (1, 11), (0, 4), (0, 11)))
    engine = Shown(n, m, w, data.draw(st.sampled_from(["map", "flow", "real", "none"])))
    if data.draw(st.booleans()):
        engine.shift = None
    order = np.array(data.draw(st.permutations(range(n))))
    signs = np.array(data.draw(st.lists(st.sampled_from([-1.0, 1.0]), min_size=n, max_size=n)))
    applied = [lambda u: u + 0.0, lambda u: signs * u[order] + 0.25]
    symmetries = [symmetry(apply, engine) for apply in applied[: data.draw(st.integers(0, 2))]]
    assert all(test.affine is not None for test in symmetries)
    drawn = chunk(
        data.draw(arrays(float, (count, n), elements=st.floats(-20.0, 20.0))),
        data.draw(arrays(float, count, elements=st.floats(-2.0, 2.0))),
        data.draw(arrays(float, (count, 2 * m + w), elements=NUMBERS)),
    )
    scans = partial(with_arrays, engine, symmetries), NativeScan(engine, symmetries)
    one, other = (scan(drawn) for scan in scans)
    flat = [[*found[:2], *found.spectra, *found[4:7]] for found in (one, other)]
    for expected, numbers in zip(*flat):
        np.testing.assert_allclose(numbers, np.reshape(expected, numbers.shape), rtol=1e-13, atol=1e-11)
    # ways as long as they have to be: at equal numbers the last bit would decide
    drawn.rows *= 1.0 + 1e-3 * np.sin(1.0 + np.arange(drawn.rows.size).reshape(drawn.rows.shape))
    one, other = (scan(drawn).reached for scan in scans)
    np.testing.assert_array_equal(one, other)
