"""Where a motion on a page is delicate it is compared twice, and the smaller deviation counts."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from orbits.cycles import deviation as module
from tools.pages.pages import page


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
    followed = module.FOLLOWED["page"]
    monkeypatch.setattr(followed, "by_events", lambda orbit: events)
    monkeypatch.setattr(followed, "by_positions", lambda orbit: states)
    orbit = SimpleNamespace(word="R", model=SimpleNamespace(flow="page"))
    assert module.deviation(orbit, lambda: (np.array([margin]), np.array([multiplier]))) == told


@pytest.mark.parametrize("early", [1e-8, 1e-5, 1e-3])
def test_no_simulation_follows_events_in_the_wrong_order(early):
    """A stick that begins after the slip that ends it: nothing but time that runs back leads from the one to the other."""
    orbit = page("absorber").orbit("ss", amplitude=0.35, friction=0.5, gravity=0.4)
    assert orbit.real and orbit.replay() < 1e-12
    slip = orbit.word.events.index("u")
    nodes = orbit.nodes.copy()
    nodes[slip - 1, 0] = nodes[slip, 0] + early
    assert replace(orbit, nodes=nodes).replay() == float("inf")
