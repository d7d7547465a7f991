"""Steady states of the slow flow: which of them the ansatz covers, and at which phase they stand."""

import numpy as np
import pytest

from orbits.theory.multiple_scales import SlowFlow, equilibria


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_states_solve_both_equations_and_say_whether_they_are_valid(friction):
    """Valid where the absorber does not reverse: B - h - C > 0."""
    seen = set()
    for forcing in (0.5, 2.47, 8.0):
        flow = SlowFlow(forcing=forcing, friction=friction)
        for detuning in np.linspace(-6.0, 6.0, 9):
            for state in equilibria(flow, float(detuning)):
                rates = flow.rates(state.position, state.phase, detuning, state.manifold)
                assert rates == pytest.approx((0.0, 0.0), abs=1e-9)
                if state.manifold == "impacting":
                    room = state.velocity - 0.5 * np.pi * friction * flow.gravity - state.amplitude
                    assert state.valid is bool(room > 0.0)
                    seen.add(state.valid)
    assert seen == {True, False}
