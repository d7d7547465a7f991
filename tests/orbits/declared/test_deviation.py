"""Where a motion on a page is delicate it is compared twice, and the smaller deviation counts."""

from types import SimpleNamespace

import pytest

from orbits.declared import deviation as module


@pytest.mark.parametrize(
    ("margin", "multiplier", "events", "states", "told"),
    [
        (1.0, 0.5, float("inf"), 1e-6, float("inf")),
        (1e-6, 0.5, 3e-4, 1e-6, 1e-6),
        (1e-6, 0.5, 3e-4, 2e-3, 3e-4),
        (1.0, 2e3, float("inf"), 2e-3, 2e-3),
        (1e-6, 0.5, 1e-12, 2e-3, 1e-12),
    ],
)
def test_the_smaller_deviation_counts_of_events_and_states_counts(
    monkeypatch, margin, multiplier, events, states, told
):
    monkeypatch.setattr(module, "by_events", lambda orbit: events)
    monkeypatch.setattr(module, "by_states", lambda orbit: states)
    orbit = SimpleNamespace(margins=[SimpleNamespace(value=margin)], multipliers=[multiplier])
    assert module.deviation(orbit) == told
