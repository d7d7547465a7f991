"""Wilson and Cowan's two populations (Hoppensteadt and Izhikevich, Weakly Connected Neural Networks, 1997, section 2.3.3) have the symmetry
(x, y, rx, ry) -> (1 - x, 1 - y, -rx, -12 - ry) for a = b = c = 10, d = -2: points of codimension two come in pairs."""

import numpy as np

import contvines as cv


def _unit(s):
    return 1.0 / (1.0 + np.exp(-s))


def _rates(x, p):
    return [-x[0] + _unit(p.rx + 10 * x[0] - 10 * x[1]), -x[1] + _unit(p.ry + 10 * x[0] + 2 * x[1])]


def test_points_on_folds_come_in_pairs_however_the_unknowns_are_scaled():
    flow = cv.FlowProblem(_rates, [0.1, 0.1], {"rx": -4.0, "ry": -6.0})  # y is 0.003 there, and goes to 1
    graph = cv.diagram(flow.equilibria("rx"), over="rx", within=(-8.0, 8.0), depth=0)
    one, other = (cv.locus(graph[label], over="ry", within=(-12.0, 6.0)) for label in ("LP1", "LP4"))
    first = sorted((point.kind, *point.value) for point in one.points.values())
    second = sorted((point.kind, -point.value[0], -12.0 - point.value[1]) for point in other.points.values())
    assert [kind for kind, *_ in first] == ["bogdanov-takens", "bogdanov-takens", "cusp"]
    assert [kind for kind, *_ in second] == [kind for kind, *_ in first]
    assert np.allclose([row[1:] for row in first], [row[1:] for row in second], rtol=0.0, atol=1e-8)
