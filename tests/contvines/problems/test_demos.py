"""Demos of other packages, as they are printed, unscaled: all special points, no others, each against a solve of its own.

The table says which points there are; :mod:`tools.demos.witness` solves for each of them in many digits, by its defining equations
and nothing of the package's. That there are no more was asked by Newton's method for these equations from many random starts
(``python -m tools.demos.search``).
"""

import json

import pytest

from tools.demos import listed, maps
from tools.demos.make_page import PAGES, cycles_page, render
from tools.demos.make_table import TABLE, graph_of, points_of, solved

pytestmark = pytest.mark.slow

DEMOS = [*listed.DEMOS, *maps.DEMOS]
EXPECTED = json.loads(TABLE.read_text(encoding="utf-8"))


def test_there_are_forty_and_more():
    assert len(DEMOS) >= 50 and len({demo.name for demo in DEMOS}) == len(DEMOS)
    assert set(EXPECTED) == {demo.name for demo in DEMOS}


@pytest.mark.parametrize("demo", DEMOS, ids=lambda demo: demo.name)
def test_demo(demo):
    graph = graph_of(demo)
    found, expected = points_of(graph), EXPECTED[demo.name]
    assert [(kind, pytest.approx(value, rel=1e-6, abs=1e-9)) for kind, value, _ in found] == [
        (row["kind"], row["value"]) for row in expected
    ]
    width = demo.within[1] - demo.within[0]
    stated = {point.value: point.location_error for point in graph.special.values()}
    for (kind, value, u), row in zip(found, expected):
        guess = row["u"] if len(row["u"]) == len(demo.u) else u
        exact = solved(demo, kind, row["value"], guess * row["cycle"])[0]
        assert value == pytest.approx(exact, rel=1e-10, abs=1e-12 * width), kind
        assert abs(value - exact) <= stated[value], "the stated error is too small"


@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("ab", {"fold": [0.0889318, 0.105739], "hopf": [0.130900]}),  # AUTO's demo ab
        ("pp2", {"branch-point": [0.6, 0.8219], "fold": [0.8329], "hopf": [0.6716]}),  # AUTO's demo pp2
        ("oxidation of CO", {"fold": [1.04204, 1.0522], "hopf": [1.0410, 1.0516]}),  # MatCont's manual
        ("morris-lecar II", {"hopf": [93.86, 212.02]}),  # Rinzel and Ermentrout 1989
        ("squid", {"hopf": [9.78, 154.5]}),  # XPPAUT
        ("lrz", {"hopf": [24.7368], "symmetry-breaking": [1.0]}),  # AUTO's manual; 470/19, Lorenz 1963
        ("wav", {"fold": [630.891, 666.144]}),  # AUTO's python/auto/test_data/fullTest.log, lines 127 and 128
        ("cusp", {"fold": [-0.384900, 0.384900]}),  # AUTO's manual
        ("adaptx", {"hopf": [1.000002]}),  # MatCont's manual
        ("henon", {"fold": [-0.1225]}),  # Henon, Commun. Math. Phys. 50 (1976) 69, for b = 0.3
        ("delayed logistic", {"neimark-sacker": [2.0]}),
        ("logistic", {"period-doubling": [3.0, 3.449489743]}),
    ],
)
def test_what_others_print(name, printed):
    for kind, values in printed.items():
        rows = [row["value"] for row in EXPECTED[name] if row["kind"] == kind]
        assert rows == pytest.approx(values, rel=3e-4), kind


def test_the_page_of_the_documentation_is_the_table():
    assert [page.read_text(encoding="utf-8") for page in PAGES] == [render(), cycles_page()]
