"""A graph of which several tests follow points in a second parameter."""

import pytest

import contvines as cv
from tests.machines import ABSORBER


@pytest.fixture(scope="session")
def absorber():
    """The symmetric motion of the reduced absorber and what leaves it."""
    return cv.diagram(ABSORBER.symmetric_orbit(amplitude=0.55), over="amplitude", within=(0.2, 1.3))
