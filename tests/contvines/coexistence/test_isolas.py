"""Isolas of closed form, and an orbit that no diagram has: atlases find them. The list has slower ones, too."""

import pytest

from tools.attractors.isolas import ISOLAS

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("isola", [isola for isola in ISOLAS if isola.quick], ids=lambda isola: isola.name)
def test_an_isola_is_found(isola):
    graph = isola.atlas()
    assert isola.found(graph), str(graph)
