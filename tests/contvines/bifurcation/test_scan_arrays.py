"""The native scan marks what the scan by arrays marks."""

import numpy as np
import pytest

from contvines.bifurcation import scan, scan_arrays
from contvines.bifurcation import segment_flags as bits
from contvines.continuation import aims
from contvines.continuation.arrays import Metric
from contvines.core.library import native

pytestmark = pytest.mark.skipif(not native(), reason="no native core")


@pytest.mark.parametrize("kind", [aims.NONE, aims.MAP, aims.FLOW, aims.REAL])
@pytest.mark.parametrize("real", [True, False])
def test_arrays_and_loops_mark_the_same(kind, real):
    seen = 0
    for seed in range(60):
        draw = np.random.default_rng(seed)
        n, size = int(draw.integers(1, 40)), int(draw.integers(1, 6))
        pairs, margins = (int(draw.integers(0, 4)) if kind != aims.NONE else 0), int(draw.integers(0, 7))
        points, values = np.cumsum(draw.normal(size=(n, size)), axis=0), np.cumsum(draw.normal(size=n))
        if seed % 3 == 0 and n > 4:
            values[2], points[2] = values[1], points[1]  # a segment of no length
        spectrum = draw.normal(1.0, 0.3, (n, pairs, 2)) * [1.0, 0.3]
        spectrum[draw.random((n, pairs)) < 0.5, 1] = 0.0  # real ones
        if kind == aims.REAL:
            spectrum[..., 0] -= 1.0  # watched at zero, pairs as well
        rows = np.hstack([spectrum.reshape(n, -1), draw.normal(0.4, 0.4, (n, margins))])
        symmetries = int(draw.integers(0, 3))
        orders = np.array([draw.permutation(size) for _ in range(symmetries)], np.int64).reshape(
            symmetries, size
        )
        images, constants = draw.choice([-1.0, 1.0], (symmetries, size)), draw.normal(size=(symmetries, size))
        shift = np.full(size, 2.0 * np.pi) * (seed % 2)
        chunk = bits.Scanned(points, values, draw.normal(size=n), rows, draw.choice([-1.0, 1.0], n))
        metric = Metric(np.ones(size + 1), np.ones(size + 1), 0.7, 1.3)
        if symmetries and n > 4:  # of the mirror u -> -u a step ends where next to nothing is changed
            orders[0], images[0], constants[0], points[3] = (
                np.arange(size),
                -1.0,
                0.0,
                1e-6 * draw.normal(size=size),
            )
        repeated = bits.Symmetries(orders, images, constants, shift, np.zeros((2, symmetries, size)))
        given = (chunk, 2 * pairs, kind, real, 1e-9, metric, repeated)
        marks = []
        for mark in (scan.in_native, scan_arrays.mark_segments):
            flags, smallest = np.zeros(max(n - 1, 0), np.int64), np.zeros(n)
            mark(*given, flags, smallest)
            marks.append((flags.tolist(), smallest.tolist()))
        assert marks[0] == marks[1], seed
        for flag in marks[0][0]:
            seen |= flag
    wanted = bits.FOLD | bits.SINGULAR | bits.BORDER | bits.HUMP | bits.MEETING | bits.LANDING
    wanted |= (bits.SHALLOW if real else 0) | (bits.MULTIPLIER if kind != aims.NONE else 0)
    assert seen & wanted == wanted
