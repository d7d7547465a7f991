"""Lyapunov exponents by neighbours that are not always in the same modes when they are looked at."""

import numpy as np
import pytest

from orbits.flows.page import growth as module


class Doubling:
    """A motion at rest beside which distances double from sample to sample."""

    def __init__(self, machine=None, params=None):
        self.machine, self.params = machine, params
        self.state, self.clock, self.modes, self.base = np.zeros(2), 0.0, (), 0.0

    def start(self, state, clock, modes):
        self.state = np.array(state)


@pytest.mark.parametrize("alike_every", [1, 2, 3])
def test_samples_that_are_waited_out_count_as_time(monkeypatch, alike_every):
    calls = 0

    def together(stepper, other):
        nonlocal calls
        calls += 1
        other.state = 2.0 * other.state
        return calls % alike_every == 0

    monkeypatch.setattr(module, "Stepper", Doubling)
    monkeypatch.setattr(module, "_together", together)
    exponent, error = module.growth(Doubling(), samples=100)
    assert exponent == pytest.approx(np.log(2.0), rel=1e-9) and error < 1e-9
