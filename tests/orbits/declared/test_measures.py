"""Measures and samples of a declared machine's orbits against one another and the orbit's own path."""

import numpy as np
import pytest

from tools.pages.pages import page


@pytest.fixture(scope="module")
def orbit():
    found = page("two_absorbers").attractor({"s1": 0.3, "s2": 0.3}, forcing=0.03, frequency=1.01).orbit
    assert found.model.forced and len(found.word)
    return found


def test_extremes_and_strobes_are_those_of_the_path(orbit):
    path = orbit.sample(40000)
    strobe = 2.0 * np.pi * np.ceil(path["phase"][0] / (2.0 * np.pi))
    for name in orbit.model.states[:2]:
        assert orbit.measure(f"max_{name}") == pytest.approx(path[name].max(), abs=1e-5)
        assert orbit.measure(f"min_{name}") == pytest.approx(path[name].min(), abs=1e-5)
        there = path[name][np.argmin(np.abs(path["phase"] - strobe))]
        assert orbit.measure(f"strobe_{name}") == pytest.approx(there, abs=1e-3 * np.ptp(path[name]) + 1e-9)
