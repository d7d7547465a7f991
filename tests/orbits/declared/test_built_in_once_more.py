"""The built-in absorber declared in a machine file: the same words and the same special points, found by other means."""

from functools import partial

import pytest

from tools.pages.same_graph import both, compared, drawn

GRAPHS = [
    lambda: both("friction", within=(0.5, 0.88), depth=1)[1],
    partial(drawn, "absorber", 410, 14),
    partial(drawn, "absorber", 410, 18),
]


@pytest.mark.slow
@pytest.mark.parametrize("graphs", GRAPHS)
def test_absorbers_have_the_same_graph(graphs):
    own, declared = graphs()
    found = compared("absorber", own, declared)
    assert found.sentences == [] and found.points == len(own.special) > 1
