"""Crossings of loci: of polygons, and of two folds of unconnected cells in closed form."""

from types import SimpleNamespace

import numpy as np
import pytest

import contvines as cv
from contvines.loci.crossings import crossings, segments


def test_polygons_cross_where_their_lines_do():
    a = np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]])
    b = np.array([[0.0, 0.5], [2.0, 0.5]])
    places = [place for _, _, place in segments(a, b)]
    assert np.allclose(places, [[0.5, 0.5], [1.5, 0.5]])


def test_two_folds_of_two_cells_cross_in_closed_form():
    # x' = a + b x - x^3 folds at a = 2 (b/3)^(3/2); y' = a - 0.3 + y - y^3 folds at a = 0.3 + 2/27^(1/2), whatever b is:
    # both at once where the two values are one
    def f(u, p):
        return np.array([p.a + p.b * u[0] - u[0] ** 3, p.a - 0.3 + u[1] - u[1] ** 3])

    start = [min(np.roots([-1.0, 0.0, 1.0, a]), key=lambda r: abs(np.imag(r))).real for a in (-1.0, -1.3)]
    problem = cv.AlgebraicProblem(f, start, {"a": -1.0, "b": 1.0}, parameter="a", spectrum="flow")
    graph = cv.diagram(problem, over="a", within=(-1.2, 1.2), depth=0)
    chart = cv.chart(graph, over="b", within=(0.6, 2.2), regions=False)
    second = 0.3 + 2 / 27**0.5
    b = 3 * (second / 2) ** (2 / 3)
    values = [(c["value"]["a"], c["value"]["b"]) for c in chart.crossings]
    assert any(np.allclose(value, (second, b), atol=1e-9) for value in values), values
    assert chart.to_dict()["crossings"] == chart.crossings


def test_crossings_are_on_the_segments_that_are_told():
    """Two polygons drawn at random: each place lies on both of its segments, and the pairs are those whose ends lie on both sides."""
    draw = np.random.default_rng(3)
    a, b = draw.uniform(size=(9, 2)), draw.uniform(size=(7, 2))

    def side(line, point):
        return np.sign(np.linalg.det([line[1] - line[0], point - line[0]]))

    wanted = {
        (i, j)
        for i in range(len(a) - 1)
        for j in range(len(b) - 1)
        if side(a[i : i + 2], b[j]) != side(a[i : i + 2], b[j + 1])
        and side(b[j : j + 2], a[i]) != side(b[j : j + 2], a[i + 1])
    }
    found = segments(a, b)
    assert len(wanted) > 3 and {(i, j) for i, j, _ in found} == wanted
    for i, j, place in found:
        for line, k in ((a, i), (b, j)):
            along = line[k + 1] - line[k]
            share = (place - line[k]) @ along / (along @ along)
            assert 0.0 <= share <= 1.0
            np.testing.assert_allclose(line[k] + share * along, place, atol=1e-12)


@pytest.mark.parametrize(("first", "second", "count"), [(0, 0, 1), (1, 0, 0), (0, 1, 0)])
def test_crossings_of_real_parts_alone_count(first, second, count):
    """Two straight loci that cross in the middle of their second segments; on either one the part from there on may be virtual."""
    real = [np.array([True, True, not virtual]) for virtual in (first, second)]
    lines = [np.array([[0.0, 0.0], [0.4, 0.4], [0.8, 0.8]]), np.array([[1.2, 0.0], [0.8, 0.4], [0.4, 0.8]])]
    loci = {
        name: SimpleNamespace(
            values=values,
            real=flags,
            problem=None,
            within=(0.0, 1.2),
            branch=SimpleNamespace(values=values[:, 1]),
        )
        for name, values, flags in zip(("A", "B"), lines, real)
    }
    chart = SimpleNamespace(within=((0.0, 1.2), (0.0, 1.2)), loci=loci, points={}, parameters=("p", "q"))
    found = crossings(chart)
    assert len(found) == count
    for crossing in found:
        assert crossing["on"] == ["A", "B"]
        assert crossing["value"] == pytest.approx({"p": 0.6, "q": 0.6})
