"""A graph of which several tests follow points in a second parameter."""

import pytest

from tests.machines import absorber_graph


@pytest.fixture(scope="session")
def absorber():
    """The symmetric motion of the reduced absorber and what leaves it."""
    return absorber_graph(0.55, (0.2, 1.3))
