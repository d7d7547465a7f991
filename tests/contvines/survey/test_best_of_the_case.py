"""The best clearance of the worked case is that of a brute-force scan, here a small one; `tools/benchmarks/best.py` has the large one."""

from dataclasses import replace

import numpy as np
import pytest

from orbits.design import choice as choosing
from orbits.settings import DESIGNING
from tools.benchmarks.best import chosen, scanned

pytestmark = pytest.mark.slow


def test_the_best_clearance_is_that_of_a_scan(monkeypatch):
    monkeypatch.setattr(choosing, "DESIGNING", replace(DESIGNING, accuracy=0.02))  # the scan is coarser
    low, high, count = 14.0, 18.0, 5
    choice = chosen(low, high, 3, depth=0)
    places, peaks = scanned(low, high, count, depth=0)
    least = int(np.nanargmin(peaks))
    assert abs(choice.values["half_width"] - places[least]) <= places[1] - places[0]
    assert choice.outcome <= peaks[least] * (1.0 + 1e-3)
