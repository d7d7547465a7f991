"""The network: boxes, arrows and captions."""

import pytest

from contvines.plots import plot_network
from tests.contvines import fakes


@pytest.fixture
def graph():
    return fakes.pitchfork_graph()


def test_network_has_a_box_per_branch_and_names_the_switches(graph):
    texts = [t.get_text() for t in plot_network(graph).axes[0].texts]
    assert [t.split()[0] for t in texts[:3]] == ["B1", "B2", "B3"]
    assert texts[3:] == ["BP1", "VG1"]
