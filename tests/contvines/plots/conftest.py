"""The graph that most tests of pictures draw."""

import pytest

from tests.contvines import fakes


@pytest.fixture
def graph():
    return fakes.pitchfork_graph()
